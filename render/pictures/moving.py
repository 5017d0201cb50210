"""Frames of a shot that moves while the camera's shutter is open."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from render.errors import CameraError
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.moment import Moment, ShutterScenes
from render.model.shutter import moments, moments_per_pixel, shares
from render.pictures.image_space import ImageSpace
from render.shot.shot import Shot
from render.stage import stand_together

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer, FrameSettings


def has_motion(camera: Camera, settings: FrameSettings) -> bool:
    """Tell whether settings sample motion and the camera's shutter is open for long enough to show any."""
    return settings.motion > 1 and (camera.shutter_close != camera.shutter_open or camera.shutter.delay != 0)


def check_shutter(camera: Camera) -> None:
    """See that a camera's shutter opens before it closes. No camera takes a picture else, motion or not.

    Raises:
        CameraError: it closes before it opens.
    """
    if not camera.shutter_close >= camera.shutter_open:
        raise CameraError(
            f"camera {camera.path}: a shutter cannot close before it opens: shutter:open is {camera.shutter_open:g} and "
            f"shutter:close is {camera.shutter_close:g}",
            code="bad_shutter",
            path=camera.path,
        )


def render_moving_frame(
    renderer: FrameRenderer,
    shot: Shot,
    camera_path: str | None,
    camera: Camera,
    time: float,
    space: ImageSpace,
    on_progress: Callable[[float], None] | None = None,
) -> Frame:
    """Render the light that falls on the film while the shutter is open.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        camera_path: prim path; None for the shot's default camera.
        camera: that camera at the time; its shutter is used, and need not be the shot's own.
        time: USD time code.
        space: settings and margin; ``motion_by`` decides whether the scene is peeled at every moment or once.
        on_progress: called with the share that is done, from 0 to 1.

    Raises:
        CameraError: the camera has impossible values at one of the moments.
        GraphicsError: OpenGL reports an error.
    """
    settings = space.requested
    size, count = (settings.width, settings.height), settings.motion
    times = time + moments(camera.shutter_open, camera.shutter_close, camera.shutter, count)
    parts = shares(camera.shutter_open, camera.shutter_close, camera.shutter, count, *size).astype(np.float32)

    cameras = stand_together([shot.camera_at(camera_path, float(at), *size) for at in times])

    def moment_at(index: int) -> Moment:
        scene = shot.scene_at(float(times[index]), camera.path)
        return space.widen_moment(Moment(scene, cameras[index], parts[index, ..., None]))

    def by_moments() -> Frame:
        return renderer.render_moving(
            count, moment_at, space.settings, on_progress, moments_per_pixel=moments_per_pixel(parts)
        )

    # surfaces that move are carried by their depth from the pupil, which is far behind an orthographic camera
    if settings.motion_by == "moments" or camera.orthographic is not None:
        return by_moments()
    begins, ends = time + camera.shutter_open, time + camera.shutter_close + camera.shutter.delay
    frame = _render_swept(renderer, shot, camera_path, (begins, ends), times, parts, space, on_progress)
    return by_moments() if frame is None else frame


def _render_swept(
    renderer: FrameRenderer,
    shot: Shot,
    camera_path: str | None,
    span: tuple[float, float],
    times: DoubleArray,
    parts: FloatArray,
    space: ImageSpace,
    on_progress: Callable[[float], None] | None,
) -> Frame | None:
    """Render the frame from one peeling in the middle of ``span``, the time codes between which any place is exposed; None where
    splats move, which that does not carry."""
    size = space.requested.width, space.requested.height
    middle = sum(span) / 2
    drawn = shot.camera_at(camera_path, middle, *size)
    scenes = ShutterScenes(*(shot.scene_at(at, drawn.path) for at in (middle, *span)))
    if not scenes.opening.splats == scenes.middle.splats == scenes.closing.splats:
        return None
    samples = [
        space.widen_moment(Moment(scenes.middle, shot.camera_at(camera_path, float(at), *size), part[..., None]))
        for at, part in zip(times, parts, strict=True)
    ]
    return renderer.render_swept(
        scenes,
        space.widen_camera(drawn),
        samples,
        space.settings,
        on_progress,
        moments_per_pixel=moments_per_pixel(parts),
    )
