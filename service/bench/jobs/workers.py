"""Workers who sleep as long as a frame takes: how well the queue and the runner of a service keep them busy.

The service is a real one within this process, with its database, its files and its events; only the drawing is a sleep. A worker
draws one frame at a time, and one more waits beside it, as with Dask. Many renders of a lower priority wait meanwhile.
"""

from __future__ import annotations

import asyncio
import random
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import aclosing, contextmanager
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

from starlette.concurrency import run_in_threadpool

from render.errors import PullfocusError
from render.model.edit_history import revision_of
from service.bench.jobs.plan import JobsPlan
from service.bench.jobs.results import Reader, ReaderRow, RequestRow, WorkersRow, reader_row, times_of, workers_row
from service.bench.jobs.streams import MOST_UNTIL_CUT, TOPICS
from service.http.event_feed import PAGE
from service.http.render_runner import LEASE_S, RenderRunner
from service.http.service import Service
from service.http.settings import Settings
from service.identity.principal import DEFAULT_PROJECT
from service.jobs.claims import NewRender
from service.jobs.dask_executor import PLACES
from service.jobs.frame_logs import FrameLog
from service.jobs.frame_work import FrameWork
from service.models.renders import RenderRequest
from service.picture.requests import DrawnFrame
from service.storage.events import EventLog, Wanted
from service.storage.store import ShotRecord

RENDERS = 4
"""Renders whose frames the workers draw."""
FORMAT = "exr"
FRAME_BYTES = 1 << 20
"""Size of what a worker says that it has drawn."""
LOOK_PAUSE_S = 0.2
CLAIMS = 200
"""Frames that are claimed and finished by hand."""
PRIORITY, LOW_PRIORITY = 60, 40
OWNER, OTHER_OWNER = "bench", "others"


class WorkersFound(NamedTuple):
    """Findings; see `JobsBench`."""

    workers: list[WorkersRow]
    queue: list[RequestRow]
    readers: list[ReaderRow]


class SleepingExecutor:
    """Executor whose workers sleep.

    Args:
        workers: how many there are.
        frame_s: time that each sleeps for a frame, s.
        content: of the frame.
    """

    def __init__(self, workers: int, frame_s: float, content: bytes) -> None:
        self._drawing = {f"worker-{number}": asyncio.Lock() for number in range(workers)}
        self._frame_s = frame_s
        self._content = content

    def places(self) -> Mapping[str, int]:
        """Return the workers; see `service.jobs.frame_work.Executor`."""
        return dict.fromkeys(self._drawing, PLACES)

    async def draw(self, worker: str, _work: FrameWork, _log: FrameLog) -> DrawnFrame:
        """Sleep, once the worker has done its frame before."""
        async with self._drawing[worker]:
            await asyncio.sleep(self._frame_s)
            return DrawnFrame({FORMAT: self._content}, 24.0)

    async def close(self) -> None:
        """Do nothing."""


async def measure_workers(folder: Path, plan: JobsPlan, database: str) -> WorkersFound:
    """Have workers draw renders, while readers follow the events.

    Args:
        folder: where the service keeps its data.
        plan: of the measurements.
        database: as the setting of a service.

    Raises:
        PullfocusError: the service does not start, or draws no frames.
    """
    service = Service.start(Settings(data=folder / "data", cache=folder / "cache", database=database, demo=False))
    following = asyncio.create_task(service.feed.run())
    try:
        return await _measure(service, plan)
    finally:
        following.cancel()
        await asyncio.gather(following, return_exceptions=True)
        await run_in_threadpool(service.close)


async def _measure(service: Service, plan: JobsPlan) -> WorkersFound:
    shot = await run_in_threadpool(_write_shot, service)
    chance = random.Random(plan.seed)
    before = await run_in_threadpool(service.events.newest)
    waiting = await run_in_threadpool(_submit, service, shot, OTHER_OWNER, LOW_PRIORITY, [plan.frames] * plan.renders)
    newest = await run_in_threadpool(service.events.newest)
    readers = [
        Reader.after("process", TOPICS[number % len(TOPICS)], chance.randint(before, newest))
        for number in range(plan.readers)
    ]
    is_over = asyncio.Event()
    reading = [
        asyncio.create_task(_read(service, reader, random.Random(f"{plan.seed}/{number}"), is_over))
        for number, reader in enumerate(readers)
    ]
    drawn: list[str] = []
    rows = []
    try:
        for frame_s in plan.frame_s:
            for workers in plan.workers:
                frames = plan.drawn_frames(workers, frame_s)
                ids = await run_in_threadpool(_submit, service, shot, OWNER, PRIORITY, _shares(frames))
                drawn += ids
                executor = SleepingExecutor(workers, frame_s, chance.randbytes(FRAME_BYTES))
                rows.append(workers_row(workers, frame_s, frames, await _draw(service, executor, ids)))
        claims = min(CLAIMS, plan.renders * plan.frames)
        drawn += await run_in_threadpool(_submit, service, shot, OWNER, PRIORITY, [claims])
        queue = await run_in_threadpool(_claim_and_finish, service, plan, claims)
        await run_in_threadpool(_remove, service, [*waiting, *drawn])
        until = await run_in_threadpool(service.events.newest)
    finally:
        is_over.set()
        await asyncio.gather(*reading)
    kept = await run_in_threadpool(kept_events, service.events)
    return WorkersFound(rows, queue, [reader_row(reader, kept, until) for reader in readers])


async def _draw(service: Service, executor: SleepingExecutor, ids: Sequence[str]) -> float:
    """Have renders drawn, and return the time that it took by the clock of the database, s."""
    runner = asyncio.create_task(RenderRunner(service, executor).run())
    try:
        while True:
            await asyncio.sleep(LOOK_PAUSE_S)
            renders = [await run_in_threadpool(service.renders.get, each) for each in ids]
            ends = [render.finished_at for render in renders if render.finished_at is not None]
            if len(ends) == len(ids):
                break
            if runner.done():
                raise PullfocusError("the runner of the service has ended") from runner.exception()
    finally:
        runner.cancel()
        await asyncio.gather(runner, return_exceptions=True)
    if sum(render.done for render in renders) != sum(render.count for render in renders):
        raise PullfocusError("some frames could not be drawn; see the log")
    return max(ends) - max(render.created_at for render in renders)


async def _read(service: Service, reader: Reader, chance: random.Random, is_over: asyncio.Event) -> None:
    """Read events until it is over, cut off at random, and then what is left."""
    wanted = Wanted(topics=reader.topics)
    while not is_over.is_set():
        left = chance.randint(1, MOST_UNTIL_CUT)
        async with aclosing(service.feed.follow(reader.last, wanted, LOOK_PAUSE_S)) as pages:
            async for events, number in pages:
                for event in events[:left]:
                    reader.note(event.number)
                is_cut = left <= len(events)
                left -= len(events)
                if not is_cut:
                    reader.last = number
                reader.cuts += is_cut
                if is_cut or is_over.is_set():
                    break
    async with aclosing(service.feed.follow(reader.last, wanted, LOOK_PAUSE_S)) as pages:
        async for events, _ in pages:
            for event in events:
                reader.note(event.number)
            if len(events) < PAGE:
                return


def kept_events(log: EventLog) -> list[tuple[int, str]]:
    """Return the number and the topic of all events that are kept."""
    kept: list[tuple[int, str]] = []
    while True:
        rows, _ = log.after(kept[-1][0] if kept else 0, Wanted(), 10 * PAGE)
        kept += [(row.number, row.topic) for row in rows]
        if len(rows) < 10 * PAGE:
            return kept


def _write_shot(service: Service) -> ShotRecord:
    """Store a shot, which nobody opens."""
    begun = service.store.begin("bench", "bench")
    begun.files.joinpath("shot.usda").write_text("#usda 1.0\n", encoding="utf-8")
    return service.store.accept(begun, "shot.usda")


def _shares(frames: int) -> list[int]:
    """Deal frames out to renders."""
    return [share for number in range(RENDERS) if (share := frames // RENDERS + (number < frames % RENDERS))]


def _submit(service: Service, shot: ShotRecord, owner: str, priority: int, counts: Sequence[int]) -> list[str]:
    """Send renders of some frames each, and return their ids."""
    frame = RenderRequest(shot=shot.id, width=480, rays=16).picture(1)
    picture = frame.model_dump(mode="json", exclude={"time", "client", "live", "format"}) | {"formats": [FORMAT]}
    return [
        service.renders.submit(
            NewRender(
                name=f"bench {number}",
                project=DEFAULT_PROJECT,
                owner=owner,
                owner_label=owner,
                idempotency_key=None,
                digest="",
                shot=shot.id,
                shot_created_at=shot.created_at.isoformat(),
                files=None,
                root=shot.root,
                edits="",
                revision=revision_of(""),
                request=picture,
                frames=range(1, count + 1),
                priority=priority,
            )
        ).id
        for number, count in enumerate(counts)
    ]


def _claim_and_finish(service: Service, plan: JobsPlan, claims: int) -> list[RequestRow]:
    """Claim frames, while many renders wait, and finish them, one after the other."""
    workers = [f"worker-{number}" for number in range(max(plan.workers))]
    seconds: defaultdict[str, list[float]] = defaultdict(list)
    for number in range(claims):
        with _timed(seconds["claim a frame"]):
            claim = service.renders.claim(workers[number % len(workers)], LEASE_S, workers)
        assert claim is not None, "renders wait"
        with _timed(seconds["extend a lease"]):
            service.renders.extend(claim, LEASE_S)
        with _timed(seconds["finish a frame"]):
            service.renders.finish(claim, {FORMAT: {"size_bytes": FRAME_BYTES, "sha256": ""}}, 24.0)
    return [RequestRow(name, 1, times_of(each)) for name, each in seconds.items()]


@contextmanager
def _timed(seconds: list[float]) -> Iterator[None]:
    """Add the time that the context takes, s."""
    began_s = perf_counter()
    yield
    seconds.append(perf_counter() - began_s)


def _remove(service: Service, ids: Sequence[str]) -> None:
    """Cancel and remove renders, with their files."""
    for each in ids:
        render = service.renders.get(each)
        if render.unended > 0:
            service.renders.cancel(each)
        service.renders.remove(each, partial(service.render_files.set_aside, each))
