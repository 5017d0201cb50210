"""Long exposures in progress: one a shot, exposed an interval at a time, with a shutter that can be closed and reopened."""

from __future__ import annotations

import asyncio
import secrets
from contextlib import suppress
from dataclasses import dataclass, field

from render.errors import PullfocusError
from render.model.shutter_intervals import ShutterInterval
from service.http.errors import ServiceError
from service.models.long_exposure import LongExposureBegin, LongExposureState
from service.picture.calls import long_exposure, state
from service.picture.requests import ExposureProgress, FrameRequest
from service.storage.store import ShotRecord
from service.workers.calls import call
from service.workers.errors import QueueFullError, WorkerError
from service.workers.worker_queue import WorkerQueue

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
        progress: progress so far.
        is_open: whether the shutter is open.
        problem: why the exposure failed, or None.
        task: exposes the intervals while the shutter is open.
    """

    key: str
    record: ShotRecord
    edits: str
    request: LongExposureBegin
    intervals: list[tuple[float, float]]
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
    """All long exposures of a service. Runs in its event loop; the pictures are in the picture process.

    Args:
        pictures: queue of the picture process.
        max_px: limit of width times height of a picture.
    """

    def __init__(self, pictures: WorkerQueue[state.PictureWorkerState], max_px: int) -> None:
        self._pictures = pictures
        self._max_px = max_px
        self._by_shot: dict[str, _Exposure] = {}
        self._discarding: set[asyncio.Task[None]] = set()

    async def begin(self, record: ShotRecord, request: LongExposureBegin) -> LongExposureState:
        """Begin a long exposure with the shutter open, in place of the one that the shot had.

        Raises:
            PullfocusError: the request cannot be exposed.
            WorkerError: the picture process did not complete the call.
        """
        intervals = ShutterInterval(request.first, request.last, request.step).intervals()
        exposure = _Exposure(secrets.token_hex(8), record, record.edit_text(), request, intervals)
        frame = FrameRequest(
            record=record,
            edits=exposure.edits,
            camera=request.camera,
            time=request.first,
            height=request.height,
            max_px=self._max_px,
            settings=request.model_dump(exclude={"camera", "first", "last", "step", "nd_stops", "height", "film"}),
            finish={"film": request.film, "display": None, "view": None, "look": None},
        )
        await self._pictures.result(call(long_exposure.begin_exposure, exposure.key, frame, request.nd_stops))
        self.discard(record.id)
        self._by_shot[record.id] = exposure
        self._open(exposure)
        return exposure.state()

    def state(self, shot_id: str) -> LongExposureState:
        """Return the progress of a shot's exposure. Raises `ServiceError` 404 where it has none."""
        return self._get(shot_id).state()

    def set_shutter(self, shot_id: str, *, is_open: bool) -> LongExposureState:
        """Open the shutter, or close it after the current interval. Raises `ServiceError` 404 where there is no exposure."""
        exposure = self._get(shot_id)
        if is_open and not exposure.is_done:
            exposure.problem = None
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
        return await self._pictures.result(
            call(long_exposure.develop_exposure, exposure.key, exposure.record, exposure.edits, file_format)
        )

    def discard(self, shot_id: str) -> None:
        """Close the shutter of a shot's exposure, if it has one, and free its memory in the picture process."""
        exposure = self._by_shot.pop(shot_id, None)
        if exposure is None:
            return
        exposure.is_open = False
        if exposure.task is not None:
            exposure.task.cancel()
        discarding = asyncio.create_task(self._discard(exposure.key))
        self._discarding.add(discarding)  # the event loop holds only a weak reference to a task
        discarding.add_done_callback(self._discarding.discard)

    def close(self) -> None:
        """Cancel all exposures, because the service stops."""
        exposing = [exposure.task for exposure in self._by_shot.values() if exposure.task is not None]
        for task in (*exposing, *self._discarding):
            task.cancel()
        self._by_shot.clear()

    async def _discard(self, key: str) -> None:
        with suppress(WorkerError, PullfocusError):
            await self._pictures.result(call(long_exposure.discard_exposure, key))

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
                exposure.progress = await self._pictures.result(interval)
            except QueueFullError:
                await asyncio.sleep(BUSY_PAUSE_S)
                continue
            except WorkerError as error:
                exposure.problem = str(error)
            except PullfocusError as error:
                exposure.problem = error.detail
            if exposure.problem is not None:
                break
        exposure.is_open = False
