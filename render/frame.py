"""One frame, from a scene and a camera to radiance.

    read the scene at a time · ask the lens for its rays · ask the focus points for the focal surface · peel the layers ·
    trace the rays through them · expose and develop the film · write the frame

The stage reader, the focus solver, film and output stand on either side; `render.shot.make_picture` walks the whole way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from types import TracebackType
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.errors import GraphicsError, InputError, SettingsError
from render.frame_settings import AOVS, ENGINES, SHADINGS, FrameSettings
from render.gl.compat import OpenGLError
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.layers.peel import Peeler
from render.layers.readback import Pick, pick_surface
from render.layers.shadows import Sphere
from render.optics.distortion import seen_at
from render.optics.thin_lens import focal_surface
from render.optics.view import PinholeView
from render.reference.accumulation import Accumulator, accumulated_rays, accumulated_sampling
from render.scene import Camera, Dome, FloatArray, Light, Scene
from render.trace.aovs import MEASURED
from render.trace.lens import LensEngine, OnPass
from render.trace.rays import ray_pattern

__all__ = ["AOVS", "ENGINES", "SHADINGS", "Frame", "FrameRenderer", "FrameSettings", "Pick"]


@dataclass(frozen=True, eq=False)
class Frame:
    """A rendered frame.

    Attributes:
        color: ``(height, width, 4)`` float32 scene-linear radiance, not exposed; premultiplied, alpha is coverage.
        aovs: the asked arrays by name, ``(height, width)``, of what the ray through the pupil's centre meets at pixel centres:
            ``depth`` float32 metres (inf where nothing is); ``coc`` float32 radius in pixels, negative in front of the focus;
            ``defocus`` float32 1/m, inverse depth less that in focus, negative behind it; ``focus_depth`` float32 metres, where
            the pixel is sharpest; ``prim_id`` uint32, the index in `prim_paths` plus one, 0
            where nothing is; ``face_id`` int32, -1 where nothing is. And ``albedo`` ``(height, width, 3)`` float32: base colours
            through the lens, as blurred as the picture.
        prim_paths: what ``prim_id`` indexes.
    """

    color: FloatArray
    aovs: dict[str, NDArray[Any]] = field(default_factory=dict)
    prim_paths: tuple[str, ...] = ()


class FrameRenderer:
    """Renders frames on one OpenGL context, in the thread that made it."""

    def __init__(self) -> None:
        """Raises `GraphicsError` where no context can be made."""
        self._lit: tuple[Scene, Camera, Scene] | None = None
        self._open()

    def _open(self) -> None:
        self.graphics = GraphicsContext()
        programs = ProgramCache(self.graphics.ctx)
        self._peeler = Peeler(self.graphics, programs)
        self._lens = LensEngine(self.graphics.ctx, programs)
        self._accumulator = Accumulator(self.graphics.ctx, programs)

    def render(
        self,
        scene: Scene,
        camera: Camera,
        settings: FrameSettings,
        on_progress: Callable[[float], None] | None = None,
        on_pass: OnPass | None = None,
    ) -> Frame:
        """Render one frame.

        Args:
            scene: what is there.
            camera: what looks; its apertures should have the picture's aspect ratio.
            settings: how.
            on_progress: called with the share that is done, from 0 to 1.
            on_pass: called after each pass of rays with the picture so far, which they make finer, and the number of rays in it.

        Raises:
            CameraError: the camera's numbers make no picture.
            GraphicsError: the device refuses.
        """
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        with self._device():
            return self._frame(view, scene, camera, settings, on_progress, on_pass)

    def _frame(
        self,
        view: PinholeView,
        scene: Scene,
        camera: Camera,
        settings: FrameSettings,
        on_progress: Callable[[float], None] | None,
        on_pass: OnPass | None,
    ) -> Frame:
        self._peeler.load(self._with_light(scene, camera), shadow_interest(camera))
        lens = replace(camera, f_stop=0.0) if settings.engine == "pinhole" else camera
        accumulates = settings.engine == "accumulation"
        if accumulates:
            check_thin(camera)
        draw = self._accumulate if accumulates else self._trace
        color = draw(view, lens, settings, settings.shading == "unlit", on_progress, on_pass)
        aovs = self._aovs(view, lens, settings, lambda: draw(view, lens, settings, True, None, None))
        return Frame(color, aovs, scene.prim_paths)

    def _trace(
        self,
        view: PinholeView,
        camera: Camera,
        settings: FrameSettings,
        unlit: bool,
        on_progress: Callable[[float], None] | None,
        on_pass: OnPass | None,
    ) -> FloatArray:
        return self._lens.picture(
            self._peeler,
            camera,
            view,
            ray_pattern(settings.rays, camera.iris, seed=settings.seed, tiled=settings.tiled),
            wavelengths=settings.wavelengths,
            layers=settings.layers,
            supersample=settings.supersample,
            unlit=unlit,
            on_progress=on_progress,
            on_pass=on_pass,
        ).color

    def pick(self, scene: Scene, camera: Camera, width: int, height: int, x: float, y: float) -> Pick | None:
        """The surface at a place of the picture, seen from the pupil's centre.

        Args:
            scene: what is there.
            camera: what looks.
            width: of the picture in pixels.
            height: likewise.
            x: pixels from the left edge.
            y: pixels from the top edge.

        Returns:
            The pick, or None where nothing is.

        Raises:
            SettingsError: the place is outside the picture.
        """
        view = PinholeView.from_camera(camera, width, height)
        if not (0 <= x <= width and 0 <= y <= height):
            raise SettingsError(f"the place to pick must lie in the {width}x{height} picture, got ({x:g}, {y:g})")
        with self._device():
            self._peeler.load(self._with_light(scene, camera), shadow_interest(camera))
            return pick_surface(self._peeler, scene, view, *seen_at(view, camera, x, y))

    def close(self) -> None:
        """Give the device's memory and the context back."""
        self.graphics.make_current()
        self._lens.release()
        self._peeler.release()
        self.graphics.close()

    def __enter__(self) -> FrameRenderer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @contextmanager
    def _device(self) -> Iterator[None]:
        """Work on the device. What fails half way there leaves nothing behind: the context is made anew for the next frame."""
        self.graphics.make_current()
        try:
            yield
        except (SettingsError, InputError):
            raise  # said before anything was drawn
        except Exception as error:
            self.graphics.close()
            self._open()
            if isinstance(error, (OpenGLError, moderngl.Error, RuntimeError)):
                raise GraphicsError(f"{self.graphics.renderer} could not draw the frame: {error}") from error
            raise

    def _accumulate(
        self,
        view: PinholeView,
        camera: Camera,
        settings: FrameSettings,
        unlit: bool,
        on_progress: Callable[[float], None] | None,
        on_pass: OnPass | None,
    ) -> FloatArray:
        """The accumulation buffer; it has no passes to show, since it draws view by view."""
        del on_pass
        points = accumulated_rays(camera, settings.rays, settings.seed)
        sampling = accumulated_sampling(camera, view, settings.rays, settings.supersample)
        return self._accumulator.accumulate(
            self._peeler,
            view,
            points,
            focal_surface(camera).plane,
            unlit=unlit,
            sampling=sampling,
            on_progress=on_progress,
        )

    def _aovs(
        self, view: PinholeView, camera: Camera, settings: FrameSettings, albedo: Callable[[], FloatArray]
    ) -> dict[str, NDArray[Any]]:
        """The asked AOVs; ``albedo`` makes the picture of base colours."""
        made: dict[str, NDArray[Any]] = {}
        if set(settings.aovs) & set(MEASURED):
            made = self._lens.measured(self._peeler, camera, view)
        if "albedo" in settings.aovs:
            made["albedo"] = albedo()[..., :3]
        return {name: made[name] for name in settings.aovs if name != "color"}

    def _with_light(self, scene: Scene, camera: Camera) -> Scene:
        """The scene, lit from the camera where it has no light at all, as usdrecord does; a faint dome shows metals' shapes."""
        if scene.lights or scene.dome is not None:
            return scene
        if self._lit is None or self._lit[0] is not scene or self._lit[1] is not camera:
            lights = (
                Light("distant", (0.8 * np.pi,) * 3, camera.world_from_camera, casts_shadow=False, path="camera light"),
            )
            dome = Dome((0.2, 0.2, 0.2), np.eye(4), visible=False, path="camera light")
            self._lit = (scene, camera, replace(scene, lights=lights, dome=dome))
        return self._lit[2]


def check_thin(camera: Camera) -> None:
    """Raise `SettingsError` where the accumulation buffer, which moves a pinhole about the pupil, cannot show the lens."""
    if camera.lens.model not in ("thin", "pinhole") and camera.f_stop > 0:
        raise SettingsError(
            f"engine accumulation can show a thin lens alone, and camera {camera.path} has a lens of model "
            f"{camera.lens.model}: use engine lens"
        )
    if not focal_surface(camera).is_plane:
        raise SettingsError(
            f"engine accumulation can show a plane of focus alone, and camera {camera.path} has a focal surface that is none: "
            "use engine lens"
        )


def shadow_interest(camera: Camera) -> Sphere:
    """Where a distant light's shadows are resolved in a large scene: around the point in focus, twelve metres at the least."""
    focus_m = camera.focus_distance_m if 0 < camera.focus_distance_m < 1000 else 10.0
    x, y, z = (float(v) for v in camera.world_from_camera[:3, 3] - focus_m * camera.world_from_camera[:3, 2])
    return Sphere(x, y, z, max(12.0, 2.5 * focus_m))
