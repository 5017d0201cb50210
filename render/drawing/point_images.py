"""Images of points of light: spot diagrams in focus, bokeh out of focus."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from render.drawing.page import FAINT, INK, LIGHTS, SMALL, TINY, draw_message
from render.model.arrays import DoubleArray
from render.optics.report import LensReport

_SHOWN_SHARE = 0.985  # of the rays that a spot diagram shows
_ROOM = 1.25
_MIN_AIRY_RADII = 1.5  # least half-width of a spot diagram, in radii of the Airy disc
_MEDIAN_BRIGHTNESS = 0.6  # level of the median of the light, as a share of white


def draw_spots(panels: Sequence[Axes], report: LensReport) -> None:
    """Draw spot diagrams at one scale, in the colours of their light, with the Airy disc around the middle.

    Args:
        panels: one for each spot.
        report: of the lens.
    """
    reach = _reach_um(report)
    for axes, spot in zip(panels, report.spots, strict=True):
        axes.set_title(f"{spot.height_mm:.1f} mm" if spot.height_mm else "axis", fontsize=SMALL, weight="normal")
        _frame(axes)
        axes.set_xlim(-reach, reach)
        axes.set_ylim(-reach, reach)
        if math.isnan(spot.rms_um):
            axes.text(0, 0, "no light", ha="center", va="center", color=FAINT, fontsize=SMALL)
            continue
        points, colours = _interleave(spot.points_um)
        axes.scatter(points[:, 0], points[:, 1], s=1.8, c=colours, linewidths=0, alpha=0.8, rasterized=True)
        axes.add_patch(Circle((0, 0), report.airy_um / 2, fill=False, edgecolor=INK, linewidth=0.6))
        axes.set_xlabel(f"{_short(spot.rms_um)} µm rms", labelpad=3)
    _scale_bar(panels[0], reach)


def draw_bokeh(panels: Sequence[Axes], report: LensReport) -> None:
    """Draw bright points at infinity, with the lens focused near, at five places of the frame, at one scale.

    Args:
        panels: one for each place.
        report: of the lens, which has bokeh.
    """
    sheet = report.bokeh
    if sheet is None:
        raise ValueError("this lens has no bokeh")
    for axes, bokeh in zip(panels, sheet.places, strict=True):
        axes.set_title(bokeh.name, fontsize=SMALL, weight="normal")
        _frame(axes)
        half_mm = bokeh.width_mm / 2
        axes.imshow(_encode_srgb(bokeh.light * _exposure(bokeh.light)), extent=(-half_mm, half_mm, -half_mm, half_mm))
        words = f"{100 * bokeh.share:.0f} % light, {bokeh.width_mm:.2g} mm" if bokeh.share else "no light"
        axes.set_xlabel(words, labelpad=3)


def draw_no_bokeh(axes: Axes, report: LensReport) -> None:
    """Draw the reason why a lens has no bokeh."""
    none = "its focus is fixed at infinity" if report.f_stop else "a pinhole blurs nothing"
    draw_message(axes, f"No bokeh: {none}.")


def _reach_um(report: LensReport) -> float:
    far = [
        float(np.quantile(np.hypot(*np.concatenate(spot.points_um).T), _SHOWN_SHARE))
        for spot in report.spots
        if not math.isnan(spot.rms_um)
    ]
    return max(_ROOM * max(far, default=0.0), _MIN_AIRY_RADII * report.airy_um / 2)


def _interleave(points_um: tuple[DoubleArray, ...]) -> tuple[DoubleArray, list[str]]:
    """Interleave the points of all colours, so that no colour hides another."""
    order = np.argsort(np.concatenate([np.arange(len(points)) for points in points_um]), kind="stable")
    colours = [colour for points, colour in zip(points_um, LIGHTS, strict=True) for _ in points]
    return np.concatenate(points_um)[order], [colours[i] for i in order]


def _exposure(light: DoubleArray) -> float:
    """Factor that shows a uniform disc bright, and leaves room for a brighter rim."""
    levels = np.sort(light.mean(axis=-1).ravel())
    grown = np.cumsum(levels)
    middle = float(levels[np.searchsorted(grown, 0.5 * grown[-1])])
    return _MEDIAN_BRIGHTNESS / middle if middle > 0 else 0.0


def _encode_srgb(light: DoubleArray) -> DoubleArray:
    """Encode linear light as sRGB (IEC 61966-2-1)."""
    clipped = np.clip(light, 0, 1)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)


def _frame(axes: Axes) -> None:
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])


def _scale_bar(axes: Axes, reach: float) -> None:
    """Draw a bar of a round length in the lower left corner."""
    power = 10.0 ** math.floor(math.log10(0.8 * reach))
    length = max(power * step for step in (1, 2, 5) if power * step <= 0.8 * reach)
    left, low = -0.92 * reach, -0.88 * reach
    axes.plot([left, left + length], [low, low], color=INK, linewidth=1.2, solid_capstyle="butt")
    axes.text(left, low + 0.04 * reach, f"{length:g} µm", fontsize=TINY, color=INK, ha="left", va="bottom")


def _short(value: float) -> str:
    return f"{value:.1f}" if value < 9.95 else f"{value:.0f}"
