"""Frames of a renderer as the progressive driver needs them: small and at once, or piece by piece."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace

import numpy as np

from render.engines import DrawRequest, engine_of
from render.frame import Frame, FrameRenderer
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.scene import Scene
from render.optics.view import PinholeView
from render.pictures.progressive.clock import Clock
from render.pictures.progressive.pace import Pace, Plan
from render.postblur.preview import Sketch
from render.trace.rays import ray_pattern

_LEAST_SHARE = 0.4
"""Of the time for a preview, that its rays have even where peeling took all of it."""


class LiveFrames:
    """Draws on a renderer, in its thread."""

    def __init__(self, renderer: FrameRenderer) -> None:
        self._renderer = renderer
        self.pace = Pace(is_software=renderer.graphics.is_software)

    def preview(
        self,
        scene: Scene,
        camera: Camera,
        settings: FrameSettings,
        clock: Clock,
        *,
        budget_ms: float,
        rays: int | None = None,
    ) -> tuple[FloatArray, int]:
        """A small picture, as good as the time that is left allows.

        Args:
            scene: what is there.
            camera: what looks.
            settings: of the picture that it goes before.
            clock: that runs since it was asked for; takes note of ``peel`` and ``blur``.
            budget_ms: when the picture should be drawn, by that clock.
            rays: for each pixel, in place of as many as fit.

        Returns:
            ``(height, width, 4)`` float32 radiance, premultiplied, and the rays of each pixel, 0 where none were traced.

        Raises:
            CameraError: the camera's numbers make no picture.
            GraphicsError: the device refuses.
        """
        renderer, device = self._renderer, self._renderer.device
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        largest = view.resized(*self.pace.largest(view.width, view.height))
        with renderer.on_device():
            looks = renderer.load(scene, camera, settings, is_preview=True)
            is_blurred = engine_of(settings).preview == "blur" and looks.f_stop > 0
            sketch: Sketch = "never" if rays is not None else "new"
            if is_blurred and not self.pace.can_blur(*largest.size, budget_ms):
                sketch = "always"
            unlit = settings.shading == "unlit"
            peeled, largest = device.previewer.peel(device.peeler, looks, largest, unlit=unlit, sketch=sketch)
            renderer.graphics.ctx.finish()
            clock.note("peel")
            if is_blurred:
                picture = device.previewer.blur(device.peeler, peeled, looks, largest)
                self.pace.learn_blur(*largest.size, clock.note("blur"))
                return picture, 0
            left_ms = max(_LEAST_SHARE * budget_ms, budget_ms - clock.total_ms)
            plan = self.pace.plan(largest.width, largest.height, left_ms)
            if rays is not None:
                plan = Plan(largest.width, largest.height, rays)
            plan = replace(plan, rays=min(plan.rays, settings.rays))
            pattern = ray_pattern(plan.rays, looks.iris, seed=settings.seed, tiled=settings.tiled)
            wavelengths = 1 if rays is None else min(settings.wavelengths, 3)
            small = view.resized(plan.width, plan.height)
            picture = device.previewer.trace(device.peeler, peeled, looks, small, pattern, wavelengths)
        self.pace.learn(plan, clock.note("blur"))
        return picture, plan.rays

    def traced(self, scene: Scene, camera: Camera, settings: FrameSettings) -> Generator[float, None, Frame]:
        """A frame by the lens engine, piece by piece: as `FrameRenderer.render` has it to the bit.

        Args:
            scene: what is there.
            camera: what looks.
            settings: how.

        Yields:
            The share of its tracing that is done; `so_far` has the picture then.

        Raises:
            CameraError: the camera's numbers make no picture.
            GraphicsError: the device refuses.
        """
        renderer = self._renderer
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        with renderer.on_device():
            looks = renderer.load(scene, camera, settings)
            request = DrawRequest(view, looks, settings)
            color = yield from renderer.engine(settings).draw_in_steps(request)
            return renderer.measure(color, scene, request)

    def so_far(self, settings: FrameSettings, under: FloatArray) -> FloatArray:
        """The picture that is being traced, where there are rays of it, over one that is there everywhere.

        Args:
            settings: of the picture that is being drawn.
            under: ``(h, w, 4)`` of any size.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        with self._renderer.on_device():
            picture, shares = self._renderer.engine(settings).unfinished()
        return np.where(shares > 0, picture, enlarged(under, picture.shape[1], picture.shape[0]))


def enlarged(picture: FloatArray, width: int, height: int) -> FloatArray:
    """A picture in more pixels, with straight lines between its own."""
    rows, columns = picture.shape[:2]
    for axis, (old, new) in enumerate(((rows, height), (columns, width))):
        places = np.clip((np.arange(new) + 0.5) * old / new - 0.5, 0, old - 1)
        low = np.minimum(places.astype(int), max(old - 2, 0))
        share = (places - low).astype(np.float32).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
        high = np.minimum(low + 1, old - 1)
        picture = (1 - share) * picture.take(low, axis) + share * picture.take(high, axis)
    return picture
