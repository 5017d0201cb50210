"""A focus curve: what the lens does over time, and for whom."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from render.errors import SettingsError
from render.focus.solve import PointState

DoubleArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PointTrack:
    """One focus point over the frames of a curve.

    Attributes:
        name: the focus point's name.
        depth_m: ``(n,)`` along the view axis, negative behind the camera, NaN where it has no place.
        weight: ``(n,)`` as authored or keyed.
        share: ``(n,)`` of the weight that decided the focus, 0 to 1.
        coc_mm: ``(n,)`` diameter of its circle of confusion on the film; NaN where it is not in front of the camera.
        states: for each frame, whether it counted or why not.
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

    Attributes:
        camera: prim path of the camera, empty for a camera that is no prim.
        frames_per_second: of the shot.
        time_codes_per_second: of the stage; a time code is ``frame · time_codes_per_second / frames_per_second``.
        time_codes: ``(n,)`` the asked USD time codes, rising.
        focus_distance_m: ``(n,)`` depth of the plane of focus; may be infinite.
        f_stop: ``(n,)`` f-number; 0 is a pinhole.
        focal_length_mm: ``(n,)``.
        near_m: ``(n,)`` near limit of depth of field.
        far_m: ``(n,)`` far limit; may be infinite.
        hyperfocal_m: ``(n,)``.
        coc_limit_mm: ``(n,)`` largest circle of confusion, as a diameter on the film, that counts as sharp.
        sources: for each frame, whether ``points`` decided or the ``camera``'s own focus distance was kept.
        reasons: for each frame, one sentence that says why.
        points: the focus points.
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

    def __post_init__(self) -> None:
        """Check that all columns have one length and that time rises.

        Raises:
            SettingsError: they do not.
        """
        count = len(self.time_codes)
        columns = [getattr(self, name) for name in LENS_COLUMNS]
        columns += [column for p in self.points for column in (p.depth_m, p.weight, p.share, p.coc_mm, p.states)]
        columns += [self.sources, self.reasons]
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


LENS_COLUMNS = ("focus_distance_m", "f_stop", "focal_length_mm", "near_m", "far_m", "hyperfocal_m", "coc_limit_mm")
