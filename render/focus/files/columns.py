"""The columns of a focus curve, as each file names them.

A length ends in its unit, in files as in code; angles are radians inside and degrees in files.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

DEGREE = math.pi / 180
DISTANCE_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
ANGLE_UNITS = {"deg": DEGREE, "rad": 1.0}


@dataclass(frozen=True)
class Column:
    """One column of numbers.

    Attributes:
        attribute: name in `FocusCurve`.
        csv: name in CSV, with its unit.
        json: name in JSON, with its unit.
        factor: factor on the file's numbers.
        drives: whether it drives the camera; the others follow from those that do.
        units: units in CSVs of other tools: factors by the ending of the name.
    """

    attribute: str
    csv: str
    json: str
    factor: float = 1.0
    drives: bool = False
    units: tuple[tuple[str, float], ...] = ()

    @property
    def stem(self) -> str:
        """Its name in CSV without the unit."""
        return self.csv.rpartition("_")[0] if self.units else self.csv


_DISTANCE = tuple(DISTANCE_UNITS.items())
_ANGLE = tuple(ANGLE_UNITS.items())
_FILM = tuple((unit, factor * 1000) for unit, factor in DISTANCE_UNITS.items() if unit in ("mm", "cm", "m", "in"))

FOCUS_DISTANCE = Column("focus_distance_m", "focus_distance_m", "focusDistanceM", drives=True, units=_DISTANCE)
F_STOP = Column("f_stop", "f_stop", "fStop", drives=True)
FOCAL_LENGTH = Column("focal_length_mm", "focal_length_mm", "focalLengthMm", drives=True, units=_FILM)
TILT = Column("tilt_rad", "tilt_deg", "tiltDeg", DEGREE, drives=True, units=_ANGLE)
COC_LIMIT = Column("coc_limit_mm", "coc_limit_mm", "cocLimitMm", units=_FILM)
SWING = Column("swing_rad", "swing_deg", "swingDeg", DEGREE, drives=True, units=_ANGLE)

COLUMNS = (
    FOCUS_DISTANCE,
    F_STOP,
    FOCAL_LENGTH,
    Column("near_m", "near_m", "nearM", units=_DISTANCE),
    Column("far_m", "far_m", "farM", units=_DISTANCE),
    Column("hyperfocal_m", "hyperfocal_m", "hyperfocalM", units=_DISTANCE),
    COC_LIMIT,
    TILT,
    SWING,
)
"""In the order of files."""

POINT_COLUMNS = (
    Column("depth_m", "depth_m", "depthM"),
    Column("weight", "weight", "weight"),
    Column("share", "share", "share"),
    Column("coc_mm", "coc_mm", "cocMm"),
)
"""Columns of each focus point."""
