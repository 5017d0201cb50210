"""Sheet of one film stock: its curves, greys, colours, grain, and a small scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from render.drawing.page import FAINT, HAIRLINE, INK, LIGHTS, SMALL, TINY, draw_message, encode_figure, style
from render.film import Grade, develop_on_film, print_space, project
from render.film.grain import APERTURE_UM
from render.film.process import STOP
from render.film.report import FilmReport
from render.film.settings import FilmSettings, GrainSettings, HalationSettings
from render.film.stock import MIDDLE_GREY, Stock
from render.film.targets import colour_chart, small_scene
from render.model.arrays import FloatArray

_INCHES = (16.0, 11.2)
_LEFT, _MIDDLE, _RIGHT = 0.045, 0.375, 0.705
_WIDE = 0.28
_TOP, _TALL = 0.575, 0.315
_RAMP = (_LEFT, 0.46, 0.94, 0.05)
_CHART, _LOUPE, _SCENE = (_LEFT, 0.03, 0.3, 0.3457), (0.385, 0.03, 0.14, 0.3457), (0.555, 0.03, 0.43, 0.3457)
_GATE_MM = (24.89, 14.0)
"""Gate of the small scene: Super 35 at 16:9."""
_SCENE_ROWS = 400
_HALATION = HalationSettings(amount=0.01, radius_mm=0.15)
_LOUPE_MM, _LOUPE_PX = 1.2, 240  # width of the film under the loupe, and its pixels
_LOUPE_STOPS = (-3, -1, 0, 1, 3)
_DARK = "#1c1c1c"


def draw_film_sheet(report: FilmReport, suffix: str) -> bytes:
    """Draw the sheet of a film stock.

    Args:
        report: of the stock.
        suffix: ``png`` or ``svg``.

    Returns:
        The file.
    """
    with style():
        figure = Figure(figsize=_INCHES, facecolor="white")
        _write_head(figure, report)
        _draw_curves(figure.add_axes((_LEFT, _TOP, _WIDE, _TALL)), report)
        _draw_tones(figure.add_axes((_MIDDLE, _TOP, _WIDE, _TALL)), report)
        _draw_granularity(figure.add_axes((_RIGHT, _TOP, _WIDE, _TALL)), report.stock)
        _draw_ramp(figure.add_axes(_RAMP), report)
        _draw_chart(figure.add_axes(_CHART), report.film)
        _draw_loupe(figure.add_axes(_LOUPE), report.film)
        _draw_scene(figure.add_axes(_SCENE), report.film)
        return encode_figure(figure, suffix)


def _write_head(figure: Figure, report: FilmReport) -> None:
    entry = report.entry
    details = [f"{entry.film.process}, for {'the camera' if entry.kind == 'camera' else 'prints'}"]
    if entry.film.speed:
        details.append(f"ISO {entry.film.speed:g}")
    if entry.balance_k:
        details.append(f"{entry.balance_k:g} K")
    details.append(f"densities {entry.densitometry}, {entry.year}")
    if report.film.push:
        details.append(f"pushed {report.film.push:+g} stops")
    if report.tried_with:
        details.append(f"{'printed on' if entry.kind == 'camera' else 'printed from'} {report.tried_with}")
    figure.text(_LEFT, 0.965, entry.title, fontsize=15, weight="bold", va="center", color=INK)
    figure.text(_LEFT, 0.938, "; ".join(details), fontsize=10, va="center", color=INK)
    figure.text(0.985, 0.965, "Pullfocus", fontsize=9, va="center", ha="right", color=FAINT)
    figure.text(0.985, 0.938, entry.description, fontsize=SMALL, va="center", ha="right", color=FAINT, style="italic")


def _draw_curves(axes: Axes, report: FilmReport) -> None:
    """Draw density over log exposure, on the manufacturer's axis, with metered grey marked."""
    stock = report.stock
    push = report.film.push if report.entry.kind == "camera" else 0.0
    axes.set_title("Characteristic curves")
    middle = stock.middle_log_exposure[len(stock.curves) // 2]
    for curve, color, grey in zip(stock.curves, _inks(stock), stock.middle_log_exposure, strict=True):
        x, density = curve.table
        axes.plot(x - push * STOP, density, color=color, linewidth=1.4)
        axes.plot(grey, curve.density(grey + push * STOP), "o", color=color, markersize=4.5)
    axes.axvline(middle, color=HAIRLINE, zorder=0)
    axes.text(middle, 0.015, "  metered grey", fontsize=TINY, color=FAINT, transform=axes.get_xaxis_transform())
    relative = report.entry.relative_exposure
    axes.set_xlabel("log10 exposure, relative" if relative else "log10 exposure in lux-seconds")
    axes.set_ylabel(f"density ({report.entry.densitometry})")
    axes.set_ylim(bottom=0)
    axes.grid(color=HAIRLINE, linewidth=0.4)


def _draw_tones(axes: Axes, report: FilmReport) -> None:
    """Draw light on the screen over light in the scene."""
    axes.set_title("From the scene to the screen")
    light = np.log2(report.light / report.light.max())
    for channel, color in enumerate(LIGHTS if len(report.stock.curves) == 3 else (INK,)):
        axes.plot(report.stops, light[:, channel], color=color, linewidth=1.4, marker=".", markersize=4)
    axes.axvline(0, color=HAIRLINE, zorder=0)
    axes.set_xlabel("stops from middle grey in the scene")
    axes.set_ylabel("stops below white on the screen")
    axes.grid(color=HAIRLINE, linewidth=0.4)


def _draw_granularity(axes: Axes, stock: Stock) -> None:
    """Draw the standard deviation of density over density."""
    axes.set_title("Granularity")
    if not stock.granularity:
        draw_message(axes, "No granularity of this stock is published.")
        return
    for curve, table, color in zip(stock.curves, stock.granularity, _inks(stock), strict=True):
        density = np.linspace(curve.base, curve.greatest, 200)
        axes.plot(density, 1000 * np.interp(density, *np.array(table).T), color=color, linewidth=1.4)
    axes.set_xlabel("density")
    axes.set_ylabel(f"1000 × standard deviation through {APERTURE_UM:g} µm")
    axes.set_ylim(bottom=0)
    axes.grid(color=HAIRLINE, linewidth=0.4)


def _draw_ramp(axes: Axes, report: FilmReport) -> None:
    """Draw greys as they are shown, with their densities below."""
    _show(axes, np.repeat(report.light[None].astype(np.float32), 2, axis=0), smooth=False)
    axes.set_title(
        "A wedge of 21 greys: stops from middle grey; density of the camera stock's green record; light on the screen"
    )
    green = report.camera_densities[:, report.camera_densities.shape[1] // 2]
    for step, (stops, density, light) in enumerate(zip(report.stops, green, report.light, strict=True)):
        axes.text(step, 1.66, f"{stops:+.1f}" if stops else "0", fontsize=TINY, ha="center", va="top", color=INK)
        axes.text(step, 2.1, f"{density:.2f}", fontsize=TINY, ha="center", va="top", color=FAINT)
        axes.text(step, 2.54, f"{100 * light[1]:.3g} %", fontsize=TINY, ha="center", va="top", color=FAINT)


def _draw_chart(axes: Axes, film: FilmSettings) -> None:
    """Draw the colour chart on film, with the scene's colour in the middle of each patch."""
    exposed = colour_chart()
    _show(axes, np.kron(_develop_without_grain(exposed, film), np.ones((20, 20, 1), np.float32)), smooth=False)
    axes.set_title("A colour chart; in the middle of each patch, the scene itself")
    scene = _project_scene(exposed)
    for row in range(4):
        for column in range(6):
            middle = (20 * column + 9.5, 20 * row + 9.5)
            axes.plot(*middle, "o", color=tuple(scene[row, column]), markersize=11, markeredgewidth=0)
    axes.set_facecolor(_DARK)


def _draw_loupe(axes: Axes, film: FilmSettings) -> None:
    """Draw the grain of several greys, enlarged."""
    axes.set_title(f"{_LOUPE_MM:g} mm of film")
    stock = film.stock
    if stock is None or not stock.granularity:
        draw_message(axes, "No grain\nis known.")
        return
    rows = round(_LOUPE_PX * _LOUPE[3] * _INCHES[1] / (_LOUPE[2] * _INCHES[0]))
    exposed = np.empty((rows, _LOUPE_PX, 3), np.float32)
    for i, band in enumerate(np.array_split(np.arange(rows), len(_LOUPE_STOPS))):
        exposed[band] = MIDDLE_GREY * 2.0 ** _LOUPE_STOPS[i]
    grainy = replace(film, grain=GrainSettings(amount=1.0))
    gate_mm = (_LOUPE_MM, _LOUPE_MM * rows / _LOUPE_PX)
    _show(axes, develop_on_film(exposed, grainy, frame=1, gate_mm=gate_mm), smooth=False)
    for i, stops in enumerate(_LOUPE_STOPS):
        row = (i + 0.5) / len(_LOUPE_STOPS) * rows
        axes.text(-6, row, f"{stops:+d}" if stops else "0", fontsize=TINY, ha="right", va="center", color=INK)


def _draw_scene(axes: Axes, film: FilmSettings) -> None:
    """Draw the small scene, with halation, and with grain where it is known."""
    grain = GrainSettings(amount=1.0 if film.stock is not None and film.stock.granularity else 0.0)
    shot = replace(film, grain=grain, halation=_HALATION)
    _show(axes, develop_on_film(small_scene(_SCENE_ROWS), shot, frame=1, gate_mm=_GATE_MM), smooth=True)
    axes.set_title(
        f"On {_GATE_MM[0]:g} × {_GATE_MM[1]:g} mm, {'with' if grain.amount else 'without'} grain and with "
        f"{100 * _HALATION.amount:g} % of halation; "
        "each bulb a stop brighter than the last"
    )


def _show(axes: Axes, light: FloatArray, *, smooth: bool) -> None:
    grade = _grade()
    shown = project(light, grade, print_space())
    axes.imshow(shown, interpolation="antialiased" if smooth else "nearest", aspect="auto")
    axes.set_axis_off()


def _develop_without_grain(exposed: FloatArray, film: FilmSettings) -> FloatArray:
    plain = replace(film, grain=GrainSettings(), halation=HalationSettings())
    return develop_on_film(exposed, plain, frame=1, gate_mm=_GATE_MM)


def _project_scene(exposed: FloatArray) -> FloatArray:
    """Project the chart without film, its white at the screen's white."""
    grade = _grade()
    return project(exposed / exposed.max(), grade, print_space())


def _grade() -> Grade:
    """Grade for a usual screen: OpenColorIO's default configuration, independent of the user's."""
    return Grade(config="ocio://default")


def _inks(stock: Stock) -> tuple[str, ...]:
    return LIGHTS if len(stock.curves) == 3 else (INK,)
