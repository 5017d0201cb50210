"""What moves in a shot while a camera's shutter is open."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from render.errors import CameraError
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.moment import Moment, ShutterScenes
from render.model.shutter import at_once, moments, shares
from render.pictures.image_space import ImageSpace
from render.shot.shot import Shot

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer, FrameSettings


def moves(lens: Camera, settings: FrameSettings) -> bool:
    """Whether motion is asked for and the camera's shutter is open for long enough to see any."""
    return settings.motion > 1 and (lens.shutter_close != lens.shutter_open or lens.shutter.delay != 0)


def check_shutter(lens: Camera) -> None:
    """See that a camera's shutter opens before it closes: no camera takes a picture else, motion or not.

    Raises:
        CameraError: it closes before it opens.
    """
    if not lens.shutter_close >= lens.shutter_open:
        raise CameraError(
            f"camera {lens.path}: a shutter cannot close before it opens: shutter:open is {lens.shutter_open:g} and "
            f"shutter:close is {lens.shutter_close:g}",
            code="bad_shutter",
            path=lens.path,
        )


def moving_frame(
    renderer: FrameRenderer,
    shot: Shot,
    camera: str | None,
    lens: Camera,
    time: float,
    space: ImageSpace,
    on_progress: Callable[[float], None] | None = None,
) -> Frame:
    """Render what falls on the film while the shutter is open.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        camera: prim path; None for the shot's default camera.
        lens: that camera at the time; its shutter is the one that opens, and need not be the shot's own.
        time: USD time code.
        space: how it is rendered, and around the frame; ``motion_by`` says whether the scene is peeled at every moment or once.
        on_progress: called with the share that is done, from 0 to 1.

    Raises:
        CameraError: the camera has impossible numbers at one of the moments.
        GraphicsError: the device refuses.
    """
    settings = space.asked
    size, count = (settings.width, settings.height), settings.motion
    times = time + moments(lens.shutter_open, lens.shutter_close, lens.shutter, count)
    parts = shares(lens.shutter_open, lens.shutter_close, lens.shutter, count, *size).astype(np.float32)
    if settings.motion_by == "velocities":
        return _swept(renderer, shot, camera, lens, time, times, parts, space, on_progress)

    def at(index: int) -> Moment:
        when = float(times[index])
        return Moment(shot.scene_at(when), shot.camera_at(camera, when, *size), parts[index, ..., None])

    return renderer.render_moving(count, space.moments(at), space.settings, on_progress, at_once=at_once(parts))


def _swept(
    renderer: FrameRenderer,
    shot: Shot,
    camera: str | None,
    lens: Camera,
    time: float,
    times: DoubleArray,
    parts: FloatArray,
    space: ImageSpace,
    on_progress: Callable[[float], None] | None,
) -> Frame:
    """The frame from one peeling, in the middle of all the time that any place of the picture is exposed."""
    size = space.asked.width, space.asked.height
    begins, ends = time + lens.shutter_open, time + lens.shutter_close + lens.shutter.delay
    middle = (begins + ends) / 2
    opening = ShutterScenes(shot.scene_at(middle), shot.scene_at(begins), shot.scene_at(ends))
    seen = [
        space.moment(Moment(opening.middle, shot.camera_at(camera, float(when), *size), part[..., None]))
        for when, part in zip(times, parts, strict=True)
    ]
    looks = space.camera(shot.camera_at(camera, middle, *size))
    return renderer.render_swept(opening, looks, seen, space.settings, on_progress, at_once=at_once(parts))
