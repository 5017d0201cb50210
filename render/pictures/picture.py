"""From a shot to a graded picture: the one way that the command line and the service share.

read the scene at a time · focus and expose the camera · render the frame · apply what the lens does to light ·
develop the film and grade
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from pxr import Usd

from render.engines import check_settings, engine_class
from render.errors import SettingsError
from render.film import Grade, GradeChoice
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.optics.photometry.illuminance import light_over_picture
from render.output import FrameMetadata
from render.pictures.flare import add_flare
from render.pictures.image_space import ImageSpace
from render.pictures.moving import check_shutter, has_motion, render_moving_frame
from render.pictures.primvars import add_primvars, check_primvars
from render.shot.accepted import draw_accepted
from render.shot.film.finish import Finish
from render.shot.light_meter import auto_expose
from render.shot.shot import Shot
from render.stage import Finding
from render.steps import step
from usd_schemas import LensCamera
from usd_schemas.units import metres_per_unit

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer, FrameSettings
    from render.pictures.live_finisher import LiveFinisher


@dataclass(frozen=True, eq=False)
class Picture:
    """A rendered and graded frame.

    Attributes:
        frame: scene-linear radiance, and the AOVs that the settings name.
        graded: ``(height, width, 3)`` float32, encoded for the display, 0 to 1.
        camera: as it was rendered, focused and exposed.
        metadata: for the header of a file.
    """

    frame: Frame
    graded: FloatArray
    camera: Camera
    metadata: FrameMetadata


def make_picture(
    renderer: FrameRenderer,
    shot: Shot,
    camera_path: str | None,
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
        camera_path: prim path; None for the shot's default camera.
        time: USD time code.
        settings: engine, size and sampling.
        grade: in place of the shot's grade.
        on_progress: called with the share of the rendering that is done, from 0 to 1.
        stock: a film of the library, in place of the shot's film.
        choice: display, view and look, in place of these parts of the shot's grade.
        live: finishes the picture on the device, for a viewer; None finishes it on the processor, as files are.

    Raises:
        SettingsError: no engine can do this, the time is not finite, the library has no such stock, or no such grade can be made.
        CameraError: the prim is no camera, has impossible values, or a shutter that closes before it opens.
        GraphicsError: OpenGL reports an error.
    """
    with step("prepare camera"):
        camera, finish = prepare_camera(renderer, shot, camera_path, time, settings, grade, stock=stock, choice=choice)
    with step("expose frame"):
        frame = expose_frame(renderer, shot, camera_path, camera, time, settings, on_progress)
    with step("develop and grade"):
        return develop_picture(shot, frame, camera, time, settings, finish, live)


def prepare_camera(
    renderer: FrameRenderer,
    shot: Shot,
    camera_path: str | None,
    time: float,
    settings: FrameSettings,
    grade: Grade | None = None,
    *,
    stock: str | None = None,
    choice: GradeChoice | None = None,
) -> tuple[Camera, Finish]:
    """Focus and expose the camera of a picture, and choose its finish. All errors of either come before anything slow is done.

    The arguments and errors are those of `make_picture`.
    """
    check_settings(settings)
    camera = shot.camera_at(camera_path, time, settings.width, settings.height)
    check_shutter(camera)
    finish = shot.film.finish(camera, time, grade, stock, choice)
    return auto_expose(renderer, shot, camera, time, settings.shading), finish


def expose_frame(
    renderer: FrameRenderer,
    shot: Shot,
    camera_path: str | None,
    camera: Camera,
    time: float,
    settings: FrameSettings,
    on_progress: Callable[[float], None] | None = None,
) -> Frame:
    """Render the light that falls on the film while the shutter is open, with all that the lens does to it.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        camera_path: prim path; None for the shot's default camera.
        camera: that camera at the time; its shutter is used, and need not be the shot's own.
        time: USD time code.
        settings: engine, size and sampling.
        on_progress: called with the share that is done, from 0 to 1.

    Raises:
        CameraError: the shutter closes before it opens, or the camera has impossible values at one of the moments.
        SettingsError: no drawn prim has a primvar that the settings name, or no deep picture can be made of the lens.
        GraphicsError: OpenGL reports an error.
    """
    check_shutter(camera)
    return draw_accepted(lambda: _expose_frame(renderer, shot, camera_path, camera, time, settings, on_progress))


def _expose_frame(
    renderer: FrameRenderer,
    shot: Shot,
    camera_path: str | None,
    camera: Camera,
    time: float,
    settings: FrameSettings,
    on_progress: Callable[[float], None] | None,
) -> Frame:
    check_primvars(shot, camera.path, time, settings)
    _note_holdouts(shot, camera.path, time, settings)
    space = ImageSpace.for_camera(camera, settings)
    if settings.deep and space.errors is not None:
        raise SettingsError(
            f"the errors of the lens by its data sheet are applied to finished pictures by the {settings.engine} engine, and "
            "cannot be to deep ones: take the engine lens"
        )
    if has_motion(camera, settings):
        frame = render_moving_frame(renderer, shot, camera_path, camera, time, space, on_progress)
    else:
        frame = renderer.render(
            shot.scene_at(time, camera.path), space.widen_camera(camera), space.settings, on_progress
        )
    return apply_lens_effects(renderer, shot, camera, time, space, frame)


def _note_holdouts(shot: Shot, camera_path: str, time: float, settings: FrameSettings) -> None:
    """Note holdouts where the engine cannot leave them out of alpha."""
    if engine_class(settings).has_rays:
        return
    scene = shot.scene_at(time, camera_path)
    held = any(batch.camera_role == "holdout" for batch in scene.batches)
    if held or any(batch.is_holdout for batch in scene.splats):
        message = f"holdouts of the render pass are black with alpha 1, since the engine {settings.engine} has no alpha"
        shot.note_asked([Finding("holdout_alpha", "/", f"{message}: take the engine lens")])


def apply_lens_effects(
    renderer: FrameRenderer, shot: Shot, camera: Camera, time: float, space: ImageSpace, frame: Frame
) -> Frame:
    """Apply what a lens does to light and the engine does not: errors in image space, vignetting, flare.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        camera: the camera.
        time: USD time code.
        space: as the frame was rendered.
        frame: as the engine drew it; its colour may be changed.

    Raises:
        GraphicsError: OpenGL reports an error.
    """
    frame = space.apply(renderer, add_primvars(shot, frame, space.settings))
    apply_vignetting(frame.color, camera, space.requested)
    if frame.deep is not None:
        gain = np.ones_like(frame.color)
        apply_vignetting(gain, camera, space.requested)
        frame = replace(frame, deep=frame.deep.dim(gain))
    return add_flare(renderer, shot.scene_at(time, camera.path), camera, space.requested, frame)


def apply_vignetting(radiance: FloatArray, camera: Camera, settings: FrameSettings) -> None:
    """Multiply a picture, in place, by the light that the lens and the angle of incidence leave of it, where the engine does not.

    Args:
        radiance: ``(height, width, 4)`` of any size.
        camera: the camera.
        settings: they name the engine.
    """
    height, width, _ = radiance.shape
    engine = engine_class(settings)
    light = light_over_picture(camera, width, height, is_pinhole=engine.is_sharp)
    if light is not None:
        radiance[..., :3] *= light[..., None]
    if not engine.traces_lens:
        radiance[..., :3] *= np.float32(camera.lens.transmittance)


def develop_picture(
    shot: Shot,
    frame: Frame,
    camera: Camera,
    time: float,
    settings: FrameSettings,
    finish: Finish,
    live: LiveFinisher | None = None,
    graded: FloatArray | None = None,
) -> Picture:
    """Expose, develop and grade the light on the film, and describe the picture.

    Args:
        shot: the shot.
        frame: the light on the film.
        camera: the camera that took it.
        time: USD time code.
        settings: as it was rendered.
        finish: film and grade.
        live: finishes it on the device; None for the processor.
        graded: the finished picture, where there is one already.

    Raises:
        SettingsError: the film cannot be developed, or the grade cannot be made.
        GraphicsError: OpenGL reports an error.
    """
    if graded is None:
        finish_picture = finish.apply if live is None else partial(live.finish, finish)
        graded = finish_picture(frame.color, camera, time=time, seed=settings.seed)
    metadata = describe_picture(shot, camera, time, settings, finish, frame.prim_paths)
    return Picture(frame, graded, camera, replace(metadata, matte_names=frame.matte_names))


def describe_picture(
    shot: Shot, camera: Camera, time: float, settings: FrameSettings, finish: Finish, prim_paths: tuple[str, ...] = ()
) -> FrameMetadata:
    """Collect the metadata of a picture.

    Args:
        shot: the shot.
        camera: the camera that took it.
        time: USD time code.
        settings: as it was rendered.
        finish: film and grade.
        prim_paths: prim paths that its ids index.
    """
    prim = shot.stage.GetPrimAtPath(camera.path) if camera.path else None
    return FrameMetadata(
        camera=camera,
        time=time,
        frames_per_second=shot.stage.GetFramesPerSecond(),
        time_codes_per_second=shot.stage.GetTimeCodesPerSecond(),
        grade=finish.grade,
        film=finish.film,
        settings=asdict(settings),
        stage=shot.path.name,
        prim_paths=prim_paths,
        color_space=shot.rendering_space(),
        metres_per_unit=metres_per_unit(shot.stage),
        exposure_time_s=_read_authored(prim, "exposure:time", time),
        iso=_read_authored(prim, "exposure:iso", time),
        t_stop=_read_t_stop(prim, camera, time),
    )


def _read_t_stop(prim: Usd.Prim | None, camera: Camera, time: float) -> float | None:
    """Read the T-stop of a lens; None where its f-number says as much."""
    glass = LensCamera(prim).lens.read(time) if prim else None
    if glass is None or camera.f_stop == 0 or glass.transmittance == 0:
        return None
    if glass.stop_marking == "t":
        return camera.f_stop
    return camera.f_stop / math.sqrt(glass.transmittance) if glass.transmittance < 1 else None


def _read_authored(prim: Usd.Prim | None, name: str, time: float) -> float | None:
    """Read an attribute that the shot sets; None where it does not."""
    attribute = prim.GetAttribute(name) if prim else None
    return float(attribute.Get(time)) if attribute and attribute.HasAuthoredValue() else None
