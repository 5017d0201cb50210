"""One frame, from a scene and a camera to radiance.

    read the scene at a time · ask the lens for its rays · ask the focus points for the focal surface · peel the layers ·
    trace the rays through them · expose and develop the film · write the frame

The stage reader, the focus solver, film and output stand on either side; `render.shot.make_picture` walks the whole way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from types import TracebackType
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.engines.accumulator import check_thin
from render.engines.engines import Engines
from render.errors import GraphicsError, InputError, SettingsError
from render.gl.cancellation import Cancelled
from render.gl.compat import OpenGLError
from render.gl.context import GraphicsContext
from render.layers.headlight import Headlight
from render.layers.movement import movements
from render.layers.readback import Pick, pick_surface
from render.layers.shadows import shadow_interest
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import AOVS, ENGINES, SHADINGS, FrameSettings
from render.model.lens import IrisShape
from render.model.moment import Moment, ShutterScenes
from render.model.scene import Scene
from render.optics.distortion import seen_at
from render.optics.view import PinholeView
from render.trace.aovs import MEASURED
from render.trace.rays import RayPattern, ray_pattern
from render.trace.swept import ShutterSample

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


_WHOLE = (0, 1)  # all rays: the first of one part


class _Patterns:
    """The patterns of cameras whose iris mostly stays the same."""

    def __init__(self, settings: FrameSettings) -> None:
        self._settings = settings
        self._made: tuple[IrisShape, RayPattern] | None = None

    def of(self, camera: Camera) -> RayPattern:
        """The pattern of all rays of a camera."""
        if self._made is None or self._made[0] != camera.iris:
            s = self._settings
            self._made = camera.iris, ray_pattern(s.rays, camera.iris, seed=s.seed, tiled=s.tiled)
        return self._made[1]


class FrameRenderer:
    """Renders frames on one OpenGL context, in the thread that made it."""

    def __init__(self) -> None:
        """Raises `GraphicsError` where no context can be made."""
        self._headlight = Headlight()
        self._open()

    def _open(self) -> None:
        self.graphics = GraphicsContext()
        self.engines = Engines(self.graphics)
        self._peeler, self._lens = self.engines.peeler, self.engines.lens

    def render(
        self,
        scene: Scene,
        camera: Camera,
        settings: FrameSettings,
        on_progress: Callable[[float], None] | None = None,
    ) -> Frame:
        """Render one frame.

        Args:
            scene: what is there.
            camera: what looks; its apertures should have the picture's aspect ratio.
            settings: how.
            on_progress: called with the share that is done, from 0 to 1.

        Raises:
            CameraError: the camera's numbers make no picture.
            GraphicsError: the device refuses.
        """
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        with self.on_device():
            return self._frame(view, scene, camera, settings, on_progress)

    def _frame(
        self,
        view: PinholeView,
        scene: Scene,
        camera: Camera,
        settings: FrameSettings,
        on_progress: Callable[[float], None] | None,
    ) -> Frame:
        lens = self.loaded(scene, camera, settings)
        color = self.engines.drawn(
            view, lens, settings, _WHOLE, unlit=settings.shading == "unlit", on_progress=on_progress
        )
        return self.frame_of(color, view, lens, scene, settings)

    def frame_of(
        self, color: FloatArray, view: PinholeView, lens: Camera, scene: Scene, settings: FrameSettings
    ) -> Frame:
        """A frame of the scene that is loaded: its colour, and what is measured beside it.

        Args:
            color: as the engine has it.
            view: the picture.
            lens: the camera as the engine has it.
            scene: what is loaded.
            settings: how it was rendered.
        """
        aovs = self.measured(view, lens, settings, lambda: self.engines.drawn(view, lens, settings, _WHOLE, unlit=True))
        return Frame(color, aovs, scene.prim_paths)

    def render_moving(
        self,
        count: int,
        moment_at: Callable[[int], Moment],
        settings: FrameSettings,
        on_progress: Callable[[float], None] | None = None,
        *,
        at_once: int | None = None,
    ) -> Frame:
        """Render one frame of what moves while the shutter is open: its rays are spread over the moments, each of which has its
        own scene, camera and focus. Motion blur and depth of field are one integral, and are taken as one (Cook, Porter &
        Carpenter 1984, "Distributed ray tracing").

        Args:
            count: of the moments, one or more.
            moment_at: the shot at each of them, in the order of time. What is measured beside the colour is that of the middle
                one.
            settings: how; each moment has at least one ray.
            on_progress: called with the share that is done, from 0 to 1.
            at_once: over how many moments that follow each other the rays are spread: those at which a place is exposed; None
                for all.

        Raises:
            CameraError: a camera's numbers make no picture.
            GraphicsError: the device refuses.
        """
        apart = at_once or count
        settings = replace(settings, rays=max(settings.rays, apart))
        total = np.zeros((settings.height, settings.width, 4), np.float32)
        frame = Frame(total)
        for i in range(count):
            moment = moment_at(i)
            view = PinholeView.from_camera(moment.camera, settings.width, settings.height)
            with self.on_device():
                lens = self.loaded(moment.scene, moment.camera, settings)
                total += moment.share * self.engines.drawn(
                    view, lens, settings, (i % apart, apart), unlit=settings.shading == "unlit"
                )
                if i == count // 2:
                    aovs = self.measured(
                        view, lens, settings, partial(self.engines.drawn, view, lens, settings, _WHOLE, unlit=True)
                    )
                    frame = Frame(total, aovs, moment.scene.prim_paths)
            if on_progress is not None:
                on_progress((i + 1) / count)
        return frame

    def render_swept(
        self,
        opening: ShutterScenes,
        middle: Camera,
        moments: Sequence[Moment],
        settings: FrameSettings,
        on_progress: Callable[[float], None] | None = None,
        *,
        at_once: int | None = None,
    ) -> Frame:
        """Render one frame of what moves while the shutter is open from one peeling: as `render_moving`, many times faster, where
        things move straight on and keep their shading (`render.trace.swept`).

        Args:
            opening: the scene while the shutter is open.
            middle: the camera in the middle of that time, of which all else is measured.
            moments: evenly over that time, in its order; their cameras and shares count, their scene does not.
            settings: how; each moment has at least one ray, and the engine is ``lens`` or ``pinhole``.
            on_progress: called with the share that is done, from 0 to 1.
            at_once: as in `render_moving`.

        Raises:
            CameraError: a camera's numbers make no picture.
            GraphicsError: the device refuses.
        """
        apart = at_once or len(moments)
        settings = replace(settings, rays=max(settings.rays, apart))
        size = settings.width, settings.height
        view = PinholeView.from_camera(middle, *size)
        moves = movements(opening.middle, opening.opening, opening.closing)
        total = np.zeros((settings.height, settings.width, 4), np.float32)
        with self.on_device():
            lens = self.loaded(opening.middle, middle, settings)
            pictures = self._lens.swept.pictures(
                self._peeler,
                view,
                self._looks(moments, settings, apart),
                moves,
                wavelengths=settings.wavelengths,
                layers=settings.layers,
                supersample=settings.supersample,
                unlit=settings.shading == "unlit",
                on_progress=on_progress,
            )
            with closing(pictures):
                for moment, picture in zip(moments, pictures, strict=True):
                    total += moment.share * picture
            aovs = self.measured(
                view, lens, settings, partial(self.engines.drawn, view, lens, settings, _WHOLE, unlit=True)
            )
        return Frame(total, aovs, opening.middle.prim_paths)

    def _looks(self, moments: Sequence[Moment], settings: FrameSettings, apart: int) -> list[ShutterSample]:
        """What is looked at in each moment: camera and picture as the engine has them, when, by which rays, in which lines."""
        looks, patterns = [], _Patterns(settings)
        for i, moment in enumerate(moments):
            camera = replace(moment.camera, f_stop=0.0) if settings.engine == "pinhole" else moment.camera
            view = PinholeView.from_camera(camera, settings.width, settings.height)
            exposed = np.broadcast_to(np.asarray(moment.share) > 0, (settings.height, settings.width, 1))
            lines = np.flatnonzero(exposed.any(axis=(1, 2)))
            span = (int(lines[0]), int(lines[-1]) + 1) if len(lines) else (0, 0)
            pattern = patterns.of(camera).part(i % apart, apart)
            looks.append(ShutterSample(camera, view, (i + 0.5) / len(moments) - 0.5, pattern, span))
        return looks

    def loaded(self, scene: Scene, camera: Camera, settings: FrameSettings, *, is_preview: bool = False) -> Camera:
        """Put the scene on the device; the camera as the engine has it.

        Args:
            scene: what is there.
            camera: what looks.
            settings: by which engine.
            is_preview: see `Peeler.load`.

        Raises:
            SettingsError: the engine cannot show the camera's lens.
        """
        if settings.engine == "accumulation":
            check_thin(camera)
        self._peeler.load(self._headlight.lit(scene, camera), shadow_interest(camera), is_preview=is_preview)
        return replace(camera, f_stop=0.0) if settings.engine == "pinhole" else camera

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
        with self.on_device():
            lit = self._headlight.lit(scene, camera)
            if not self._peeler.holds(lit):  # one that is there will do, wherever its shadows are: a pick sees none
                self._peeler.load(lit, shadow_interest(camera))
            return pick_surface(self._peeler, scene, view, *seen_at(view, camera, x, y))

    def forget_layers(self) -> None:
        """Have the next frame peel its layers anew, whatever was drawn last: for who measures it."""
        self._peeler.forget()

    def close(self) -> None:
        """Give the device's memory and the context back."""
        self.graphics.make_current()
        self.engines.release()
        self.graphics.close()

    def __enter__(self) -> FrameRenderer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @contextmanager
    def on_device(self) -> Iterator[None]:
        """Work on the device. What fails half way there leaves nothing behind: the context is made anew for the next frame."""
        self.graphics.make_current()
        try:
            yield
        except (SettingsError, InputError, Cancelled):
            raise  # said before anything was drawn, or left where work can be left
        except Exception as error:
            self.graphics.close()
            self._open()
            if isinstance(error, (OpenGLError, moderngl.Error, RuntimeError)):
                raise GraphicsError(f"{self.graphics.renderer} could not draw the frame: {error}") from error
            raise

    def measured(
        self, view: PinholeView, camera: Camera, settings: FrameSettings, albedo: Callable[[], FloatArray]
    ) -> dict[str, NDArray[Any]]:
        """The asked AOVs; ``albedo`` makes the picture of base colours."""
        made: dict[str, NDArray[Any]] = {}
        if set(settings.aovs) & set(MEASURED):
            made = self._lens.measured(self._peeler, camera, view)
        if "albedo" in settings.aovs:
            made["albedo"] = albedo()[..., :3]
        return {name: made[name] for name in settings.aovs if name != "color"}
