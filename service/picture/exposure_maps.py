"""Function of the picture process that measures exposure maps, and their encoding."""

from __future__ import annotations

import numpy as np

from render.film.develop import expose
from render.film.stock import MIDDLE_GREY
from render.model.arrays import FloatArray
from render.optics.photometry.metering import LUMINANCE_OF_ACESCG
from render.pictures.picture import expose_frame, prepare_camera
from render.steps import step
from service.models.exposure_maps import ExposureMapHead
from service.picture.encoded_maps import encode_map
from service.picture.frames import frame_settings
from service.picture.requests import FrameRequest
from service.picture.state import PictureWorkerState, picture_function

STEPS_PER_STOP = 256
_LEAST = np.iinfo(np.int16).min
"""Number of a pixel without light."""


@picture_function
def measure_exposure_map(state: PictureWorkerState, request: FrameRequest) -> bytes:
    """Measure how bright each pixel of a frame is on the film, before it is developed and graded.

    Args:
        state: the worker's state.
        request: the frame.

    Returns:
        The map, encoded by `encode_exposure_map`.

    Raises:
        PullfocusError: as `render.pictures.picture.make_picture`.
    """
    with state.opened.use(request.record, request.edits) as shot:
        settings = frame_settings(request, shot)
        camera, _ = prepare_camera(state.renderer, shot, request.camera, request.time, settings)
        frame = expose_frame(state.renderer, shot, request.camera, camera, request.time, settings)
    with step("encode"):
        return encode_exposure_map(stops_from_grey(expose(frame.color[..., :3], camera.exposure_scale)))


def stops_from_grey(exposed: FloatArray) -> FloatArray:
    """Give the stops by which the luminance of ``(height, width, 3)`` exposed light in ACEScg lies above a grey of 18 %.

    Returns:
        ``(height, width)``; minus infinity where there is no light.
    """
    luminance = exposed @ np.asarray(LUMINANCE_OF_ACESCG, np.float32)
    with np.errstate(divide="ignore"):
        return np.asarray(np.log2(np.maximum(luminance, 0) / np.float32(MIDDLE_GREY)), np.float32)


def encode_exposure_map(stops: FloatArray) -> bytes:
    """Encode ``(height, width)`` stops to the nearest of their steps.

    The format is the one that `service.http.routes.exposure_maps.get_exposure_map` describes.
    """
    height, width = stops.shape
    most = np.iinfo(np.int16).max
    numbers = np.nan_to_num(np.rint(stops * STEPS_PER_STOP), nan=_LEAST, posinf=most, neginf=_LEAST)
    bits = np.clip(numbers, _LEAST, most).astype("<i2").view("<u2")
    return encode_map(ExposureMapHead(width=width, height=height, steps_per_stop=STEPS_PER_STOP), bits[None])
