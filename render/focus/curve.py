"""Focus curves: the lens over time, and the points that decide its focus."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from render.errors import SettingsError
from render.focus.solve import PointState
from render.model.arrays import DoubleArray

LENS_COLUMNS = ("focus_distance_m", "f_stop", "focal_length_mm", "near_m", "far_m", "hyperfocal_m", "coc_limit_mm")
"""Columns of numbers that every curve has, in the order of files."""

FAR_AWAY_M = 1e5
"""Finite focus distance written for infinity where a file or a spline needs a finite one.

At 100 km, a 300 mm lens at f/2 makes a circle of confusion of half a micron of a star.
"""

ANGLE_COLUMNS = ("tilt_rad", "swing_rad")
"""Columns of angles; 0 where they are not given."""


@dataclass(frozen=True, eq=False)
class PointTrack:
    """One focus point over the frames of a curve.

    Attributes:
        name: the focus point's name.
        depth_m: ``(n,)`` depth along the view axis, negative behind the camera, NaN without a position.
        weight: ``(n,)`` weight, authored or keyed.
        share: ``(n,)`` share of the weights that decided the focus, 0 to 1.
        coc_mm: ``(n,)`` diameter of its circle of confusion on the film; NaN where it is not in front of the camera.
        states: state at each frame: counted, or the reason why not.
    """

    name: str
    depth_m: DoubleArray
    weight: DoubleArray
    share: DoubleArray
    coc_mm: DoubleArray
    states: tuple[PointState, ...]


@dataclass(frozen=True, eq=False)
class FocusCurve:
    """The lens, frame by frame.

    A curve read from a file holds NaN for missing values: `render.focus.files.ReadCurve` names the columns that the file gives.

    Attributes:
        camera: prim path of the camera, empty for a camera that is no prim.
        frames_per_second: frame rate of the shot.
        time_codes_per_second: time codes per second; a time code is ``frame · time_codes_per_second / frames_per_second``.
        time_codes: ``(n,)`` USD time codes, rising.
        focus_distance_m: ``(n,)`` depth of the plane of focus; may be infinite.
        f_stop: ``(n,)`` f-number; 0 is a pinhole.
        focal_length_mm: ``(n,)``.
        near_m: ``(n,)`` near limit of depth of field.
        far_m: ``(n,)`` far limit; may be infinite.
        hyperfocal_m: ``(n,)``.
        coc_limit_mm: ``(n,)`` largest circle of confusion, as a diameter on the film, that counts as sharp.
        sources: for each frame, whether ``points`` decided or the ``camera``'s own focus distance was kept.
        reasons: for each frame, the reason in one sentence.
        points: the focus points.
        tilt_rad: ``(n,)`` turn of the lens about the axis to the right; positive looks up. All 0 when left out.
        swing_rad: ``(n,)`` turn about the axis up, before the tilt; positive looks left. All 0 when left out.
        limited: ``(n,)`` whether the lens missed the requested focus: its close focus, its infinity, its speed or its largest
            angle held it back. All False when left out.
        lens_name: name engraved on the lens, or empty.
        gate_mm: width and height of the film gate, where it is known.
        distortion: for each frame k1 to k5 of the lens (`render.optics.measured.opentrackio_lens`), all 0 for a lens without
            distortion; empty where it is not known.
    """

    camera: str
    frames_per_second: float
    time_codes_per_second: float
    time_codes: DoubleArray
    focus_distance_m: DoubleArray
    f_stop: DoubleArray
    focal_length_mm: DoubleArray
    near_m: DoubleArray
    far_m: DoubleArray
    hyperfocal_m: DoubleArray
    coc_limit_mm: DoubleArray
    sources: tuple[Literal["points", "camera"], ...]
    reasons: tuple[str, ...]
    points: tuple[PointTrack, ...] = ()
    tilt_rad: DoubleArray = field(default_factory=lambda: np.zeros(0))
    swing_rad: DoubleArray = field(default_factory=lambda: np.zeros(0))
    limited: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, np.bool_))
    lens_name: str = ""
    gate_mm: tuple[float, float] | None = None
    distortion: tuple[tuple[float, ...], ...] = ()

    def __post_init__(self) -> None:
        """Fill the columns that were left out, and check that all have one length and that time rises.

        Raises:
            SettingsError: they do not.
        """
        count = len(self.time_codes)
        for name in (*ANGLE_COLUMNS, "limited"):
            if len(getattr(self, name)) == 0:
                object.__setattr__(self, name, np.zeros(count, getattr(self, name).dtype))
        columns = [getattr(self, name) for name in (*LENS_COLUMNS, *ANGLE_COLUMNS, "limited")]
        columns += [column for p in self.points for column in (p.depth_m, p.weight, p.share, p.coc_mm, p.states)]
        columns += [self.sources, self.reasons, *([self.distortion] if self.distortion else [])]
        if any(len(column) != count for column in columns):
            raise SettingsError(f"every column of a focus curve must have its {count} frames", code="bad_curve")
        if not np.all(np.isfinite(self.time_codes)) or np.any(np.diff(self.time_codes) <= 0):
            raise SettingsError("the time codes of a focus curve must be finite and rise", code="bad_curve")

    @property
    def frames(self) -> DoubleArray:
        """``(n,)`` frame numbers: time codes in frames."""
        return self.time_codes * (self.frames_per_second / self.time_codes_per_second)

    @property
    def seconds(self) -> DoubleArray:
        """``(n,)`` time codes in seconds."""
        return self.time_codes / self.time_codes_per_second

    def sharp_points(self, index: int) -> tuple[str, ...]:
        """Names of the focus points whose circle of confusion is within the limit at one frame.

        Args:
            index: of the frame in the columns.
        """
        limit_mm = self.coc_limit_mm[index]
        return tuple(point.name for point in self.points if point.coc_mm[index] <= limit_mm)
