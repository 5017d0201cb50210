"""AOVs seen through the lens: each pixel's depth and ids along the chief ray, the one through the middle of the pupil."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from render.layers.peel import Peeler
from render.layers.readback import read_surfaces
from render.layers.targets import MAX_LAYER_PIXELS
from render.model.arrays import DoubleArray, IntArray
from render.model.limits import MAX_PICTURE_SIDE_PX
from render.optics.distortion import ChiefRays
from render.optics.view import PinholeView
from render.trace.layer_view import MAX_SLOPE
from render.trace.picture_focus import PictureFocus
from render.trace.rays import RayBundle
from render.trace.sharpness import measure_sharpness

MEASURED = ("depth", "coc", "defocus", "focus_depth", "prim_id", "face_id")
MAX_AREA_RATIO = 8.0
"""Surfaces are drawn with at most this many times the picture's pixels: a lens that sees further is measured less finely."""


def measure_aovs(
    peeler: Peeler, view: PinholeView, bundle: RayBundle, focus: PictureFocus, chief: ChiefRays | None
) -> dict[str, NDArray[Any]]:
    """All of `MEASURED`, each ``(height, width)``.

    Args:
        peeler: with the scene loaded.
        view: the picture.
        bundle: the lens.
        focus: focal surface.
        chief: the lens's chief rays; None where they are straight.
    """
    w, prim_id, face_id = _nearest(peeler, view, chief)
    sharp = measure_sharpness(bundle, focus, view)
    with np.errstate(divide="ignore"):
        depth, focus_depth = (1.0 / np.maximum(values, 0.0) for values in (w.astype(np.float64), sharp.w))
    return {
        "depth": depth.astype(np.float32),
        "coc": (view.fx * sharp.pupil_m * (sharp.w - w)).astype(np.float32),
        "defocus": (w - sharp.w).astype(np.float32),
        "focus_depth": focus_depth.astype(np.float32),
        "prim_id": prim_id,
        "face_id": face_id,
    }


def _nearest(
    peeler: Peeler, view: PinholeView, chief: ChiefRays | None
) -> tuple[NDArray[np.float32], NDArray[np.uint32], IntArray]:
    """Trace each pixel's chief ray to the first surface."""
    if chief is None:
        return read_surfaces(peeler, view)
    x, y = np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.height) + 0.5)
    slopes = np.stack([(x - view.cx) / view.fx, (y - view.cy) / view.fy], axis=-1)
    seen = chief.undistort_slopes(slopes)
    seen *= MAX_SLOPE / np.maximum(np.hypot(*np.moveaxis(seen, -1, 0)), MAX_SLOPE)[..., None]  # the lens is dark beyond
    scale = _scale(seen, view)
    seen *= np.array([view.fx, view.fy]) * scale
    left, top = np.floor(seen.reshape(-1, 2).min(axis=0)).astype(int)
    right, bottom = np.ceil(seen.reshape(-1, 2).max(axis=0)).astype(int)
    # one more pixel of margin on the far sides, for a chief ray that falls on the very edge
    wide = replace(
        view,
        width=int(right - left) + 1,
        height=int(bottom - top) + 1,
        fx=view.fx * scale,
        fy=view.fy * scale,
        cx=float(-left),
        cy=float(-top),
    )
    column = (seen[..., 0] - left).astype(int)
    row = (seen[..., 1] - top).astype(int)
    w, prim_id, face_id = read_surfaces(peeler, wide)
    return w[row, column], prim_id[row, column], face_id[row, column]


def _scale(seen: DoubleArray, view: PinholeView) -> float:
    """Scale of the pixels in which surfaces at slopes ``(..., 2)`` are drawn, relative to the picture's own; at most 1."""
    span = np.ptp(seen.reshape(-1, 2), axis=0) * [view.fx, view.fy] + 1
    most = min(MAX_AREA_RATIO * view.width * view.height, 0.9 * MAX_LAYER_PIXELS)
    return min(1.0, float(np.sqrt(most / span.prod())), float((MAX_PICTURE_SIDE_PX - 4) / span.max()))
