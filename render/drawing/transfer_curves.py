"""Second part of a lens's sheet: modulation transfer, errors of each colour, breathing, and the focus ring's scale."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from render.drawing.page import BEAMS, FAINT, HAIRLINE, INK, LIGHTS, SMALL, TINY, draw_message
from render.model.arrays import DoubleArray
from render.optics.report import LensReport
from render.optics.report.focus_scale import THROW_DEG, FocusMark
from render.optics.report.mtf import FREQUENCIES

_LINES = ((0, "-"), (1, "--"))  # sagittal and tangential
_WITHOUT = "Without surfaces there is no ring to turn."
_LEAST_MM, _LEAST_UM, _LEAST_PERCENT = 0.05, 2.0, 0.5
_APART_DEG = 13.0  # labels of the scale that are nearer overlap


def draw_mtf(axes: Axes, report: LensReport) -> None:
    """Draw modulation transfer over the image height."""
    axes.set_title("MTF with diffraction")
    mtf = report.mtf
    if mtf is None:
        draw_message(axes, "A pinhole's diffraction is left out.")
        return
    for f, frequency in enumerate(FREQUENCIES):
        for d, style in _LINES:
            label = f"{frequency:g} lp/mm" if d == 0 else None
            axes.plot(mtf.heights_mm, 100 * mtf.field[f, d], color=BEAMS[f], linestyle=style, label=label)
            axes.plot(mtf.heights_mm, 100 * mtf.field_geometric[f, d], color=BEAMS[f], linewidth=0.5, linestyle=":")
    _percent(axes)
    axes.set_xlim(0, report.corner_mm)
    axes.set_xlabel("image height, mm: — sagittal, - - tangential, ··· by rays alone")
    _legend(axes, 3)


def draw_through_focus(axes: Axes, report: LensReport) -> None:
    """Draw modulation transfer of the middle frequency through focus."""
    mtf, f = report.mtf, len(FREQUENCIES) // 2
    axes.set_title(f"MTF through focus, {FREQUENCIES[f]:g} lp/mm")
    if mtf is None:
        draw_message(axes, "Through a pinhole all is sharp.")
        return
    for p, height in enumerate(mtf.focus_heights_mm):
        for d, style in _LINES:
            label = f"{height:.1f} mm high" if d == 0 else None
            axes.plot(mtf.shifts_mm, 100 * mtf.focus[f, d, p], color=BEAMS[p], linestyle=style, label=label)
    axes.axvline(0, color=FAINT, linewidth=0.6, zorder=1)
    _percent(axes)
    axes.set_xlim(mtf.shifts_mm[0], mtf.shifts_mm[-1])
    axes.set_xlabel("film behind its place, mm")
    _legend(axes, 3)


def _span_both_ways(axes: Axes, values: DoubleArray, least: float) -> None:
    """Let the axis across reach as far to the left as to the right, past all finite values."""
    most = np.abs(values[np.isfinite(values)]).max(initial=least)
    axes.set_xlim(-1.08 * most, 1.08 * most)


def draw_longitudinal(axes: Axes, report: LensReport) -> None:
    """Draw where rays of each colour cross the axis, over their height in the stop."""
    axes.set_title("Longitudinal aberration")
    colour = report.colour
    if colour is None:
        draw_message(axes, "A pinhole has no errors.")
        return
    for values, light, name in zip(colour.longitudinal_mm, LIGHTS, ("red", "green", "blue"), strict=True):
        axes.plot(values, colour.pupil, color=light, label=name)
    _span_both_ways(axes, colour.longitudinal_mm, _LEAST_MM)
    axes.set_ylim(0, 1)
    _cross(axes, "mm behind the film", "height in the stop")
    _legend(axes, 3)


def draw_lateral(axes: Axes, report: LensReport) -> None:
    """Draw lateral colour over the image height."""
    axes.set_title("Lateral colour against green")
    colour = report.colour
    if colour is None:
        draw_message(axes, "A pinhole has no errors.")
        return
    for values, light, name in zip(colour.lateral_um, LIGHTS, ("red", "green", "blue"), strict=True):
        if name != "green":
            axes.plot(values, colour.heights_mm, color=light, label=name)
    _span_both_ways(axes, colour.lateral_um, _LEAST_UM)
    axes.set_ylim(0, report.corner_mm)
    _cross(axes, "µm farther from the axis", "image height, mm")
    _legend(axes, 2)


def draw_breathing(axes: Axes, report: LensReport) -> None:
    """Draw the growth of the picture over the focus distance."""
    axes.set_title("Breathing")
    marks = [mark for mark in report.focus_marks if mark.unit == "m" and np.isfinite(mark.distance_m)]
    if not marks:
        draw_message(axes, "Without surfaces it does not breathe.")
        return
    growth = [100 * mark.breathing for mark in marks]
    axes.plot([mark.distance_m for mark in marks], growth, color=INK, marker=".")
    axes.set_xscale("log")
    axes.set_xlim(0.9 * marks[-1].distance_m, 1.1 * marks[0].distance_m)
    most = max(_LEAST_PERCENT, 1.15 * float(np.abs(growth).max()))
    axes.set_ylim(-most, most)
    ticks = [mark.distance_m for mark in marks if mark.distance_m in (10.0, 5.0, 3.0, 2.0, 1.0, 0.5, 0.3)]
    axes.set_xticks(ticks or [marks[0].distance_m], [f"{tick:g}" for tick in ticks] or [marks[0].label])
    axes.minorticks_off()
    axes.axhline(0, color=FAINT, linewidth=0.6, zorder=1)
    axes.grid(color=HAIRLINE, linewidth=0.4)
    axes.set_xlabel("focus distance from the film, m")
    axes.set_ylabel("% larger picture than at infinity")


def draw_focus_scale(axes: Axes, report: LensReport) -> None:
    """Draw the ring's witness marks, unrolled: metres above, feet below."""
    axes.set_title("Focus scale")
    if not report.focus_marks:
        draw_message(axes, _WITHOUT)
        return
    axes.set_xlim(-8, THROW_DEG + 8)
    axes.set_ylim(-1, 1)
    axes.set_yticks([])
    axes.axhline(0, color=FAINT, linewidth=0.8)
    for unit, side in (("m", 1), ("ft", -1)):
        marks = [mark for mark in report.focus_marks if mark.unit == unit]
        shown = _apart(marks)
        for mark in marks:
            length = 0.35 if mark in shown else 0.2
            axes.plot([mark.turn_deg] * 2, [0, side * length], color=INK, linewidth=0.8)
        for mark in shown:
            axes.text(mark.turn_deg, side * 0.45, mark.label, ha="center", va="center", fontsize=SMALL, color=INK)
        axes.text(THROW_DEG + 6, side * 0.8, unit, ha="right", va="center", fontsize=TINY, color=FAINT)
    travel = max(mark.travel_mm for mark in report.focus_marks)
    axes.set_xlabel(f"degrees of a ring of {THROW_DEG:g}° and even pitch; travel {travel:.2f} mm")


def _apart(marks: list[FocusMark]) -> list[FocusMark]:
    """Marks whose labels do not overlap: infinity, the nearest, and what fits between from the near end."""
    shown: list[FocusMark] = []
    for mark in (marks[0], *marks[:0:-1]):
        if all(abs(mark.turn_deg - other.turn_deg) >= _APART_DEG for other in shown):
            shown.append(mark)
    return shown


def _percent(axes: Axes) -> None:
    axes.set_ylim(0, 100)
    axes.set_ylabel("%")
    axes.grid(color=HAIRLINE, linewidth=0.4)


def _cross(axes: Axes, across: str, up: str) -> None:
    axes.axvline(0, color=FAINT, linewidth=0.6, zorder=1)
    axes.grid(color=HAIRLINE, linewidth=0.4)
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    axes.locator_params(axis="x", nbins=6)


def _legend(axes: Axes, columns: int) -> None:
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=columns)
