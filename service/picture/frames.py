"""Functions of the picture process that render frames and pick surfaces. It alone owns GL, in its one thread."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from render.errors import PullfocusError
from render.film import GradeChoice
from render.frame import FrameSettings
from render.frame import Pick as SurfacePick
from render.model.arrays import FloatArray
from render.model.burn_in import BurnIn
from render.output import encode
from render.output.encode import encode_jpeg, to_8_bit
from render.output.stills import shrink_picture
from render.pictures.live_finisher import LiveFinisher
from render.pictures.picture import Picture, make_picture
from render.shot import Shot
from render.shot.accepted import draw_accepted
from render.shot.picture_height import picture_height
from render.steps import step
from service.models.focus import Anchor, Pick
from service.models.shots import PickRequest
from service.picture.requests import THUMBNAIL, DrawnFrame, FrameRequest
from service.picture.state import PictureWorkerState, picture_function
from service.stage.opened import as_sent
from service.storage.store import ShotRecord
from service.workers.output import write_line

PICK_WIDTH_PX = 2048
"""Width of the picture that a position is picked in: finer than a pointer's step."""


@picture_function
def warm_up(state: PictureWorkerState) -> None:
    """Create the GL context. Raises `GraphicsError`."""
    _ = state.renderer


@picture_function
def render_frame(state: PictureWorkerState, request: FrameRequest, file_format: str, live: bool = False) -> bytes:
    """Render and encode one frame. Unless it is live, the picture is the one that `pullfocus record` writes.

    Args:
        state: the worker's state.
        request: the frame.
        file_format: png, jpeg or exr.
        live: whether film and grade run on the graphics device, which is quicker and slightly less exact.

    Raises:
        PullfocusError: as `render.pictures.picture.make_picture`.
    """
    picture = _make_picture(state, request, state.live_finisher if live else None)
    with step("encode"):
        return encode(file_format, picture.frame, picture.graded, picture.metadata)


@picture_function
def render_files(state: PictureWorkerState, request: FrameRequest, formats: Sequence[str]) -> DrawnFrame:
    """Render one frame, and encode it in several formats and small; each file is the one that `pullfocus record` writes.

    Args:
        state: the worker's state.
        request: the frame.
        formats: of png, jpeg and exr.

    Raises:
        PullfocusError: as `render.pictures.picture.make_picture`.
    """
    try:
        picture = _make_picture(state, request, None)
    finally:
        _write_findings(state, request)
    with step("encode"):
        graded = _burnt(picture, request.burn_in)
        files = {name: encode(name, picture.frame, graded, picture.metadata) for name in formats}
        small = shrink_picture(to_8_bit(picture.graded)).astype(np.float32) / np.float32(255)
        files[THUMBNAIL] = encode_jpeg(small, picture.metadata)
    with state.opened.use(request.record, request.edits) as shot:
        return DrawnFrame(files, shot.stage.GetTimeCodesPerSecond())


def _burnt(picture: Picture, burn_in: BurnIn | None) -> FloatArray:
    """Return the graded picture with the facts that are burnt in."""
    if burn_in is None:
        return picture.graded
    from render.drawing.burn_in import draw_burn_in  # matplotlib takes a second

    return draw_burn_in(picture.graded, burn_in, picture.metadata)


def _write_findings(state: PictureWorkerState, request: FrameRequest) -> None:
    """Write to the output of the process what of the shot is not honoured, or cannot be used."""
    with suppress(PullfocusError), state.opened.use(request.record, request.edits) as shot:
        for finding in shot.findings():
            write_line(as_sent(f"{finding.code}: {finding.path}: {finding.message}", request.record), time.time())


def _make_picture(state: PictureWorkerState, request: FrameRequest, live: LiveFinisher | None) -> Picture:
    with state.opened.use(request.record, request.edits) as shot:
        return make_picture(
            state.renderer,
            shot,
            request.camera,
            request.time,
            frame_settings(request, shot),
            stock=request.finish["film"],
            choice=grade_choice(request),
            live=live,
        )


def frame_settings(request: FrameRequest, shot: Shot) -> FrameSettings:
    """Return the settings of a requested frame, in the shape of the camera's film gate where it has no height.

    Raises:
        SettingsError: it has too many pixels, or is expected to take too long.
        CameraError: it is no camera, or has impossible values.
    """
    height, width = request.height, request.settings["width"]
    if height is None:
        height = picture_height(shot, request.camera, request.time, width)
        request.limits.check(width, height)
    return FrameSettings(**request.settings, height=height)


def grade_choice(request: FrameRequest) -> GradeChoice | None:
    """Return the grade that a request names in place of the shot's, or None."""
    finish = request.finish
    choice = GradeChoice(display=finish["display"], view=finish["view"], look=finish["look"])
    return None if choice == GradeChoice() else choice


@picture_function
def pick_surface(state: PictureWorkerState, record: ShotRecord, edits: str, request: PickRequest) -> Pick:
    """Find the surface under a pixel. Raises `CameraError` or `SettingsError`."""
    with state.opened.use(record, edits) as shot:
        size = request.width, request.height
        pick = pick_at(state, shot, request.camera, request.time, size, (request.x, request.y))
    if pick is None:
        return Pick(hit=False)
    return Pick(hit=True, anchor=anchor_of(pick), depth_m=pick.depth_m, position_m=pick.position_m)


@picture_function
def measure_depth(
    state: PictureWorkerState,
    record: ShotRecord,
    edits: str,
    camera: str | None,
    time: float,
    screen: tuple[float, float],
    aspect: float | None,
) -> float:
    """Measure the depth of the surface at a position of the picture.

    Args:
        state: the worker's state.
        record: the shot.
        edits: text of its edit layer at the time of the request.
        camera: prim path, or None for the default camera.
        time: USD time code.
        screen: the position, from (0, 0) top left to (1, 1) bottom right.
        aspect: width over height of the picture; None takes the film gate's.

    Returns:
        Metres along the view axis; infinite where there is no surface.

    Raises:
        CameraError: it is no camera.
        SettingsError: the camera makes no picture.
    """
    with state.opened.use(record, edits) as shot:
        pick = _pick_on_screen(state, shot, camera, time, screen, aspect)
    return math.inf if pick is None else pick.depth_m


@picture_function
def find_anchor(
    state: PictureWorkerState,
    record: ShotRecord,
    edits: str,
    camera: str | None,
    time: float,
    screen: tuple[float, float],
) -> Anchor | None:
    """Find the anchor of the surface at a position of the picture in the shape of the film gate; None for no surface.

    Args and errors are those of `measure_depth`.
    """
    with state.opened.use(record, edits) as shot:
        pick = _pick_on_screen(state, shot, camera, time, screen, None)
    return None if pick is None else anchor_of(pick)


def _pick_on_screen(
    state: PictureWorkerState,
    shot: Shot,
    camera: str | None,
    time: float,
    screen: tuple[float, float],
    aspect: float | None,
) -> SurfacePick | None:
    height = max(1, round(PICK_WIDTH_PX / aspect)) if aspect else picture_height(shot, camera, time, PICK_WIDTH_PX)
    position = screen[0] * PICK_WIDTH_PX, screen[1] * height
    return pick_at(state, shot, camera, time, (PICK_WIDTH_PX, height), position)


def pick_at(
    state: PictureWorkerState,
    shot: Shot,
    camera: str | None,
    time: float,
    size: tuple[int, int],
    position: tuple[float, float],
) -> SurfacePick | None:
    """Find the surface at a position of a picture.

    Args:
        state: the worker's state.
        shot: the shot.
        camera: prim path, or None for the default camera.
        time: USD time code.
        size: width and height of the picture, px.
        position: x and y from its top left corner, px.
    """
    prepared = shot.camera_at(camera, time, *size)
    return draw_accepted(lambda: state.renderer.pick(shot.scene_at(time, prepared.path), prepared, *size, *position))


def anchor_of(pick: SurfacePick) -> Anchor:
    """Return the anchor that keeps a focus point on a picked surface."""
    return Anchor(
        target=(pick.prim_path,) if pick.prototype_path is None else (pick.prim_path, pick.prototype_path),
        face=pick.face,
        fan_triangle=pick.fan_triangle,
        barycentric=pick.barycentric,
        instance=pick.instance,
    )
