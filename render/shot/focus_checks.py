"""Which numbers of a camera's focus and of its focus points make sense.

A point with a number that has no meaning is left out and named, so that the others still focus the shot. How the focus is found
has nothing to fall back to: there such a number is an error.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np
from numpy.typing import NDArray
from pxr import Usd

from render.errors import CameraError
from render.focus.points import PointKind, number_faults
from usd_schemas import FocusData, FocusPoint
from usd_schemas.binding import property_values
from usd_schemas.values import limit_problem

DoubleArray = NDArray[np.float64]

_FIELDS = {
    "weights": "weight",
    "blurs_mm": "blur",
    "surface_offsets_m": "surface_offset",
    "falloffs": "falloff",
    "extents": "extent",
}
"""Names in `render.focus.points.FocusTargets`, and of the fields of `FocusPoint`."""

NUMBERS = tuple(_FIELDS.values())
"""Fields of `FocusPoint` that say how much a point counts, and for what."""


@dataclass(frozen=True, eq=False)
class PointNumbers:
    """Numbers of k focus points at n times, without those that have no meaning.

    Attributes:
        columns: ``(n, k)`` by their names in `render.focus.points.FocusTargets`, lengths in metres. A point that is at fault at a
            time has those of a new one then.
        faults: for each time, what is wrong with points, by name, in a sentence.
    """

    columns: dict[str, DoubleArray]
    faults: tuple[dict[str, str], ...]

    @classmethod
    def of(cls, points: Sequence[Sequence[FocusPoint]], metres_in_a_unit: float) -> PointNumbers:
        """Look over what points say.

        Args:
            points: for each of n times, all k of them.
            metres_in_a_unit: of the stage.
        """
        authored = {
            name: np.array([[getattr(point, field) for point in row] for row in points], np.float64)
            for name, field in _FIELDS.items()
        }
        faults = tuple(_faults(points, authored))
        columns = authored
        if any(faults):
            new = FocusPoint("new")
            rows = zip(points, faults, strict=True)
            at_fault = np.array([[point.name in told for point in row] for row, told in rows], np.bool_)
            columns = {name: np.where(at_fault, getattr(new, _FIELDS[name]), said) for name, said in authored.items()}
        return cls(columns | {"surface_offsets_m": columns["surface_offsets_m"] * metres_in_a_unit}, faults)


def _faults(points: Sequence[Sequence[FocusPoint]], numbers: Mapping[str, DoubleArray]) -> list[dict[str, str]]:
    names = [point.name for point in points[0]]
    of_kind = {
        point.name: f"focus point {point.name!r} must be sharp or soft, but it is {point.kind!r}"
        for point in points[0]
        if point.kind not in get_args(PointKind)
    }
    if not number_faults(names, numbers):  # as ever, so that all times are looked at at once
        return [of_kind for _ in points]
    rows = ({name: column[i] for name, column in numbers.items()} for i in range(len(points)))
    return [number_faults(names, row) | of_kind for row in rows]


def sound_kinds(points: Sequence[FocusPoint]) -> list[PointKind]:
    """Kinds of points; of those that are at fault, as theirs is none, that of a new one.

    Args:
        points: at any time.
    """
    return [point.kind if point.kind in get_args(PointKind) else "sharp" for point in points]


def check_settings(prim: Usd.Prim, focus: Sequence[FocusData]) -> None:
    """Check the numbers by which points focus a camera; one that is focused by hand needs none of them.

    Args:
        prim: the camera.
        focus: what it asks of the focus, at all times that matter.

    Raises:
        CameraError: a number is not finite, or beyond what the schema allows.
    """
    if focus[0].mode == "manual":
        return
    said = dict.fromkeys(pair for data in focus for pair in property_values(data) if isinstance(pair[1], float))
    for name, value in said:
        wrong = limit_problem(prim.GetAttribute(name), value)
        if not math.isfinite(value):
            wrong = f"must be finite, got {value:g}"
        if wrong:
            raise CameraError(f"{name} of camera {prim.GetPath()} {wrong}", path=str(prim.GetPath()))
