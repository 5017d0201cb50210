"""One frame, from a scene and a camera to radiance: the middle of the sentence

    read the scene at a time · ask the lens for its rays · ask the focus points for the focal surface · peel the layers ·
    trace the rays through them · expose and develop the film · write the frame

`render.pictures.picture.make_picture` is the whole of it. Here a scene is loaded on the device, an engine draws it
(`render.engines`), and AOVs are measured beside it. `FrameRenderer.render` draws one time. Two methods draw an open shutter:
`FrameRenderer.render_moving` peels the scene at each moment, `FrameRenderer.render_swept` peels it once and moves its surfaces.

The device is the GPU, or Mesa's software renderer in its place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace
from types import TracebackType
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.engines import DrawRequest, Engine, check_scene, check_settings, engine_class
from render.engines.shared.aovs import measure_aovs
from render.engines.shared.device import Device
from render.engines.shared.request import Progress
from render.engines.shared.shutter_samples import make_shutter_samples
from render.errors import GraphicsError, InputError, SettingsError
from render.gl.cancellation import Cancelled
from render.gl.compat import OpenGLError
from render.gl.context import GraphicsContext
from render.layers.camera_scene import CameraScenes
from render.layers.movement import find_movements
from render.layers.readback import Pick, pick_surface
from render.layers.shadows import shadow_region
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.deep import DeepSamples
from render.model.focus_map import FocusMap
from render.model.frame_settings import FrameSettings
from render.model.mattes import MATTES, MatteSum, make_matte_sum
from render.model.moment import Moment, ShutterScenes
from render.model.scene import Scene
from render.model.surface_points import SurfacePoints
from render.optics.distortion import undistort_position
from render.optics.view import PinholeView
from render.steps import step

_AOV_WAVELENGTHS = 3
"""Wavelengths that a lens's table has where AOVs are measured; sharpness is that of the middle one."""

__all__ = ["Frame", "FrameRenderer", "FrameSettings", "Pick"]


@dataclass(frozen=True, eq=False)
class Frame:
    """A rendered frame.

    Attributes:
        color: ``(height, width, 4)`` float32 scene-linear radiance, not exposed; premultiplied, alpha is coverage.
        aovs: the arrays that the settings name, ``(height, width)`` or, where `render.model.aovs` has several channels,
            ``(height, width, channels)``. They are measured where the ray through the pupil's centre meets a surface, at pixel
            centres; ``albedo`` and the mattes (`render.model.mattes`) are as blurred as the picture. Ids are int32 but for
            ``prim_id``, which is uint32; the rest is float32.
        prim_paths: prim paths that ids of prims index.
        points: what the pixels see, where the settings name primvars (`render.pictures.primvars` reads them).
        time: USD time code of ``points``.
        matte_names: names in the picture of each matte among the AOVs.
        deep: samples in depth, where the settings ask for them.
    """

    color: FloatArray
    aovs: dict[str, NDArray[Any]] = field(default_factory=dict)
    prim_paths: tuple[str, ...] = ()
    points: SurfacePoints | None = None
    time: float = 0.0
    matte_names: dict[str, tuple[str, ...]] = field(default_factory=dict)
    deep: DeepSamples | None = None


class FrameRenderer:
    """Renders frames on one OpenGL context, in the thread that made it.

    Attributes:
        graphics: the context. After an OpenGL error it is replaced by a new one.
        device: the peeler, the tracers and the blurs on that context.
    """

    def __init__(self) -> None:
        """Raises `GraphicsError` where no context can be made."""
        self._scenes = CameraScenes()
        self._open()

    def _open(self) -> None:
        self.graphics = GraphicsContext()
        self.device = Device(self.graphics)
        self._engines: dict[type[Engine], Engine] = {}

    def render(
        self, scene: Scene, camera: Camera, settings: FrameSettings, on_progress: Progress | None = None
    ) -> Frame:
        """Render one frame.

        Args:
            scene: the scene at one time.
            camera: the camera; its film apertures should have the picture's aspect ratio.
            settings: engine, size and sampling.
            on_progress: called with the share that is done, from 0 to 1.

        Raises:
            SettingsError: no engine can do this, or not with this lens.
            CameraError: the camera's values cannot make a picture.
            GraphicsError: OpenGL reports an error.
        """
        check_settings(settings)
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        with self.on_device():
            camera = self.load(scene, camera, settings)
            mattes = make_matte_sum(settings.width, settings.height, settings.aovs, deep=settings.deep)
            request = DrawRequest(view, camera, settings, on_progress=on_progress, mattes=mattes)
            frame = self.measure(self.engine(settings).draw(request), scene, request)
        if mattes is not None:
            mattes.end_moment(1.0)
        return add_mattes(frame, mattes, settings)

    def render_moving(
        self,
        count: int,
        moment_at: Callable[[int], Moment],
        settings: FrameSettings,
        on_progress: Progress | None = None,
        *,
        moments_per_pixel: int | None = None,
    ) -> Frame:
        """Render one frame with an open shutter. Its rays are spread over moments, each with a scene and a camera of its own.

        Motion blur and depth of field are one integral, and are sampled as one (Cook, Porter & Carpenter 1984, "Distributed Ray
        Tracing").

        Args:
            count: number of moments, 1 or more.
            moment_at: the shot at each moment, called in the order of time. AOVs are those of the middle one.
            settings: engine, size and sampling; each moment has at least one ray.
            on_progress: called with the share that is done, from 0 to 1.
            moments_per_pixel: number of successive moments at which any one pixel is exposed, fewer than all with a rolling
                shutter. The rays of a pixel are spread over these. None for all moments.

        Raises:
            SettingsError: no engine can do this, or not with this lens.
            CameraError: a camera's values cannot make a picture.
            GraphicsError: OpenGL reports an error.
        """
        check_settings(settings)
        ray_parts = moments_per_pixel or count
        settings = replace(settings, rays=max(settings.rays, ray_parts))
        total = np.zeros((settings.height, settings.width, 4), np.float32)
        frame = Frame(total)
        mattes = make_matte_sum(settings.width, settings.height, settings.aovs, deep=settings.deep)
        for i in range(count):
            moment = moment_at(i)
            view = PinholeView.from_camera(moment.camera, settings.width, settings.height)
            with self.on_device():
                camera = self.load(moment.scene, moment.camera, settings)
                request = DrawRequest(view, camera, settings, part=(i % ray_parts, ray_parts), mattes=mattes)
                total += moment.share * self.engine(settings).draw(request)
                if mattes is not None:
                    mattes.end_moment(moment.share)
                if i == count // 2:
                    frame = self.measure(total, moment.scene, request)
            if on_progress is not None:
                on_progress((i + 1) / count)
        return add_mattes(frame, mattes, settings)

    def render_swept(
        self,
        scenes: ShutterScenes,
        middle_camera: Camera,
        moments: Sequence[Moment],
        settings: FrameSettings,
        on_progress: Progress | None = None,
        *,
        moments_per_pixel: int | None = None,
    ) -> Frame:
        """Render one frame with an open shutter from one peeling, many times faster than `render_moving`.

        Surfaces move along straight lines and keep their shading (`render.trace.motion_tracer`).

        Args:
            scenes: the scene as the shutter opens, half-way, and as it closes.
            middle_camera: the camera half-way. AOVs are those of this camera.
            moments: moments in order, evenly spaced; their cameras and shares are used, their scenes are not.
            settings: an engine that takes velocities, size and sampling; each moment has at least one ray.
            on_progress: called with the share that is done, from 0 to 1.
            moments_per_pixel: as in `render_moving`.

        Raises:
            SettingsError: no engine can do this, or not with this lens.
            CameraError: a camera's values cannot make a picture.
            GraphicsError: OpenGL reports an error.
        """
        check_settings(settings)
        ray_parts = moments_per_pixel or len(moments)
        settings = replace(settings, rays=max(settings.rays, ray_parts))
        view = PinholeView.from_camera(middle_camera, settings.width, settings.height)
        seen = [scene.seen_by(middle_camera.path) for scene in (scenes.middle, scenes.opening, scenes.closing)]
        movements = find_movements(*seen)
        samples = make_shutter_samples(moments, settings, ray_parts, lambda camera: _close_iris(camera, settings))
        total = np.zeros((settings.height, settings.width, 4), np.float32)
        with self.on_device():
            camera = self.load(scenes.middle, middle_camera, settings)
            mattes = make_matte_sum(settings.width, settings.height, settings.aovs, deep=settings.deep)
            request = DrawRequest(view, camera, settings, on_progress=on_progress, mattes=mattes)
            with closing(self.engine(settings).draw_swept(request, samples, movements)) as pictures:
                for moment, picture in zip(moments, pictures, strict=True):
                    total += moment.share * picture
                    if mattes is not None:
                        mattes.end_moment(moment.share)
            frame = self.measure(total, scenes.middle, request)
        return add_mattes(frame, mattes, settings)

    def load(self, scene: Scene, camera: Camera, settings: FrameSettings, *, is_preview: bool = False) -> Camera:
        """Put the scene on the device.

        Args:
            scene: the scene; lit from the camera where it has no light.
            camera: the camera.
            settings: they name the engine.
            is_preview: see `Peeler.load`.

        Returns:
            The camera as the engine draws it: with a closed iris where the engine is sharp.

        Raises:
            SettingsError: the engine cannot show the camera's lens, or the scene's Gaussian splats.
        """
        drawn = self.drawn_camera(camera, settings)
        check_scene(settings, scene)
        with step("load scene"):
            self.device.peeler.load(self._scenes.scene(scene, camera), shadow_region(camera), is_preview=is_preview)
        return drawn

    def drawn_camera(self, camera: Camera, settings: FrameSettings) -> Camera:
        """Return the camera as the engine that settings name draws it: with a closed iris where the engine is sharp.

        Raises:
            SettingsError: the engine cannot show the camera's lens.
        """
        engine_class(settings).check_camera(camera)
        return _close_iris(camera, settings)

    def has_loaded(self, scene: Scene, camera: Camera) -> bool:
        """Whether `load` would do nothing: the scene is on the device, with its shadows as this camera's pictures have them."""
        return self.device.peeler.has_shadows(self._scenes.scene(scene, camera), shadow_region(camera))

    def has_scene(self, scene: Scene, camera: Camera) -> bool:
        """Whether the scene is on the device, with any shadows."""
        return self.device.peeler.has_scene(self._scenes.scene(scene, camera))

    def measure(self, color: FloatArray, scene: Scene, request: DrawRequest) -> Frame:
        """Make a frame of a picture, and measure the AOVs of the loaded scene.

        Args:
            color: the picture, as the engine drew it.
            scene: the scene that is loaded.
            request: the request for that picture.
        """
        draw = self.engine(request.settings).draw
        measured = measure_aovs(self.device, draw, request, scene.stage_from_world)
        return Frame(color, measured.values, scene.prim_paths, measured.points, scene.time)

    def map_focus(
        self,
        scene: Scene,
        camera: Camera,
        settings: FrameSettings,
        *,
        size: tuple[int, int] | None = None,
        is_preview: bool = False,
    ) -> FocusMap:
        """Measure how sharp each pixel of a picture is, without drawing it.

        Depths are kept: a change of focus or stop needs no new drawing of the surfaces. They are those at the scene's time,
        also where the picture is spread over an open shutter.

        Args:
            scene: the scene at one time.
            camera: the camera; its film apertures should have the picture's aspect ratio.
            settings: of the picture; the map has the values of its AOVs ``coc`` and ``depth``.
            size: width and height of the map in pixels, in place of the picture's.
            is_preview: see `Peeler.load`; the sharpness is that of rays of one wavelength then.

        Raises:
            SettingsError: the engine cannot show the camera's lens.
            CameraError: the camera's values cannot make a picture.
            GraphicsError: OpenGL reports an error.
        """
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        if size is not None:
            view = view.resize(*size)
        with self.on_device():
            drawn = self.load(scene, camera, settings, is_preview=is_preview)
            lit = self._scenes.scene(scene, camera)
            mapper = self.device.tracer.focus_mapper
            return mapper.measure(self.device.peeler, lit, drawn, view, 1 if is_preview else _AOV_WAVELENGTHS)

    def engine(self, settings: FrameSettings) -> Engine:
        """Return the engine that settings name; it is made on first use.

        Raises:
            SettingsError: there is none of that name.
        """
        kind = engine_class(settings)
        if kind not in self._engines:
            self._engines[kind] = kind(self.device)
        return self._engines[kind]

    def pick(self, scene: Scene, camera: Camera, width: int, height: int, x: float, y: float) -> Pick | None:
        """Find the surface at a position of the picture, seen from the pupil's centre.

        Args:
            scene: the scene at one time.
            camera: the camera.
            width: of the picture in pixels.
            height: likewise.
            x: pixels from the left edge.
            y: pixels from the top edge.

        Returns:
            The pick, or None for the background.

        Raises:
            SettingsError: the position is outside the picture.
        """
        view = PinholeView.from_camera(camera, width, height)
        if not (0 <= x <= width and 0 <= y <= height):
            raise SettingsError(f"the place to pick must lie in the {width}x{height} picture, got ({x:g}, {y:g})")
        peeler = self.device.peeler
        with self.on_device():
            lit = self._scenes.scene(scene, camera)
            if not peeler.has_scene(lit):  # picking ignores shadows, so shadow maps of any region will do
                peeler.load(lit, shadow_region(camera))
            pick = pick_surface(peeler, lit, view, *undistort_position(view, camera, x, y))
        return None if pick is None else replace(pick, depth_m=pick.depth_m - camera.set_back_m)

    def forget_layers(self) -> None:
        """Drop cached layers, so that the next frame peels again. For benches."""
        self.device.peeler.clear_cache()

    def close(self) -> None:
        """Release the device's memory and the context."""
        self.graphics.make_current()
        for engine in self._engines.values():
            engine.release()
        self.device.release()
        self.graphics.close()

    def __enter__(self) -> FrameRenderer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @contextmanager
    def on_device(self) -> Iterator[None]:
        """Make the context current. After an OpenGL error, replace the context, so that the next frame starts from a clean state.

        Raises:
            GraphicsError: OpenGL reports an error.
        """
        self.graphics.make_current()
        try:
            yield
            self.graphics.raise_faults()
        except (SettingsError, InputError, Cancelled):
            raise  # the context is intact: nothing was drawn yet, or work stopped at a cancellation point
        except Exception as error:
            self.graphics.close()
            self._open()
            if isinstance(error, (OpenGLError, moderngl.Error, RuntimeError)):
                raise GraphicsError(f"{self.graphics.renderer} could not draw the frame: {error}") from error
            raise


def add_mattes(frame: Frame, mattes: MatteSum | None, settings: FrameSettings) -> Frame:
    """Return a frame with the mattes that settings name, or its samples in depth; ``mattes`` has their sum, whose moments have
    ended."""
    if mattes is None:
        return frame
    if mattes.is_deep:
        return replace(frame, deep=mattes.layer(frame.color))
    ranked = {name: mattes.rank(name) for name in MATTES if name in settings.aovs}
    aovs = frame.aovs | {name: pixels for name, (pixels, _) in ranked.items()}
    return replace(frame, aovs=aovs, matte_names={name: names for name, (_, names) in ranked.items()})


def _close_iris(camera: Camera, settings: FrameSettings) -> Camera:
    """Close the iris where the engine is sharp."""
    return replace(camera, f_stop=0.0) if engine_class(settings).is_sharp else camera
