"""Lens tables: the rays of a lens as the tracer reads them.

Both tables hold, for a field point, a wavelength and a pupil point, the ray in object space: its slope's error against the ideal
lens in the plane of focus (m of x to a m of depth) and where it passes the plane of the entrance pupil (metres).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, FloatArray

SLOPE_T, SLOPE_S = 0, 20
PUPIL_T, PUPIL_S = 36, 48
FRONT_RIM, REAR_RIM = 57, 66
WEIGHT = 75
REGION = 79  # centre, half axes along and across; whether a rim clips
BOUND = 83  # slope error: centre and radius; pupil point: centre and radius
LIGHT = 87  # mean weight of the rays of the whole disc, blocked ones as 0: the light of a white field
ROW_LENGTH = 88
"""Numbers of a row: first the coefficients of polynomials over the pupil, then constants."""


@dataclass(frozen=True, eq=False)
class PolynomialTable:
    """A rotationally symmetric lens: polynomials over the pupil, for field heights from the axis outward.

    A row has room for degree 7 in the slope errors and 5 in the pupil points; terms of higher degrees follow its other
    numbers (`render.trace.lens_fit`). In each row x is the tangential pupil coordinate,
    toward the pixel, and y the sagittal one, on the unit disc; where a rim clips the stop, the disc stands for the ellipse
    around what is open. Polynomials hold the coefficients of x⁰, x¹, ... then those with y², and so on; sagittal ones are
    divided by y.

    Attributes:
        rows: ``(wavelengths, heights, n)`` float32, n `ROW_LENGTH` or more.
        last_slope: field of the last height, slope in object space; heights are even in it.
        pupil_reach_m: farthest that a ray passes from the pupil's centre.
        slope_reach: largest slope of an open ray less that of its ideal, within the picture.
        slope_degree: of the slope errors' polynomials, 5 to 13: coefficients above it are 0.
        pupil_degree: of the pupil points', 5 or 3.
        film_error_mm: largest error of its rays on the film that was found between what it is fitted to; 0 for a table that holds
            its lens exactly.
    """

    rows: FloatArray
    last_slope: float
    pupil_reach_m: float
    slope_reach: float
    slope_degree: int = 7
    pupil_degree: int = 5
    film_error_mm: float = 0.0


@dataclass(frozen=True, eq=False)
class GridTable:
    """Any lens: rays on a grid over the pupil, for a grid of field points.

    Attributes:
        rays: ``(wavelengths, fields, side, side, 4)`` float32: slope error and pupil point, x right and y down.
        light: ``(wavelengths, fields, side, side, 2)`` float32: weight; clearance, below 0 where the ray passes.
        fields: how many across and down.
        last_slope: field of the outermost across and down.
        mirrored: whether the fields are those of one quarter of the picture, from the axis to the right and down; the others
            mirror it.
        pupil_reach_m: farthest that a ray passes from the pupil's centre.
        slope_reach: largest slope of an open ray less that of its ideal, within the picture.
    """

    rays: FloatArray
    light: FloatArray
    fields: tuple[int, int]
    last_slope: tuple[float, float]
    pupil_reach_m: float
    slope_reach: float
    mirrored: bool = False

    @property
    def axis_field(self) -> int:
        """Number of the field on the axis, or nearest to it."""
        columns, rows = self.fields
        return 0 if self.mirrored else (rows // 2) * columns + columns // 2

    def nearest_fields(self, x: DoubleArray, y: DoubleArray) -> NDArray[np.int64]:
        """Numbers of the fields that are nearest to slopes of the picture."""
        places = []
        for slope, last, count in zip((x, y), self.last_slope, self.fields, strict=True):
            share = np.abs(slope) / last if self.mirrored else 0.5 + 0.5 * slope / last
            places.append(np.clip(np.rint(share * (count - 1)), 0, count - 1).astype(np.int64))
        return np.asarray(places[1] * self.fields[0] + places[0])


LensTable = PolynomialTable | GridTable


def table_arrays(table: LensTable) -> dict[str, NDArray[Any]]:
    """Return the fields of a table as arrays, by name; numbers are arrays without axes."""
    return {field.name: np.asarray(getattr(table, field.name)) for field in fields(table)}


def table_from_arrays(arrays: Mapping[str, NDArray[Any]]) -> LensTable:
    """Make a table from the arrays of `table_arrays`.

    Raises:
        ValueError: they are not the fields of a table.
    """
    for kind in (PolynomialTable, GridTable):
        if set(arrays) == {field.name for field in fields(kind)}:
            return kind(**{name: _plain(array) for name, array in arrays.items()})
    raise ValueError(f"no lens table has the fields {', '.join(arrays)}")


def _plain(array: NDArray[Any]) -> Any:
    """Number of an array without axes, tuple of one with one axis; a table's own arrays have more."""
    return array if array.ndim > 1 else tuple(array.tolist()) if array.ndim else array.item()
