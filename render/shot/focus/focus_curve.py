"""The focus curve of a camera: the solved focus over time, and the layer that carries it to other tools."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from pxr import Usd

from render.errors import SettingsError
from render.focus import FocusCurve, PointTrack
from render.focus.tilt import tilt_and_swing
from render.model.arrays import DoubleArray
from render.optics.thin_lens import focal_surface
from render.shot.focus.curve_layer import curve_layer
from render.shot.focus.focused import Focused
from usd_schemas.curves import EXACT

MAX_CURVE_FRAMES = 100_000
"""About an hour at 24 frames a second: more than that in one curve is a slip of the hand."""


def solve_curve(
    stage: Usd.Stage, camera_path: str, frames: Sequence[float], focus_over: Callable[[list[float]], list[Focused]]
) -> FocusCurve:
    """The lens of a camera over some frames, its focus solved at each.

    Args:
        stage: the stage.
        camera_path: of a camera.
        frames: rising USD time codes.
        focus_over: focuses the camera at such times.

    Raises:
        SettingsError: there are no frames, too many, or they do not rise.
        CameraError: it is no camera, or has impossible numbers.
    """
    if not 1 <= len(frames) <= MAX_CURVE_FRAMES:
        raise SettingsError(
            f"a focus curve has from 1 to {MAX_CURVE_FRAMES} frames, but {len(frames)} were asked for",
            code="bad_frames",
        )
    times = np.array(frames, np.float64)
    if not np.all(np.isfinite(times)) or np.any(np.diff(times) <= 0):
        raise SettingsError("the frames of a focus curve must be finite and rise", code="bad_frames")
    solved = focus_over(times.tolist())
    angles = np.array([lens_angles(s) for s in solved])
    fields = [s.depth_of_field for s in solved]
    time_codes_per_second = stage.GetTimeCodesPerSecond()
    return FocusCurve(
        camera=camera_path,
        frames_per_second=stage.GetFramesPerSecond(),
        time_codes_per_second=time_codes_per_second,
        time_codes=times,
        focus_distance_m=np.array([s.camera.focus_distance_m for s in solved]),
        f_stop=np.array([s.camera.f_stop for s in solved]),
        focal_length_mm=np.array([s.camera.focal_length_mm for s in solved]),
        near_m=np.array([f.near_m for f in fields]),
        far_m=np.array([f.far_m for f in fields]),
        hyperfocal_m=np.array([f.hyperfocal_m for f in fields]),
        coc_limit_mm=np.array([s.coc_limit_mm for s in solved]),
        sources=tuple(s.solution.source for s in solved),
        reasons=tuple(s.solution.reason for s in solved),
        points=_tracks(solved),
        tilt_rad=angles[:, 0],
        swing_rad=angles[:, 1],
        limited=np.array([bool(s.solution.limit or s.note) for s in solved]),
        lens_name=solved[0].camera.lens.name,
        gate_mm=(solved[0].camera.horizontal_aperture_mm, solved[0].camera.vertical_aperture_mm),
    )


def lens_angles(focused: Focused) -> tuple[float, float]:
    """Tilt and swing in radians of the lens that has the plane of focus.

    Args:
        focused: the solved camera.
    """
    plane = focal_surface(focused.camera).plane
    return (0.0, 0.0) if plane.is_upright else tilt_and_swing(plane, focused.camera.focal_length_mm)


def focus_layer(stage: Usd.Stage, curve: FocusCurve, *, baked: bool, tolerance: float = EXACT) -> str:
    """A layer that gives the camera all that drives it, to be sublayered over the shot by any tool (`curve_layer`).

    Args:
        stage: the stage that the curve is of.
        curve: the curve.
        baked: time samples, for tools that read no splines, in place of native splines.
        tolerance: how far a spline may be off, relative to the value; more makes fewer knots.

    Returns:
        usda text.

    Raises:
        SettingsError: the tolerance is no share, or a value is beyond what its attribute allows.
    """
    comment = f"Focus of {curve.camera}, solved by Pullfocus: sublayer this over the shot."
    return curve_layer(stage, curve.camera, curve, baked=baked, comment=comment, tolerance=tolerance)


def _tracks(solved: Sequence[Focused]) -> tuple[PointTrack, ...]:
    """The focus points through all frames; which points there are does not change over time."""
    names = [point.name for point in solved[0].points]
    shape = len(solved), len(names)

    def column(values: Callable[[Focused], Iterable[float]]) -> DoubleArray:
        return np.array([list(values(s)) for s in solved], np.float64).reshape(shape)

    depths_m = column(lambda s: (target.depth_m for target in s.targets))
    weights = column(lambda s: (target.weight for target in s.targets))
    shares = column(lambda s: s.solution.shares)
    slopes = np.array([[target.slope for target in s.targets] for s in solved], np.float64).reshape(*shape, 2)
    cocs_mm = np.array([s.cocs_mm(*places) for s, *places in zip(solved, depths_m, slopes, strict=True)]).reshape(shape)
    return tuple(
        PointTrack(
            name=name,
            depth_m=depths_m[:, i],
            weight=weights[:, i],
            share=shares[:, i],
            coc_mm=cocs_mm[:, i],
            states=tuple(s.solution.states[i] for s in solved),
        )
        for i, name in enumerate(names)
    )
