"""Two lenses side by side, as a table and as JSON."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from rich import box
from rich.table import Table

from render.cli.tables.lens import lens_json
from render.errors import one_line
from render.model.arrays import DoubleArray
from render.optics.report import data_sheet
from render.optics.report.mtf import FREQUENCIES
from render.shot.lens.comparison import BREATHING_M, ComparedLens

_FIELDS = (0.0, 0.5, 1.0)
_PLACES = ("axis", "half way", "corner")


def comparison_json(sides: tuple[ComparedLens, ComparedLens]) -> dict[str, Any]:
    """Convert a comparison to JSON; dark values and those that a lens does not have are null.

    Args:
        sides: the two lenses.
    """
    return {
        "lenses": [
            {
                **lens_json(side.lens, side.report, side.picture_error_mm),
                "breathing": {"focusDistancesM": list(BREATHING_M), "growth": _numbers(np.array(side.breathing))},
            }
            for side in sides
        ]
    }


def comparison_table(sides: tuple[ComparedLens, ComparedLens]) -> Table:
    """Convert a comparison to a table with a column for each lens; rows that differ are bold.

    Args:
        sides: the two lenses.
    """
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("", style="dim", no_wrap=True)
    for side in sides:
        table.add_column(one_line(side.lens.title), overflow="fold", ratio=1)
    left, right = ({name: value for group in _groups(side) for name, value in group} for side in sides)
    for name in (*left, *(name for name in right if name not in left)):
        values = left.get(name, "—"), right.get(name, "—")
        table.add_row(name, *values, style="bold" if values[0] != values[1] else "")
    return table


def _groups(side: ComparedLens) -> list[list[tuple[str, str]]]:
    return [*data_sheet(side.report), _curves(side), [("breathing", _breathing(side))]]


def _curves(side: ComparedLens) -> list[tuple[str, str]]:
    curves = side.report.curves
    rows = [
        ("distortion %", _over_field(100 * curves.distortion, "+.2f")),
        ("illumination %", _over_field(100 * curves.illumination, ".0f")),
    ]
    if not side.report.f_stop:
        return rows
    rows += [
        ("sagittal focus mm", _over_field(curves.sagittal_mm, "+.3f")),
        ("tangential focus mm", _over_field(curves.tangential_mm, "+.3f")),
    ]
    mtf, colour = side.report.mtf, side.report.colour
    if mtf is not None:
        for k, frequency in enumerate(FREQUENCIES):
            sagittal, tangential = (_over_field(100 * mtf.field[k, axis], ".0f") for axis in (0, 1))
            rows.append((f"MTF % at {frequency:g}/mm", f"sagittal {sagittal}; tangential {tangential}"))
    if colour is not None:
        red, _, blue = colour.lateral_um
        rows.append(("red less blue µm", _over_field(red - blue, "+.1f")))
        near_axis = colour.longitudinal_mm[:, 0]
        rows.append(("red less blue mm", f"{near_axis[0] - near_axis[2]:+.3f} along the axis"))
    return rows


def _over_field(values: DoubleArray, form: str) -> str:
    chosen = [float(values[round(field * (len(values) - 1))]) for field in _FIELDS]
    digits = int(form[-2]) if "." in form else 0
    words = [format(round(value, digits) + 0.0, form) if math.isfinite(value) else "dark" for value in chosen]
    return ", ".join(f"{place} {word}" for place, word in zip(_PLACES, words, strict=True))


def _breathing(side: ComparedLens) -> str:
    words = [
        f"{100 * growth:+.1f} % at {distance:g} m" if math.isfinite(growth) else f"does not reach {distance:g} m"
        for distance, growth in zip(BREATHING_M, side.breathing, strict=True)
    ]
    return ", ".join(words)


def _numbers(values: DoubleArray) -> list[float | None]:
    return [float(value) if math.isfinite(value) else None for value in values]
