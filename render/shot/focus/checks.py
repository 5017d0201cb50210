"""Checks of the numbers of a camera's focus settings and focus points.

A point with a number that has no meaning is left out and named, so that the other points still focus the shot. Focus settings
have no fallback: there such a number is an error.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np
from pxr import Usd

from render.errors import CameraError
from render.focus.points import PointKind, number_faults
from render.model.arrays import DoubleArray
from usd_schemas import FocusData, FocusPoint
from usd_schemas.binding import property_values
from usd_schemas.values import limit_problem

_FIELDS = {
    "weights": "weight",
    "blurs_mm": "blur",
    "surface_offsets_m": "surface_offset",
    "falloffs": "falloff",
    "extents": "extent",
}
"""Fields of `FocusPoint` by the names that `render.focus.points.FocusTargets` has for them."""

NUMBERS = tuple(_FIELDS.values())
"""Fields of `FocusPoint` that weight and shape its effect."""

_PLACES = {"offset": "offset", "barycentric": "barycentric coordinates"}


@dataclass(frozen=True, eq=False)
class PointNumbers:
    """Numeric fields of k focus points at n times, with defaults where a number has no meaning.

    Attributes:
        columns: ``(n, k)`` by their names in `render.focus.points.FocusTargets`, lengths in metres. A number without meaning
            at a time is replaced by its default.
        faults: for each time, a sentence for each point at fault, by name.
        points: for each time, all points, with defaults in place of fields at fault.
    """

    columns: dict[str, DoubleArray]
    faults: tuple[dict[str, str], ...]
    points: tuple[tuple[FocusPoint, ...], ...]

    @classmethod
    def from_points(cls, points: Sequence[Sequence[FocusPoint]], metres_in_a_unit: float) -> PointNumbers:
        """Check focus points.

        Args:
            points: for each of n times, all k of them.
            metres_in_a_unit: of the stage.
        """
        columns = _columns(points)
        faults = tuple(_faults(points, columns))
        sound = tuple(tuple(row) for row in points)
        if any(faults):
            rows = zip(points, faults, strict=True)
            sound = tuple(tuple(_repair(p) if p.name in faulty else p for p in row) for row, faulty in rows)
            columns = _columns(sound)
        return cls(columns | {"surface_offsets_m": columns["surface_offsets_m"] * metres_in_a_unit}, faults, sound)


def _columns(points: Sequence[Sequence[FocusPoint]]) -> dict[str, DoubleArray]:
    return {
        name: np.array([[getattr(point, field) for point in row] for row in points], np.float64)
        for name, field in _FIELDS.items()
    }


def _repair(point: FocusPoint) -> FocusPoint:
    """Replace fields without meaning by their defaults."""
    new = FocusPoint("new")
    bad = [field for name, field in _FIELDS.items() if number_faults([""], {name: np.array([getattr(point, field)])})]
    bad += [field for field in _PLACES if not all(map(math.isfinite, getattr(point, field)))]
    bad += ["kind"] * (point.kind not in get_args(PointKind))
    return replace(point, **{field: getattr(new, field) for field in bad})


def _faults(points: Sequence[Sequence[FocusPoint]], numbers: Mapping[str, DoubleArray]) -> list[dict[str, str]]:
    names = [point.name for point in points[0]]
    if not number_faults(names, numbers):  # the usual case: all times are checked at once
        return [_other_faults(row) for row in points]
    rows = ({name: column[i] for name, column in numbers.items()} for i in range(len(points)))
    return [number_faults(names, row) | _other_faults(at_time) for row, at_time in zip(rows, points, strict=True)]


def _other_faults(points: Sequence[FocusPoint]) -> dict[str, str]:
    faults = {}
    for p in points:
        for field, what in _PLACES.items():
            place = getattr(p, field)
            if not all(map(math.isfinite, place)):
                faults[p.name] = f"the {what} of focus point {p.name!r} must be finite numbers, but they are {place}"
        if p.kind not in get_args(PointKind):
            faults[p.name] = f"focus point {p.name!r} must be sharp or soft, but it is {p.kind!r}"
    return faults


def check_settings(prim: Usd.Prim, focus: Sequence[FocusData]) -> None:
    """Check the settings by which points focus a camera; a camera that is focused by hand needs none of them.

    Args:
        prim: the camera.
        focus: its focus settings at all times that matter.

    Raises:
        CameraError: a number is not finite, or a value is beyond what the schema allows.
    """
    if focus[0].mode == "manual":
        return
    values = dict.fromkeys(pair for data in focus for pair in property_values(data) if isinstance(pair[1], float | str))
    for name, value in values:
        attribute = prim.GetAttribute(name)
        tokens, wrong = attribute.GetMetadata("allowedTokens"), limit_problem(attribute, value)
        if tokens and value not in tokens:
            wrong = f"must be one of {', '.join(tokens)}, got {value!r}"
        elif isinstance(value, float) and not math.isfinite(value):
            wrong = f"must be finite, got {value:g}"
        if wrong:
            raise CameraError(f"{name} of camera {prim.GetPath()} {wrong}", path=str(prim.GetPath()))
