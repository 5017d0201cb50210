"""Previews: small pictures from layers that are peeled once for a view and serve every focus and stop.

The lens tracer makes them with few rays. Layers and N-buffers are kept, so that a change of focus or stop costs its rays alone.
Engines that blur a single image are previewed by FLAG.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.layers.peel import PREVIEW, SKETCH, Layers, Peeler
from render.layers.umbra import umbra_reach
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.optics.thin_lens import pupil_radius_m
from render.optics.view import PinholeView
from render.postblur.flag_blur import FlagBlur
from render.postblur.single_image import SingleImageBlur, largest_radius_px
from render.trace.lens import LensTracer, Stage
from render.trace.picture_focus import picture_focus
from render.trace.rays import RayPattern

LAYERS = 2
"""Number of peeled layers: the surfaces that the pupil's centre sees, and those behind them."""
WIDE_OPEN = 1.4
"""F-number that the layers are peeled for. At a smaller one, some hidden surfaces are missing."""
SKETCH_SHARE = 2 / 3
"""Scale of the coarse peel used for a view seen for the first time, which may change at once again."""
Sketch = Literal["never", "new", "always"]
_MARGIN = 1 / 16  # of the longer side


class Previewer:
    """Draws previews, with the programs of one context."""

    def __init__(self, graphics: GraphicsContext, programs: ProgramCache, blur: SingleImageBlur) -> None:
        self._tracer = LensTracer(graphics.ctx, programs, graphics.cancellation)
        self._blur, self._flag = blur, FlagBlur(graphics.ctx, programs, graphics.cancellation)
        self._nearest: tuple[Layers, float] | None = None

    def peel(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        *,
        unlit: bool,
        sketch: Sketch,
        sketch_layers: int = LAYERS,
    ) -> tuple[Layers, PinholeView]:
        """Peel the loaded scene, or take the layers that are kept of it.

        Args:
            peeler: with the scene loaded.
            camera: its focus and stop do not matter.
            view: the largest preview.
            unlit: take base colour for radiance.
            sketch: when to peel coarsely: ``new`` does so for a view seen for the first time. A view that is kept has
                changed in something that needs no new layers, and is worth the whole size.
            sketch_layers: layers of a coarse peel.

        Returns:
            The layers, and the view they show: the argument, or the same in fewer pixels.
        """
        width, height = (max(1, round(SKETCH_SHARE * side)) for side in (view.width, view.height))
        small, wide = _widen(view.resize(width, height)), _widen(view)
        is_new = not peeler.has_layers(wide, unlit=unlit, cache_slot=PREVIEW) and not peeler.has_layers(
            small, unlit=unlit, cache_slot=SKETCH
        )
        if sketch == "always" or (sketch == "new" and is_new):
            return self._peel(peeler, camera, small, sketch_layers, unlit, SKETCH), view.resize(width, height)
        return self._peel(peeler, camera, wide, LAYERS, unlit, PREVIEW), view

    def _peel(
        self, peeler: Peeler, camera: Camera, wide: PinholeView, layers: int, unlit: bool, cache_slot: str
    ) -> Layers:
        pupil_m = camera.focal_length_mm / 2000 / WIDE_OPEN if camera.f_stop > 0 else 0.0
        umbra = umbra_reach(max(wide.fx, wide.fy) * pupil_m)
        layers = layers if pupil_m > 0 else 1
        is_sketch = cache_slot == SKETCH
        return peeler.peel(wide, layers=layers, umbra=umbra, unlit=unlit, is_sketch=is_sketch, cache_slot=cache_slot)

    def trace(
        self,
        peeler: Peeler,
        peeled: Layers,
        camera: Camera,
        view: PinholeView,
        pattern: RayPattern,
        wavelengths: int,
        on_stage: Callable[[Stage], None] = lambda stage: None,
    ) -> FloatArray:
        """Trace the camera's lens through kept layers, by few rays.

        Args:
            peeler: of the layers.
            peeled: layers of this view.
            camera: its lens, focus and stop count.
            view: the picture.
            pattern: where its rays start.
            wavelengths: how many to trace, for a lens with colour errors.
            on_stage: as for `LensTracer.trace_steps`.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        return self._tracer.trace_layers(
            peeled,
            camera,
            view,
            pattern,
            wavelengths=wavelengths,
            nearest_w=self._nearest_w(peeler, peeled),
            on_stage=on_stage,
        )

    def blur(self, peeler: Peeler, peeled: Layers, camera: Camera, view: PinholeView) -> FloatArray:
        """Blur kept layers by FLAG.

        Args:
            peeler: of the layers.
            peeled: layers of this view.
            camera: its focus and stop count.
            view: the picture.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        wide = peeled.view
        focus = picture_focus(camera, wide)
        pupil_px = max(wide.fx, wide.fy) * pupil_radius_m(camera)
        most_px = largest_radius_px(focus, pupil_px, self._nearest_w(peeler, peeled))
        picture = self._blur.blur_layers(peeled, camera, focus, pupil_px, most_px, self._flag)
        left, top = round(wide.cx - view.cx), round(wide.cy - view.cy)
        return np.ascontiguousarray(picture[top : top + view.height, left : left + view.width])

    def _nearest_w(self, peeler: Peeler, peeled: Layers) -> float:
        """Greatest inverse depth in kept layers, 1/m; that of the last layers is kept."""
        if peeled.nearest_w is not None:
            return peeled.nearest_w
        if self._nearest is None or self._nearest[0] is not peeled:
            self._nearest = peeled, peeler.nearest_w(peeled.view)
        return self._nearest[1]

    def release(self) -> None:
        """Give the memory back."""
        self._nearest = None
        self._flag.release()
        self._tracer.release()


def _widen(view: PinholeView) -> PinholeView:
    return view.widen(int(np.ceil(_MARGIN * max(view.width, view.height))))
