"""Sheet of one lens: its section, numbers, aberrations over the field, and bokeh."""

from __future__ import annotations

import textwrap

from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase

from render.drawing.data_sheet_curves import draw_blur, draw_character, draw_colour
from render.drawing.field_curves import draw_distortion, draw_field_curvature, draw_illumination
from render.drawing.page import FAINT, INK, SMALL, draw_message, encode_figure, style
from render.drawing.point_images import draw_bokeh, draw_no_bokeh, draw_spots
from render.drawing.section import draw_section
from render.drawing.transfer_curves import (
    draw_breathing,
    draw_focus_scale,
    draw_lateral,
    draw_longitudinal,
    draw_mtf,
    draw_through_focus,
)
from render.optics.report import LensReport, data_sheet
from render.optics.report.data_sheet import metres
from render.shot.lens.lens_alone import LensAlone

_INCHES = (16.0, 11.2)
_LINE = 0.0143  # line spacing, as a share of the sheet's height
_CHARACTERS = 63
_NAMES_LEFT, _VALUES_LEFT, _NUMBERS_TOP, _NUMBERS_END = 0.675, 0.748, 0.905, 0.462
_SECTION = (0.045, 0.518, 0.605, 0.36)
_STAMPS_LOW, _STAMPS_TITLE, _STAMP_INCHES, _STAMP_STEP = 0.302, 0.444, 1.33, 0.0905
_SPOTS_LEFT, _BOKEH_LEFT = 0.045, 0.53
_CURVES = ((0.045, draw_field_curvature), (0.375, draw_distortion), (0.705, draw_illumination))
_DATA_SHEET_CURVES = (
    ((0.045, 0.545, 0.28, 0.34), draw_blur),
    ((0.375, 0.745, 0.265, 0.14), draw_colour),
    ((0.375, 0.545, 0.265, 0.12), draw_character),
)
_MORE_INCHES, _MORE_SIZE = 6.6, (0.28, 0.28)
_MORE_CURVES = (
    ((0.045, 0.63), draw_mtf),
    ((0.375, 0.63), draw_through_focus),
    ((0.705, 0.63), draw_breathing),
    ((0.045, 0.14), draw_longitudinal),
    ((0.375, 0.14), draw_lateral),
    ((0.705, 0.14), draw_focus_scale),
)
_CURVES_LOW, _CURVE_SIZE = 0.085, (0.28, 0.165)


def draw_lens_sheet(lens: LensAlone, report: LensReport, suffix: str) -> bytes:
    """Draw the sheet of a lens.

    Args:
        lens: the lens.
        report: of the lens as it is set.
        suffix: ``png`` or ``svg``.

    Returns:
        The file.
    """
    with style():
        page = Figure(figsize=(_INCHES[0], _INCHES[1] + _MORE_INCHES), facecolor="white")
        figure, more = page.subfigures(2, 1, squeeze=False, height_ratios=(_INCHES[1], _MORE_INCHES))[:, 0]
        _write_head(figure, lens, report)
        _write_numbers(figure, report)
        _draw_inside(figure, report)
        _draw_point_images(figure, report)
        for left, draw in _CURVES:
            draw(figure.add_axes((left, _CURVES_LOW, *_CURVE_SIZE)), report)
        for (left, low), draw in _MORE_CURVES:
            draw(more.add_axes((left, low, *_MORE_SIZE)), report)
        return encode_figure(page, suffix)


def _draw_inside(figure: FigureBase, report: LensReport) -> None:
    """Draw the section of a lens with surfaces, or the curves of a data sheet."""
    if report.camera.lens.data_sheet is not None:
        for place, draw in _DATA_SHEET_CURVES:
            draw(figure.add_axes(place), report)
        return
    figure.text(_SECTION[0], _SECTION[1] + _SECTION[3] + 0.034, "Section", weight="bold", va="bottom", color=INK)
    if not report.camera.lens.has_cylinders:
        draw_section(figure.add_axes(_SECTION), report)
        return
    left, low, width, high = _SECTION
    for name, bottom, sideways in (("upright", low + 0.55 * high, False), ("from side to side", low, True)):
        axes = figure.add_axes((left, bottom, width, 0.42 * high))
        draw_section(axes, report, sideways=sideways)
        axes.set_xlabel("")
        axes.set_ylabel(f"mm {name}")


def _write_head(figure: FigureBase, lens: LensAlone, report: LensReport) -> None:
    camera = report.camera
    stop = f"f/{report.f_stop:.3g}, " if report.f_stop else ""
    gate = f"{camera.horizontal_aperture_mm:g} × {camera.vertical_aperture_mm:g} mm"
    setting = f"{camera.focal_length_mm:.4g} mm, {stop}focused at {metres(camera.focus_distance_m)}, gate {gate}"
    figure.text(_SECTION[0], 0.965, lens.title, fontsize=15, weight="bold", va="center", color=INK)
    figure.text(_SECTION[0], 0.938, setting, fontsize=10, va="center", color=INK)
    figure.text(0.985, 0.965, "Pullfocus", fontsize=9, va="center", ha="right", color=FAINT)
    if lens.description:
        figure.text(
            0.985, 0.938, lens.description, fontsize=SMALL, va="center", ha="right", color=FAINT, style="italic"
        )


def _write_numbers(figure: FigureBase, report: LensReport) -> None:
    """Write as many numbers as there is room for. A lens file may have many notes; a last line marks what is cut off."""
    y = _NUMBERS_TOP
    notes = [("note", note) for note in report.notes]
    for group in (*data_sheet(report), notes):
        for name, value in group:
            lines = textwrap.wrap(value, _CHARACTERS)
            if y - _LINE * (len(lines) + 1) < _NUMBERS_END:
                figure.text(
                    _VALUES_LEFT, y, "and more: see pullfocus lenses show", fontsize=SMALL, va="top", color=FAINT
                )
                return
            figure.text(_NAMES_LEFT, y, name, fontsize=SMALL, va="top", color=FAINT)
            figure.text(_VALUES_LEFT, y, "\n".join(lines), fontsize=SMALL, va="top", color=INK, linespacing=1.25)
            y -= _LINE * len(lines)
        y -= _LINE / 2


def _draw_point_images(figure: FigureBase, report: LensReport) -> None:
    focus = metres(report.camera.focus_distance_m)
    words = f"of a point in focus at {focus}, by image height; up is outward, circle: diffraction's disc"
    _title(figure, _SPOTS_LEFT, "Spots", words if report.f_stop else "")
    if report.f_stop:
        draw_spots(_row(figure, _SPOTS_LEFT, len(report.spots)), report)
    else:
        draw_message(_wide(figure, _SPOTS_LEFT), "A pinhole has no errors, and its diffraction is left out.")
    if report.bokeh is None:
        _title(figure, _BOKEH_LEFT, "Bokeh", "")
        draw_no_bokeh(_wide(figure, _BOKEH_LEFT), report)
        return
    near = metres(report.bokeh.focus_distance_m)
    words = (
        f"of a point at infinity, focused at {near}; light against the centre's, width shown, each exposed for itself"
    )
    _title(figure, _BOKEH_LEFT, "Bokeh", words)
    draw_bokeh(_row(figure, _BOKEH_LEFT, len(report.bokeh.places)), report)


def _title(figure: FigureBase, left: float, title: str, words: str) -> None:
    figure.text(left, _STAMPS_TITLE, title, weight="bold", va="bottom", color=INK)
    figure.text(left + 0.042, _STAMPS_TITLE, words, fontsize=SMALL, va="bottom", color=INK)


def _row(figure: FigureBase, left: float, count: int) -> list[Axes]:
    size = (_STAMP_INCHES / _INCHES[0], _STAMP_INCHES / _INCHES[1])
    return [figure.add_axes((left + i * _STAMP_STEP, _STAMPS_LOW, *size)) for i in range(count)]


def _wide(figure: FigureBase, left: float) -> Axes:
    return figure.add_axes((left, _STAMPS_LOW, 5 * _STAMP_STEP, _STAMP_INCHES / _INCHES[1]))
