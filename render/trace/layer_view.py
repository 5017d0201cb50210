"""View of the layers: its extent, which is the picture and a guard band for rays that leave it, and its resolution."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.limits import MAX_PICTURE_SIDE_PX
from render.optics.view import PinholeView
from render.trace.lens_table import BOUND, LIGHT, PolynomialTable
from render.trace.picture_focus import PictureFocus
from render.trace.rays import RayBundle

MAX_BLUR_SHARE = 0.25
"""Limit on the guard band on each side, relative to the picture's longer side. Beyond it, rays see repeated edge pixels.

Only surfaces near the picture's edge with a larger circle of confusion are affected.
"""
MAX_AREA_RATIO = 2.5
"""Limit on the layers' pixels relative to the picture's at their resolution; a lens that sees further gets coarser layers."""
MAX_SLOPE = 4.5
"""No picture from one point goes beyond 77 degrees from its axis."""
MARGIN_STEPS = 64
"""Steps of the guard band in the picture's longer side: a slightly different focus or stop has the same layers."""
_EDGE_POINTS = 33


@dataclass(frozen=True)
class RayExtent:
    """Bounds of rays, in slopes of object space relative to the view axis: x right, y down."""

    left: float
    top: float
    right: float
    bottom: float


def make_layer_view(
    view: PinholeView,
    bundle: RayBundle,
    focus: PictureFocus,
    supersample: float,
    nearest_w: float,
    most_side_px: int = MAX_PICTURE_SIDE_PX,
) -> PinholeView:
    """The view to peel.

    Args:
        view: the picture.
        bundle: the lens.
        focus: focal surface.
        supersample: layer pixels per picture pixel along each axis.
        nearest_w: inverse depth of the nearest surface in view, 1/m.
        most_side_px: limit on the layers' sides.
    """
    return extend_view(view, bound_rays(view, bundle, focus, nearest_w), supersample, most_side_px)


def extend_view(
    view: PinholeView, extent: RayExtent, supersample: float, most_side_px: int = MAX_PICTURE_SIDE_PX
) -> PinholeView:
    """View of the layers that show a picture and a given extent around it.

    Args:
        view: view of the picture.
        extent: bounds of the rays.
        supersample: layer pixels per picture pixel along each axis.
        most_side_px: limit on the layers' sides; margins are cut to it.
    """
    step = max(view.width, view.height) / MARGIN_STEPS
    margins = [
        step * max(0, int(np.ceil(beyond / step - 1e-6)))
        for beyond in (
            view.cx + extent.right * view.fx - view.width,
            -(view.cx + extent.left * view.fx),
            view.cy + extent.bottom * view.fy - view.height,
            -(view.cy + extent.top * view.fy),
        )
    ]
    area = (view.width + margins[0] + margins[1]) * (view.height + margins[2] + margins[3])
    scale = supersample * min(1.0, float(np.sqrt(MAX_AREA_RATIO * view.width * view.height / area)))
    room = max(0, (most_side_px - int(np.ceil(scale * max(view.width, view.height)))) // 2)
    right, left, bottom, top = (min(int(np.ceil(margin * scale)) + 2, room) for margin in margins)
    return replace(
        view,
        width=int(np.ceil(view.width * scale)) + left + right,
        height=int(np.ceil(view.height * scale)) + top + bottom,
        fx=view.fx * scale,
        fy=view.fy * scale,
        cx=view.cx * scale + left,
        cy=view.cy * scale + top,
    )


def bound_rays(view: PinholeView, bundle: RayBundle, focus: PictureFocus, nearest_w: float) -> RayExtent:
    """Bounds of the rays of the picture's edge, at any depth from infinity to the nearest surface."""
    edge = _edge_points(view)
    w_f, pupil = focus.at(edge)
    return _bound_off_focus(view, bundle, edge, pupil * np.maximum(np.abs(w_f), np.abs(nearest_w - w_f)))


def _bound_off_focus(view: PinholeView, bundle: RayBundle, edge: DoubleArray, off_focus: DoubleArray) -> RayExtent:
    slopes = (edge - [view.cx, view.cy]) / [view.fx, view.fy]
    centres, radii = _bounds(bundle, slopes, off_focus)
    cap = MAX_BLUR_SHARE * max(view.width / view.fx, view.height / view.fy)
    radii = np.minimum(radii, cap)[:, None]
    low = np.clip((centres - radii).min(axis=0), -MAX_SLOPE, MAX_SLOPE)
    high = np.clip((centres + radii).max(axis=0), -MAX_SLOPE, MAX_SLOPE)
    return RayExtent(float(low[0]), float(low[1]), float(high[0]), float(high[1]))


def transform_extent(extent: RayExtent, turn: DoubleArray, move_m: DoubleArray, nearest_w: float) -> RayExtent:
    """Bounds of the rays of a camera that stands elsewhere, in slopes seen from here.

    Args:
        extent: bounds in that camera's own slopes.
        turn: ``(3, 3)`` from its axes to those here: x right, y down, z ahead.
        move_m: ``(3,)`` its position, in the axes here, metres.
        nearest_w: inverse depth of the nearest surface in view, 1/m.
    """
    x, y = np.meshgrid(np.linspace(extent.left, extent.right, 5), np.linspace(extent.top, extent.bottom, 5))
    ahead = np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3) @ turn.T
    slopes = ahead[:, :2] / np.maximum(ahead[:, 2:], 1 / MAX_SLOPE)
    beside = np.minimum(
        np.abs(move_m[:2] - move_m[2] * slopes) * nearest_w, MAX_BLUR_SHARE * np.ptp([extent.left, extent.right])
    )
    low = np.clip((slopes - beside).min(axis=0), -MAX_SLOPE, MAX_SLOPE)
    high = np.clip((slopes + beside).max(axis=0), -MAX_SLOPE, MAX_SLOPE)
    return RayExtent(float(low[0]), float(low[1]), float(high[0]), float(high[1]))


def _bounds(bundle: RayBundle, slopes: DoubleArray, off_focus: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Bounds of the rays of ``(n, 2)`` fields at the focus: centres ``(n, 2)`` and radii ``(n,)``, slopes."""
    if not isinstance(bundle.table, PolynomialTable):
        return slopes, bundle.slope_reach + bundle.reach_m * off_focus
    rows = bundle.table.rows.astype(np.float64)
    lit = np.asarray(rows[..., LIGHT] > 0).any(axis=0)
    height = np.hypot(*slopes.T)
    heights = np.linspace(0.0, bundle.table.last_slope, rows.shape[1])
    first_dark = heights[min(np.flatnonzero(lit).max(initial=0) + 1, len(heights) - 1)]
    inside = np.minimum(height, first_dark)  # pixels beyond the lens's image circle see nothing
    outward = slopes * (inside / np.maximum(height, 1e-12))[:, None]

    def over_wavelengths(place: int, most: bool) -> DoubleArray:
        values = rows[..., BOUND + place]
        extreme = values.max(axis=0) if most else values.min(axis=0)
        return np.asarray(np.interp(inside, heights, extreme))

    far, near = over_wavelengths(0, True), over_wavelengths(0, False)
    pupil = np.maximum(np.abs(over_wavelengths(2, True)), np.abs(over_wavelengths(2, False)))
    off = outward * ((far + near) / 2 / np.maximum(inside, 1e-12))[:, None]
    centres = outward + off * [1 / bundle.squeeze, 1.0]
    radii = (far - near) / 2 + over_wavelengths(1, True) + (pupil + over_wavelengths(3, True)) * off_focus
    return centres, radii


def _edge_points(view: PinholeView) -> DoubleArray:
    """Points ``(n, 2)`` along the picture's edge, pixels; the middle of each side is one of them."""
    along = np.linspace(0.0, 1.0, _EDGE_POINTS)
    zero, one = np.zeros(_EDGE_POINTS), np.ones(_EDGE_POINTS)
    edges = [(along, zero), (along, one), (zero, along), (one, along)]
    return np.concatenate([np.stack([x * view.width, y * view.height], axis=1) for x, y in edges])
