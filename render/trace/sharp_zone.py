"""Zone of a picture that is nearly in focus, for the sharp layer (`render.layers.sharp_layer`)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.layers.limits import BLOCK_PX
from render.layers.sharp_layer import FINER, SLACK, FocusZone, SharpZone
from render.layers.surface_sampling import layer_sampling
from render.model.arrays import FloatArray
from render.optics.view import PinholeView
from render.trace.layer_view import bound_sharp_rays
from render.trace.picture_focus import PictureFocus
from render.trace.rays import RayBundle

SHARP_COC_PX = 1.5
"""Circle of confusion, radius in picture pixels, up to which the layers' resolution shows along edges."""
_ALIGNED_PX = BLOCK_PX // FINER
"""Alignment of the zone in texels of the layers: its N-buffers' blocks are the same in each window of a picture in tiles."""
_GRID = 65  # points along each side, at which w in focus is taken
MOST_SCALE = 4
"""Limit on the sharp layer's texels per picture pixel along each axis."""


def make_focus_zone(
    layers: PinholeView, view: PinholeView, bundle: RayBundle, focus: PictureFocus, nearest_w: float
) -> FocusZone | None:
    """Make the zone of what is nearly in focus; None where a picture has one ray per pixel, or layers that are fine already.

    Args:
        layers: view of the layers.
        view: view of the picture.
        bundle: the lens.
        focus: focal surface.
        nearest_w: inverse depth of the nearest surface in view, 1/m.
    """
    scale = layers.fx / view.fx
    if FINER * scale > MOST_SCALE * 1.01 or nearest_w <= 0 or bundle.pattern.whole == 1:
        return None
    _, pupil = focus.over_picture()
    pupil_px = max(view.fx, view.fy) * bundle.reach_m * float(pupil.max())
    half_width = min(SHARP_COC_PX / pupil_px, 10 * nearest_w) if pupil_px > 0 else 10 * nearest_w
    return FocusZone(layers, _focus_grid(layers, view, focus), half_width, half_width * pupil_px * scale)


def make_sharp_zone(
    zone: FocusZone, view: PinholeView, bundle: RayBundle, focus: PictureFocus, nearest_w: float
) -> SharpZone | None:
    """Contents of a picture's sharp layer; None where nothing is nearly in focus.

    Args:
        zone: what is.
        view: view of the picture.
        bundle: the lens.
        focus: focal surface.
        nearest_w: inverse depth of the nearest surface in view, 1/m.
    """
    layers, half_width, plane = zone.whole, zone.half_width, focus.affine
    w_f, _ = focus.over_picture()
    nearest = min(1.01 * nearest_w, (1 + SLACK) * (float(w_f.max()) + half_width))
    farthest = (1 - SLACK) * (float(w_f.min()) - half_width)
    if nearest <= max(farthest, 0.0):
        return None
    extent = bound_sharp_rays(view, bundle, focus, min(half_width, 2 * nearest))
    low = np.floor([layers.cx + extent.left * layers.fx, layers.cy + extent.top * layers.fy]).astype(int) - 2
    high = np.ceil([layers.cx + extent.right * layers.fx, layers.cy + extent.bottom * layers.fy]).astype(int) + 2
    low, high = np.maximum(low, 0) // _ALIGNED_PX * _ALIGNED_PX, np.minimum(high, layers.size)
    size = high - low
    sharp = replace(
        layers,
        width=FINER * int(size[0]),
        height=FINER * int(size[1]),
        fx=FINER * layers.fx,
        fy=FINER * layers.fy,
        cx=FINER * (layers.cx - int(low[0])),
        cy=FINER * (layers.cy - int(low[1])),
        near_m=max(layers.near_m, 1 / nearest),
        far_m=layers.far_m if farthest <= 0 else min(layers.far_m, 1 / farthest),
    )
    rays = bundle.pattern.whole if plane else 1
    sampling = layer_sampling(sharp, view, plane or (0.0, 0.0, 0.0), bundle.reach_m, rays)
    first = int(low[0]), int(low[1])
    return SharpZone(sharp, first, first, zone, sampling)


def _focus_grid(layers: PinholeView, view: PinholeView, focus: PictureFocus) -> FloatArray:
    """w in focus ``(_GRID, _GRID)`` over the layers, corners included, 1/m."""
    x, y = (np.linspace(0, side, _GRID) for side in layers.size)
    places = np.stack(np.meshgrid(x, y), axis=-1) - [layers.cx, layers.cy]
    w, _ = focus.at(places * [view.fx / layers.fx, view.fy / layers.fy] + [view.cx, view.cy])
    return np.ascontiguousarray(w, np.float32)
