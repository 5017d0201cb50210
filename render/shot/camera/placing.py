"""Places a camera in the world, by one transform of its prim: a key at a time, or a move of all of its way."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom

from render.errors import CameraError, SettingsError
from render.model.arrays import DoubleArray
from render.shot.times import check_time
from render.stage import frame_range
from render.stage.assembly.poses import world_pose
from render.stage.world import column_matrix, rigid_frame, world_from_stage
from usd_schemas.units import metres_per_unit

OP = "xformOp:transform"
"""The one transform operation of a camera that was placed."""
MAX_SAMPLES = 20_000
"""Most samples that a camera's way may have to be placed."""
_FARTHEST_M = 1e9
_LEAST_SINE = 1e-6
"""Least sine of the angle between the directions of a place."""
_LINEAR = (UsdGeom.XformOp.TypeTranslate, UsdGeom.XformOp.TypeScale, UsdGeom.XformOp.TypeTransform)
"""Types of operations whose matrix is linear in the value, so that samples of either are interpolated alike."""


@dataclass(frozen=True)
class CameraPlace:
    """Place and direction of a camera in the world: metres, +Y up.

    Attributes:
        position_m: of the camera prim's origin.
        ahead: direction of the optical axis, of any length above 0.
        up: direction that is up in the picture, of any length above 0; what of it lies along the axis does not count.
    """

    position_m: tuple[float, float, float]
    ahead: tuple[float, float, float]
    up: tuple[float, float, float]


def frame_of(place: CameraPlace) -> DoubleArray:
    """``(4, 4)`` world from camera, which looks along -Z with +Y up.

    Raises:
        SettingsError: a number is not finite or out of range, or the directions do not span a plane.
    """
    position, ahead, up = (np.array(vector, np.float64) for vector in (place.position_m, place.ahead, place.up))
    if not (np.isfinite([position, ahead, up]).all() and (np.abs([position, ahead, up]) <= _FARTHEST_M).all()):
        detail = f"a camera's place must be finite numbers of at most {_FARTHEST_M:g}, got {place}"
        raise SettingsError(detail, code="bad_place")
    lengths = np.linalg.norm(ahead) * np.linalg.norm(up)
    across = np.cross(ahead, up)
    if not np.linalg.norm(across) > _LEAST_SINE * lengths:
        detail = f"ahead and up must be two directions, got {place.ahead} and {place.up}"
        raise SettingsError(detail, code="bad_place")
    frame = np.eye(4)
    frame[:3, 2] = -ahead / np.linalg.norm(ahead)
    frame[:3, 0] = across / np.linalg.norm(across)
    frame[:3, 1] = np.cross(frame[:3, 2], frame[:3, 0])
    frame[:3, 3] = position
    return frame


def place_camera(camera: UsdGeom.Camera, place: CameraPlace, time: float, *, is_keyed: bool) -> None:
    """Place a camera at a time, in the stage's edit target, by the operation `OP` alone.

    It stays below its parents and goes on to move with them; a stack that is reset stays so. The scale and shear of its own
    transform, which what lies below the camera has, stay too.

    A key leaves the keys at other times as they are. Where the camera turns between its keys, it gets one at each frame before,
    since matrices are interpolated otherwise. Without a key, all of the camera's way moves along, rigidly below its parent.

    Args:
        camera: of the stage, in no instance.
        place: in the world.
        time: USD time code at which it is there.
        is_keyed: whether it is a key.

    Raises:
        CameraError: the transform above it is flat, or its way has too many samples.
        SettingsError: the place cannot be, or the time is not finite.
        StageError: a transform is not finite.
    """
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # of hostile transforms; the result is checked
        _place(camera, place, time, is_keyed=is_keyed)


def _place(camera: UsdGeom.Camera, place: CameraPlace, time: float, *, is_keyed: bool) -> None:
    wanted, prim, code = frame_of(place), camera.GetPrim(), Usd.TimeCode(check_time(time))
    world = world_from_stage(prim.GetStage())
    before = world_pose(prim, UsdGeom.XformCache(code), world)
    target = _inverse(_above(camera, code, world), camera) @ _moved(before, wanted, metres_per_unit(prim.GetStage()))
    way = {at: _local(camera, at) for at in sample_times(camera)}
    if is_keyed:
        way[time] = target
    elif way:
        along = target @ _inverse(_local(camera, time), camera)
        way = {at: along @ local for at, local in way.items()}
    _author(camera, way, target)
    after = rigid_frame(world_pose(prim, UsdGeom.XformCache(code), world))
    if not np.allclose(after, wanted, rtol=1e-7, atol=1e-6 * max(1.0, float(np.abs(wanted).max()))):
        raise _unplaceable(camera)


def sample_times(camera: UsdGeom.Camera) -> list[float]:
    """Times of the samples with which one matrix follows a camera's own transform, rising; none where that stands still.

    They are the times of its keys; and the frames between these, where matrices are not interpolated as its operations are.

    Raises:
        CameraError: there are more than `MAX_SAMPLES`.
    """
    ops = [op for op in camera.GetOrderedXformOps() if op.MightBeTimeVarying()]
    times = set(camera.GetTimeSamples())
    splines = [op.GetAttr().GetSpline() for op in ops if op.GetAttr().HasSpline()]
    for spline in splines:
        times |= set(spline.GetKnots().keys())
    ends = list(times)
    if splines:
        shot = frame_range(camera.GetPrim().GetStage())
        ends += [shot.start, shot.end]
    is_straight = len(ops) == 1 and ops[0].GetOpType() in _LINEAR and not splines
    if ends and not is_straight:
        first, last = math.ceil(min(ends)), math.floor(max(ends))
        if last - first > MAX_SAMPLES:
            raise _too_long(camera)
        times |= {float(frame) for frame in range(first, last + 1)}
    if len(times) > MAX_SAMPLES:
        raise _too_long(camera)
    return sorted(times)


def _moved(before: DoubleArray, wanted: DoubleArray, unit_m: float) -> DoubleArray:
    """``(4, 4)`` pose with the frame that is wanted, and the scale and shear of another; that of a flat one is a unit's."""
    frame = rigid_frame(before)
    if abs(np.linalg.det(frame[:3, :3])) < 0.5:
        return np.asarray(wanted @ np.diag([unit_m, unit_m, unit_m, 1.0]))
    return np.asarray(wanted @ np.linalg.inv(frame) @ before)


def _above(camera: UsdGeom.Camera, code: Usd.TimeCode, world: DoubleArray) -> DoubleArray:
    """``(4, 4)`` world from the space that a camera's own transform is in."""
    parent = camera.GetPrim().GetParent()
    is_top = parent.IsPseudoRoot() or camera.GetResetXformStack()
    return world if is_top else world_pose(parent, UsdGeom.XformCache(code), world)


def _local(camera: UsdGeom.Camera, time: float) -> DoubleArray:
    """``(4, 4)`` own transform of a camera at a time."""
    return column_matrix(camera.GetLocalTransformation(Usd.TimeCode(time)))


def _inverse(matrix: DoubleArray, camera: UsdGeom.Camera) -> DoubleArray:
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError as error:
        raise _unplaceable(camera) from error
    return np.asarray(inverse)


def _author(camera: UsdGeom.Camera, way: dict[float, DoubleArray], target: DoubleArray) -> None:
    """Author samples, or without any one value for all time, as the only operation of a camera. Raises `CameraError`."""
    if not all(np.isfinite(matrix).all() for matrix in (target, *way.values())):
        raise _unplaceable(camera)
    prim, resets = camera.GetPrim(), camera.GetResetXformStack()
    attribute = prim.CreateAttribute(OP, Sdf.ValueTypeNames.Matrix4d, custom=False)
    if attribute.GetTypeName() != Sdf.ValueTypeNames.Matrix4d:
        path = str(prim.GetPath())
        raise CameraError(f"{OP} of camera {path} must be a matrix4d, got {attribute.GetTypeName()}", path=path)
    attribute.Clear()
    for at, matrix in way.items():
        attribute.Set(_usd_matrix(matrix), at)
    if not way:
        attribute.Set(_usd_matrix(target))
    camera.SetXformOpOrder([UsdGeom.XformOp(attribute)], resets)


def _usd_matrix(matrix: DoubleArray) -> Gf.Matrix4d:
    return Gf.Matrix4d(*matrix.T.ravel().tolist())


def _unplaceable(camera: UsdGeom.Camera) -> CameraError:
    path = str(camera.GetPath())
    detail = f"camera {path} cannot be placed: the transforms above it or its own are flat, or too large or small"
    return CameraError(detail, code="bad_place", path=path)


def _too_long(camera: UsdGeom.Camera) -> CameraError:
    path = str(camera.GetPath())
    detail = f"camera {path} cannot be placed: its way has more than {MAX_SAMPLES:,} samples"
    return CameraError(detail, code="bad_place", path=path)
