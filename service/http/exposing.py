"""The long exposures that go on: one for each shot, driven an interval at a time, and stopped and gone on with at will."""

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


@dataclass
class _Exposure:
    """One of them.

    Attributes:
        key: names it in the picture process.
        record: of its shot.
        edits: its edit layer when it was begun.
        wish: what was asked for.
        intervals: begin and end of each.
        exposed: how much is on the film.
        is_open: whether the shutter is.
        problem: why it failed.
        task: that drives it, while the shutter is open.
    """

    key: str
    record: ShotRecord
    edits: str
    wish: LongExposureBegin
    intervals: list[tuple[float, float]]
    exposed: ExposureProgress = field(default_factory=ExposureProgress)
    is_open: bool = False
    problem: str | None = None
    task: asyncio.Task[None] | None = None

    @property
    def done(self) -> bool:
        return self.exposed.intervals >= len(self.intervals)

    def state(self) -> LongExposureState:
        """As it is told."""
        at = self.exposed.intervals
        shutter = "done" if self.done else "failed" if self.problem else "open" if self.is_open else "closed"
        return LongExposureState.model_validate(
            {
                "shutter": shutter,
                "camera": self.wish.camera,
                "first": self.wish.first,
                "last": self.wish.last,
                "time": self.intervals[at - 1][1] if at else self.wish.first,
                "intervals": at,
                "interval_count": len(self.intervals),
                "open_frames": self.exposed.open_frames,
                "open_seconds": self.exposed.open_seconds,
                "nd_stops": self.exposed.nd_stops,
                "problem": self.problem,
            }
        )


class Exposures:
    """All long exposures of a service. Lives in its event loop; the light itself is in the picture process.

    Args:
        pictures: queue of the picture process.
        max_px: pixels of one picture; more are not rendered.
    """

    def __init__(self, pictures: WorkerQueue[state.PictureWorkerState], max_px: int) -> None:
        self._pictures = pictures
        self._max_px = max_px
        self._of_shot: dict[str, _Exposure] = {}
        self._dropping: set[asyncio.Task[None]] = set()

    async def begin(self, record: ShotRecord, wish: LongExposureBegin) -> LongExposureState:
        """Open the shutter, in place of whatever long exposure the shot had.

        Raises:
            PullfocusError: what is asked for cannot be exposed.
        """
        intervals = ShutterInterval(wish.first, wish.last, wish.step).intervals()
        exposure = _Exposure(secrets.token_hex(8), record, record.edit_text(), wish, intervals)
        request = FrameRequest(
            record=record,
            edits=exposure.edits,
            camera=wish.camera,
            time=wish.first,
            height=wish.height,
            max_px=self._max_px,
            settings=wish.model_dump(exclude={"camera", "first", "last", "step", "nd_stops", "height", "film"}),
            finish={"film": wish.film, "display": None, "view": None, "look": None},
        )
        await self._pictures.result(call(long_exposure.begin_exposure, exposure.key, request, wish.nd_stops))
        self.drop(record.id)
        self._of_shot[record.id] = exposure
        self._open(exposure)
        return exposure.state()

    def state(self, shot_id: str) -> LongExposureState:
        """How far a shot's is. Raises `ServiceError` 404 where it has none."""
        return self._get(shot_id).state()

    def set_shutter(self, shot_id: str, *, is_open: bool) -> LongExposureState:
        """Open it again, or close it after the interval that is at work. Raises `ServiceError` 404 where there is none."""
        exposure = self._get(shot_id)
        if is_open and not exposure.done:
            exposure.problem = None
            self._open(exposure)
        else:
            exposure.is_open = False
        return exposure.state()

    async def picture(self, shot_id: str, file_format: str) -> bytes:
        """What is exposed so far, as a file.

        Raises:
            ServiceError: 404 where the shot has no long exposure.
            PullfocusError: nothing is exposed yet, or it is lost.
        """
        exposure = self._get(shot_id)
        return await self._pictures.result(
            call(long_exposure.develop_exposure, exposure.key, exposure.record, exposure.edits, file_format)
        )

    def drop(self, shot_id: str) -> None:
        """Close the shutter of a shot's, if it has one, and throw the film away, as soon as the picture process gets to it."""
        exposure = self._of_shot.pop(shot_id, None)
        if exposure is None:
            return
        exposure.is_open = False
        if exposure.task is not None:
            exposure.task.cancel()
        dropping = asyncio.create_task(self._drop(exposure.key))
        self._dropping.add(dropping)  # else nothing holds it, and it may be gone before it is done
        dropping.add_done_callback(self._dropping.discard)

    async def _drop(self, key: str) -> None:
        with suppress(WorkerError, PullfocusError):
            await self._pictures.result(call(long_exposure.discard_exposure, key))

    def close(self) -> None:
        """End all of them: the service stops."""
        driving = [exposure.task for exposure in self._of_shot.values() if exposure.task is not None]
        for task in (*driving, *self._dropping):
            task.cancel()
        self._of_shot.clear()

    def _get(self, shot_id: str) -> _Exposure:
        if shot_id not in self._of_shot:
            raise ServiceError(
                404, "exposure_not_found", f"No long exposure of shot {shot_id!r} was begun.", path=shot_id
            )
        return self._of_shot[shot_id]

    def _open(self, exposure: _Exposure) -> None:
        exposure.is_open = True
        if exposure.task is None or exposure.task.done():
            exposure.task = asyncio.create_task(self._run(exposure))

    async def _run(self, exposure: _Exposure) -> None:
        """Expose until it is done, closed or fails."""
        while exposure.is_open and not exposure.done:
            begin, end = exposure.intervals[exposure.exposed.intervals]
            interval = call(long_exposure.expose_interval, exposure.key, exposure.record, exposure.edits, begin, end)
            try:
                exposure.exposed = await self._pictures.result(interval)
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
