"""The engines that a frame is drawn by, on one context: each makes a picture of the scene that the peeler has loaded."""

from __future__ import annotations

from collections.abc import Callable

from render.engines.accumulator import Accumulator, accumulated_rays, accumulated_sampling
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.layers.peel import Peeler
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.optics.thin_lens import focal_surface
from render.optics.view import PinholeView
from render.postblur.engine import PostBlurEngine
from render.postblur.preview import PreviewEngine
from render.trace.lens import LensEngine
from render.trace.rays import ray_pattern

Part = tuple[int, int]
"""Some of a picture's rays: the number of the part, and how many parts there are."""
Progress = Callable[[float], None]


class Engines:
    """The engines of one context."""

    def __init__(self, graphics: GraphicsContext) -> None:
        programs = ProgramCache(graphics.ctx)
        self.peeler = Peeler(graphics, programs)
        self.lens = LensEngine(graphics.ctx, programs, graphics.cancellation)
        self._accumulator = Accumulator(graphics.ctx, programs)
        self.post_blur = PostBlurEngine(graphics.ctx, programs, graphics.cancellation)
        self.preview = PreviewEngine(graphics, programs, self.post_blur)

    def drawn(
        self,
        view: PinholeView,
        camera: Camera,
        settings: FrameSettings,
        part: Part,
        *,
        unlit: bool = False,
        on_progress: Progress | None = None,
    ) -> FloatArray:
        """The loaded scene's picture by some part of its rays.

        Args:
            view: the picture.
            camera: what looks.
            settings: by which engine, and how.
            part: of the rays; an engine without rays draws the whole picture each time.
            unlit: take base colour for radiance.
            on_progress: called with the share that is done, from 0 to 1.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        if settings.engine == "accumulation":
            return self._accumulated(view, camera, settings, part, unlit, on_progress)
        if settings.engine in self.post_blur.engines and camera.f_stop > 0:
            return self._post_blurred(view, camera, settings, unlit, on_progress)
        pattern = ray_pattern(settings.rays, camera.iris, seed=settings.seed, tiled=settings.tiled).part(*part)
        return self.lens.picture(
            self.peeler,
            camera,
            view,
            pattern,
            wavelengths=settings.wavelengths,
            layers=settings.layers,
            supersample=settings.supersample,
            unlit=unlit,
            on_progress=on_progress,
        ).color

    def release(self) -> None:
        """Give the device's memory back."""
        self.lens.release()
        self.post_blur.release()
        self.preview.release()
        self.peeler.release()

    def _accumulated(
        self,
        view: PinholeView,
        camera: Camera,
        settings: FrameSettings,
        part: Part,
        unlit: bool,
        on_progress: Progress | None,
    ) -> FloatArray:
        points = accumulated_rays(camera, settings.rays, settings.seed)[part[0] :: part[1]]
        return self._accumulator.accumulate(
            self.peeler,
            view,
            points,
            focal_surface(camera).plane,
            unlit=unlit,
            sampling=accumulated_sampling(camera, view, settings.rays, settings.supersample),
            on_progress=on_progress,
        )

    def _post_blurred(
        self, view: PinholeView, camera: Camera, settings: FrameSettings, unlit: bool, on_progress: Progress | None
    ) -> FloatArray:
        picture = self.post_blur.picture(
            self.peeler,
            camera,
            view,
            settings.engine,
            layers=settings.layers,
            supersample=settings.supersample,
            unlit=unlit,
        )
        if on_progress is not None:
            on_progress(1.0)
        return picture
