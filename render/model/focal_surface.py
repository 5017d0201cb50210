"""Focal surface over the picture, as plain data. `render.focus.surface` evaluates it.

Places are slopes of object space from the middle of the entrance pupil, ``(X/z, Y/z)``: x to the right, y *up*, so that they
depend neither on the picture's size nor on its shape. What is said of them is inverse depth ``w = 1/z`` in 1/m, in which every
plane of the world is affine in the slopes (DESIGN section 2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray

MAX_CONTROLS = 64
"""Limit on a surface's control points, from the tracer."""

MAX_HALVES = 2
"""Half lenses that it may have, as USD's cameras do."""


@dataclass(frozen=True)
class FocalPlane:
    """A plane of focus: ``w = w0 + x·slope_x + y·slope_y``.

    Attributes:
        w0: inverse depth on the view axis, 1/m; 0 is infinity.
        slope_x: 1/m for each slope to the right; not 0 for a swung lens.
        slope_y: 1/m for each slope up; not 0 for a tilted one.
    """

    w0: float
    slope_x: float = 0.0
    slope_y: float = 0.0

    @property
    def is_upright(self) -> bool:
        """Whether it is square to the view axis."""
        return self.slope_x == 0 and self.slope_y == 0


@dataclass(frozen=True, eq=False)
class Controls:
    """Control points: values at positions of the picture, and their interpolation.

    The value anywhere is the mean of all, weighted by ``weight · reach(d) / d^exponent`` with d the distance on the screen (Lee,
    Eisemann & Seidel 2010, section 5.2): at a place it is that place's own. ``reach`` is ``(1 - (d / falloff)²)²`` and 0 from the
    falloff on, or 1 everywhere for a falloff of 0.

    Attributes:
        places: ``(k, 2)`` slopes.
        values: ``(k, m)`` of the m things that are interpolated together.
        weights: ``(k,)`` 0 or more.
        falloffs: ``(k,)`` slopes; 0 reaches everywhere.
        exponent: how local the values are.
    """

    places: DoubleArray
    values: DoubleArray
    weights: DoubleArray
    falloffs: DoubleArray
    exponent: float = 3.0

    def __post_init__(self) -> None:
        """Check shapes and ranges.

        Raises:
            SettingsError: they are wrong, or there are more than `MAX_CONTROLS`.
        """
        count = len(self.places)
        if count > MAX_CONTROLS:
            raise SettingsError(f"a focal surface has at most {MAX_CONTROLS} control points, got {count}")
        columns = (self.places, self.values, self.weights, self.falloffs)
        if any(len(column) != count for column in columns) or np.shape(self.places) != (count, 2):
            raise SettingsError("every column of a focal surface's control points must be as long as its places")
        if not all(np.isfinite(column).all() for column in columns):
            raise SettingsError("the control points of a focal surface must have finite numbers")
        if (self.weights < 0).any() or (self.falloffs < 0).any():
            raise SettingsError("the control points of a focal surface must have weights and falloffs of 0 or more")
        if not 0 < self.exponent <= 16:
            raise SettingsError(
                f"the exponent of a focal surface must be above 0 and at most 16, got {self.exponent:g}"
            )


@dataclass(frozen=True)
class HalfLens:
    """A half lens before the lens: beyond its edge the focus lies elsewhere (a split diopter).

    Attributes:
        direction: unit ``(x, y)``, square to the edge and toward the half lens.
        offset: distance of the edge from the view axis along the direction, slopes.
        width: of the zone in which it fades in, slopes, half of it on either side of the edge.
        w: inverse depth in focus through it, 1/m.
    """

    direction: tuple[float, float]
    offset: float
    width: float
    w: float


@dataclass(frozen=True, eq=False)
class FocalSurface:
    """Focal surface of a lens, with its relative pupil radius.

    Attributes:
        plane: plane of focus of the lens.
        controls: what no lens can: values are w in 1/m and the natural logarithm of the depth of field's extent; None for none.
        blend: from the plane (0) to the controls (1).
        halves: half lenses, the first applied first.
        bends: curvature of field by hand: values are changes of w in 1/m; None for none.
    """

    plane: FocalPlane
    controls: Controls | None = None
    blend: float = 1.0
    halves: tuple[HalfLens, ...] = ()
    bends: Controls | None = None

    def __post_init__(self) -> None:
        """Check the number of half lenses.

        Raises:
            SettingsError: more than `MAX_HALVES`.
        """
        if len(self.halves) > MAX_HALVES:
            raise SettingsError(f"a focal surface has at most {MAX_HALVES} half lenses, got {len(self.halves)}")

    @property
    def is_plane(self) -> bool:
        """Whether the plane is all there is to it."""
        return not (self.halves or (self.controls is not None and self.blend > 0) or self.bends is not None)
