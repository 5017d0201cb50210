"""Focus points as the lens sees them over many frames: arrays of frames by points, with nothing of USD left in them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from render.errors import SettingsError
from render.model.arrays import BoolArray, DoubleArray

PointKind = Literal["sharp", "soft"]

NEAREST_DEPTH_M = 1e-100
"""Depth below which a point counts as behind the camera, so that inverse depths can be squared."""

LEAST_EXTENT = 1e-3
"""Smallest extent in the schema, which stands for no depth of field."""


@dataclass(frozen=True)
class FocusTarget:
    """Focus point at one time, as seen by the lens.

    Attributes:
        name: the focus point's name.
        depth_m: along the view axis, positive in front of the camera; NaN where the point has no place.
        weight: how much it counts, 0 or more.
        kind: whether it must be ``sharp`` or ``soft``.
        blur_mm: of a soft point the wanted diameter of the circle of confusion on the film, 0 leaves it to ``surface_offset_m``;
            for a sharp one its limit where the points also set the stop, 0 for the common limit.
        surface_offset_m: for a soft point, how far behind it the focus shall lie; negative is before it.
        enabled: whether it counts at all.
        in_frame: whether it lies inside the picture.
        slope: ``(X/z, Y/z)`` from the entrance pupil, x right and y up; NaN where that is not known.
        falloff: screen distance in frame widths at which its influence ends; 0 for nowhere.
        extent: of the depth of field around it, relative to the lens's own.
        visible: visible share, from 0, where something stands before it, to 1.
    """

    name: str
    depth_m: float
    weight: float = 1.0
    kind: PointKind = "sharp"
    blur_mm: float = 0.0
    surface_offset_m: float = 0.0
    enabled: bool = True
    in_frame: bool = True
    slope: tuple[float, float] = (math.nan, math.nan)
    falloff: float = 0.0
    extent: float = 1.0
    visible: float = 1.0

    @property
    def is_blurred(self) -> bool:
        """Whether it must be soft by a circle of confusion."""
        return self.kind == "soft" and self.blur_mm > 0

    @property
    def aim_m(self) -> float:
        """Depth of the focus that it requests: its own, or beside it for a soft point."""
        return self.depth_m + self.surface_offset_m if self.kind == "soft" and self.blur_mm == 0 else self.depth_m


@dataclass(frozen=True, eq=False)
class FocusTargets:
    """k focus points over n frames. Made by `from_columns`.

    Attributes:
        names: k names.
        kinds: k kinds.
        depths_m: ``(n, k)`` along the view axis; NaN where a point has no place.
        slopes: ``(n, k, 2)`` from the entrance pupil, x right and y up; NaN where there is none, as behind the camera.
        weights: ``(n, k)`` 0 or more.
        blurs_mm: ``(n, k)`` as in `FocusTarget`.
        surface_offsets_m: ``(n, k)`` as in `FocusTarget`.
        falloffs: ``(n, k)`` frame widths; 0 ends nowhere.
        extents: ``(n, k)`` of the depth of field around each, relative to the lens's own.
        enabled: ``(n, k)``.
        in_frame: ``(n, k)``.
        visible: ``(n, k)`` from 0, hidden, to 1, seen.
        frame_widths: ``(n,)`` of the picture in slopes.
        field_shifts_w: ``(n, k)`` by how much the lens is sharpest nearer at each than where it is focused, for its curvature of
            field, 1/m.
    """

    names: tuple[str, ...]
    kinds: tuple[PointKind, ...]
    depths_m: DoubleArray
    slopes: DoubleArray
    weights: DoubleArray
    blurs_mm: DoubleArray
    surface_offsets_m: DoubleArray
    falloffs: DoubleArray
    extents: DoubleArray
    enabled: BoolArray
    in_frame: BoolArray
    visible: DoubleArray
    frame_widths: DoubleArray
    field_shifts_w: DoubleArray

    def __post_init__(self) -> None:
        """Check shapes and numbers.

        Raises:
            SettingsError: a column has the wrong shape, or a number no meaning; of the points, the first is named.
        """
        shape = self.depths_m.shape
        if len(shape) != 2 or len(self.names) != shape[1] or len(self.kinds) != shape[1]:
            raise SettingsError(f"focus points over time must be frames by their {len(self.names)} names, got {shape}")
        wrong = [name for name in _COLUMNS if np.shape(getattr(self, name)) != shape]
        wrong += ["slopes"] * (self.slopes.shape != (*shape, 2))
        wrong += ["frame_widths"] * (self.frame_widths.shape != shape[:1])
        if wrong:
            raise SettingsError(f"the {wrong[0]} of focus points must be as many as their depths, {shape}")
        if not set(self.kinds) <= set(get_args(PointKind)):
            raise SettingsError(f"a focus point must be sharp or soft, got {self.kinds}", code="bad_focus_point")
        for fault in number_faults(self.names, {column: getattr(self, column) for column in _CHECKED}).values():
            raise SettingsError(fault, code="bad_focus_point")

    @classmethod
    def from_columns(
        cls,
        names: Sequence[str],
        depths_m: ArrayLike,
        *,
        kinds: Sequence[PointKind] | PointKind = "sharp",
        slopes: ArrayLike = math.nan,
        weights: ArrayLike = 1.0,
        blurs_mm: ArrayLike = 0.0,
        surface_offsets_m: ArrayLike = 0.0,
        falloffs: ArrayLike = 0.0,
        extents: ArrayLike = 1.0,
        enabled: ArrayLike = True,
        in_frame: ArrayLike = True,
        visible: ArrayLike = 1.0,
        frame_widths: ArrayLike = 1.0,
        field_shifts_w: ArrayLike = 0.0,
    ) -> FocusTargets:
        """Make points over time from columns that broadcast to frames by points.

        Args:
            names: k names.
            depths_m: ``(n, k)``, or ``(k,)`` for one frame.
            kinds: one for all, or k.
            slopes: ``(n, k, 2)``; none by default.
            weights: and all the others: ``(n, k)``, ``(k,)`` or one number.
            blurs_mm: see the class.
            surface_offsets_m: see the class.
            falloffs: see the class.
            extents: see the class.
            enabled: see the class.
            in_frame: see the class.
            visible: see the class.
            frame_widths: ``(n,)`` or one number.
            field_shifts_w: ``(n, k)``, ``(k,)`` or one number.

        Raises:
            SettingsError: shapes or numbers are wrong.
        """
        depths = np.atleast_2d(np.asarray(depths_m, np.float64))
        shape = depths.shape

        def column(values: ArrayLike) -> DoubleArray:
            return np.broadcast_to(np.asarray(values, np.float64), shape)

        def switch(values: ArrayLike) -> BoolArray:
            return np.broadcast_to(np.asarray(values, np.bool_), shape)

        return cls(
            names=tuple(names),
            kinds=(kinds,) * len(names) if isinstance(kinds, str) else tuple(kinds),
            depths_m=depths,
            slopes=np.broadcast_to(np.asarray(slopes, np.float64), (*shape, 2)),
            weights=column(weights),
            blurs_mm=column(blurs_mm),
            surface_offsets_m=column(surface_offsets_m),
            falloffs=column(falloffs),
            extents=column(extents),
            enabled=switch(enabled),
            in_frame=switch(in_frame),
            visible=column(visible),
            frame_widths=np.broadcast_to(np.asarray(frame_widths, np.float64), shape[:1]),
            field_shifts_w=column(field_shifts_w),
        )

    @classmethod
    def at_one_time(cls, points: Sequence[FocusTarget], frame_width: float = 1.0) -> FocusTargets:
        """Make one frame of points.

        Args:
            points: the points.
            frame_width: of the picture in slopes.

        Raises:
            SettingsError: a number of a point has no meaning.
        """
        return cls.from_columns(
            [p.name for p in points],
            np.array([[p.depth_m for p in points]], np.float64).reshape(1, len(points)),
            kinds=[p.kind for p in points],
            slopes=np.array([p.slope for p in points], np.float64).reshape(1, len(points), 2),
            weights=[p.weight for p in points],
            blurs_mm=[p.blur_mm for p in points],
            surface_offsets_m=[p.surface_offset_m for p in points],
            falloffs=[p.falloff for p in points],
            extents=[p.extent for p in points],
            enabled=[p.enabled for p in points],
            in_frame=[p.in_frame for p in points],
            visible=[p.visible for p in points],
            frame_widths=frame_width,
        )

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self.depths_m)

    @property
    def is_soft(self) -> BoolArray:
        """Mask ``(k,)`` of the points that must be soft."""
        return np.array([kind == "soft" for kind in self.kinds], np.bool_)

    @property
    def is_blurred(self) -> BoolArray:
        """Mask ``(n, k)`` of the points that must be soft by a circle of confusion."""
        return self.is_soft & (self.blurs_mm > 0)

    @property
    def aims_m(self) -> DoubleArray:
        """Depths ``(n, k)`` of the focus that each point requests: its own, or beside it for a soft point."""
        offset = self.is_soft & (self.blurs_mm == 0)
        return np.where(offset, self.depths_m + self.surface_offsets_m, self.depths_m)

    @property
    def aims_w(self) -> DoubleArray:
        """``(n, k)`` where the plane of focus must be at each: one over `aims_m` less the field's shift there, 1/m; 0 where the
        aim is not in front of the camera. Below 0 where a curved field has it sharp beyond infinity."""
        aims = self.aims_m
        ahead = aims >= NEAREST_DEPTH_M
        return np.where(ahead, 1 / np.where(ahead, aims, 1.0) - self.field_shifts_w, 0.0)

    def axis_w(self, tilts: ArrayLike = 0.0) -> DoubleArray:
        """Inverse depths ``(n, k)`` on the view axis at which the lens's focus meets each point's request.

        Of an upright lens that is `aims_w`; of a tilted one it is more or less by what its plane of focus rises from the axis to
        the point; where it is below 0, the plane meets the axis behind the camera.

        Args:
            tilts: ``(n, 2)`` how the plane's w changes with the slope to the right and up, as in
                `render.model.focal_surface.FocalPlane`; or 0.
        """
        rise = np.broadcast_to(np.asarray(tilts, np.float64), (self.frames, 2))
        if not rise.any():
            return self.aims_w
        return np.asarray(self.aims_w - (rise[:, None] * np.nan_to_num(self.slopes)).sum(axis=-1))

    def at(self, frame: int) -> tuple[FocusTarget, ...]:
        """The points at one frame.

        Args:
            frame: index of it.
        """
        return tuple(self._points(frame))

    def _points(self, frame: int) -> Iterator[FocusTarget]:
        for i, (name, kind) in enumerate(zip(self.names, self.kinds, strict=True)):
            at = (frame, i)
            yield FocusTarget(
                name=name,
                depth_m=float(self.depths_m[at]),
                weight=float(self.weights[at]),
                kind=kind,
                blur_mm=float(self.blurs_mm[at]),
                surface_offset_m=float(self.surface_offsets_m[at]),
                enabled=bool(self.enabled[at]),
                in_frame=bool(self.in_frame[at]),
                slope=(float(self.slopes[at][0]), float(self.slopes[at][1])),
                falloff=float(self.falloffs[at]),
                extent=float(self.extents[at]),
                visible=float(self.visible[at]),
            )


def number_faults(names: Sequence[str], columns: Mapping[str, DoubleArray]) -> dict[str, str]:
    """Faults in the numbers of focus points, by name: the first fault of each faulty point, in one sentence.

    Args:
        names: k names.
        columns: ``(n, k)`` or ``(k,)`` by the names that they have in `FocusTargets`: weights, blurs_mm, surface_offsets_m,
            falloffs, extents, visible. Others are passed over.
    """
    faults: dict[str, str] = {}
    for column, (what, least) in _CHECKED.items():
        if column not in columns:
            continue
        values = np.atleast_2d(columns[column])
        bad = ~(np.isfinite(values) & (values >= least))
        for i in np.flatnonzero(bad.any(axis=0)).tolist():
            value = values[np.argmax(bad[:, i]), i]
            expected = "a finite number" if least == -math.inf else f"a finite number of {least:g} or more"
            faults.setdefault(
                names[i], f"the {what} of focus point {names[i]!r} must be {expected}, but it is {value:g}"
            )
    return faults


_COLUMNS = (
    "weights",
    "blurs_mm",
    "surface_offsets_m",
    "falloffs",
    "extents",
    "enabled",
    "in_frame",
    "visible",
    "field_shifts_w",
)
_CHECKED = {
    "weights": ("weight", 0.0),
    "blurs_mm": ("blur in mm", 0.0),
    "surface_offsets_m": ("surface offset in m", -math.inf),
    "falloffs": ("falloff in frame widths", 0.0),
    "extents": ("extent", LEAST_EXTENT),
    "visible": ("visible share", 0.0),
}
