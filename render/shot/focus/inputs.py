"""Settings of a camera and its focus points, read from the stage at several times, with nothing solved yet."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pxr import Usd

from render.errors import CameraError
from render.focus.points import FocusTargets
from render.focus.tilt import planes_of
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Scene
from render.optics.depth_of_field import default_coc_limit_mm
from render.optics.distortion import distort_positions
from render.optics.thin_lens import focus_w
from render.optics.view import PinholeView
from render.shot.focus.checks import NUMBERS, PointNumbers, check_settings
from render.shot.focus.visibility import visible_shares
from render.stage import AnchorReader, read_camera, stand_together
from render.trace.field_focus import field_shifts_w
from usd_schemas import FocusData, FocusPoint, FocusPointView, LensCamera, SchemaError, SplitDiopter, TiltShiftData
from usd_schemas.units import metres_per_unit

_STEEPEST_DEG = 89.0
"""The limit in the schema."""


@dataclass(frozen=True, eq=False)
class FocusInputs:
    """A camera and its k focus points at n times.

    Attributes:
        times: ``(n,)`` USD time codes, rising.
        cameras: with their own film gates, focused as authored.
        focus: focus settings of the camera.
        tilts: tilt and shift of its lens.
        diopters: its half lenses.
        throws_deg: ``(n,)`` turn of its focus ring from close focus to infinity; 0 where it is not known.
        f_stop_range: of the lens, wide open and stopped down; 0 leaves an end unbounded.
        key_times: ``(m,)`` times of the keys of its focus points, held keys aside.
        points: for each time, its focus points; a field without meaning has its default.
        numbers: their numeric fields.
        positions_m: ``(n, k, 3)`` in the world; NaN where a point has no position.
        problems: for each time, why points have no position or are left out, by name.
        visible: ``(n, k)`` share of the entrance pupil that sees each point, 0 to 1; 1 where the camera ignores occlusion.
        metres_in_a_unit: of the stage.
        seconds_in_a_code: of the stage.
    """

    times: DoubleArray
    cameras: tuple[Camera, ...]
    focus: tuple[FocusData, ...]
    tilts: tuple[TiltShiftData, ...]
    diopters: tuple[SplitDiopter, ...]
    throws_deg: DoubleArray
    f_stop_range: tuple[float, float]
    key_times: DoubleArray
    points: tuple[tuple[FocusPoint, ...], ...]
    numbers: PointNumbers
    positions_m: DoubleArray
    problems: tuple[dict[str, str], ...]
    visible: DoubleArray
    metres_in_a_unit: float
    seconds_in_a_code: float

    @property
    def seconds(self) -> DoubleArray:
        """``(n,)`` the times in seconds; 0 for the default time, which has no others beside it."""
        return np.nan_to_num(self.times) * self.seconds_in_a_code

    @property
    def key_seconds(self) -> DoubleArray:
        """``(m,)`` the keys' times in seconds."""
        return self.key_times * self.seconds_in_a_code

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the k points, the same at all times."""
        return tuple(point.name for point in self.points[0])

    @property
    def camera_w(self) -> DoubleArray:
        """``(n,)`` inverse focus distance of the camera itself, 1/m."""
        return np.array([focus_w(camera) for camera in self.cameras])

    @property
    def camera_f_stops(self) -> DoubleArray:
        """``(n,)`` f-number of the camera itself."""
        return np.array([camera.f_stop for camera in self.cameras])

    @property
    def tilt_gradients(self) -> DoubleArray:
        """``(n, 2)`` change of w with the slope to the right and up, of the lens at its authored tilt and swing."""
        tilts = np.radians([[tilt.tilt_deg, tilt.swing_deg] for tilt in self.tilts])
        focal_mm = np.array([camera.focal_length_mm for camera in self.cameras])
        return planes_of(tilts[:, 0], tilts[:, 1], math.inf, focal_mm)[:, 1:]

    @property
    def is_smoothed(self) -> bool:
        """True where points fade in and out."""
        return any(focus.smoothing_s > 0 for focus in self.focus)

    def setting(self, name: str) -> DoubleArray:
        """``(n,)`` a number of the focus settings, by its field of `FocusData`."""
        return np.array([getattr(focus, name) for focus in self.focus], np.float64)

    @cached_property
    def unshifted_targets(self) -> FocusTargets:
        """The points in the lens's terms, for a lens without curvature of field, which takes long to trace.

        A point at fault has no position, and default numbers where its own have no meaning.
        """
        projected = [
            project_points(camera, positions) for camera, positions in zip(self.cameras, self.positions_m, strict=True)
        ]
        return FocusTargets.from_columns(
            self.names,
            np.array([p.depths_m for p in projected]),
            kinds=[point.kind for point in self.points[0]],
            slopes=np.array([p.slopes for p in projected]),
            enabled=np.array([[point.enabled for point in points] for points in self.points], np.bool_),
            in_frame=np.array([p.inside for p in projected]),
            visible=self.visible,
            frame_widths=np.array([c.horizontal_aperture_mm / c.focal_length_mm for c in self.cameras]),
            **self.numbers.columns,
        )

    @cached_property
    def targets(self) -> FocusTargets:
        """`unshifted_targets` with the shifts of the lens's curvature of field."""
        targets = self.unshifted_targets
        # for a lens focused on the point: the shift changes little between there and the solved focus
        shifts = map(field_shifts_w, self.cameras, targets.slopes, targets.aims_w)
        return replace(targets, field_shifts_w=np.array(list(shifts)).reshape(targets.depths_m.shape))


def coc_limit_mm(camera: Camera, focus: FocusData) -> float:
    """Largest diameter of a circle of confusion on the film that counts as sharp."""
    if focus.circle_of_confusion_mm > 0:
        return focus.circle_of_confusion_mm
    return default_coc_limit_mm(camera.horizontal_aperture_mm, camera.vertical_aperture_mm)


def read_focus_inputs(
    stage: Usd.Stage,
    anchors: AnchorReader,
    camera_path: str,
    times: Sequence[float],
    scene_at: Callable[[float, str], Scene],
) -> FocusInputs:
    """Read a camera and its focus points at several times.

    Args:
        stage: the stage.
        anchors: finds focus points on that stage.
        camera_path: of a camera.
        times: rising USD time codes.
        scene_at: the scene at a time as a camera has it drawn; called only where hidden points count for less.

    Raises:
        CameraError: it is no camera, or has impossible values.
    """
    cameras = stand_together([read_camera(stage, camera_path, time) for time in times])
    try:
        lens_camera = LensCamera(stage.GetPrimAtPath(camera_path))
        focus = lens_camera.focus.read_over(times)
        tilts = lens_camera.tilt_shift.read_over(times)
        lenses = lens_camera.lens.read_over(times)
        views = lens_camera.focus_points()
        over_time = [view.read_over(times) for view in views]
        points = tuple(tuple(point[i] for point in over_time) for i in range(len(times)))
    except SchemaError as error:
        raise CameraError(str(error), path=camera_path) from error
    for tilt in tilts:
        _check_angles(tilt, camera_path)
    check_settings(lens_camera.prim, focus)
    metres = metres_per_unit(stage)
    placed, numbers = anchors.read_anchors(points, list(times)), PointNumbers.from_points(points, metres)
    positions_m = placed.positions_m.copy()
    for i, faults in enumerate(numbers.faults):
        positions_m[i, [point.name in faults for point in points[i]]] = np.nan
    return FocusInputs(
        times=np.array(times, np.float64),
        cameras=cameras,
        focus=focus,
        tilts=tilts,
        diopters=tuple(lens.split_diopter for lens in lenses),
        throws_deg=np.array([lens.focus_throw for lens in lenses], np.float64),
        f_stop_range=lenses[0].f_stop_range,
        key_times=_key_times(views),
        points=numbers.points,
        numbers=numbers,
        positions_m=positions_m,
        problems=tuple(lost | faults for lost, faults in zip(placed.problems, numbers.faults, strict=True)),
        visible=_visible_shares(cameras, focus, positions_m, times, scene_at),
        metres_in_a_unit=metres,
        seconds_in_a_code=1 / stage.GetTimeCodesPerSecond(),
    )


def _check_angles(tilt: TiltShiftData, camera_path: str) -> None:
    """Raise `CameraError` where an angle is too steep: at a right angle to the film a lens has no plane of focus."""
    angles = {"tilt": (tilt.tilt_deg, -1), "swing": (tilt.swing_deg, -1), "maxAngle": (tilt.max_angle_deg, 0)}
    for name, (angle, sign) in angles.items():
        least = sign * _STEEPEST_DEG
        if not least <= angle <= _STEEPEST_DEG:
            what = f"from {least:g} to {_STEEPEST_DEG:g} degrees, got {angle:g}"
            raise CameraError(f"tiltShift:{name} of camera {camera_path} must be {what}", path=camera_path)


def _key_times(views: Sequence[FocusPointView]) -> DoubleArray:
    keys = [key for view in views for attribute in NUMBERS for key in view.keys(attribute)]
    return np.array(sorted({key.time for key in keys if key.interpolation != "held"}), np.float64)


def _visible_shares(
    cameras: tuple[Camera, ...],
    focus: tuple[FocusData, ...],
    positions_m: DoubleArray,
    times: Sequence[float],
    scene_at: Callable[[float, str], Scene],
) -> DoubleArray:
    """``(n, k)`` share of the entrance pupil that sees each point; 1 where the camera ignores occlusion."""
    shares = np.ones(positions_m.shape[:2])
    for i, time in enumerate(times):
        if focus[i].occluded != "keep" and np.isfinite(positions_m[i]).any():
            shares[i] = visible_shares(scene_at(time, cameras[i].path), cameras[i], positions_m[i])
    return shares


@dataclass(frozen=True, eq=False)
class ProjectedPoints:
    """World points projected into a camera's picture.

    Attributes:
        screens: ``(k, 2)`` positions from (0, 0) top left to (1, 1) bottom right; NaN behind the camera.
        depths_m: ``(k,)`` along the view axis.
        slopes: ``(k, 2)`` in object space from the entrance pupil, x right and y up; NaN behind the camera.
        inside: ``(k,)`` whether they lie inside the picture and the clipping range.
    """

    screens: DoubleArray
    depths_m: DoubleArray
    slopes: DoubleArray
    inside: NDArray[np.bool_]


def project_points(camera: Camera, positions_m: DoubleArray) -> ProjectedPoints:
    """Project world points into a camera's picture.

    Args:
        camera: its gate is the picture.
        positions_m: ``(k, 3)`` in the world; NaN for none.
    """
    view = PinholeView.from_camera(camera, 1, 1)  # a picture of 1 × 1 pixels
    straight, depths_m = view.project(positions_m)
    screens = distort_positions(view, camera, straight)
    with np.errstate(invalid="ignore"):
        inside = np.all((screens >= 0) & (screens <= 1), axis=-1)
        inside &= (depths_m >= camera.near_m) & (depths_m <= camera.far_m)
    slopes = (straight - [view.cx, view.cy]) / [view.fx, -view.fy]
    return ProjectedPoints(screens, depths_m, slopes, inside)
