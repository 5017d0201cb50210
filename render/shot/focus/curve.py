"""Focus curve of a camera: its focus solved over time, and the layer that carries it to other tools."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np
from pxr import Usd

from render.errors import SettingsError
from render.focus import FocusCurve, PointTrack
from render.focus.tilt import tilt_and_swing
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.optics.measured.opentrackio_lens import tracked_distortion
from render.optics.thin_lens import focal_surface, focus_w
from render.shot.focus.curve_layer import curve_layer
from render.shot.focus.focused_camera import FocusedCamera
from usd_schemas.curves import EXACT

_FOCUS_STEPS = 64
MAX_CURVE_FRAMES = 100_000
"""About an hour at 24 frames a second; more in one curve is taken as a mistake."""


def solve_curve(
    stage: Usd.Stage,
    camera_path: str,
    frames: Sequence[float],
    solve: Callable[[list[float]], list[FocusedCamera]],
    *,
    distortion: bool = False,
) -> FocusCurve:
    """Solve the focus of a camera at some frames.

    Args:
        stage: the stage.
        camera_path: of a camera.
        frames: rising USD time codes.
        solve: focuses the camera at such times.
        distortion: whether the lens's distortion is wanted at each frame, which takes a while for a lens with surfaces.

    Raises:
        SettingsError: there are no frames, too many, or they do not rise.
        CameraError: it is no camera, or has impossible values.
    """
    if not 1 <= len(frames) <= MAX_CURVE_FRAMES:
        raise SettingsError(
            f"a focus curve has from 1 to {MAX_CURVE_FRAMES} frames, but {len(frames)} were asked for",
            code="bad_frames",
        )
    times = np.array(frames, np.float64)
    if not np.all(np.isfinite(times)) or np.any(np.diff(times) <= 0):
        raise SettingsError("the frames of a focus curve must be finite and rise", code="bad_frames")
    cameras = solve(times.tolist())
    angles = np.array([lens_angles(c) for c in cameras])
    fields = [c.stated_depth_of_field for c in cameras]
    time_codes_per_second = stage.GetTimeCodesPerSecond()
    return FocusCurve(
        camera=camera_path,
        frames_per_second=stage.GetFramesPerSecond(),
        time_codes_per_second=time_codes_per_second,
        time_codes=times,
        focus_distance_m=np.array([c.camera.stated_focus_m for c in cameras]),
        f_stop=np.array([c.camera.f_stop for c in cameras]),
        focal_length_mm=np.array([c.camera.stated_focal_length_mm for c in cameras]),
        near_m=np.array([f.near_m for f in fields]),
        far_m=np.array([f.far_m for f in fields]),
        hyperfocal_m=np.array([f.hyperfocal_m for f in fields]),
        coc_limit_mm=np.array([c.coc_limit_mm for c in cameras]),
        sources=tuple(c.solution.source for c in cameras),
        reasons=tuple(c.solution.reason for c in cameras),
        points=_point_tracks(cameras),
        tilt_rad=angles[:, 0],
        swing_rad=angles[:, 1],
        limited=np.array([bool(c.solution.limit or c.note) for c in cameras]),
        lens_name=cameras[0].camera.lens.name,
        gate_mm=(cameras[0].camera.horizontal_aperture_mm, cameras[0].camera.vertical_aperture_mm),
        distortion=_distortions([c.camera for c in cameras]) if distortion else (),
    )


def _distortions(cameras: Sequence[Camera]) -> tuple[tuple[float, ...], ...]:
    """OpenTrackIO's coefficients of each camera's lens; its focus counts in `_FOCUS_STEPS` steps of the curve's nearest.

    An anamorphic lens has none, since the model is round, nor has a steep fisheye, which it cannot describe.
    """
    step_w = max(focus_w(camera) for camera in cameras) / _FOCUS_STEPS
    known: dict[tuple[object, ...], tuple[float, ...]] = {}
    found = []
    for camera in cameras:
        steps = round(focus_w(camera) / step_w) if step_w else 0
        lens = camera.lens
        kind = lens.model, lens.prescription, lens.seidel, lens.data_sheet, lens.scales, lens.squeeze, camera.f_stop > 0
        key = (*kind, camera.focal_length_mm, camera.horizontal_aperture_mm, camera.vertical_aperture_mm, steps)
        if key not in known:
            near = replace(camera, focus_distance_m=1 / (steps * step_w) if steps else math.inf)
            is_round = lens.squeeze == 1 and not lens.has_cylinders
            tracked = tracked_distortion(near) if is_round else None
            known[key] = tracked.radial if tracked is not None and tracked.holds else (0.0,)
        found.append(known[key])
    return tuple(found)


def lens_angles(focused: FocusedCamera) -> tuple[float, float]:
    """Tilt and swing in radians of a lens with this plane of focus.

    Args:
        focused: the solved camera.
    """
    plane = focal_surface(focused.camera).plane
    return (0.0, 0.0) if plane.is_upright else tilt_and_swing(plane, focused.camera.focal_length_mm)


def focus_layer(stage: Usd.Stage, curve: FocusCurve, *, baked: bool, tolerance: float = EXACT) -> str:
    """Write a layer that drives a camera by its focus curve, to be sublayered over the shot by any tool (`curve_layer`).

    Args:
        stage: the shot of the curve.
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


def _point_tracks(cameras: Sequence[FocusedCamera]) -> tuple[PointTrack, ...]:
    """The focus points over all frames; a camera has the same points at all times."""
    names = [point.name for point in cameras[0].points]
    shape = len(cameras), len(names)

    def column(values: Callable[[FocusedCamera], Iterable[float]]) -> DoubleArray:
        return np.array([list(values(c)) for c in cameras], np.float64).reshape(shape)

    set_back_m = np.array([c.camera.set_back_m for c in cameras])
    depths_m = column(lambda c: (target.depth_m for target in c.targets))
    weights = column(lambda c: (target.weight for target in c.targets))
    shares = column(lambda c: c.solution.shares)
    slopes = np.array([[target.slope for target in c.targets] for c in cameras], np.float64).reshape(*shape, 2)
    cocs_mm = np.array([c.cocs_mm(*places) for c, *places in zip(cameras, depths_m, slopes, strict=True)]).reshape(
        shape
    )
    return tuple(
        PointTrack(
            name=name,
            depth_m=depths_m[:, i] - set_back_m,
            weight=weights[:, i],
            share=shares[:, i],
            coc_mm=cocs_mm[:, i],
            states=tuple(c.solution.states[i] for c in cameras),
        )
        for i, name in enumerate(names)
    )
