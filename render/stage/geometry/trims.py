"""Trimming of triangles in the plane of a patch's parameters by closed loops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray, LongArray

_AT_A_TIME = 1 << 22
"""Pairs of places and loop edges that are looked at together."""


@dataclass(frozen=True, eq=False)
class Trimmed:
    """Rest of triangles that are trimmed.

    Attributes:
        places: ``(n, 2)`` those of the whole triangles, then those at which edges are cut.
        triangles: ``(m, 3)``.
        source: ``(m,)`` whole triangle that each is a part of.
    """

    places: DoubleArray
    triangles: LongArray
    source: LongArray


def trim(places: DoubleArray, triangles: LongArray, loops: Sequence[DoubleArray]) -> Trimmed:
    """Keep what lies to the left of the loops.

    An outer loop runs counter-clockwise, and those around holes clockwise; where the largest loop of several runs the other way,
    all are taken to do so. Where all loops run clockwise, they are holes of the whole patch. A cut is straight within a triangle.

    Args:
        places: ``(n, 2)``.
        triangles: ``(m, 3)`` places.
        loops: ``(k, 2)`` corners of each, which close by themselves.
    """
    distance = _inside(places, loops)
    kept = distance[triangles] > 0
    count = kept.sum(axis=1)
    whole = np.flatnonzero(count == 3)
    found, sources, new = [triangles[whole]], [whole], [places]
    first = len(places)
    for number in (1, 2):
        chosen = np.flatnonzero(count == number)
        if not len(chosen):
            continue
        odd = np.argmax(kept[chosen] == (number == 1), axis=1)  # the corner that is alone on its side
        turned = np.take_along_axis(triangles[chosen], (odd[:, None] + np.arange(3)) % 3, axis=1)
        alone, after, before = turned.T
        cuts = [_cut(places, distance, alone, other) for other in (after, before)]
        on_after = first + np.arange(len(chosen))
        on_before = on_after + len(chosen)
        new += cuts
        first += 2 * len(chosen)
        if number == 1:
            found.append(np.stack([alone, on_after, on_before], axis=1))
            sources.append(chosen)
        else:
            found += [np.stack([on_after, after, before], axis=1), np.stack([on_after, before, on_before], axis=1)]
            sources += [chosen, chosen]
    return Trimmed(np.concatenate(new), np.concatenate(found), np.concatenate(sources))


def _cut(places: DoubleArray, distance: DoubleArray, a: LongArray, b: LongArray) -> DoubleArray:
    """Places between two ends at which the distance is 0."""
    share = distance[a] / (distance[a] - distance[b])
    return np.asarray(places[a] + share[:, None] * (places[b] - places[a]))


def _inside(places: DoubleArray, loops: Sequence[DoubleArray]) -> DoubleArray:
    """``(n,)`` distance from the nearest loop, negative where a place is not kept."""
    areas = [float(np.sum(_cross(loop, np.roll(loop, -1, axis=0)))) for loop in loops]
    largest = areas[int(np.argmax(np.abs(areas)))]
    turn = -1 if largest < 0 and any(area > 0 for area in areas) else 1
    least = -1 if all(area < 0 for area in areas) else 0
    starts = np.concatenate(loops)
    ends = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    found = np.zeros(len(places))
    step = max(1, _AT_A_TIME // len(starts))
    for first in range(0, len(places), step):
        own = places[first : first + step, None]
        along, toward = ends - starts, own - starts
        length = np.maximum(np.sum(along**2, axis=-1), 1e-300)
        share = np.clip(np.sum(toward * along, axis=-1) / length, 0, 1)
        apart = np.linalg.norm(toward - share[..., None] * along, axis=-1).min(axis=1)
        side = _cross(np.broadcast_to(along, toward.shape), toward)
        y, low, high = own[..., 1], starts[:, 1], ends[:, 1]
        winding = ((low <= y) & (high > y) & (side > 0)).sum(axis=1) - ((low > y) & (high <= y) & (side < 0)).sum(
            axis=1
        )
        found[first : first + step] = np.where(turn * winding > least, apart, -apart)
    return found


def _cross(one: DoubleArray, other: DoubleArray) -> DoubleArray:
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])
