"""How what is drawn moves while the shutter is open: the same surfaces in the middle of that time and at both its ends."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from render.scene import Batch, DoubleArray, FloatArray, IntArray, Scene


@dataclass(frozen=True, eq=False)
class Movement:
    """A batch at both ends of a time.

    Attributes:
        opening_poses: ``(k, 4, 4)`` float64 world from geometry space, of the batch's instances, when the time begins.
        closing_poses: likewise, when it ends.
        opening_positions: ``(n, 3)`` float32 of its vertices when the time begins; None where the geometry does not bend.
        closing_positions: likewise, when it ends.
        reach_m: no point of it moves farther than this.
    """

    opening_poses: DoubleArray
    closing_poses: DoubleArray
    opening_positions: FloatArray | None
    closing_positions: FloatArray | None
    reach_m: float


def movements(middle: Scene, opening: Scene, closing: Scene) -> dict[int, Movement]:
    """How the batches of a scene move.

    Surfaces are known again by the prim and face that they begin with, their size, and the numbers of their instances; what is
    not there at both ends, or is cut into other triangles, is taken to stand still.

    Args:
        middle: the scene in the middle of a time.
        opening: when it begins.
        closing: when it ends.

    Returns:
        Movements by the identities of the batches in the middle; those that stand still have none.
    """
    before, after = _by_key(opening), _by_key(closing)
    found = {}
    for key, batch in _keys(middle):
        first, last = before.get(key), after.get(key)
        if first is None or last is None or (first is batch and last is batch):
            continue
        movement = _movement(batch, first, last)
        if movement.reach_m > 0:
            found[id(batch)] = movement
    return found


Key = tuple[int, ...]


def _keys(scene: Scene) -> list[tuple[Key, Batch]]:
    """Each batch with what it is known again by; those that are alike are told apart by their order."""
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
    return dict(_keys(scene))


def _movement(batch: Batch, first: Batch, last: Batch) -> Movement:
    bends = first.geometry is not last.geometry
    starts, ends = first.geometry.positions, last.geometry.positions
    opening, closing = _poses_of(batch, first), _poses_of(batch, last)
    there = np.flatnonzero(np.isnan(opening).any(axis=(1, 2)) | np.isnan(closing).any(axis=(1, 2)))
    opening[there] = closing[there] = batch.poses[there]
    if bends and np.array_equal(starts, ends):
        bends = False
    box = _corners(starts), _corners(ends)
    moved = _placed(box[1], closing) - _placed(box[0], opening)
    reach_m = float(np.linalg.norm(moved, axis=-1).max(initial=0.0))
    if bends:
        scales = np.linalg.norm(closing[:, :3, :3], ord=2, axis=(1, 2))
        reach_m += float(np.linalg.norm(ends - starts, axis=-1).max(initial=0.0) * scales.max(initial=0.0))
    return Movement(opening, closing, starts if bends else None, ends if bends else None, reach_m)


def _poses_of(batch: Batch, other: Batch) -> DoubleArray:
    """``(k, 4, 4)`` the poses that the batch's instances have in another; NaN for those that are not there."""
    if len(batch.poses) == len(other.poses) and _same(batch, other):
        return np.array(other.poses)
    places = {name: i for i, name in enumerate(_names(other))}
    poses = np.full(batch.poses.shape, np.nan)
    for i, name in enumerate(_names(batch)):
        if name in places:
            poses[i] = other.poses[places[name]]
    return poses


def _same(batch: Batch, other: Batch) -> bool:
    return _equal(batch.instance_prim_ids, other.instance_prim_ids) and _equal(
        batch.instance_numbers, other.instance_numbers
    )


def _equal(one: IntArray | None, other: IntArray | None) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other)


def _names(batch: Batch) -> list[tuple[int, int]]:
    """What each instance is known again by: the prim that it is picked as, and its number."""
    none = np.full(len(batch.poses), -1)
    prims = none if batch.instance_prim_ids is None else batch.instance_prim_ids
    numbers = none if batch.instance_numbers is None else batch.instance_numbers
    return [(int(prim), int(number)) for prim, number in zip(prims, numbers, strict=True)]


def _corners(positions: FloatArray) -> DoubleArray:
    """``(8, 3)`` of the box around some points."""
    if len(positions) == 0:
        return np.zeros((8, 3))
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    return np.asarray(np.where(bits, positions.max(axis=0), positions.min(axis=0)), np.float64)


def _placed(points: DoubleArray, poses: DoubleArray) -> DoubleArray:
    """``(k, n, 3)`` points in the world."""
    turned: DoubleArray = points @ poses[:, :3, :3].transpose(0, 2, 1)
    return turned + poses[:, None, :3, 3]
