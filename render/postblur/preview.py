"""Small pictures for who waits for them: from layers that are peeled once for a view, whatever the focus and the stop become.

The quickest true picture that there is comes from the lens tracer with few rays: layers and N-buffers are there already, so that
a change of focus or stop costs its rays alone. Engines that blur one picture are previewed by the quickest of them, FLAG.
"""

from __future__ import annotations

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
from render.postblur.engine import PostBlurEngine
from render.trace.lens import LensEngine
from render.trace.picture_focus import picture_focus
from render.trace.rays import RayPattern

LAYERS = 2
"""What is seen, and what it hides from the middle of the pupil alone."""
WIDE_OPEN = 1.4
"""The f-number for which they are peeled: with a smaller one, a little of what is hidden is taken for what hides it."""
SKETCH_SHARE = 2 / 3
"""Of the largest preview, along a side: what is peeled of a view that was not there before, and may change at once again."""
Sketch = Literal["never", "new", "always"]
_MARGIN = 1 / 16  # of the longer side


class PreviewEngine:
    """Draws small pictures, with the programs of one context."""

    def __init__(self, graphics: GraphicsContext, programs: ProgramCache, post_blur: PostBlurEngine) -> None:
        self._lens = LensEngine(graphics.ctx, programs, graphics.cancellation)
        self._post_blur = post_blur

    def peeled(
        self, peeler: Peeler, camera: Camera, view: PinholeView, *, unlit: bool, sketch: Sketch
    ) -> tuple[Layers, PinholeView]:
        """The layers of the loaded scene; nothing is drawn where they are there.

        Args:
            peeler: with the scene loaded.
            camera: whose focus and stop do not matter.
            view: the largest preview.
            unlit: take base colour for radiance.
            sketch: whether smaller layers will do: of what is ``new``; what is asked for again, and has other changes than
                those that need new layers, is worth the whole size.

        Returns:
            The layers, and what they are of: the view, or the same in fewer pixels.
        """
        width, height = (max(1, round(SKETCH_SHARE * side)) for side in (view.width, view.height))
        small, wide = _widened(view.resized(width, height)), _widened(view)
        is_new = not peeler.keeps(wide, unlit=unlit, cache_slot=PREVIEW) and not peeler.keeps(
            small, unlit=unlit, cache_slot=SKETCH
        )
        if sketch == "always" or (sketch == "new" and is_new):
            return self._peeled(peeler, camera, small, unlit, SKETCH), view.resized(width, height)
        return self._peeled(peeler, camera, wide, unlit, PREVIEW), view

    def _peeled(self, peeler: Peeler, camera: Camera, wide: PinholeView, unlit: bool, place: str) -> Layers:
        pupil_m = camera.focal_length_mm / 2000 / WIDE_OPEN if camera.f_stop > 0 else 0.0
        umbra = umbra_reach(max(wide.fx, wide.fy) * pupil_m)
        return peeler.peel(wide, layers=LAYERS if pupil_m > 0 else 1, umbra=umbra, unlit=unlit, cache_slot=place)

    def traced(
        self, peeler: Peeler, peeled: Layers, camera: Camera, view: PinholeView, pattern: RayPattern, wavelengths: int
    ) -> FloatArray:
        """The picture through the camera's lens, by few rays.

        Args:
            peeler: that peeled.
            peeled: of this view.
            camera: its lens, focus and stop count.
            view: the picture.
            pattern: where its rays start.
            wavelengths: how many to trace, for a lens with colour errors.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        return self._lens.through(
            peeled, camera, view, pattern, wavelengths=wavelengths, nearest_w=peeler.nearest_w(peeled.view)
        )

    def blurred(self, peeler: Peeler, peeled: Layers, camera: Camera, view: PinholeView) -> FloatArray:
        """The picture by FLAG.

        Args:
            peeler: that peeled.
            peeled: of this view.
            camera: its focus and stop count.
            view: the picture.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        wide = peeled.view
        focus = picture_focus(camera, wide)
        pupil_px = max(wide.fx, wide.fy) * pupil_radius_m(camera)
        w_f, pupil = focus.over_picture()
        nearest_w = peeler.nearest_w(wide)
        most_px = float((pupil_px * pupil * np.maximum(w_f, np.abs(nearest_w - w_f))).max())
        picture = self._post_blur.of_layers(peeled, camera, focus, pupil_px, most_px, "flag")
        left, top = round(wide.cx - view.cx), round(wide.cy - view.cy)
        return np.ascontiguousarray(picture[top : top + view.height, left : left + view.width])

    def release(self) -> None:
        """Give the memory back."""
        self._lens.release()


def _widened(view: PinholeView) -> PinholeView:
    return view.widened(int(np.ceil(_MARGIN * max(view.width, view.height))))
