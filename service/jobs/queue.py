"""The queue of renders: who draws which frame next, and what became of it. All of it is in the database, so nothing is lost.

A worker *claims* a task and holds it by a lease, which it extends while it draws. A lease that runs out means that the worker is
gone. See `service.jobs.attempts` for when a task is tried again.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import AbstractContextManager

from sqlalchemy import Engine, delete, func, select, update
from sqlalchemy.orm import Session, undefer

from render.errors import NotFoundError
from service.jobs.attempts import Attempts
from service.jobs.claims import Claim, NewRender
from service.jobs.errors import ConflictError
from service.jobs.events import noted, render_event
from service.jobs.frame_logs import FrameLogs, forget_logs
from service.jobs.frame_ranges import format_frames
from service.jobs.lookups import RenderLookups, sent_before
from service.jobs.product_queue import ProductQueue
from service.jobs.product_states import accept_products, add_products, cancel_products, retry_products
from service.jobs.states import find_render, find_unended, move, note_end, state_of
from service.jobs.task_rows import add_tasks
from service.jobs.totals import RenderTotals
from service.jobs.turns import next_task
from service.storage.database.connection import is_shared, time_of, transaction
from service.storage.database.tables import AttemptRow, FileEntry, RenderNeedRow, RenderRow, TaskRow
from service.storage.events import EventLog

MOST_UNENDED = 2000
"""Renders of one owner that have not ended."""
_NOT_KEPT = ("frames", "after", "products")


class RenderQueue:
    """The queue of renders. Any thread may use it, and any number of processes.

    Args:
        engine: of a database that `service.storage.database.connection` has opened.
        events: takes down what changes.
        clock: tells the time in a transaction, s since 1970; by default the clock that all users of the database share.
        holder: id of the data folder, which holds claims and is the home of renders; it stays the same over restarts.
        has_bucket: whether renders whose shots are in a bucket can be drawn.

    Attributes:
        totals: over all renders.
        lookups: about single ones.
        logs: of their frames.
        products: what is made of these.
    """

    def __init__(
        self,
        engine: Engine,
        events: EventLog,
        clock: Callable[[Session], float] = time_of,
        holder: str = "",
        *,
        has_bucket: bool = False,
    ) -> None:
        self._engine = engine
        self._events = events
        self._clock = clock
        self._holder, self._has_bucket = holder, has_bucket
        self._attempts = Attempts(events, clock, holder)
        self.totals = RenderTotals(engine)
        self.lookups = RenderLookups(engine)
        self.logs = FrameLogs(engine)
        self.products = ProductQueue(engine, events, clock, holder, has_bucket=has_bucket)

    def close(self) -> None:
        """Close the connections to the database."""
        self._engine.dispose()

    def sent_before(self, owner: str, idempotency_key: str, digest: str) -> RenderRow | None:
        """Return the render that was sent with a key before; None where there is none.

        Raises:
            ConflictError: the key was used for another request.
        """
        with self._reading() as session:
            return sent_before(session, owner, idempotency_key, digest)

    def submit(self, new: NewRender) -> RenderRow:
        """Add a render.

        Returns:
            The render, or the one that was sent with the same idempotency key before.

        Raises:
            ConflictError: the idempotency key was used for another request, or the owner has too many renders.
            NotFoundError: one that it waits for is not there.
        """
        with self._writing() as session:
            if new.idempotency_key is not None:
                before = sent_before(session, new.owner, new.idempotency_key, new.digest)
                if before is not None:
                    return before
            unended = select(func.count()).where(RenderRow.owner == new.owner, RenderRow.unended > 0)
            if (session.scalar(unended) or 0) >= MOST_UNENDED:
                raise ConflictError(
                    f"you have {MOST_UNENDED:,} renders that have not ended; wait, or cancel some",
                    code="too_many_renders",
                )
            drawn = new.frames if new.request.get("formats") != [] else ()
            render = RenderRow(
                id=f"r-{secrets.token_hex(6)}",
                **{name: value for name, value in vars(new).items() if name not in _NOT_KEPT},
                frames=format_frames(new.frames),
                count=len(drawn),
                ready=len(drawn),
                home=self._holder,
                stored_bytes=len(new.edits.encode()),
                wanted="run",
                created_at=self._clock(session),
            )
            add_products(render, new.products)
            session.add(render)
            session.flush()
            session.add_all(
                RenderNeedRow(render=render.id, needs=find_render(session, needed).id) for needed in set(new.after)
            )
            add_tasks(session, render.id, drawn)
            self._events.add(session, render_event(render, "render-sent"))
            return render

    def get(self, render_id: str) -> RenderRow:
        """Return a render. Raises `NotFoundError`."""
        with self._reading() as session:
            return find_render(session, render_id)

    def list(self, project: str | None, most: int, before: tuple[float, str] | None = None) -> Sequence[RenderRow]:
        """Return renders, the newest first.

        Args:
            project: whose; None for those of all projects.
            most: number of renders.
            before: time and id of a render; older ones are returned. None begins with the newest.
        """
        wanted = select(RenderRow).order_by(RenderRow.created_at.desc(), RenderRow.id.desc()).limit(most)
        if project is not None:
            wanted = wanted.where(RenderRow.project == project)
        if before is not None:
            created_at, render_id = before
            is_older = (RenderRow.created_at < created_at) | (
                (RenderRow.created_at == created_at) & (RenderRow.id < render_id)
            )
            wanted = wanted.where(is_older)
        with self._reading() as session:
            return session.scalars(wanted).all()

    def tasks(self, render_id: str) -> Sequence[tuple[TaskRow, Sequence[AttemptRow]]]:
        """Return the tasks of a render in the order of their frames, with their attempts. Raises `NotFoundError`."""
        with self._reading() as session:
            find_render(session, render_id)
            tasks = session.scalars(select(TaskRow).where(TaskRow.render == render_id).order_by(TaskRow.frame)).all()
            attempts = session.scalars(
                select(AttemptRow).where(AttemptRow.render == render_id).order_by(AttemptRow.number)
            ).all()
            by_frame: dict[int, list[AttemptRow]] = {}
            for attempt in attempts:
                by_frame.setdefault(attempt.frame, []).append(attempt)
            return [(task, by_frame.get(task.frame, [])) for task in tasks]

    def task(self, render_id: str, frame: int) -> TaskRow:
        """Return a task. Raises `NotFoundError`: there is no such render, or it has no such frame."""
        with self._reading() as session:
            render = find_render(session, render_id)
            task = session.get(TaskRow, (render_id, frame))
            if task is None:
                detail = f"render {render_id!r} has no frame {frame}, it has {render.frames[:200]}"
                raise NotFoundError(detail, code="frame_not_found", path="frame")
            return task

    def claim(self, worker: str, lease_s: float, present: Collection[str] = ()) -> Claim | None:
        """Claim the next task: of the render with the highest priority, then of the oldest, its first frame that is ready.

        Args:
            worker: who claims it.
            lease_s: time after which the worker is taken for gone, unless it extends the lease.
            present: all workers that there are. A frame that one has failed is left to those who have not; where it has failed
                `service.jobs.turns.MOST_FAILED_EACH` frames of a render, all of that render are.
        """
        with self._writing() as session:
            self._attempts.end_lost(session)
            home = self._holder if is_shared(self._engine) else None
            task = next_task(session, self._clock(session), worker, present, home, has_bucket=self._has_bucket)
            if task is None:
                return None
            render = session.get_one(RenderRow, task.render, options=[undefer(RenderRow.edits)])
            self._attempts.begin(session, render, task, worker, lease_s)
            return Claim(
                render.id,
                task.frame,
                task.attempts,
                worker,
                render.owner,
                render.shot,
                render.shot_created_at,
                render.files,
                render.root,
                render.project,
                render.edits,
                render.request,
            )

    def extend(self, claim: Claim, lease_s: float) -> bool:
        """Extend a lease; return whether the task is still the worker's and wanted."""
        with self._writing() as session:
            held = self._held(session, claim)
            if held is None:
                return False
            held[1].lease_until = self._clock(session) + lease_s
            return held[0].wanted != "cancel"

    def finish(self, claim: Claim, files: Mapping[str, FileEntry], time_codes_per_second: float, log: str = "") -> bool:
        """Note that a frame is drawn and stored.

        Args:
            claim: the task.
            files: its files by format.
            time_codes_per_second: of the shot, for movies.
            log: end of its log.

        Returns:
            Whether the task was still the worker's, or this was noted before, by a commit whose answer was lost.
        """
        with self._writing() as session:
            held = self._held(session, claim)
            if held is None:
                task = session.get(TaskRow, (claim.render, claim.frame))
                state = task and (task.state, task.attempts, task.files)
                return state == ("done", claim.attempt, dict(files))
            render, task = held
            task.files = dict(files)
            render.time_codes_per_second = time_codes_per_second
            render.stored_bytes += _size_of(task)
            self._attempts.end(session, render, task, "done", "done", None, log)
            return True

    def fail(self, claim: Claim, error: str, log: str = "", *, may_pass: bool) -> None:
        """Note that a frame could not be drawn.

        Args:
            claim: the task.
            error: what went wrong, for people.
            log: end of its log.
            may_pass: whether another try may succeed.
        """
        with self._writing() as session:
            held = self._held(session, claim)
            if held is not None:
                self._attempts.fail(session, *held, error, log, may_pass=may_pass)

    def lose(self, claim: Claim, error: str, log: str = "") -> None:
        """Note that the worker of a frame is gone: the frame is drawn again, and this counts as no failure of its own.

        Args:
            claim: the task.
            error: what is gone, for people.
            log: end of its log.
        """
        with self._writing() as session:
            held = self._held(session, claim)
            if held is not None:
                self._attempts.lose(session, *held, error, log)

    def give_back(self, claim: Claim, reason: str, log: str = "") -> None:
        """Give a task back that was not finished, as when the service stops; it counts as no failure.

        Args:
            claim: the task.
            reason: for people.
            log: end of its log.
        """
        with self._writing() as session:
            held = self._held(session, claim)
            if held is not None:
                self._attempts.end(session, *held, "ready", "given-back", reason, log)

    def put_off(self, claim: Claim, pause_s: float, *, is_of_owner: bool = False) -> None:
        """Give a task back that could not be begun; this attempt is forgotten, and none of its render is claimed for a while.

        Args:
            claim: the task.
            pause_s: time until another one of its render is claimed.
            is_of_owner: whether all renders of its owner are put off.
        """
        with self._writing() as session:
            held = self._held(session, claim)
            if held is None:
                return
            render, task = held
            self._attempts.end(session, render, task, "ready", "given-back", None)
            forget_logs(session, render, task.frame, task.attempts)
            session.delete(session.get_one(AttemptRow, (task.render, task.frame, task.attempts)))
            render.not_before = until = self._clock(session) + pause_s
            if is_of_owner:
                theirs = update(RenderRow).where(RenderRow.owner == render.owner, RenderRow.ready > 0)
                session.execute(theirs.values(not_before=until))

    def pause(self, render_id: str) -> RenderRow:
        """Begin no more frames of a render. Raises `NotFoundError`, `ConflictError`: it has ended."""
        return self._want(render_id, "pause")

    def resume(self, render_id: str) -> RenderRow:
        """Go on with a render that was paused. Raises `NotFoundError`, `ConflictError`: it has ended."""
        return self._want(render_id, "run")

    def cancel(self, render_id: str) -> RenderRow:
        """End a render; its finished frames stay. Raises `NotFoundError`, `ConflictError`: it has ended already."""
        with self._writing() as session:
            render = find_unended(session, render_id)
            with noted(self._events, session, render):
                render.wanted = "cancel"
                waiting = update(TaskRow).where(TaskRow.render == render_id, TaskRow.state == "ready")
                session.execute(waiting.values(state="canceled"))
                render.canceled += render.ready
                render.ready = 0
                cancel_products(render)
            note_end(render, self._clock(session))
            return render

    def accept(self, render_id: str) -> RenderRow:
        """Take a render for done that has failed or was canceled. Raises `NotFoundError`, `ConflictError`: it has not."""
        with self._writing() as session:
            render = find_render(session, render_id)
            if state_of(render) not in ("failed", "canceled"):
                raise ConflictError(
                    f"render {render_id!r} is {state_of(render)}: one that failed or was canceled is accepted"
                )
            with noted(self._events, session, render):
                render.accepted = True
                render.wanted = "run" if render.wanted == "cancel" else render.wanted  # of what this has made
                accept_products(render)
            note_end(render, self._clock(session))
            return render

    def retry(self, render_id: str, lost: Sequence[int] = ()) -> RenderRow:
        """Try the frames and products again that have failed or were canceled; a paused render stays so.

        Args:
            render_id: the render.
            lost: frames that are done and whose files are gone, which are drawn again, too.

        Raises:
            NotFoundError: there is no such render.
            ConflictError: it has none of these.
        """
        with self._writing() as session:
            render = find_render(session, render_id)
            again = list(lost)
            wanted = select(TaskRow).where(TaskRow.render == render_id)
            is_over = TaskRow.state.in_(("failed", "canceled")) | (TaskRow.state == "done") & TaskRow.frame.in_(again)
            tasks = session.scalars(wanted.where(is_over)).all()
            if not tasks and render.products_lacking == 0:
                detail = "has no frames or products that have failed, were canceled or are lost"
                raise ConflictError(f"render {render_id!r} {detail}")
            with noted(self._events, session, render):
                for task in tasks:
                    render.stored_bytes -= _size_of(task) if task.state == "done" else 0
                    move(render, task, "ready")
                    task.failures, task.losses, task.not_before = 0, 0, 0.0
                retry_products(render, has_new_frames=bool(tasks))
                render.accepted = False
                render.wanted = "pause" if render.wanted == "pause" else "run"
            render.finished_at = None
            return render

    def remove(self, render_id: str, set_files_aside: Callable[[], None]) -> None:
        """Forget a render that has ended.

        Args:
            render_id: the render.
            set_files_aside: called in the transaction, before the render is forgotten; it must be quick.

        Raises:
            NotFoundError: there is no such render.
            ConflictError: it has not ended.
        """
        with self._writing() as session:
            render = find_render(session, render_id)
            if render.unended > 0:
                raise ConflictError(f"render {render_id!r} is under way; cancel it before you remove it")
            set_files_aside()
            self._events.add(session, render_event(render, "render-removed"))
            session.execute(delete(RenderRow).where(RenderRow.id == render_id))

    def take_back_left(self, kept: Collection[Claim] = (), lease_s: float = 0.0) -> None:
        """Take back the frames that this holder does not work on any more; it counts as no loss.

        Args:
            kept: claims that it works on, whose leases are extended: none when a service starts.
            lease_s: of these.
        """
        keys = {(claim.render, claim.frame, claim.attempt) for claim in kept}
        with self._writing() as session:
            self._attempts.take_back(session, keys, lease_s, is_shared=is_shared(self._engine))

    def is_at_hand(self, render: RenderRow) -> bool:
        """Return whether the frames of a render are in the data folder of this queue, or in a bucket."""
        if render.files is not None:
            return self._has_bucket
        return not is_shared(self._engine) or render.home in (None, self._holder)

    def check(self) -> None:
        """Look at whether the database answers. Raises `OutputError`."""
        with self._reading() as session:
            session.scalar(select(1))

    def _want(self, render_id: str, wanted: str) -> RenderRow:
        with self._writing() as session:
            render = find_unended(session, render_id)
            if render.wanted == "cancel":
                raise ConflictError(f"render {render_id!r} is being canceled; retry it once it has ended")
            with noted(self._events, session, render):
                render.wanted = wanted
            return render

    def _held(self, session: Session, claim: Claim) -> tuple[RenderRow, TaskRow] | None:
        """Return the render and task of a claim; None where the task is another worker's by now, or was removed."""
        task = session.get(TaskRow, (claim.render, claim.frame))
        if task is None or (task.state, task.worker, task.attempts) != ("running", claim.worker, claim.attempt):
            return None
        return find_render(session, claim.render), task

    def _writing(self) -> AbstractContextManager[Session]:
        return transaction(self._engine)

    def _reading(self) -> AbstractContextManager[Session]:
        return transaction(self._engine, only_reads=True)


def _size_of(task: TaskRow) -> int:
    """Return the size of a frame's files, bytes."""
    return sum(entry["size_bytes"] for entry in task.files.values())
