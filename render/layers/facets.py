"""Surfaces of mesh lights as a few flat ones."""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray, LongArray

_MOST_FACES = 20_000
_ROUNDS = 8
_PARTS, _SPLITS = 8, 8
_CLOSED = 0.01  # largest sum of vector areas of a closed surface, over the sum of their lengths


def gather_facets(triangles: DoubleArray, count: int) -> DoubleArray:
    """Gather triangles into flat facets, by places and directions (k-means, Lloyd 1982, "Least squares quantization in PCM").

    A facet has the sum of its triangles' vector areas, so that it sends the same light to all places that see all of it. Those of
    a closed surface are enlarged to its area, since parts that are seen edge-on come short.

    Args:
        triangles: ``(m, 3, 3)`` corners, counter-clockwise seen from outside.
        count: most facets.

    Returns:
        ``(k, 6)`` centres and vector areas: along the normals, as long as the areas are large; k is at most ``count``, and 0
        where all areas are 0.
    """
    faces = _faces(_split(triangles, _PARTS * count) if len(triangles) < _MOST_FACES else triangles)
    faces = faces[np.linalg.norm(faces[:, 3:], axis=1) > 0]
    if len(faces) > _MOST_FACES:  # neighbours in the file are mostly neighbours in space
        faces = _gather(faces, np.arange(len(faces)) * _MOST_FACES // len(faces))
    if len(faces) <= count:
        return faces
    areas = np.linalg.norm(faces[:, 3:], axis=1)
    middle = np.average(faces[:, :3], axis=0, weights=areas)
    size = np.sqrt(np.average(((faces[:, :3] - middle) ** 2).sum(1), weights=areas)) or 1.0
    places = np.concatenate([(faces[:, :3] - middle) / size, faces[:, 3:] / areas[:, None]], axis=1)
    centres = places[[np.argmax(areas)]]
    while len(centres) < count:  # the farthest place from all others
        apart = ((places[:, None] - centres) ** 2).sum(2).min(1)
        centres = np.concatenate([centres, places[[np.argmax(apart)]]])
    for _ in range(_ROUNDS):
        nearest = ((places[:, None] - centres) ** 2).sum(2).argmin(1)
        weights = np.bincount(nearest, areas, count)
        sums = np.stack([np.bincount(nearest, areas * column, count) for column in places.T], axis=1)
        centres = np.where(weights[:, None] > 0, sums / np.maximum(weights, 1e-300)[:, None], centres)
    facets = _gather(faces, nearest)
    sizes = np.linalg.norm(facets[:, 3:], axis=1)
    if np.linalg.norm(facets[:, 3:].sum(0)) < _CLOSED * sizes.sum():
        facets[:, 3:] *= areas.sum() / sizes.sum()
    return facets


def _faces(triangles: DoubleArray) -> DoubleArray:
    """Centres and vector areas ``(m, 6)`` of triangles."""
    first, second, third = (triangles[:, corner] for corner in range(3))
    return np.concatenate([triangles.mean(1), np.cross(second - first, third - first) / 2], axis=1)


def _split(triangles: DoubleArray, parts: int) -> DoubleArray:
    """Cut triangles that are larger than a share of the whole into four, and those again."""
    for _ in range(_SPLITS):
        areas = np.linalg.norm(_faces(triangles)[:, 3:], axis=1)
        large = areas > areas.sum() / parts
        if not large.any():
            break
        a, b, c = (triangles[large, corner] for corner in range(3))
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        cut = [np.stack(corners, axis=1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        triangles = np.concatenate([triangles[~large], *cut])
    return triangles


def _gather(faces: DoubleArray, groups: LongArray) -> DoubleArray:
    """Sums of the vector areas of groups of faces, at their mean places by area; groups without area are left out."""
    areas, count = np.linalg.norm(faces[:, 3:], axis=1), int(groups.max()) + 1
    weights = np.bincount(groups, areas, count)
    places = [np.bincount(groups, areas * column, count) / np.maximum(weights, 1e-300) for column in faces[:, :3].T]
    vectors = [np.bincount(groups, column, count) for column in faces[:, 3:].T]
    gathered = np.stack([*places, *vectors], axis=1)
    return np.asarray(gathered[np.linalg.norm(gathered[:, 3:], axis=1) > 1e-6 * weights])
