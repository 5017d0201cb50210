"""Long exposures in progress: one a shot, exposed an interval at a time, with a shutter that can be closed and reopened."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from starlette.concurrency import run_in_threadpool

from render.errors import PullfocusError
from render.model.shutter_intervals import ShutterInterval
from service.http.clients import present_client
from service.http.errors import ServiceError
from service.models.long_exposure import LongExposureBegin, LongExposureState
from service.models.picture_limits import PictureLimits
from service.picture.calls import long_exposure
from service.picture.calls import state as picture_state
from service.picture.requests import ExposureProgress, FrameRequest
from service.storage.store import ShotRecord
from service.workers.calls import Call, call
from service.workers.errors import QueueFullError, WorkerError
from service.workers.jobs import Client
from service.workers.lane import Lane
from service.workers.places import Place

Reply = TypeVar("Reply")
SenderCheck = Callable[[], None]

BUSY_PAUSE_S = 0.5
"""Time before an interval is submitted again after the queue was full."""


@dataclass
class _Exposure:
    """A long exposure of one shot.

    Attributes:
        key: its name in the picture process.
        record: the shot.
        edits: text of the edit layer when the exposure began.
        request: the client's request.
        intervals: begin and end of each interval, USD time codes.
        client: who it is made for: the one who opened the shutter last.
        progress: progress so far.
        check: raises `ServiceError` once the sender who opened the shutter last is no longer let in.
        is_open: whether the shutter is open.
        problem: why the exposure failed, or None.
        task: exposes the intervals while the shutter is open.
    """

    key: str
    record: ShotRecord
    edits: str
    request: LongExposureBegin
    intervals: list[tuple[float, float]]
    client: Client
    check: SenderCheck
    progress: ExposureProgress = field(default_factory=ExposureProgress)
    is_open: bool = False
    problem: str | None = None
    task: asyncio.Task[None] | None = None

    @property
    def is_done(self) -> bool:
        """True where every interval is exposed."""
        return self.progress.intervals >= len(self.intervals)

    @property
    def shutter(self) -> str:
        """State of the shutter, as `LongExposureState` has it."""
        if self.is_done:
            return "done"
        return "failed" if self.problem else "open" if self.is_open else "closed"

    def state(self) -> LongExposureState:
        """Return the progress as a model."""
        exposed = self.progress.intervals
        return LongExposureState.model_validate(
            {
                "shutter": self.shutter,
                "camera": self.request.camera,
                "first": self.request.first,
                "last": self.request.last,
                "time": self.intervals[exposed - 1][1] if exposed else self.request.first,
                "intervals": exposed,
                "interval_count": len(self.intervals),
                "open_frames": self.progress.open_frames,
                "open_seconds": self.progress.open_seconds,
                "nd_stops": self.progress.nd_stops,
                "problem": self.problem,
            }
        )


class LongExposures:
    """All long exposures of a service. Runs in its event loop; the pictures are in the workers of the lane ``exposure``.

    Args:
        lane: of the workers that hold them.
        place_of: returns what a worker that serves a shot may see.
    """

    def __init__(
        self,
        lane: Lane[picture_state.PictureWorkerState],
        place_of: Callable[[ShotRecord], Place],
    ) -> None:
        self._lane = lane
        self._place_of = place_of
        self._by_shot: dict[str, _Exposure] = {}

    async def begin(
        self, record: ShotRecord, request: LongExposureBegin, limits: PictureLimits, check: SenderCheck
    ) -> LongExposureState:
        """Begin a long exposure with the shutter open, in place of the one that the shot had.

        Args:
            record: the shot.
            request: what is asked for.
            limits: what the picture may have.
            check: called before each interval; raises `ServiceError` where the sender may no longer use the service.

        Raises:
            PullfocusError: the request cannot be exposed.
            WorkerError: the picture process did not complete the call.
        """
        intervals = ShutterInterval(request.first, request.last, request.step).intervals()
        key, client = secrets.token_hex(8), present_client()
        exposure = _Exposure(key, record, record.edit_text(), request, intervals, client, check)
        frame = FrameRequest(
            record=record,
            edits=exposure.edits,
            camera=request.camera,
            time=request.first,
            height=request.height,
            limits=limits,
            settings=request.model_dump(exclude={"camera", "first", "last", "step", "nd_stops", "height", "film"}),
            finish={"film": request.film, "display": None, "view": None, "look": None},
        )
        await self._call(exposure, call(long_exposure.begin_exposure, exposure.key, frame, request.nd_stops))
        if record.id in self._by_shot:
            self._by_shot[record.id].is_open = False
        self._by_shot[record.id] = exposure
        self._open(exposure)
        return exposure.state()

    def state(self, shot_id: str) -> LongExposureState:
        """Return the progress of a shot's exposure. Raises `ServiceError` 404 where it has none."""
        return self._get(shot_id).state()

    def set_shutter(self, shot_id: str, check: SenderCheck, *, is_open: bool) -> LongExposureState:
        """Open the shutter, or close it after the current interval.

        Args:
            shot_id: the shot.
            check: as in `begin`, of the present sender.
            is_open: what becomes of the shutter.

        Raises:
            ServiceError: 404, there is no exposure.
        """
        exposure = self._get(shot_id)
        if is_open and not exposure.is_done:
            if not exposure.is_open:
                exposure.problem, exposure.check, exposure.client = None, check, present_client()
            self._open(exposure)
        else:
            exposure.is_open = False
        return exposure.state()

    async def picture(self, shot_id: str, file_format: str) -> bytes:
        """Develop the exposure so far.

        Args:
            shot_id: the shot.
            file_format: png, jpeg or exr.

        Returns:
            The encoded picture.

        Raises:
            ServiceError: 404 where the shot has no long exposure.
            PullfocusError: nothing is exposed yet, or the exposure is lost.
            WorkerError: the picture process did not complete the call.
        """
        exposure = self._get(shot_id)
        return await self._call(
            exposure, call(long_exposure.develop_exposure, exposure.key, exposure.record, exposure.edits, file_format)
        )

    async def discard(self, shot_id: str) -> None:
        """Close the shutter of a shot's exposure, if it has one, and end the worker that holds it."""
        exposure = self._by_shot.pop(shot_id, None)
        if exposure is not None:
            exposure.is_open = False
            await run_in_threadpool(self._lane.pool.close_place, shot_id, self._lane.role)

    def close(self) -> None:
        """Cancel all exposures, because the service stops."""
        for exposure in self._by_shot.values():
            if exposure.task is not None:
                exposure.task.cancel()
        self._by_shot.clear()

    async def _call(self, exposure: _Exposure, work: Call[picture_state.PictureWorkerState, Reply]) -> Reply:
        """Run a call in the worker that holds the exposure."""
        return await self._lane.result(work, self._place_of(exposure.record), exposure.client)

    def _get(self, shot_id: str) -> _Exposure:
        if shot_id not in self._by_shot:
            raise ServiceError(
                404, "exposure_not_found", f"No long exposure of shot {shot_id!r} was begun.", path=shot_id
            )
        return self._by_shot[shot_id]

    def _open(self, exposure: _Exposure) -> None:
        exposure.is_open = True
        if exposure.task is None or exposure.task.done():
            exposure.task = asyncio.create_task(self._expose(exposure))

    async def _expose(self, exposure: _Exposure) -> None:
        """Expose intervals until the last one, a closed shutter or a failure."""
        while exposure.is_open and not exposure.is_done:
            begin, end = exposure.intervals[exposure.progress.intervals]
            interval = call(long_exposure.expose_interval, exposure.key, exposure.record, exposure.edits, begin, end)
            try:
                exposure.check()
                exposure.progress = await self._call(exposure, interval)
            except QueueFullError:
                await asyncio.sleep(BUSY_PAUSE_S)
                continue
            except (WorkerError, ServiceError) as error:
                exposure.problem = str(error)
            except PullfocusError as error:
                exposure.problem = error.detail
            if exposure.problem is not None:
                break
        exposure.is_open = False
