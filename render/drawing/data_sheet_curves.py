"""Curves of a lens's data sheet over the image height; they take the place of the section of a lens with surfaces."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from render.drawing.page import BEAMS, FAINT, HAIRLINE, INK, LIGHTS
from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet
from render.optics.data_sheet import at_heights
from render.optics.report import LensReport

_SAMPLES = 200


def draw_blur(axes: Axes, report: LensReport) -> None:
    """Draw the blur along the radius and across it, and the flare of coma."""
    sheet, heights = _tables(report)
    axes.set_title("Blur" + (f" at f/{sheet.f_stop:.3g}" if sheet.f_stop else ""))
    for name, label, colour, line in (
        ("sagittal_blur_mm", "sagittal", BEAMS[0], "-"),
        ("tangential_blur_mm", "tangential", BEAMS[2], "--"),
        ("coma_mm", "coma's flare", INK, ":"),
    ):
        _draw(axes, sheet, name, heights, label, colour, line, 1000)
    _finish(axes, report, "µm: standard deviations, and coma's length outward")


def draw_colour(axes: Axes, report: LensReport) -> None:
    """Draw lateral colour, and the focus of red and blue."""
    sheet, heights = _tables(report)
    axes.set_title("Colour")
    _draw(axes, sheet, "lateral_color_mm", heights, "red farther out than blue, µm", LIGHTS[0], "-", 1000)
    _draw(axes, sheet, "axial_color_mm", heights, "red focused behind blue, 1/100 mm", LIGHTS[2], "--", 100)
    _finish(axes, report, "")


def draw_character(axes: Axes, report: LensReport) -> None:
    """Draw spherical aberration, which makes the disc behind the focus uneven."""
    sheet, heights = _tables(report)
    axes.set_title("Spherical aberration, share of the blur")
    _draw(axes, sheet, "spherical", heights, "+ bright edge behind the focus, − bright middle", INK, "-", 1)
    axes.set_ylim(-1.05, 1.05)
    _finish(axes, report, "")


def _tables(report: LensReport) -> tuple[DataSheet, DoubleArray]:
    sheet = report.camera.lens.data_sheet
    if sheet is None:
        raise ValueError("this lens has no data sheet")
    return sheet, np.linspace(0.0, report.corner_mm, _SAMPLES)


def _draw(
    axes: Axes, sheet: DataSheet, name: str, heights: DoubleArray, label: str, colour: str, line: str, unit: float
) -> None:
    values = np.array(getattr(sheet, name))
    if not len(values):
        return
    axes.plot(heights, unit * at_heights(sheet, name, heights), color=colour, linestyle=line, label=label)
    nodes, is_shown = np.array(sheet.heights_mm), np.array(sheet.heights_mm) <= heights[-1]
    axes.plot(nodes[is_shown], unit * values[is_shown], color=colour, marker="o", markersize=2.5, linestyle="")


def _finish(axes: Axes, report: LensReport, unit: str) -> None:
    axes.set_xlim(0, report.corner_mm)
    axes.axhline(0, color=FAINT, linewidth=0.6, zorder=1)
    axes.set_xlabel("image height, mm")
    axes.set_ylabel(unit)
    axes.grid(color=HAIRLINE, linewidth=0.4)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="best")
