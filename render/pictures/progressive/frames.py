"""Frames of the progressive renderer: previews that fit a time, and frames drawn in steps."""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np

from render.engines import DrawRequest, engine_class
from render.frame import Frame, FrameRenderer, add_mattes
from render.layers.peeled import Layers
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.focus_map import FocusMap
from render.model.frame_settings import FrameSettings
from render.model.mattes import make_matte_sum
from render.model.scene import Scene
from render.optics.view import PinholeView
from render.pictures.progressive.clock import Clock
from render.pictures.progressive.planner import PreviewPlan, PreviewPlanner
from render.postblur.preview import Sketch
from render.trace.lens import Stage as TraceStage
from render.trace.rays import make_ray_pattern

MAP_SIDE_PX = 480
"""Longer side of the focus maps of previews: measuring and sending a larger one would take longer than the preview."""
_LEAST_RAY_SHARE = 0.1
"""Share of a preview's time, or of the time until its layers were there where that is longer, that its rays have at least."""
_PREVIEW_WAVELENGTHS = 3
"""Most wavelengths of a preview whose rays are given; the others have one."""


class LiveFrames:
    """Draws on a renderer, in its thread."""

    def __init__(self, renderer: FrameRenderer) -> None:
        self._renderer = renderer
        self._planner = PreviewPlanner(is_software=renderer.graphics.is_software)

    def draw_preview(
        self,
        scene: Scene,
        camera: Camera,
        settings: FrameSettings,
        clock: Clock,
        *,
        budget_ms: float,
        is_moving: bool = False,
        is_hurried: bool = False,
        rays: int | None = None,
    ) -> tuple[FloatArray, int]:
        """Draw a small picture, as good as the time that is left allows.

        Args:
            scene: the scene.
            camera: the camera.
            settings: of the final picture.
            clock: runs since the request; takes note of ``peel`` and ``blur``.
            budget_ms: time by that clock at which the picture should be drawn.
            is_moving: as in `PreviewRequest`.
            is_hurried: as in `PreviewRequest`.
            rays: rays per pixel, in place of as many as fit.

        Returns:
            ``(height, width, 4)`` float32 radiance, premultiplied, and the rays per pixel, 0 where none were traced.

        Raises:
            CameraError: the camera's values cannot make a picture.
            GraphicsError: OpenGL reports an error.
        """
        renderer = self._renderer
        # From the camera each time, so that pictures of several sizes share the layers of their previews.
        view = largest = PinholeView.from_camera(camera, *self._planner.largest_size(settings.width, settings.height))
        with renderer.on_device():
            drawn = renderer.drawn_camera(camera, settings)
            is_blurred = engine_class(settings).preview == "blur" and drawn.f_stop > 0
            sketch: Sketch = "never" if rays is not None else "new"
            if is_blurred and not self._planner.can_blur(*largest.size, budget_ms):
                sketch = "always"
            unlit = settings.shading == "unlit"
            previewer, peeler = renderer.device.previewer, renderer.device.peeler
            peeler.sketches.maker.pause(is_paused=is_hurried)  # pictures of others come first
            is_brief = is_hurried or (is_moving and renderer.graphics.is_software)
            kept = previewer.find_sketch(scene, camera, largest, unlit=unlit) if is_brief else None
            is_again = kept is not None and not is_hurried and renderer.has_scene(scene, camera)
            if is_again and sketch != "always":
                # The same view once more, so that something else changes: it is worth whole layers.
                kept, is_brief, sketch = None, False, "never"
            if kept is None:
                renderer.load(scene, camera, settings, is_preview=True)
                if is_brief:
                    kept = previewer.peel_sketch(peeler, scene, drawn, largest, unlit=unlit)
                else:
                    kept = previewer.peel(peeler, drawn, largest, unlit=unlit, sketch=sketch)
            peeled, largest = kept
            renderer.graphics.ctx.finish()
            clock.note("peel")
            if is_blurred:
                picture = previewer.blur(peeler, peeled, drawn, largest)
                self._planner.learn_blur(*largest.size, clock.note("blur"))
                return picture, 0
            spent_ms = clock.total_ms
            least_ms = _LEAST_RAY_SHARE * max(budget_ms, spent_ms)
            plan = self._plan(largest, settings, budget_ms - spent_ms, least_ms, rays)
            wavelengths = 1 if rays is None else min(settings.wavelengths, _PREVIEW_WAVELENGTHS)
            fixed_ms = 0.0

            def note_fixed(stage: TraceStage) -> None:
                nonlocal fixed_ms
                if stage == "highlights":
                    fixed_ms = clock.note("blur")

            picture = self._trace(
                peeled, drawn, view.resize(plan.width, plan.height), settings, plan, wavelengths, note_fixed
            )
        took_ms = clock.note("blur")
        if rays is None:
            self._planner.learn(plan, took_ms, fixed_ms)
        return picture, plan.rays

    def _plan(
        self, largest: PinholeView, settings: FrameSettings, left_ms: float, least_ms: float, rays: int | None
    ) -> PreviewPlan:
        if rays is None:
            return self._planner.plan(largest.width, largest.height, left_ms, least_ms, settings.rays)
        return PreviewPlan(largest.width, largest.height, min(rays, settings.rays))

    def _trace(
        self,
        peeled: Layers,
        camera: Camera,
        view: PinholeView,
        settings: FrameSettings,
        plan: PreviewPlan,
        wavelengths: int,
        on_stage: Callable[[TraceStage], None],
    ) -> FloatArray:
        device = self._renderer.device
        pattern = make_ray_pattern(plan.rays, camera.iris, seed=settings.seed, tiled=settings.tiled)
        return device.previewer.trace(device.peeler, peeled, camera, view, pattern, wavelengths, on_stage)

    def map_focus(self, scene: Scene, camera: Camera, settings: FrameSettings, *, is_preview: bool = False) -> FocusMap:
        """Measure how sharp each pixel of a picture is: as `FrameRenderer.map_focus`, for a preview in at most `MAP_SIDE_PX`."""
        scale = min(1.0, MAP_SIDE_PX / max(settings.width, settings.height))
        size = max(1, round(scale * settings.width)), max(1, round(scale * settings.height))
        return self._renderer.map_focus(
            scene, camera, settings, size=size if is_preview else None, is_preview=is_preview
        )

    def draw_in_steps(self, scene: Scene, camera: Camera, settings: FrameSettings) -> Generator[float, None, Frame]:
        """Draw a frame piece by piece, by an engine that draws in steps: equal to `FrameRenderer.render`'s to the bit.

        Args:
            scene: the scene.
            camera: the camera.
            settings: engine, size and sampling.

        Yields:
            Share that is done; `partial_picture` can be read between steps.

        Raises:
            CameraError: the camera's values cannot make a picture.
            GraphicsError: OpenGL reports an error.
        """
        renderer = self._renderer
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        with renderer.on_device():
            mattes = make_matte_sum(settings.width, settings.height, settings.aovs, deep=settings.deep)
            request = DrawRequest(view, renderer.load(scene, camera, settings), settings, mattes=mattes)
            color = yield from renderer.engine(settings).draw_in_steps(request)
            frame = renderer.measure(color, scene, request)
        if mattes is not None:
            mattes.end_moment(1.0)
        return add_mattes(frame, mattes, settings)

    def keeps_layers(self, scene: Scene, camera: Camera, settings: FrameSettings) -> bool:
        """Tell whether `draw_in_steps` would draw no layers, since they are kept. Arguments as there."""
        renderer = self._renderer
        if not renderer.has_loaded(scene, camera):
            return False
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        with renderer.on_device():
            mattes = make_matte_sum(settings.width, settings.height, settings.aovs, deep=settings.deep)
            request = DrawRequest(view, renderer.load(scene, camera, settings), settings, mattes=mattes)
            return renderer.engine(settings).keeps_layers(request)

    def partial_picture(self, settings: FrameSettings, under: FloatArray) -> FloatArray:
        """Read the picture that `draw_in_steps` is drawing, over another one where it has no rays yet.

        Args:
            settings: of the picture that is being drawn.
            under: ``(h, w, 4)`` of any size.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        with self._renderer.on_device():
            picture, shares = self._renderer.engine(settings).partial_picture()
        return np.where(shares > 0, picture, enlarge(under, picture.shape[1], picture.shape[0]))


def enlarge(picture: FloatArray, width: int, height: int) -> FloatArray:
    """Enlarge a picture, linearly between the centres of its pixels."""
    rows, columns = picture.shape[:2]
    for axis, (old, new) in enumerate(((rows, height), (columns, width))):
        places = np.clip((np.arange(new) + 0.5) * old / new - 0.5, 0, old - 1)
        low = np.minimum(places.astype(int), max(old - 2, 0))
        share = (places - low).astype(np.float32).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
        high = np.minimum(low + 1, old - 1)
        picture = (1 - share) * picture.take(low, axis) + share * picture.take(high, axis)
    return picture
