"""Who makes which product of a render next, and what became of it: products are claimed and held by leases, as frames are.

All of it is in the rows of the renders, and each change is in a transaction that writes, of which there is one at a time.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from typing import Literal

from sqlalchemy import ColumnElement, Engine, select
from sqlalchemy.orm import Session

from service.jobs.attempts import MOST_FAILURES, MOST_LEASE_S, MOST_LOSSES, back_off_of
from service.jobs.events import noted
from service.jobs.product_states import changed_entry, has_product_to_make, may_be_made, put_products
from service.jobs.states import find_render, note_end
from service.jobs.turns import by_turn, may_begin
from service.storage.database.connection import is_shared, transaction
from service.storage.database.tables import ProductEntry, RenderRow
from service.storage.events import EventLog


@dataclass(frozen=True)
class ProductClaim:
    """A product that a service makes.

    Attributes:
        render: id of the render.
        name: of the product.
        attempt: number of this attempt, from 1 on.
        owner: id of the principal whose render it is.
    """

    render: str
    name: str
    attempt: int
    owner: str


class ProductQueue:
    """The products of the renders of a database. Any thread may use it, and any number of processes.

    Args:
        engine: of the database.
        events: takes down what changes.
        clock: tells the time in a transaction, s since 1970.
        holder: id of the data folder, which holds claims.
        has_bucket: whether renders whose shots are in a bucket are worked on.
    """

    def __init__(
        self, engine: Engine, events: EventLog, clock: Callable[[Session], float], holder: str, *, has_bucket: bool
    ) -> None:
        self._engine, self._events, self._clock = engine, events, clock
        self._holder, self._has_bucket = holder, has_bucket

    def claim(self, lease_s: float) -> ProductClaim | None:
        """Claim the next product: of the render with the highest priority, then of the oldest; None where all wait.

        Args:
            lease_s: time after which the service is taken for gone, unless it extends the lease.
        """
        with transaction(self._engine, only_reads=True) as session:
            is_worth_it = self._may_begin(self._clock(session)) | (RenderRow.products_running > 0)
            if session.scalar(select(RenderRow.id).where(is_worth_it).limit(1)) is None:
                return None
        with transaction(self._engine) as session:
            now = self._clock(session)
            self._end_lost(session, now)
            for render_id in by_turn(session, self._may_begin(now)):
                render = session.get_one(RenderRow, render_id)
                for name in render.products:
                    if may_be_made(render, name, now):
                        return self._begin(session, render, name, now, lease_s)
            return None

    def extend(self, claim: ProductClaim, lease_s: float) -> bool:
        """Extend a lease; return whether the product is still this service's and wanted."""
        with transaction(self._engine) as session:
            render = self._held(session, claim)
            if render is None:
                return False
            self._extend(session, render, claim.name, lease_s)
            return render.wanted != "cancel"

    def finish(self, claim: ProductClaim, size_bytes: int) -> None:
        """Note that a product is made and stored."""
        with transaction(self._engine) as session:
            render = self._held(session, claim)
            if render is not None:
                change: dict[str, object] = {"state": "done", "size_bytes": size_bytes, "error": None}
                self._put(session, render, claim.name, change)

    def fail(self, claim: ProductClaim, error: str, *, may_pass: bool = False) -> None:
        """Note that a product could not be made.

        Args:
            claim: the product.
            error: what went wrong, for people.
            may_pass: whether another try may succeed.
        """
        with transaction(self._engine) as session:
            render = self._held(session, claim)
            if render is not None:
                self._try_again(session, render, claim.name, "failures", MOST_FAILURES if may_pass else 1, error)

    def give_back(self, claim: ProductClaim, pause_s: float = 0.0) -> None:
        """Give a product back that was not finished, as when the service stops.

        Args:
            claim: the product.
            pause_s: time until it is claimed again.
        """
        with transaction(self._engine) as session:
            render = self._held(session, claim)
            if render is not None:
                until = self._clock(session) + pause_s
                self._put(session, render, claim.name, {"state": "waiting", "not_before": until})

    def take_back_left(self, kept: Collection[ProductClaim] = (), lease_s: float = 0.0) -> None:
        """Take back the products that this holder does not work on any more; it counts as no loss.

        Args:
            kept: claims that it works on, whose leases are extended: none when a service starts.
            lease_s: of these.
        """
        keys = {(claim.render, claim.name, claim.attempt) for claim in kept}
        with transaction(self._engine) as session:
            for render, name, entry in _running(session):
                is_its = entry["holder"] == self._holder or not is_shared(self._engine)
                if not is_its:
                    continue
                if (render.id, name, entry["attempts"]) in keys:
                    self._extend(session, render, name, lease_s)
                else:
                    self._put(session, render, name, {"state": "waiting"})

    def note_size(self, render_id: str, size_bytes: int) -> None:
        """Note the size of all products of a render. Raises `NotFoundError`: it was removed meanwhile."""
        with transaction(self._engine) as session:
            find_render(session, render_id).product_bytes = size_bytes

    def _may_begin(self, now: float) -> ColumnElement[bool]:
        """Return the condition that a product of a render may be made, but for the pauses of the products themselves."""
        home = self._holder if is_shared(self._engine) else None
        return has_product_to_make() & may_begin(now, home, has_bucket=self._has_bucket)

    def _begin(self, session: Session, render: RenderRow, name: str, now: float, lease_s: float) -> ProductClaim:
        attempt = render.products[name]["attempts"] + 1
        held = {"state": "running", "attempts": attempt, "holder": self._holder, "lease_until": now + lease_s}
        with noted(self._events, session, render):
            render.started_at = render.started_at or now
            put_products(render, {name: changed_entry(render.products[name], held)})
        return ProductClaim(render.id, name, attempt, render.owner)

    def _extend(self, session: Session, render: RenderRow, name: str, lease_s: float) -> None:
        until = self._clock(session) + lease_s
        put_products(render, {name: changed_entry(render.products[name], {"lease_until": until})})

    def _end_lost(self, session: Session, now: float) -> None:
        """Take products back whose leases have run out, or end so late that the clock was set back."""
        for render, name, entry in _running(session):
            if not now <= (entry["lease_until"] or 0.0) <= now + MOST_LEASE_S:
                self._try_again(session, render, name, "losses", MOST_LOSSES, "the service that made it is gone")

    def _try_again(
        self,
        session: Session,
        render: RenderRow,
        name: str,
        counter: Literal["failures", "losses"],
        most: int,
        error: str,
    ) -> None:
        """End an attempt that has failed or was lost; the product has failed after the last one of `most`."""
        tries = render.products[name][counter] + 1
        change: dict[str, object] = {
            "state": "failed" if tries >= most else "waiting",
            counter: tries,
            "not_before": self._clock(session) + back_off_of(tries),
            "error": error,
        }
        self._put(session, render, name, change)

    def _put(self, session: Session, render: RenderRow, name: str, change: dict[str, object]) -> None:
        """End an attempt; a product that waits again is given up where its render is."""
        if change["state"] == "waiting" and render.wanted == "cancel":
            change = change | {"state": "canceled"}
        with noted(self._events, session, render):
            if change["state"] == "failed":
                render.accepted = False  # what was accepted was without this
            change = change | {"holder": None, "lease_until": None}
            put_products(render, {name: changed_entry(render.products[name], change)})
        note_end(render, self._clock(session))

    def _held(self, session: Session, claim: ProductClaim) -> RenderRow | None:
        """Return the render of a claim; None where the product is another service's by now, or was removed."""
        render = session.get(RenderRow, claim.render)
        entry = render and render.products.get(claim.name)
        if not entry or (entry["state"], entry["holder"], entry["attempts"]) != (
            "running",
            self._holder,
            claim.attempt,
        ):
            return None
        return render


def _running(session: Session) -> Iterator[tuple[RenderRow, str, ProductEntry]]:
    """Yield the products that are made, with their renders."""
    for render in session.scalars(select(RenderRow).where(RenderRow.products_running > 0)).all():
        for name, entry in list(render.products.items()):
            if entry["state"] == "running":
                yield render, name, entry
