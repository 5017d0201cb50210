"""Has the frames of renders drawn by the workers of an executor."""

from __future__ import annotations

import asyncio
import logging
import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack, suppress
from dataclasses import replace
from functools import partial
from typing import ParamSpec, TypeVar

from starlette.concurrency import run_in_threadpool

from render.errors import OutputError, PullfocusError
from render.model.burn_in import BurnIn
from service.hidden_folders import without_folders
from service.http.background_tasks import claim_work, keep_busy, wait_for
from service.http.errors import ServiceError
from service.http.frame_requests import frame_request
from service.http.lane_executor import LaneExecutor
from service.http.log_keeping import LogKeeper
from service.http.render_shots import shot_of
from service.http.request_context import work_fields
from service.http.service import Service
from service.http.settings import MEBIBYTE
from service.jobs.claims import Claim
from service.jobs.dask_executor import DaskAddress, DaskExecutor
from service.jobs.files import FrameFiles
from service.jobs.frame_work import Executor, FrameError, FrameWork, LostFrameError, may_pass
from service.models.frames import FrameQuery
from service.picture.requests import THUMBNAIL, DrawnFrame
from service.storage.database.tables import FileEntry
from service.storage.errors import UnavailableError
from service.storage.store import ShotRecord
from service.workers.errors import QueueFullError, StoppingError, WorkerError
from service.workers.jobs import Client

Arguments = ParamSpec("Arguments")
Reply = TypeVar("Reply")

log = logging.getLogger("pullfocus.service")

LEASE_S = 60.0
"""Time after which a worker is taken for gone. It tells three times within it that it is there."""
PAUSE_S = 1.0
"""Longest time between two looks for frames."""
BUSY_PAUSE_S = 15.0
"""Pause of a render that the service has no room for, or whose owner has used up the processor time of a day."""
NOTE_PAUSE_S = 1.0
"""Time until something is noted again that could not be, as the database was gone."""
STORE_S = 15.0
"""Time in which a frame that is drawn is still stored once nobody waits for it."""
ROOM_PAUSE_S = 5.0
"""Time until a frame is stored again that could not be, as the disk was full or the bucket gone."""
MOST_LEFT = 8
"""Attempts before the last one whose files are removed, should they have left any."""
_NO_PICTURE = ("formats", "aovs", "lens", "burn_in")
"""Fields that are kept with a render beside the settings of its pictures."""
STOPPING = "the service stops"


async def run_renders(service: Service) -> None:
    """Draw the frames of renders until the service stops."""
    await run_in_threadpool(_recover, service)
    executor = _make_executor(service)
    try:
        await RenderRunner(service, executor).run()
    finally:
        await executor.close()


def _make_executor(service: Service) -> Executor:
    if not service.settings.dask:
        return LaneExecutor(service)
    address = DaskAddress.parse(service.settings.dask)
    return DaskExecutor(address, service.quotas.charge, service.quarantine.blame, service.settings.worker_read)


class RenderRunner:
    """Hands the frames of renders to the workers of an executor.

    Args:
        service: whose renders they are.
        executor: draws them.
    """

    def __init__(self, service: Service, executor: Executor) -> None:
        self._service = service
        self._executor = executor
        self._drawing: dict[asyncio.Task[None], Claim] = {}
        self._is_sure = True
        self._has_room = True

    async def run(self) -> None:
        """Keep every worker busy until this is cancelled; what is drawn then is given back."""
        wake = self._service.renders_wake
        await keep_busy(
            self._begin_one,
            partial(wait_for, wake, PAUSE_S),  # until a render is sent, or a frame has ended
            self._doubt,
            self._drawing.keys(),
            log=log,
            complaint="renders cannot go on now",
        )

    def _doubt(self) -> None:
        """Look for what is held and not drawn: it may be claimed by a commit whose answer was lost."""
        self._is_sure = False

    async def _begin_one(self) -> bool:
        """Begin the next frame, if a worker is free and there is one. Returns whether it was so."""
        if not self._look_for_room():
            return False
        if not self._is_sure:
            await run_in_threadpool(self._service.renders.take_back_left, tuple(self._drawing.values()), LEASE_S)
            self._is_sure = True
        places = self._executor.places()
        counts = Counter(claim.worker for claim in self._drawing.values())
        free = sorted((name for name in places if counts[name] < places[name]), key=lambda name: counts[name])
        for worker in free:
            queue = self._service.renders
            claiming = partial(queue.claim, worker, LEASE_S, tuple(places))
            claim = await claim_work(claiming, partial(queue.give_back, reason=STOPPING), log)
            if claim is not None:
                task = asyncio.create_task(work_on(self._service, self._executor, claim))
                self._drawing[task] = claim
                task.add_done_callback(self._end)
                return True
        return False

    def _look_for_room(self) -> bool:
        """Return whether the disk has room for a frame. What is drawn while it has none is drawn in vain."""
        settings = self._service.settings
        free_mb = shutil.disk_usage(settings.data).free // MEBIBYTE
        has_room = free_mb >= settings.min_free_mb
        if self._has_room and not has_room:
            log.warning(
                "renders wait: the disk has %d MiB free, less than min_free_mb (%d)", free_mb, settings.min_free_mb
            )
        self._has_room = has_room
        return has_room

    def _end(self, task: asyncio.Task[None]) -> None:
        del self._drawing[task]
        self._service.renders_wake.set()
        self._service.products_wake.set()
        if not task.cancelled() and task.exception() is not None:
            log.error("what became of a frame cannot be noted", exc_info=task.exception())


def _recover(service: Service) -> None:
    """Take back what a service that was killed has left. No other one works in the data folder, whose lock this one has."""
    try:
        service.renders.take_back_left()
        service.render_files.remove_set_aside()
    except (OutputError, OSError) as error:
        log.error("what an earlier service has left of renders cannot be taken back: %s", error)


async def work_on(service: Service, executor: Executor, claim: Claim) -> None:
    """Have a frame drawn and note what became of it.

    Args:
        service: whose frame it is.
        executor: draws it.
        claim: the frame.
    """
    named = {"render": claim.render, "frame": claim.frame, "attempt": claim.attempt, "worker": claim.worker}
    work_fields.set(named)  # this task works on nothing else
    queue, keeper = service.renders, LogKeeper(service.renders.logs, claim)
    keeper.log.add(f"attempt {claim.attempt} at frame {claim.frame} of render {claim.render}, by worker {claim.worker}")
    drawing = asyncio.create_task(_draw(service, executor, claim, keeper))
    beside = [asyncio.create_task(_hold(service, claim, drawing)), asyncio.create_task(keeper.run())]
    try:
        await drawing
    except asyncio.CancelledError:
        if _is_cancelling():
            drawing.cancel()
            await asyncio.wait((drawing,))
            # Here, as nothing that is awaited may be finished before the service is.
            queue.give_back(claim, STOPPING, keeper.new_lines())
            raise
        await _note(queue.give_back, claim, "the render was canceled", await keeper.end())
    except LostFrameError as error:
        log.warning("frame %d of render %s is lost: %s", claim.frame, claim.render, error)
        await _note(queue.lose, claim, without_folders(str(error)), await keeper.end())
    except UnavailableError as error:
        log.warning("frame %d of render %s cannot be begun now: %s", claim.frame, claim.render, error)
        await _note(queue.put_off, claim, BUSY_PAUSE_S)
    except (PullfocusError, WorkerError, ServiceError, FrameError, OSError) as error:
        if _comes_too_early(error):
            is_of_owner = isinstance(error, ServiceError)  # who has used up the processor time of a day
            await _note(queue.put_off, claim, BUSY_PAUSE_S, is_of_owner=is_of_owner)
        else:
            log.warning("frame %d of render %s could not be drawn: %s", claim.frame, claim.render, error)
            await _note(queue.fail, claim, without_folders(str(error)), await keeper.end(), may_pass=_may_pass(error))
    except Exception as error:
        log.exception("frame %d of render %s could not be drawn", claim.frame, claim.render)
        await _note(queue.fail, claim, without_folders(repr(error)), await keeper.end(), may_pass=False)
    finally:
        for task in beside:
            task.cancel()


class _NoRoomError(Exception):
    """A frame is drawn, and what it goes to is full or gone for now."""


async def _note(note: Callable[Arguments, Reply], *args: Arguments.args, **kwargs: Arguments.kwargs) -> Reply:
    """Note something in the queue, again while its database cannot be used: what was drawn is worth waiting for."""
    is_told = False
    while True:
        try:
            return await run_in_threadpool(note, *args, **kwargs)
        except UnavailableError as error:
            if not is_told:
                log.warning("what became of a frame cannot be noted yet: %s", error)
            is_told = True
        await asyncio.sleep(NOTE_PAUSE_S)


def _comes_too_early(error: Exception) -> bool:
    """Return whether there was no room for a frame, or its owner has used up the processor time of a day."""
    if isinstance(error, ServiceError):
        return error.status == 429
    return isinstance(error, QueueFullError | StoppingError)


def _is_cancelling() -> bool:
    """Return whether the present task is being cancelled, and not one that it waits for."""
    task = asyncio.current_task()
    return task is not None and task.cancelling() > 0


async def _hold(service: Service, claim: Claim, drawing: asyncio.Task[None]) -> None:
    """Extend the lease of a frame while it is drawn; stop that once nobody wants it."""
    while True:
        await asyncio.sleep(LEASE_S / 3)
        try:
            is_wanted = await run_in_threadpool(service.renders.extend, claim, LEASE_S)
        except Exception:
            log.exception("the lease of frame %d of render %s cannot be extended", claim.frame, claim.render)
            continue
        if not is_wanted:
            drawing.cancel()
            return


async def _draw(service: Service, executor: Executor, claim: Claim, keeper: LogKeeper) -> None:
    """Have a frame drawn and store it."""
    with ExitStack() as stack:
        record = await shot_of(service, claim, stack)
        await _draw_shot(service, executor, claim, record, keeper)


async def _draw_shot(service: Service, executor: Executor, claim: Claim, record: ShotRecord, keeper: LogKeeper) -> None:
    """Have a frame of a shot drawn and store it."""
    service.quarantine.check(record)
    formats, aovs = claim.request["formats"], claim.request.get("aovs", [])  # an earlier version kept no AOVs
    picture = {name: value for name, value in claim.request.items() if name not in _NO_PICTURE}
    query = FrameQuery.model_validate(picture | {"time": claim.frame})
    cost, limits = service.admission.check(record.id, query, aovs=aovs)
    client = Client(claim.owner, claim.render)
    service.quotas.check_work(client)
    burn_in = claim.request.get("burn_in")
    request = frame_request(record, claim.edits, query, limits, aovs)
    if burn_in:
        request = replace(request, burn_in=BurnIn(**burn_in | {"facts": tuple(burn_in["facts"])}))
    key = f"{claim.render}/{claim.frame}/{claim.attempt}"
    work = FrameWork(key, request, tuple(formats), client, cost.ordinary_s)
    drawn = await executor.draw(claim.worker, work, keeper.log)
    storing = asyncio.create_task(_store(service, claim, record.project, drawn, keeper))
    try:
        await asyncio.shield(storing)
    except asyncio.CancelledError:
        await asyncio.wait((storing,), timeout=STORE_S)  # the render may be removed once the frame is given back
        storing.cancel()
        raise


async def _store(service: Service, claim: Claim, project: str, drawn: DrawnFrame, keeper: LogKeeper) -> None:
    """Store the files of a frame. What comes too late, as another worker has the frame by now, is thrown away.

    Raises:
        ServiceError: the project has no room for them.
        OutputError: they cannot be written.
    """
    wanted = [*claim.request["formats"], *({THUMBNAIL} & drawn.files.keys())]
    contents = {suffix: drawn.files[suffix] for suffix in wanted}  # a worker is not trusted with names
    await _note(service.quotas.check_room, project, sum(map(len, contents.values())))
    entries = await _write_patiently(service.render_files, claim, contents)
    for suffix, entry in entries.items():
        keeper.log.add(f"stored {suffix}: {entry['size_bytes']} bytes, SHA-256 {entry['sha256']}")
    lines = await keeper.end()
    is_stored = await _note(service.renders.finish, claim, entries, drawn.time_codes_per_second, lines)
    before = range(max(1, claim.attempt - MOST_LEFT), claim.attempt) if is_stored else (claim.attempt,)
    await run_in_threadpool(_remove_attempts, service.render_files, claim, before)


async def _write_patiently(files: FrameFiles, claim: Claim, contents: Mapping[str, bytes]) -> dict[str, FileEntry]:
    """Write the files of a frame, again while there is no room for them: what was drawn is worth waiting for.

    Raises:
        OutputError: they cannot be written.
    """
    is_told = False
    while True:
        try:
            return await run_in_threadpool(_write, files, claim, contents)
        except _NoRoomError as error:
            if not is_told:
                log.warning("frame %d of render %s cannot be stored now: %s", claim.frame, claim.render, error)
            is_told = True
        await asyncio.sleep(ROOM_PAUSE_S)


def _write(files: FrameFiles, claim: Claim, contents: Mapping[str, bytes]) -> dict[str, FileEntry]:
    """Write the files of a frame, all or none. Raises `_NoRoomError`, `OutputError`, `OSError`."""
    place = claim.render, claim.frame, claim.attempt
    try:
        return {suffix: files.write(*place, suffix, content) for suffix, content in contents.items()}
    except (OutputError, OSError) as error:
        with suppress(OutputError, OSError):
            files.remove_attempt(*place, tuple(contents))
        if isinstance(error, UnavailableError) or getattr(error, "code", "") == "disk_full":
            raise _NoRoomError(str(error)) from error
        raise


def _remove_attempts(files: FrameFiles, claim: Claim, attempts: Iterable[int]) -> None:
    """Remove what attempts at a frame have left. What cannot be removed is no harm, and is removed with the render."""
    try:
        for attempt in attempts:
            files.remove_attempt(claim.render, claim.frame, attempt, (*claim.request["formats"], THUMBNAIL))
    except (OutputError, OSError) as error:
        log.warning("files of frame %d of render %s cannot be removed: %s", claim.frame, claim.render, error)


def _may_pass(error: Exception) -> bool:
    """Return whether another try may succeed."""
    return not isinstance(error, ServiceError) and may_pass(error)
