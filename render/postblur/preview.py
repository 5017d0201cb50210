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
from render.layers.peel import PREVIEW, SKETCH, Peeler
from render.layers.peeled import Layers
from render.layers.umbra import umbra_reach
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Scene
from render.optics.thin_lens import pupil_radius_m
from render.optics.view import PinholeView
from render.postblur.flag_blur import FlagBlur
from render.postblur.single_image import SingleImageBlur, largest_radius_px
from render.postblur.sketches import Sketches, SketchKey
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
        self._sketches = Sketches()

    def peel(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        *,
        unlit: bool,
        sketch: Sketch,
    ) -> tuple[Layers, PinholeView]:
        """Peel the loaded scene, or take the layers that are kept of it.

        Args:
            peeler: with the scene loaded.
            camera: its focus does not matter; of its stop, whether it is closed (0).
            view: the largest preview.
            unlit: take base colour for radiance.
            sketch: when to peel coarsely: ``new`` does so for a view seen for the first time. A view that is kept has
                changed in something that needs no new layers, and is worth the whole size.

        Returns:
            The layers, and the view they show: the argument, or the same in fewer pixels.
        """
        sketched = _sketched(view)
        small, wide = _widen(sketched), _widen(view)
        is_new = not peeler.has_layers(wide, unlit=unlit, cache_slot=PREVIEW) and not peeler.has_layers(
            small, unlit=unlit, cache_slot=SKETCH
        )
        if sketch == "always" or (sketch == "new" and is_new):
            return self._peel(peeler, camera, small, LAYERS, unlit, SKETCH), sketched
        return self._peel(peeler, camera, wide, LAYERS, unlit, PREVIEW), view

    def find_sketch(
        self, scene: Scene, camera: Camera, view: PinholeView, *, unlit: bool
    ) -> tuple[Layers, PinholeView] | None:
        """Return the layers of a hurried sketch that is kept, whether or not its scene is loaded, and the view they show.

        Args:
            scene: what they show.
            camera: its focus and stop do not matter.
            view: the largest preview.
            unlit: base colour was taken for radiance.
        """
        if scene.version is None:
            return None
        sketched = _sketched(view)
        kept = self._sketches.find(_sketch_key(scene, camera, sketched, unlit), _widen(sketched))
        return None if kept is None else (kept, sketched)

    def peel_sketch(
        self, peeler: Peeler, scene: Scene, camera: Camera, view: PinholeView, *, unlit: bool
    ) -> tuple[Layers, PinholeView]:
        """Peel a hurried sketch of the loaded scene, of one layer, and keep it for `find_sketch`; unless layers of it are kept.

        Args:
            peeler: with the scene loaded.
            scene: the scene.
            camera: its focus does not matter; of its stop, whether it is closed (0).
            view: the largest preview.
            unlit: take base colour for radiance.

        Returns:
            The layers, and the view they show.
        """
        if peeler.has_layers(_widen(view), unlit=unlit, cache_slot=PREVIEW):
            return self.peel(peeler, camera, view, unlit=unlit, sketch="never")
        sketched = _sketched(view)
        self._peel(peeler, camera, _widen(sketched), 1, unlit, SKETCH)
        layers = peeler.hand_over(SKETCH)
        self._sketches.keep(_sketch_key(scene, camera, sketched, unlit), layers)
        return layers, sketched

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
        picture = self._blur.blur_layers(peeled, camera, view, focus, pupil_px, most_px, self._flag)
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
        self._sketches.release()
        self._flag.release()
        self._tracer.release()


def _sketched(view: PinholeView) -> PinholeView:
    """Return a view in the fewer pixels of a sketch."""
    return view.resize(*(max(1, round(SKETCH_SHARE * side)) for side in (view.width, view.height)))


def _sketch_key(scene: Scene, camera: Camera, sketched: PinholeView, unlit: bool) -> SketchKey:
    return SketchKey(scene.version, camera.path, sketched.size, unlit)


def _widen(view: PinholeView) -> PinholeView:
    return view.widen(int(np.ceil(_MARGIN * max(view.width, view.height))))
