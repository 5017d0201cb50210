"""Movement of surfaces while the shutter is open: the same surfaces in the middle of that time and at both its ends."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, FloatArray
from render.model.scene import Batch, Scene
from render.optics.view import PinholeView


@dataclass(frozen=True, eq=False)
class Movement:
    """A batch at both ends of the shutter interval.

    Attributes:
        opening_poses: ``(k, 4, 4)`` float64 world from geometry space, of the batch's instances, as the shutter opens.
        closing_poses: the same as it closes.
        opening_positions: ``(n, 3)`` float32 positions of its vertices as the shutter opens; None where the geometry is rigid.
        closing_positions: the same as it closes.
        corners: ``(3, k, 8, 3)`` corners of its instances' boxes in the world, metres: as the shutter opens, in the middle, and
            as it closes.
    """

    opening_poses: DoubleArray
    closing_poses: DoubleArray
    opening_positions: FloatArray | None
    closing_positions: FloatArray | None
    corners: DoubleArray


def find_movements(middle: Scene, opening: Scene, closing: Scene) -> dict[int, Movement]:
    """Match the batches of a scene across the shutter interval, and return how each of them moves.

    Surfaces are matched by their first prim and face, their triangles, and the numbers of their instances. Batches that are
    not there at both ends, or have other triangles there, count as still.

    Args:
        middle: the scene in the middle of the shutter interval.
        opening: the scene at its start.
        closing: the scene at its end.

    Returns:
        Movements by the ids of the batches in the middle; still batches have none.
    """
    before, after = _by_key(opening), _by_key(closing)
    moves = {}
    for key, batch in batch_keys(middle):
        first, last = before.get(key), after.get(key)
        if first is None or last is None or (first is batch and last is batch):
            continue
        if _has_same_topology(batch, first) and _has_same_topology(batch, last):
            movement = _movement(batch, first, last)
            if movement is not None:
                moves[id(batch)] = movement
    return moves


def swept_bounds(moves: Iterable[Movement], view: PinholeView) -> DoubleArray:
    """Bounds, in the middle of the interval, of the moving instances that come into view: ``(4,)`` slopes left, top,
    right, bottom.

    The bounds contain the picture and extend beyond it by no more than the instances move.

    Args:
        moves: movements of the batches.
        view: view of the picture in the middle of the interval.
    """
    first = np.array([-view.cx / view.fx, -view.cy / view.fy])
    last = np.array([(view.width - view.cx) / view.fx, (view.height - view.cy) / view.fy])
    low, high = first.copy(), last.copy()
    for movement in moves:
        slopes, seen = _slopes(movement.corners, view)
        begins, ends = slopes.min(axis=(0, 2)), slopes.max(axis=(0, 2))
        comes = seen & (ends >= first).all(axis=1) & (begins <= last).all(axis=1)
        way = np.abs(slopes - slopes[1]).max(axis=(0, 2))[comes]
        low = np.minimum(low, np.maximum(slopes[1].min(axis=1)[comes], first - way).min(axis=0, initial=np.inf))
        high = np.maximum(high, np.minimum(slopes[1].max(axis=1)[comes], last + way).max(axis=0, initial=-np.inf))
    return np.concatenate([low, high])


def nearest_moving_w(moves: Iterable[Movement], view: PinholeView) -> float:
    """Inverse depth that no moving instance in view exceeds at any time of the interval, 1/m: that of the nearest corner of a
    box, at most ``1 / view.near_m``; 0 where none moves.

    Args:
        moves: movements of the batches.
        view: view of the layers in the middle of the interval.
    """
    first = np.array([-view.cx / view.fx, -view.cy / view.fy])
    last = np.array([(view.width - view.cx) / view.fx, (view.height - view.cy) / view.fy])
    nearest_w = 0.0
    for movement in moves:
        slopes, seen = _slopes(movement.corners, view)
        comes = seen & (slopes.max(axis=(0, 2)) >= first).all(axis=1) & (slopes.min(axis=(0, 2)) <= last).all(axis=1)
        depth = -(movement.corners @ view.camera_from_world[2, :3] + view.camera_from_world[2, 3])
        nearest_m = np.maximum(depth.min(axis=(0, 2)), view.near_m)
        nearest_w = max(nearest_w, float((1 / nearest_m[comes]).max(initial=0.0)))
    return nearest_w


def _slopes(corners: DoubleArray, view: PinholeView) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Slopes ``(3, k, 8, 2)`` of corners, x right and y down, and visibility ``(k,)``.

    Corners behind the near plane are moved to it. An instance is visible where any of its corners is in front of the
    eye at any time.
    """
    points = corners @ view.camera_from_world[:3, :3].T + view.camera_from_world[:3, 3]
    depth = -points[..., 2]
    slopes = points[..., :2] * [1.0, -1.0] / np.maximum(depth, view.near_m)[..., None]
    return slopes, np.asarray((depth > view.near_m).any(axis=(0, 2)))


Key = tuple[int, ...]


def batch_keys(scene: Scene) -> list[tuple[Key, Batch]]:
    """Batches with keys that identify them over time; equal keys are distinguished by their order."""
    times: Counter[Key] = Counter()
    keys = []
    for batch in scene.batches:
        geometry = batch.geometry
        begins = (int(geometry.prim_ids[0]), int(geometry.face_ids[0])) if len(geometry.triangles) else (-1, -1)
        key: Key = (*begins, len(geometry.triangles), len(geometry.positions), int(batch.double_sided))
        times[key] += 1
        keys.append(((*key, times[key]), batch))
    return keys


def _by_key(scene: Scene) -> dict[Key, Batch]:
    return dict(batch_keys(scene))


def _has_same_topology(batch: Batch, other: Batch) -> bool:
    return batch.geometry is other.geometry or np.array_equal(batch.geometry.triangles, other.geometry.triangles)


def _movement(batch: Batch, first: Batch, last: Batch) -> Movement | None:
    """Movement of a batch between two others with the same surfaces; None where it stands still."""
    opening, closing = _match_poses(batch, first), _match_poses(batch, last)
    absent = np.flatnonzero(np.isnan(opening).any(axis=(1, 2)) | np.isnan(closing).any(axis=(1, 2)))
    opening[absent] = closing[absent] = batch.poses[absent]
    shapes = [other.geometry.positions for other in (first, batch, last)]
    bends = any(not _has_same_positions(shape, shapes[1]) for shape in shapes[::2])
    if not bends and np.array_equal(opening, batch.poses) and np.array_equal(closing, batch.poses):
        return None
    times = zip(shapes, (opening, batch.poses, closing), strict=True)
    corners = np.stack([_to_world(_corners(shape), poses) for shape, poses in times])
    return Movement(opening, closing, shapes[0] if bends else None, shapes[2] if bends else None, corners)


def _has_same_positions(one: FloatArray, other: FloatArray) -> bool:
    return one is other or np.array_equal(one, other)


def _match_poses(batch: Batch, other: Batch) -> DoubleArray:
    """Poses ``(k, 4, 4)`` that the batch's instances have in another batch; NaN for missing instances.

    Where the numbers of instances differ, only ids identify them: numbers that merely count them do not.
    """
    names, others = _instance_keys(batch), _instance_keys(other)
    if names == others:
        return np.array(other.poses)
    poses = np.full(batch.poses.shape, np.nan)
    if _only_counts(batch) or _only_counts(other):
        return poses
    places = {name: i for i, name in enumerate(others)}
    for i, name in enumerate(names):
        if name in places:
            poses[i] = other.poses[places[name]]
    return poses


def _only_counts(batch: Batch) -> bool:
    numbers = batch.instance_numbers
    return numbers is not None and np.array_equal(numbers, np.arange(len(numbers)))


def _instance_keys(batch: Batch) -> list[tuple[int, int]]:
    """Keys that identify each instance over time: ``(prim id, instance number)``, -1 where there is none."""
    none = np.full(len(batch.poses), -1)
    prims = none if batch.instance_prim_ids is None else batch.instance_prim_ids
    numbers = none if batch.instance_numbers is None else batch.instance_numbers
    return [(int(prim), int(number)) for prim, number in zip(prims, numbers, strict=True)]


def _corners(positions: FloatArray) -> DoubleArray:
    """Corners ``(8, 3)`` of the box around points."""
    if len(positions) == 0:
        return np.zeros((8, 3))
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    return np.asarray(np.where(bits, positions.max(axis=0), positions.min(axis=0)), np.float64)


def _to_world(points: DoubleArray, poses: DoubleArray) -> DoubleArray:
    """Transform points into the world, ``(k, n, 3)``."""
    turned: DoubleArray = points @ poses[:, :3, :3].transpose(0, 2, 1)
    return turned + poses[:, None, :3, 3]
