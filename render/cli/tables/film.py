"""Report of a film stock as tables and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich import box
from rich.table import Table

from render.film.curve import Knots
from render.film.report import FilmReport

_DECIMALS = 5
"""Decimals of densities and exposures, more than any densitometer has."""


def film_json(report: FilmReport) -> dict[str, Any]:
    """Convert a report to JSON, with null for missing values.

    Args:
        report: of the stock.
    """
    entry, stock = report.entry, report.stock
    printed = report.print_densities
    return {
        "name": entry.name,
        "title": entry.title,
        "description": entry.description,
        "process": entry.film.process,
        "kind": entry.kind,
        "speed": entry.film.speed or None,
        "balanceK": entry.balance_k,
        "year": entry.year,
        "densitometry": entry.densitometry,
        "exposureIsRelative": entry.relative_exposure,
        "push": report.film.push,
        "triedWith": report.tried_with,
        "channels": _channels(report),
        "baseDensity": _rounded(stock.base),
        "middleLogExposure": _rounded(stock.middle_log_exposure),
        "middleDensity": _rounded(stock.middle_density),
        "gamma": _rounded(report.gamma),
        "slopeAtGrey": _rounded(report.slope_at_grey),
        "latitudeStops": [_rounded(reach) for reach in report.latitude_stops],
        "curves": [_pairs(curve.knots) for curve in stock.curves],
        "granularity": [_pairs(table) for table in stock.granularity] or None,
        "wedge": {
            "stops": _rounded(report.stops.tolist()),
            "cameraDensities": [_rounded(step) for step in report.camera_densities.tolist()],
            "printDensities": None if printed is None else [_rounded(step) for step in printed.tolist()],
            "light": [_rounded(step) for step in report.light.tolist()],
        },
    }


def film_table(report: FilmReport) -> Table:
    """Convert a report to a table, without the curves.

    Args:
        report: of the stock.
    """
    entry, stock = report.entry, report.stock
    table = Table(box=box.SIMPLE_HEAD, show_header=False, title=entry.title, title_justify="left", pad_edge=False)
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    table.add_row("description", entry.description)
    if entry.film.speed:
        table.add_row("speed", f"ISO {entry.film.speed:g}")
    if entry.balance_k:
        table.add_row("made for light of", f"{entry.balance_k:g} K")
    if report.tried_with:
        table.add_row("printed on" if entry.kind == "camera" else "printed from", report.tried_with)
    if report.film.push:
        table.add_row("pushed", f"{report.film.push:+g} stops")
    table.add_row("densities", f"{entry.densitometry}, read off the data sheet of {entry.year}")
    axis = "relative" if entry.relative_exposure else "of lux-seconds"
    table.add_row("records", ", ".join(_channels(report)))
    table.add_row("base", _join(stock.base))
    table.add_row("metered grey", f"at log10 exposure {_join(stock.middle_log_exposure)} ({axis})")
    table.add_row("its density", _join(stock.middle_density))
    table.add_row("slope there", _join(report.slope_at_grey))
    table.add_row("gamma", f"{_join(report.gamma)}, of the straight line")
    reach = "; ".join(f"{below:+.1f} to {above:+.1f}" for below, above in report.latitude_stops)
    table.add_row("answers to light", f"{reach} stops from grey")
    table.add_row("granularity", _granularity(report))
    return table


def wedge_table(report: FilmReport) -> Table:
    """Convert the wedge of 21 greys to a table.

    Args:
        report: of the stock.
    """
    title = "A wedge of greys"
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title=title, title_justify="left")
    printed = report.print_densities
    for column in ("stops", "density in the camera", *(("density of the print",) if printed is not None else ())):
        table.add_column(column, no_wrap=True, justify="right")
    table.add_column("light on the screen, %", no_wrap=True, justify="right")
    for step, stops in enumerate(report.stops):
        row = [f"{stops:+.1f}", _join(report.camera_densities[step])]
        if printed is not None:
            row.append(_join(printed[step]))
        light = report.light[step, : len(report.stock.curves)]
        table.add_row(*row, " / ".join(f"{100 * part:.3g}" for part in light))
    return table


def _channels(report: FilmReport) -> list[str]:
    return ["red", "green", "blue"] if len(report.stock.curves) == 3 else ["all light"]


def _granularity(report: FilmReport) -> str:
    if not report.stock.granularity:
        return "none is published"
    figures = [1000 * deviation for deviation in report.granularity_at_1]
    listed = " / ".join(f"{figure:.1f}" for figure in figures)
    return f"{listed} thousandths of density through 48 µm, at 1.0 above base"


def _join(numbers: Sequence[float]) -> str:
    return " / ".join(f"{number:.2f}" for number in numbers)


def _rounded(numbers: Sequence[float]) -> list[float]:
    return [round(float(number), _DECIMALS) for number in numbers]


def _pairs(knots: Knots) -> list[list[float]]:
    return [_rounded(knot) for knot in knots]
