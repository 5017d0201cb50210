"""Points of light as the lens draws them: spot diagrams in focus, bokeh out of focus."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from render.drawing.page import FAINT, INK, LIGHTS, SMALL, TINY, say_instead
from render.model.arrays import DoubleArray
from render.optics.report import LensReport

_CAUGHT = 0.985  # share of the rays that a spot diagram has to show
_ROOM = 1.25
_LEAST_AIRY = 1.5  # radii of diffraction's disc, at least, from the middle to the side
_BRIGHTNESS = 0.6  # of the screen's white: what half of the light is darker than


def draw_spots(panels: Sequence[Axes], report: LensReport) -> None:
    """Spot diagrams at one scale, in the colours of their light, with diffraction's disc around the middle.

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
        points, colours = _mingled(spot.points_um)
        axes.scatter(points[:, 0], points[:, 1], s=1.8, c=colours, linewidths=0, alpha=0.8, rasterized=True)
        axes.add_patch(Circle((0, 0), report.airy_um / 2, fill=False, edgecolor=INK, linewidth=0.6))
        axes.set_xlabel(f"{_short(spot.rms_um)} µm rms", labelpad=3)
    _scale_bar(panels[0], reach)


def draw_bokeh(panels: Sequence[Axes], report: LensReport) -> None:
    """Bright points at infinity, with the lens focused near, at five places of the frame, at one scale.

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
        axes.imshow(_encoded(bokeh.light * _exposure(bokeh.light)), extent=(-half_mm, half_mm, -half_mm, half_mm))
        words = f"{100 * bokeh.share:.0f} % light, {bokeh.width_mm:.2g} mm" if bokeh.share else "no light"
        axes.set_xlabel(words, labelpad=3)


def say_no_bokeh(axes: Axes, report: LensReport) -> None:
    """Why there is none."""
    none = "its focus is fixed at infinity" if report.f_stop else "a pinhole blurs nothing"
    say_instead(axes, f"No bokeh: {none}.")


def _reach_um(report: LensReport) -> float:
    far = [
        float(np.quantile(np.hypot(*np.concatenate(spot.points_um).T), _CAUGHT))
        for spot in report.spots
        if not math.isnan(spot.rms_um)
    ]
    return max(_ROOM * max(far, default=0.0), _LEAST_AIRY * report.airy_um / 2)


def _mingled(points_um: tuple[DoubleArray, ...]) -> tuple[DoubleArray, list[str]]:
    """Points of all lights and their colours, in turns, so that none hides another."""
    order = np.argsort(np.concatenate([np.arange(len(points)) for points in points_um]), kind="stable")
    colours = [colour for points, colour in zip(points_um, LIGHTS, strict=True) for _ in points]
    return np.concatenate(points_um)[order], [colours[i] for i in order]


def _exposure(light: DoubleArray) -> float:
    """Factor that shows an even disc bright, and leaves room for a brighter rim."""
    levels = np.sort(light.mean(axis=-1).ravel())
    grown = np.cumsum(levels)
    middle = float(levels[np.searchsorted(grown, 0.5 * grown[-1])])
    return _BRIGHTNESS / middle if middle > 0 else 0.0


def _encoded(light: DoubleArray) -> DoubleArray:
    """Linear light as sRGB shows it (IEC 61966-2-1)."""
    clipped = np.clip(light, 0, 1)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)


def _frame(axes: Axes) -> None:
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])


def _scale_bar(axes: Axes, reach: float) -> None:
    """A bar of a round length in the lower left corner."""
    power = 10.0 ** math.floor(math.log10(0.8 * reach))
    length = max(power * step for step in (1, 2, 5) if power * step <= 0.8 * reach)
    left, low = -0.92 * reach, -0.88 * reach
    axes.plot([left, left + length], [low, low], color=INK, linewidth=1.2, solid_capstyle="butt")
    axes.text(left, low + 0.04 * reach, f"{length:g} µm", fontsize=TINY, color=INK, ha="left", va="bottom")


def _short(value: float) -> str:
    return f"{value:.1f}" if value < 9.95 else f"{value:.0f}"
