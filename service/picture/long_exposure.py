"""Functions of the picture process that make a long exposure, one interval a call so that other work can run in between."""

from __future__ import annotations

from render.errors import NotFoundError
from render.output import encode
from render.pictures.long_exposure import LongExposure
from service.picture.frames import frame_settings
from service.picture.requests import ExposureProgress, FrameRequest
from service.picture.state import PictureWorkerState, picture_function
from service.storage.store import ShotRecord


@picture_function
def begin_exposure(state: PictureWorkerState, key: str, request: FrameRequest, nd_stops: float | None) -> None:
    """Prepare a long exposure with the shutter closed, in place of the one before.

    Args:
        state: the worker's state.
        key: names the exposure.
        request: the frame at which it begins; later edits have no effect.
        nd_stops: density of a neutral density filter; None keeps the exposure of a single frame.

    Raises:
        PullfocusError: as `render.pictures.long_exposure.LongExposure`.
    """
    with state.opened.use(request.record, request.edits) as shot:
        exposure = LongExposure(
            state.renderer,
            shot,
            request.camera,
            request.time,
            frame_settings(request, shot),
            nd_stops=nd_stops,
            stock=request.finish["film"],
        )
    state.exposure = key, exposure


@picture_function
def expose_interval(
    state: PictureWorkerState, key: str, record: ShotRecord, edits: str, begin: float, end: float
) -> ExposureProgress:
    """Open the shutter for an interval.

    Args:
        state: the worker's state.
        key: names the exposure.
        record: its shot.
        edits: text of the edit layer when the exposure began.
        begin: USD time code.
        end: USD time code.

    Raises:
        NotFoundError: the process that held the exposure is gone.
        PullfocusError: as `LongExposure.expose`.
    """
    with state.opened.use(record, edits) as shot:
        exposure = _exposure(state, key)
        exposure.shot = shot  # which may have been reopened since
        exposure.expose(begin, end)
        progress = exposure.state
    return ExposureProgress(progress.open_frames, progress.open_seconds, progress.intervals, progress.nd_stops)


@picture_function
def develop_exposure(state: PictureWorkerState, key: str, record: ShotRecord, edits: str, file_format: str) -> bytes:
    """Develop and encode the exposure so far: the picture that `pullfocus record --long-exposure` writes.

    Args:
        state: the worker's state.
        key: names the exposure.
        record: its shot.
        edits: text of the edit layer when the exposure began.
        file_format: png, jpeg or exr.

    Raises:
        NotFoundError: the process that held the exposure is gone.
        PullfocusError: as `LongExposure.picture`.
    """
    with state.opened.use(record, edits) as shot:
        exposure = _exposure(state, key)
        exposure.shot = shot
        picture = exposure.develop()
    return encode(file_format, picture.frame, picture.graded, picture.metadata)


def _exposure(state: PictureWorkerState, key: str) -> LongExposure:
    if state.exposure is None or state.exposure[0] != key:
        raise NotFoundError(
            "The picture process that held the long exposure is gone, or holds a newer one: begin it anew.",
            code="exposure_lost",
        )
    return state.exposure[1]
