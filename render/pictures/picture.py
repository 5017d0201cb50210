"""From a shot to a graded picture: the one way that the command line and the service share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from pxr import Usd

from render.engines import check_settings, engine_of
from render.film import Grade, GradeChoice
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.optics.photometry.illuminance import light_over_picture
from render.output import FrameMetadata
from render.pictures.flare import flared
from render.pictures.image_space import ImageSpace
from render.pictures.moving import check_shutter, moves, moving_frame
from render.shot.film.finish import Finish
from render.shot.light_meter import auto_expose
from render.shot.shot import Shot

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer, FrameSettings
    from render.pictures.live_finisher import LiveFinisher


@dataclass(frozen=True, eq=False)
class Picture:
    """A rendered and graded frame.

    Attributes:
        frame: scene-linear radiance, and the measurements that were asked for.
        graded: ``(height, width, 3)`` float32, encoded for the display, 0 to 1.
        camera: as it was rendered, its focus solved.
        metadata: what a file says about it.
    """

    frame: Frame
    graded: FloatArray
    camera: Camera
    metadata: FrameMetadata


def make_picture(
    renderer: FrameRenderer,
    shot: Shot,
    camera: str | None,
    time: float,
    settings: FrameSettings,
    grade: Grade | None = None,
    on_progress: Callable[[float], None] | None = None,
    *,
    stock: str | None = None,
    choice: GradeChoice | None = None,
    live: LiveFinisher | None = None,
) -> Picture:
    """Read the scene at a time, focus the camera, render, expose and grade.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        camera: prim path; None for the shot's default camera.
        time: USD time code.
        settings: how it is rendered.
        grade: for which display, in place of what the shot says.
        on_progress: called with the share of the rendering that is done, from 0 to 1.
        stock: a film of the library, in place of what the shot says.
        choice: what is wanted of the grade, in place of parts of what the shot says.
        live: finishes it on the device, for somebody who waits for it; None finishes it as files are.

    Raises:
        SettingsError: the time is not finite, the library has no such stock, or no such grade can be made.
        CameraError: it is no camera, has impossible numbers, or a shutter that closes before it opens.
        GraphicsError: the device refuses.
    """
    lens, finish = prepare_camera(renderer, shot, camera, time, settings, grade, stock=stock, choice=choice)
    frame = expose_frame(renderer, shot, camera, lens, time, settings, on_progress)
    return picture_of(shot, frame, lens, time, settings, finish, live)


def prepare_camera(
    renderer: FrameRenderer,
    shot: Shot,
    camera: str | None,
    time: float,
    settings: FrameSettings,
    grade: Grade | None = None,
    *,
    stock: str | None = None,
    choice: GradeChoice | None = None,
) -> tuple[Camera, Finish]:
    """The camera of a picture, focused and exposed, and how the picture is finished. What is wrong with either is told before
    anything slow is done.

    The arguments and errors are those of `make_picture`.
    """
    check_settings(settings)
    lens = shot.camera_at(camera, time, settings.width, settings.height)
    check_shutter(lens)
    finish = shot.film.finish(lens, time, grade, stock, choice)
    return auto_expose(renderer, shot, lens, time, settings.shading), finish


def picture_of(
    shot: Shot,
    frame: Frame,
    lens: Camera,
    time: float,
    settings: FrameSettings,
    finish: Finish,
    live: LiveFinisher | None = None,
    graded: FloatArray | None = None,
) -> Picture:
    """Expose, develop and grade what fell on the film, and say what it is.

    Args:
        shot: the shot.
        frame: of it.
        lens: the camera that took it.
        time: USD time code.
        settings: how it was rendered.
        finish: how it is finished.
        live: on which device; None for the processor.
        graded: the finished picture, where it is there already.

    Raises:
        SettingsError: it cannot be finished so.
        GraphicsError: the device refuses.
    """
    if graded is None:
        by = finish.apply if live is None else partial(live.picture, finish)
        graded = by(frame.color, lens, time=time, seed=settings.seed)
    return Picture(frame, graded, lens, metadata_of(shot, lens, time, settings, finish, frame.prim_paths))


def metadata_of(
    shot: Shot, lens: Camera, time: float, settings: FrameSettings, finish: Finish, prim_paths: tuple[str, ...] = ()
) -> FrameMetadata:
    """What a file says about a picture.

    Args:
        shot: the shot.
        lens: the camera that took it.
        time: USD time code.
        settings: how it was rendered.
        finish: how it was finished.
        prim_paths: what its ids index.
    """
    prim = shot.stage.GetPrimAtPath(lens.path) if lens.path else None
    return FrameMetadata(
        camera=lens,
        time=time,
        frames_per_second=shot.stage.GetFramesPerSecond(),
        grade=finish.grade,
        film=finish.film,
        settings=asdict(settings),
        stage=shot.path.name,
        prim_paths=prim_paths,
        exposure_time_s=_authored(prim, "exposure:time", time),
        iso=_authored(prim, "exposure:iso", time),
    )


def expose_frame(
    renderer: FrameRenderer,
    shot: Shot,
    camera: str | None,
    lens: Camera,
    time: float,
    settings: FrameSettings,
    on_progress: Callable[[float], None] | None = None,
) -> Frame:
    """What falls on the film while the shutter is open, all that the lens does to it included.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        camera: prim path; None for the shot's default camera.
        lens: that camera at the time; its shutter is the one that opens, and need not be the shot's own.
        time: USD time code.
        settings: how it is rendered.
        on_progress: called with the share that is done, from 0 to 1.

    Raises:
        CameraError: the shutter closes before it opens, or the camera has impossible numbers at one of the moments.
        GraphicsError: the device refuses.
    """
    check_shutter(lens)
    space = ImageSpace.of(lens, settings)
    if moves(lens, settings):
        frame = moving_frame(renderer, shot, camera, lens, time, space, on_progress)
    else:
        frame = renderer.render(shot.scene_at(time), space.camera(lens), space.settings, on_progress)
    return apply_lens_effects(renderer, shot, lens, time, space, frame)


def apply_lens_effects(
    renderer: FrameRenderer, shot: Shot, lens: Camera, time: float, space: ImageSpace, frame: Frame
) -> Frame:
    """What a lens does to light that an engine does not know of.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        lens: the camera.
        time: USD time code.
        space: how the frame was rendered.
        frame: as the engine has it; its colour may be changed.

    Raises:
        GraphicsError: the device refuses.
    """
    settings = space.asked
    frame = space.finished(renderer, frame)
    apply_vignetting(frame.color, lens, settings)
    return flared(renderer, shot.scene_at(time), lens, settings, frame)


def apply_vignetting(radiance: FloatArray, lens: Camera, settings: FrameSettings) -> None:
    """Take from a picture, in place, what the lens and the obliqueness of light take and its engine does not.

    Args:
        radiance: ``(height, width, 4)`` of any size.
        lens: the camera.
        settings: whose engine made it.
    """
    height, width, _ = radiance.shape
    engine = engine_of(settings)
    light = light_over_picture(lens, width, height, is_pinhole=engine.is_sharp)
    if light is not None:
        radiance[..., :3] *= light[..., None]
    if not engine.traces_lens:
        radiance[..., :3] *= np.float32(lens.lens.transmittance)


def _authored(prim: Usd.Prim | None, name: str, time: float) -> float | None:
    """The value of an attribute that the shot sets, or None."""
    attribute = prim.GetAttribute(name) if prim else None
    return float(attribute.Get(time)) if attribute and attribute.HasAuthoredValue() else None
