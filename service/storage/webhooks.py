"""Webhooks: receivers of events, what each has got, and which service delivers to it.

A service *holds* a webhook by a lease, as a worker holds a task of a render: of several services over one database only one
delivers to a receiver. What the holder notes counts only while it has the lease.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from sqlalchemy import Engine, func, select
from sqlalchemy.orm import Session

from render.errors import NotFoundError
from service.storage.database.connection import is_shared, time_of, transaction
from service.storage.database.tables import EventRow, WebhookRow
from service.storage.events import Wanted

MOST_WEBHOOKS = 32
"""Webhooks of all projects together."""
BACK_OFF_S = 2.0
"""Pause before the second try; twice as long each time."""
MOST_BACK_OFF_S = 600.0
GIVE_UP_S = 86_400.0
"""Time for which a receiver is tried without success until its webhook is disabled."""
LEAST_FAILURES = 100
"""Tries that it has had then: a service that was off for a day has not tried."""
MAX_ERROR = 500
"""Length of an error's text."""


@dataclass(frozen=True)
class Held:
    """A webhook that the present service delivers to.

    Attributes:
        id: of the webhook.
        url: of its receiver.
        secret: that its deliveries are signed with.
        wanted: which events it gets.
        after: number of the last event that is delivered, or not wanted.
        failures: tries in succession without success.
        wait_s: time until the next try, s.
    """

    id: str
    url: str
    secret: str = field(repr=False)
    wanted: Wanted
    after: int
    failures: int
    wait_s: float


class Webhooks:
    """The webhooks. Any thread may use them, and any number of processes.

    Args:
        engine: of a database that `service.storage.database.connection` has opened.
        clock: tells the time in a transaction, s since 1970; by default the clock that all users of the database share.
    """

    def __init__(self, engine: Engine, clock: Callable[[Session], float] = time_of) -> None:
        self._engine = engine
        self._clock = clock

    def add(self, url: str, secret: str, wanted: Wanted) -> WebhookRow | None:
        """Add a webhook, which gets the events from now on. Returns None where there are `MOST_WEBHOOKS`.

        Args:
            url: of the receiver.
            secret: that its deliveries are signed with.
            wanted: which events it gets.
        """
        with transaction(self._engine) as session:
            if (session.scalar(select(func.count()).select_from(WebhookRow)) or 0) >= MOST_WEBHOOKS:
                return None
            row = WebhookRow(
                id=f"w-{secrets.token_hex(6)}",
                url=url,
                secret=secret,
                **vars(wanted) | {"topics": list(wanted.topics)},
                created_at=self._clock(session),
                after=session.scalar(select(func.max(EventRow.number))) or 0,
            )
            session.add(row)
            session.flush()
            return row

    def list(self, project: str | None) -> Sequence[WebhookRow]:
        """Return the webhooks of a project, the oldest first; None for those of all."""
        query = select(WebhookRow).order_by(WebhookRow.created_at, WebhookRow.id)
        if project is not None:
            query = query.where(WebhookRow.project == project)
        with transaction(self._engine, only_reads=True) as session:
            return session.scalars(query).all()

    def get(self, webhook: str, project: str | None) -> WebhookRow:
        """Return a webhook of a project; None for any. Raises `NotFoundError`."""
        with transaction(self._engine, only_reads=True) as session:
            return _find(session, webhook, project)

    def remove(self, webhook: str, project: str | None) -> None:
        """Remove a webhook of a project; None for any. Raises `NotFoundError`."""
        with transaction(self._engine) as session:
            session.delete(_find(session, webhook, project))

    def enable(self, webhook: str, project: str | None) -> WebhookRow:
        """Let a webhook of a project that was disabled go on where it was; None for any. Raises `NotFoundError`."""
        with transaction(self._engine) as session:
            row = _find(session, webhook, project)
            if row.disabled is not None:
                row.disabled = row.failing_since = row.next_try_at = None
                row.failures = 0
            return row

    def hold(self, worker: str, lease_s: float, reached: Mapping[str, int]) -> Sequence[Held]:
        """Take the webhooks that no other service delivers to, and extend the leases of those that are held.

        Args:
            worker: name of the service.
            lease_s: time after which the service is taken for gone.
            reached: number of the last event that each webhook has got, or does not want, by its id.

        Returns:
            All that the service holds now.
        """
        query = select(WebhookRow).where(WebhookRow.disabled.is_(None))
        with transaction(self._engine, only_reads=True) as session:
            rows, now = session.scalars(query).all(), self._clock(session)
        if any(self._is_due(row, worker, lease_s, now) for row in rows):
            with transaction(self._engine) as session:
                rows, now = session.scalars(query).all(), self._clock(session)
                for row in rows:
                    if self._is_due(row, worker, lease_s, now):
                        row.worker, row.lease_until = worker, now + lease_s
                        row.after = max(row.after, reached.get(row.id, 0))
        return [_held(row, now) for row in rows if row.worker == worker]

    def release(self, worker: str, reached: Mapping[str, int]) -> None:
        """Leave the webhooks of a service to others, as when it stops.

        Args:
            worker: name of the service.
            reached: as for `hold`.
        """
        with transaction(self._engine) as session:
            for row in session.scalars(select(WebhookRow).where(WebhookRow.worker == worker)):
                row.worker = row.lease_until = None
                row.after = max(row.after, reached.get(row.id, 0))

    def note_delivered(self, webhook: str, worker: str, after: int, status: int) -> bool:
        """Note that a receiver has got an event; return whether the service still holds the webhook.

        Args:
            webhook: its id.
            worker: name of the service.
            after: number to go on after.
            status: of the answer.
        """
        with transaction(self._engine) as session:
            row = session.get(WebhookRow, webhook)
            if row is None or row.worker != worker:
                return False
            row.after, row.last_status, row.failures = after, status, 0
            row.last_error = row.failing_since = row.next_try_at = None
            return row.disabled is None

    def note_failed(self, webhook: str, worker: str, status: int | None, error: str, ends: bool) -> float | None:
        """Note that a receiver has not taken an event. Where that has lasted for `GIVE_UP_S`, the webhook is disabled.

        Args:
            webhook: its id.
            worker: name of the service.
            status: of the answer; None where there was none.
            error: what went wrong, for people.
            ends: whether the receiver wants no more events, so that the webhook is disabled at once.

        Returns:
            Time until the next try, s; None where the webhook is disabled, gone, or another service's.
        """
        with transaction(self._engine) as session:
            row, now = session.get(WebhookRow, webhook), self._clock(session)
            if row is None or row.worker != worker or row.disabled is not None:
                return None
            row.last_status, row.last_error = status, error[:MAX_ERROR]
            row.failures += 1
            row.failing_since = now if row.failing_since is None else row.failing_since
            if ends or (row.failures >= LEAST_FAILURES and now - row.failing_since >= GIVE_UP_S):
                row.disabled = row.last_error if ends else f"no success for 24 hours; {row.last_error}"
                row.worker = row.lease_until = row.next_try_at = None
                return None
            pause_s = min(BACK_OFF_S * 2.0 ** min(row.failures - 1, 30), MOST_BACK_OFF_S)
            row.next_try_at = now + pause_s
            return pause_s

    def _is_due(self, row: WebhookRow, worker: str, lease_s: float, now: float) -> bool:
        """Return whether a service may take a webhook, or has to extend its lease."""
        if row.worker == worker:
            return row.lease_until is None or row.lease_until < now + lease_s * 2 / 3
        if row.worker is None or row.lease_until is None or row.lease_until < now:
            return True
        return not is_shared(self._engine)  # of a service before, as one alone works in a data folder


def _find(session: Session, webhook: str, project: str | None) -> WebhookRow:
    row = session.get(WebhookRow, webhook)
    if row is None or project not in (None, row.project):
        raise NotFoundError(f"there is no webhook {webhook[:80]!r}", code="webhook_not_found", path=webhook[:80])
    return row


def _held(row: WebhookRow, now: float) -> Held:
    wanted = Wanted(row.project, row.topics, row.shot, row.render)
    wait_s = max((row.next_try_at or 0.0) - now, 0.0)
    return Held(row.id, row.url, row.secret, wanted, row.after, row.failures, wait_s)
