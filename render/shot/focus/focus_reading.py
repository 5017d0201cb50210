"""What a camera and its focus points say over time, with nothing solved yet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pxr import Usd

from render.errors import CameraError
from render.focus.points import FocusTargets
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Scene
from render.optics.distortion import shown_at
from render.optics.view import PinholeView
from render.shot.focus.focus_checks import NUMBERS, PointNumbers, check_settings
from render.shot.focus.visibility import visible
from render.stage import AnchorReader, read_camera
from render.trace.field_focus import field_shifts_w
from usd_schemas import FocusData, FocusPoint, FocusPointView, LensCamera, SchemaError, SplitDiopter, TiltShiftData
from usd_schemas.units import metres_per_unit

_STEEPEST_DEG = 89.0  # as the schema has it


@dataclass(frozen=True, eq=False)
class FocusReading:
    """A camera and its k focus points at n times.

    Attributes:
        times: ``(n,)`` USD time codes, rising.
        cameras: with their own film gates, focused as authored.
        focus: what the camera asks of the focus.
        tilts: how its lens is tilted.
        diopters: its half lenses.
        throws_deg: ``(n,)`` turn of its focus ring from close focus to infinity; 0 where it is not known.
        f_stop_range: of the lens, wide open and stopped down; 0 leaves an end unbounded.
        key_times: ``(m,)`` times of the keys of its focus points that say a value and do not hold it.
        points: for each time, its focus points, without what has no meaning.
        numbers: what they say in numbers.
        positions_m: ``(n, k, 3)`` where they stand in the world; NaN where a point has no place.
        problems: for each time, why points have no place or are left out, by name.
        visible: ``(n, k)`` how much of each is seen, 1 where nobody asks; NaN never.
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
        """``(n,)`` the times in seconds."""
        return self.times * self.seconds_in_a_code

    @property
    def key_seconds(self) -> DoubleArray:
        """``(m,)`` the keys' times in seconds."""
        return self.key_times * self.seconds_in_a_code

    @property
    def names(self) -> tuple[str, ...]:
        """Of the k points; which there are does not change over time."""
        return tuple(point.name for point in self.points[0])

    @cached_property
    def targets(self) -> FocusTargets:
        """The points as the lens sees them; those that are at fault have no place, and the numbers of a new point."""
        seen = [see(camera, places) for camera, places in zip(self.cameras, self.positions_m, strict=True)]
        targets = FocusTargets.of(
            self.names,
            np.array([s.depths_m for s in seen]),
            kinds=[point.kind for point in self.points[0]],
            slopes=np.array([s.slopes for s in seen]),
            enabled=np.array([[point.enabled for point in points] for points in self.points], np.bool_),
            in_frame=np.array([s.inside for s in seen]),
            visible=self.visible,
            frame_widths=np.array([c.horizontal_aperture_mm / c.focal_length_mm for c in self.cameras]),
            **self.numbers.columns,
        )
        # as of a lens that is focused on the point: it changes little from there to where the lens will be focused
        shifts = map(field_shifts_w, self.cameras, targets.slopes, targets.aims_w)
        return replace(targets, field_shifts_w=np.array(list(shifts)).reshape(targets.depths_m.shape))


def read_focus(
    stage: Usd.Stage,
    anchors: AnchorReader,
    camera_path: str,
    times: Sequence[float],
    scene_at: Callable[[float], Scene],
) -> FocusReading:
    """Read a camera and its focus points.

    Args:
        stage: the stage.
        anchors: finds focus points on that stage.
        camera_path: of a camera.
        times: rising USD time codes.
        scene_at: what is drawn at a time; asked only where hidden points count for less.

    Raises:
        CameraError: it is no camera, or has impossible numbers.
    """
    cameras = tuple(read_camera(stage, camera_path, time) for time in times)
    try:
        lens_camera = LensCamera(stage.GetPrimAtPath(camera_path))
        focus = lens_camera.focus.read_over(times)
        tilts = lens_camera.tilt_shift.read_over(times)
        lenses = lens_camera.lens.read_over(times)
        views = lens_camera.focus_points()
        of_points = [view.read_over(times) for view in views]
        points = tuple(tuple(over_times[i] for over_times in of_points) for i in range(len(times)))
    except SchemaError as error:
        raise CameraError(str(error), path=camera_path) from error
    for tilt in tilts:
        _check_angles(tilt, camera_path)
    check_settings(lens_camera.prim, focus)
    metres = metres_per_unit(stage)
    placed, numbers = anchors.anchored(points, list(times)), PointNumbers.of(points, metres)
    positions_m = placed.positions_m.copy()
    for i, told in enumerate(numbers.faults):
        positions_m[i, [point.name in told for point in points[i]]] = np.nan
    return FocusReading(
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
        problems=tuple(lost | told for lost, told in zip(placed.problems, numbers.faults, strict=True)),
        visible=_visible(cameras, focus, positions_m, times, scene_at),
        metres_in_a_unit=metres,
        seconds_in_a_code=1 / stage.GetTimeCodesPerSecond(),
    )


def _check_angles(tilt: TiltShiftData, camera_path: str) -> None:
    """Raise `CameraError` where no lens turns so far: at a right angle to the film it has no plane of focus."""
    angles = {"tilt": (tilt.tilt, -1), "swing": (tilt.swing, -1), "maxAngle": (tilt.max_angle, 0)}
    for name, (angle, sign) in angles.items():
        least = sign * _STEEPEST_DEG
        if not least <= angle <= _STEEPEST_DEG:
            what = f"from {least:g} to {_STEEPEST_DEG:g} degrees, got {angle:g}"
            raise CameraError(f"tiltShift:{name} of camera {camera_path} must be {what}", path=camera_path)


def _key_times(views: Sequence[FocusPointView]) -> DoubleArray:
    keys = [key for view in views for attribute in NUMBERS for key in view.keys(attribute)]
    return np.unique([key.time for key in keys if key.interpolation != "held"]).astype(np.float64)


def _visible(
    cameras: tuple[Camera, ...],
    focus: tuple[FocusData, ...],
    positions_m: DoubleArray,
    times: Sequence[float],
    scene_at: Callable[[float], Scene],
) -> DoubleArray:
    """``(n, k)`` how much of each point is seen; 1 where the camera does not ask."""
    seen = np.ones(positions_m.shape[:2])
    for i, time in enumerate(times):
        if focus[i].occluded != "keep" and np.isfinite(positions_m[i]).any():
            seen[i] = visible(scene_at(time), cameras[i], positions_m[i])
    return seen


@dataclass(frozen=True, eq=False)
class Seen:
    """World points in a camera's picture, of whatever size.

    Attributes:
        screens: ``(k, 2)`` places from (0, 0) top left to (1, 1) bottom right; NaN behind the camera.
        depths_m: ``(k,)`` along the view axis.
        slopes: ``(k, 2)`` of object space from the entrance pupil, x right and y up; NaN behind the camera.
        inside: ``(k,)`` whether they lie inside the picture and the clipping range.
    """

    screens: DoubleArray
    depths_m: DoubleArray
    slopes: DoubleArray
    inside: NDArray[np.bool_]


def see(camera: Camera, positions_m: DoubleArray) -> Seen:
    """Where world points stand in a camera's picture.

    Args:
        camera: its gate is the picture.
        positions_m: ``(k, 3)`` in the world; NaN for none.
    """
    view = PinholeView.from_camera(camera, 1, 1)  # a picture of 1 × 1
    straight, depths_m = view.project(positions_m)
    screens = shown_at(view, camera, straight)
    with np.errstate(invalid="ignore"):
        inside = np.all((screens >= 0) & (screens <= 1), axis=-1)
        inside &= (depths_m >= camera.near_m) & (depths_m <= camera.far_m)
    slopes = (straight - [view.cx, view.cy]) / [view.fx, -view.fy]
    return Seen(screens, depths_m, slopes, inside)
