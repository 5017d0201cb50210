"""Two lenses side by side on one sheet: curves over the field in two colours, spots and bokeh in two rows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from render.drawing.page import BEAMS, FAINT, HAIRLINE, INK, SMALL, encode_figure, style
from render.drawing.point_images import draw_bokeh, draw_no_bokeh, draw_spots
from render.optics.report.data_sheet import metres
from render.optics.report.mtf import FREQUENCIES
from render.shot.lens.comparison import BREATHING_M, ComparedLens

Sides = tuple[ComparedLens, ComparedLens]

_INCHES = (16.0, 11.2)
_COLOURS = (BEAMS[0], BEAMS[2])
_CURVE_SIZE = (0.2, 0.2)
_LEFTS, _LOWS = (0.045, 0.29, 0.535, 0.78), (0.69, 0.415)
_STAMP, _STEP, _ROWS = (1.33 / 16.0, 1.33 / 11.2), 0.0905, (0.205, 0.035)
_SPOTS_LEFT, _BOKEH_LEFT = 0.045, 0.53


def draw_lens_comparison(sides: Sides, suffix: str) -> bytes:
    """Draw two lenses on one sheet.

    Args:
        sides: the two lenses.
        suffix: ``png`` or ``svg``.

    Returns:
        The file.
    """
    panels: tuple[Callable[[Axes, Sides], None], ...] = (
        _draw_distortion,
        _draw_illumination,
        _draw_field_curvature,
        _draw_breathing,
        *(_contrast(k) for k in range(len(FREQUENCIES))),
        _draw_colour,
    )
    with style():
        figure = Figure(figsize=_INCHES, facecolor="white")
        for i, side in enumerate(sides):
            camera, report = side.report.camera, side.report
            stop = f"f/{report.f_stop:.3g}, " if report.f_stop else ""
            setting = f"{camera.focal_length_mm:.4g} mm, {stop}focused at {metres(camera.focus_distance_m)}"
            left = (_SPOTS_LEFT, _BOKEH_LEFT)[i]
            figure.text(left, 0.965, side.lens.title, fontsize=15, weight="bold", va="center", color=_COLOURS[i])
            figure.text(left, 0.938, setting, fontsize=10, va="center", color=INK)
            _draw_points(figure, side, _ROWS[i], _COLOURS[i])
        for k, draw in enumerate(panels):
            axes = figure.add_axes((_LEFTS[k % 4], _LOWS[k // 4], *_CURVE_SIZE))
            draw(axes, sides)
            axes.grid(color=HAIRLINE, linewidth=0.4)
        return encode_figure(figure, suffix)


def _draw_points(figure: Figure, side: ComparedLens, low: float, colour: str) -> None:
    report = side.report

    def row(left: float, count: int) -> list[Axes]:
        return [figure.add_axes((left + i * _STEP, low, *_STAMP)) for i in range(count)]

    figure.text(0.012, low + _STAMP[1] / 2, side.lens.name, rotation=90, va="center", color=colour, fontsize=SMALL)
    if report.f_stop:
        draw_spots(row(_SPOTS_LEFT, len(report.spots)), report)
    if report.bokeh is None:
        draw_no_bokeh(figure.add_axes((_BOKEH_LEFT, low, 5 * _STEP, _STAMP[1])), report)
    else:
        draw_bokeh(row(_BOKEH_LEFT, len(report.bokeh.places)), report)


def _draw_distortion(axes: Axes, sides: Sides) -> None:
    axes.set_title("Distortion, %")
    for side, colour in zip(sides, _COLOURS, strict=True):
        curves = side.report.curves
        axes.plot(curves.heights_mm, 100 * curves.distortion, color=colour)
    _over_height(axes, sides)


def _draw_illumination(axes: Axes, sides: Sides) -> None:
    axes.set_title("Relative illumination, %")
    for side, colour in zip(sides, _COLOURS, strict=True):
        axes.plot(side.report.curves.heights_mm, 100 * side.report.curves.illumination, color=colour)
    axes.set_ylim(bottom=0)
    _over_height(axes, sides)


def _draw_field_curvature(axes: Axes, sides: Sides) -> None:
    axes.set_title("Focus behind the film, mm: sagittal –, tangential - -")
    for side, colour in zip(sides, _COLOURS, strict=True):
        if side.report.f_stop:
            curves = side.report.curves
            axes.plot(curves.heights_mm, curves.sagittal_mm, color=colour)
            axes.plot(curves.heights_mm, curves.tangential_mm, color=colour, linestyle="--")
    _over_height(axes, sides)


def _draw_breathing(axes: Axes, sides: Sides) -> None:
    axes.set_title("Breathing: growth of the picture, %")
    nearness = np.array([0.0, *(1 / distance for distance in BREATHING_M)])
    for side, colour in zip(sides, _COLOURS, strict=True):
        axes.plot(nearness, [0.0, *(100 * growth for growth in side.breathing)], color=colour, marker="o", markersize=3)
    axes.set_xticks(nearness, ["∞", *(f"{distance:g}" for distance in BREATHING_M)])
    axes.set_xlabel("focus distance, m")


def _contrast(k: int) -> Callable[[Axes, Sides], None]:
    def draw(axes: Axes, sides: Sides) -> None:
        axes.set_title(f"MTF at {FREQUENCIES[k]:g}/mm, %: sagittal –, tangential - -")
        for side, colour in zip(sides, _COLOURS, strict=True):
            mtf = side.report.mtf
            if mtf is not None:
                for values, line in zip(mtf.field[k], ("-", "--"), strict=True):
                    axes.plot(mtf.heights_mm, 100 * values, color=colour, linestyle=line)
        axes.set_ylim(0, 105)
        _over_height(axes, sides)

    return draw


def _draw_colour(axes: Axes, sides: Sides) -> None:
    axes.set_title("Lateral colour: red farther out than blue, µm")
    for side, colour in zip(sides, _COLOURS, strict=True):
        curves = side.report.colour
        if curves is not None:
            axes.plot(curves.heights_mm, curves.lateral_um[0] - curves.lateral_um[2], color=colour)
    _over_height(axes, sides)


def _over_height(axes: Axes, sides: Sides) -> None:
    axes.set_xlim(0, sides[0].report.corner_mm)
    axes.axhline(0, color=FAINT, linewidth=0.6, zorder=1)
    axes.set_xlabel("image height, mm")
