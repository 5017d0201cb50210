"""Function of the picture process that measures focus maps, and their encoding."""

from __future__ import annotations

import numpy as np

from render.model.focus_map import FocusMap
from render.shot.accepted import draw_accepted
from render.steps import step
from service.models.focus_maps import FocusMapHead
from service.picture.encoded_maps import encode_map
from service.picture.frames import frame_settings
from service.picture.requests import FrameRequest
from service.picture.state import PictureWorkerState, picture_function


@picture_function
def measure_focus_map(state: PictureWorkerState, request: FrameRequest) -> bytes:
    """Measure how sharp each pixel of a frame is.

    Args:
        state: the worker's state.
        request: the frame.

    Returns:
        The map, encoded by `encode_focus_map`.

    Raises:
        PullfocusError: as `render.frame.FrameRenderer.map_focus`.
    """
    with state.opened.use(request.record, request.edits) as shot:
        settings = frame_settings(request, shot)
        camera = shot.camera_at(request.camera, request.time, settings.width, settings.height)
        focus = draw_accepted(
            lambda: state.renderer.map_focus(shot.scene_at(request.time, camera.path), camera, settings)
        )
    with step("encode"):
        return encode_focus_map(focus)


def encode_focus_map(focus: FocusMap) -> bytes:
    """Encode a focus map without loss, in about half of its size.

    The format is the one that `service.http.routes.frames.get_focus_map` describes.
    """
    height, width = focus.coc_px.shape
    bits = np.stack([focus.coc_px, focus.depth_m]).astype("<f4").view("<u4")
    return encode_map(FocusMapHead(width=width, height=height, film_mm_per_px=focus.film_mm_per_px), bits)
