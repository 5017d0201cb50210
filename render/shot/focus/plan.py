"""The set from above: a camera's frame and the cut through what it holds sharp, the paths of its focus points, and their moves.

The plan is the plane of the camera's right vector and its optical axis, so that a place in it is a distance to the right and a
depth, and depths in it are those of every readout, whichever way the camera is pitched or rolled. Heights are dropped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from render.errors import CameraError, NotFoundError, SettingsError
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.optics.distortion import undistort_position
from render.optics.view import PinholeView
from render.shot.camera.lookup import CameraLookup
from render.shot.camera.placing import CameraPlace, place_camera
from render.shot.camera.subject_framing import USUAL_SHARE, PictureField, Subject, depth_pupil, framing_pupil
from render.shot.edits.edit_layer import Edits
from render.shot.focus.focused_camera import FocusedCamera
from render.shot.focus.shot_focus import ShotFocus
from render.shot.focus.solver import FocusSolver
from render.shot.times import check_time
from render.stage import AnchorReader, read_camera, stand_together
from usd_schemas import FocusPoint, LensCamera, SchemaError

CUT_PLACES = 33
"""Places of the picture's width at which the cut is read, the view axis aside."""

_FARTHEST_OFFSET = 1e9
"""Largest offset of a focus point from its anchor, in scene units."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A camera from above, at one time.

    Attributes:
        camera: prim path; empty for a camera that is no prim.
        position_m: ``(3,)`` its origin in the world.
        right: ``(3,)`` unit vector to the right of its picture, in the world.
        ahead: ``(3,)`` unit vector of its optical axis, in the world.
        set_back_m: distance of its pupil behind its origin; 0 but for an orthographic camera.
        gate_mm: width of its film gate.
        slopes: ``(k,)`` rising, from the pupil: metres to the right for each metre of depth. The first and the last are the edges
            of the picture, and the view axis is among them.
        w: ``(k, 3)`` inverse depths from the pupil at these slopes, 1/m: of the near limit of sharpness, of the focus, and of the
            far limit. 0 is infinity, and below 0 there is none in front of the camera; infinite for a pinhole's limits.
        axis_w: ``(3,)`` the same on the view axis.
    """

    camera: str
    position_m: DoubleArray
    right: DoubleArray
    ahead: DoubleArray
    set_back_m: float
    gate_mm: float
    slopes: DoubleArray
    w: DoubleArray
    axis_w: DoubleArray


@dataclass(frozen=True, eq=False)
class Paths:
    """Ways of a camera and its k focus points over n times.

    Attributes:
        camera_m: ``(n, 3)`` origin of the camera in the world.
        names: names of the focus points.
        points_m: ``(n, k, 3)`` their places in the world; NaN where a point has none.
    """

    camera_m: DoubleArray
    names: tuple[str, ...]
    points_m: DoubleArray


class ShotPlan:
    """Cameras of a shot from above.

    Args:
        stage: the shot.
        edits: where edits go.
        cameras: finds cameras by path.
        anchors: finds the positions of focus points on the stage.
        solver: solves the focus.
        focus: edits focus points.
    """

    def __init__(
        self,
        stage: Usd.Stage,
        edits: Edits,
        cameras: CameraLookup,
        anchors: AnchorReader,
        solver: FocusSolver,
        focus: ShotFocus,
    ) -> None:
        self._stage = stage
        self._edits = edits
        self._cameras = cameras
        self._anchors = anchors
        self._solver = solver
        self._focus = focus

    def read(self, camera_path: str | None, time: float) -> Plan:
        """Read the plan of a camera with its own film gate.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        return _plan(self._solver.solve(camera_path, time))

    def paths(self, camera_path: str | None, times: Sequence[float]) -> Paths:
        """Read where a camera and its focus points are over some times.

        Args:
            camera_path: of a camera.
            times: rising USD time codes, at least one.
        """
        choice = self._cameras.default(times[0]) if camera_path is None else None
        if choice is not None and choice.framing is not None:
            still = np.tile(_origin(choice.framing.world_from_camera, choice.framing.set_back_m), (len(times), 1))
            return Paths(still, (), np.empty((len(times), 0, 3)))
        path = self._cameras.path(camera_path)
        cameras = stand_together([read_camera(self._stage, path, time) for time in times])
        try:
            over = [view.read_over(times) for view in LensCamera(self._stage.GetPrimAtPath(path)).focus_points()]
        except SchemaError as error:
            raise CameraError(str(error), path=path) from error
        points = [[point[i] for point in over] for i in range(len(times))]
        return Paths(
            camera_m=np.array([_origin(camera.world_from_camera, camera.set_back_m) for camera in cameras]),
            names=tuple(point.name for point in points[0]),
            points_m=self._anchors.read_anchors(points, list(times)).positions_m,
        )

    def move_point(
        self, camera_path: str | None, name: str, time: float, position_m: tuple[float, float, float]
    ) -> FocusPoint:
        """Move a focus point to a place in the world, by its offset from what it is attached to, which it goes on to follow.

        Args:
            camera_path: of a camera.
            name: of the focus point.
            time: USD time code at which it is there.
            position_m: where to, metres, +Y up.

        Returns:
            The point as it is afterwards, at the time.

        Raises:
            NotFoundError: the camera has no such point, or the point has no place at the time.
            SettingsError: the place is not finite, or out of reach.
            StageError: a transform is not finite, or flattens space.
        """
        time = check_time(time)
        if not all(map(math.isfinite, position_m)):
            raise SettingsError(f"a focus point moves to three finite numbers, got {position_m}", code="bad_place")
        point = self._cameras.editable_point(camera_path, name).read(time)
        try:
            offset = self._anchors.offset_to(point, np.array(position_m, np.float64), time)
        except NotFoundError as error:
            raise NotFoundError(error.detail, code="no_place", path=name) from error
        if not (np.abs(offset) <= _FARTHEST_OFFSET).all():
            raise SettingsError(f"focus point {name} cannot be moved that far", code="bad_place", path=name)
        x, y, z = offset.tolist()
        with self._edits.transaction(f"move focus point {name}"):
            return self._focus.update_point(camera_path, name, time=time, offset=(x, y, z))

    def frame_subject(
        self,
        camera_path: str | None,
        name: str,
        time: float,
        *,
        is_keyed: bool = False,
        share: float = USUAL_SHARE,
        aspect: float | None = None,
    ) -> None:
        """Move a camera, so that the subject of a focus point fills a share of its picture.

        The subject (`render.shot.camera.subject_framing`) is what the point follows: the bounds of its part, or of the prim that
        it is on; else its place alone. A camera keeps its direction, and an orthographic one its depth too. The picture's field
        is that of the focus before the move: where the focus follows the subject, a lens that breathes fills a little more or
        less.

        Args:
            camera_path: of a camera.
            name: of the focus point.
            time: USD time code.
            is_keyed: whether the camera gets a key there; else all of its way is moved along.
            share: of the picture's width or height, above 0 and below 1.
            aspect: width over height of the picture; None for the film gate's.

        Raises:
            CameraError: there is no such camera, it lies in an instance, or cannot be placed.
            NotFoundError: the camera has no such point, or the point has no place at the time.
            SettingsError: the share is out of range, or the place out of reach.
            StageError: a transform is not finite, or the subject has too many shapes.
        """
        if not 0 < share < 1:
            raise SettingsError(
                f"a subject fills a share of the picture above 0 and below 1, got {share:g}", path="share"
            )
        prim = self._cameras.editable(camera_path).prim
        point = self._cameras.editable_point(camera_path, name).read(check_time(time))
        camera = self._solver.fit_to_picture(self._solver.solve(camera_path, time), time, aspect)
        frame = np.asarray(camera.world_from_camera, np.float64)
        axes, field, subject = frame[:3, :3].T * [[1], [1], [-1]], _field(camera), self._subject(point, time)
        if camera.orthographic is None:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # the place is checked
                pupil = framing_pupil(subject, axes, field, share)
        else:
            pupil = depth_pupil(subject.middle_m, axes, field, float((subject.middle_m - frame[:3, 3]) @ axes[2]))
        x, y, z = (pupil + camera.set_back_m * axes[2]).tolist()
        _, up, ahead = (tuple(axis) for axis in axes.tolist())
        with self._edits.transaction(f"frame {name}"):
            place_camera(UsdGeom.Camera(prim), CameraPlace((x, y, z), ahead, up), time, is_keyed=is_keyed)

    def _subject(self, point: FocusPoint, time: float) -> Subject:
        """Read what a focus point follows: its place alone where that has no bounds. Raises as `frame_subject`."""
        try:
            subject = Subject(*self._anchors.extent(point, time))
        except NotFoundError:  # without bounds, or without a place
            subject = None
        if subject is not None and np.isfinite([*subject.halves_m, subject.middle_m]).all() and subject.has_size:
            return subject
        try:
            return Subject(self._anchors.position(point, time), np.zeros((3, 3)))
        except NotFoundError as error:
            raise NotFoundError(error.detail, code="no_place", path=point.name) from error


def _field(camera: Camera) -> PictureField:
    """Edges of the picture of a camera, where its lens images them."""
    view = PinholeView.from_camera(camera, 1, 1)
    left, right = (undistort_position(view, camera, x, view.cy)[0] for x in (0.0, 1.0))
    top, bottom = (undistort_position(view, camera, view.cx, y)[1] for y in (0.0, 1.0))
    return PictureField(
        (left - view.cx) / view.fx, (right - view.cx) / view.fx, (view.cy - bottom) / view.fy, (view.cy - top) / view.fy
    )


def _plan(focused: FocusedCamera) -> Plan:
    camera = focused.camera
    turned = np.asarray(camera.world_from_camera, np.float64)
    slopes = _cut_slopes(focused)
    level = np.stack([slopes, np.zeros_like(slopes)], axis=-1)
    return Plan(
        camera=camera.path,
        position_m=_origin(turned, camera.set_back_m),
        right=turned[:3, 0],
        ahead=-turned[:3, 2],
        set_back_m=camera.set_back_m,
        gate_mm=camera.horizontal_aperture_mm,
        slopes=slopes,
        w=focused.sharp_w_at(level),
        axis_w=focused.axis_w,
    )


def _cut_slopes(focused: FocusedCamera) -> DoubleArray:
    """Slopes at equal steps of the picture's width, on the level of the view axis, where the lens images them; and 0."""
    view = PinholeView.from_camera(focused.camera, 1, 1)
    places = [undistort_position(view, focused.camera, x, view.cy)[0] for x in np.linspace(0, 1, CUT_PLACES).tolist()]
    slopes = (np.array(places) - view.cx) / view.fx
    inside = slopes[0] < 0 < slopes[-1]
    return np.unique(np.append(slopes, 0.0)) if inside else slopes


def _origin(world_from_camera: DoubleArray, set_back_m: float) -> DoubleArray:
    """``(3,)`` origin of a camera prim in the world: before the pupil where that is set back."""
    turned = np.asarray(world_from_camera, np.float64)
    return np.asarray(turned[:3, 3] - set_back_m * turned[:3, 2])
