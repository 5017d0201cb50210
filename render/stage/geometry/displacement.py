"""Displacement of surfaces along their normals, by UsdPreviewSurface's input of that name: a constant, a primvar or a texture.

A displacement is a distance in stage units, whatever the scale of the prim, as in Storm. On instances of a PointInstancer it is
that of the prototype, scaled with the instance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import BoolArray, DoubleArray, FloatArray, HalfArray, LongArray
from render.model.scene import TextureLookup, Wrap
from render.model.udim import layers_at
from render.stage.geometry.polygons import BadGeometry, Polygons, compute_normals, fan, transfer_normals
from render.stage.world import column_matrix


@dataclass(frozen=True, eq=False)
class Displacement:
    """Displacement that a material asks for.

    Attributes:
        amount: distance, in stage units, where nothing else gives it.
        primvar: name of the primvar that it is read from, or that a texture's coordinates are; None for a constant.
        lookup: texture, or None.
        varies: whether it may be another at other times, but for the primvar's values.
    """

    amount: float
    primvar: str | None = None
    lookup: TextureLookup | None = None
    varies: bool = False


Metric = tuple[float, ...]
"""Inverse of the squares of lengths in stage units of a prim's space: nine numbers of a symmetric matrix ``(3, 3)``."""
_DIGITS = 9
UNIT_METRIC: Metric = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def metric_of(prim: Usd.Prim) -> Metric:
    """Metric of a prim's space at the earliest time: a scale that is animated scales the displacement, too.

    Returns:
        That of the stage itself where the prim's transform is flat or not finite.
    """
    matrix = column_matrix(UsdGeom.XformCache(Usd.TimeCode.EarliestTime()).GetLocalToWorldTransform(prim))[:3, :3]
    try:
        inverse = np.linalg.inv(matrix.T @ matrix)
    except np.linalg.LinAlgError:
        return UNIT_METRIC
    if not np.isfinite(inverse).all():
        return UNIT_METRIC
    return tuple(float(f"{value:.{_DIGITS}g}") for value in inverse.ravel())


def displace(polygons: Polygons, at_corners: FloatArray | DoubleArray, metric: Metric) -> Polygons:
    """Polygons whose points have moved along their smooth normals. Authored normals, and those of creases, turn with the faces.

    Args:
        polygons: the surface.
        at_corners: ``(c,)`` distances; points have the mean of their corners', so that seams of textures do not open.
        metric: of the prim's space.

    Raises:
        BadGeometry: a distance is not finite, or authored normals do not fit the faces.
    """
    if not len(polygons.corners):
        return polygons
    count = len(polygons.points)
    corners = np.maximum(np.bincount(polygons.corners, minlength=count), 1)
    amount = np.bincount(polygons.corners, at_corners.astype(np.float64), minlength=count) / corners
    if not np.isfinite(amount).all():
        raise BadGeometry("its displacement is not finite")
    triangles = fan(polygons)
    normals = compute_normals(replace(polygons, smooth=True), triangles).values.astype(np.float64)
    along = normals @ np.array(metric).reshape(3, 3)
    length = np.sqrt(np.sum(along * normals, axis=1, keepdims=True))
    moved = (polygons.points + amount[:, None] * along / np.maximum(length, 1e-30)).astype(np.float32)
    carried = transfer_normals(polygons, triangles, moved)
    return replace(polygons, points=moved, normals=carried)


def look_up(lookup: TextureLookup, coordinates: FloatArray, step: int = 1) -> DoubleArray:
    """``(n,)`` values of a texture's channel at texture coordinates ``(n, 2)``, bilinear between texels.

    Args:
        lookup: the texture.
        coordinates: before the texture's own transform.
        step: values are means over so many texels each way.
    """
    channel = max(lookup.channel, 0)
    places, scale, bias = _places(lookup, coordinates), float(lookup.scale[channel]), float(lookup.bias[channel])
    if not lookup.image.tiles:
        texels = lookup.image.pixels[..., channel]
        return _between_texels(texels, places, (lookup.wrap_s, lookup.wrap_t), step) * scale + bias
    layers = layers_at(lookup.image.tiles, places)
    values = np.full(len(places), float(lookup.fallback[channel]))
    for layer in np.unique(layers[layers >= 0]):
        own = layers == layer
        within = places[own] - np.floor(places[own])
        texels = lookup.image.pixels[layer, ..., channel]
        values[own] = _between_texels(texels, within, ("clamp", "clamp"), step) * scale + bias
    return values


def _between_texels(texels: HalfArray, places: DoubleArray, wraps: tuple[Wrap, Wrap], step: int) -> DoubleArray:
    """``(n,)`` values between the texels ``(height, width)`` of an image, or between means of ``step`` of them each way."""
    across, down = texels.shape[1] / step, texels.shape[0] / step
    means = _means(texels.astype(np.float64), step)
    height, width = means.shape
    x, y = places[:, 0] * across - 0.5, (1 - places[:, 1]) * down - 0.5
    left, top = np.floor(x), np.floor(y)
    value = np.zeros(len(places))
    for column, share_x in ((left, 1 - (x - left)), (left + 1, x - left)):
        for row, share_y in ((top, 1 - (y - top)), (top + 1, y - top)):
            (i, in_y), (j, in_x) = _wrap(row, height, wraps[1]), _wrap(column, width, wraps[0])
            value += share_x * share_y * np.where(in_x & in_y, means[i, j], 0.0)
    return value


def texels_between(lookup: TextureLookup, at_corners: FloatArray, polygons: Polygons) -> int:
    """Texels between neighbours on a surface, at least 1: detail that is finer than its points would be taken at random.

    Args:
        lookup: the texture.
        at_corners: ``(c, 2)`` texture coordinates of the surface's corners.
        polygons: the surface.
    """
    if not len(at_corners):
        return 1
    counts = polygons.counts[polygons.counts > 0].astype(np.int64)
    following = np.arange(1, len(at_corners) + 1)
    ends = np.cumsum(counts)
    following[ends - 1] = ends - counts
    places = _places(lookup, at_corners)
    height, width = lookup.image.pixels.shape[-3:-1]
    steps = np.abs(places[following] - places) @ np.diag([width, height])
    longest = np.sort(steps.max(axis=1))
    return int(np.clip(longest[len(longest) // 2], 1, min(width, height)))


def _places(lookup: TextureLookup, coordinates: FloatArray) -> DoubleArray:
    homogeneous = np.column_stack([coordinates, np.ones(len(coordinates))])
    return np.asarray(homogeneous @ lookup.uv_transform.T.astype(np.float64))


def _means(texels: DoubleArray, step: int) -> DoubleArray:
    """Means of squares of texels; those at the right and at the bottom may be cut."""
    for axis in range(2):
        firsts = np.arange(0, texels.shape[axis], step)
        sizes = np.minimum(step, texels.shape[axis] - firsts)
        texels = np.add.reduceat(texels, firsts, axis=axis) / np.expand_dims(sizes, 1 - axis)
    return texels


def _wrap(place: DoubleArray, count: int, wrap: Wrap) -> tuple[LongArray, BoolArray]:
    """Texels that stand for those of numbers that may lie outside, and which of these count."""
    inside = (place >= 0) & (place < count) if wrap == "black" else np.ones(len(place), bool)
    if wrap == "repeat":
        index = place % count
    elif wrap == "mirror":
        index = place % (2 * count)
        index = np.minimum(index, 2 * count - 1 - index)
    else:
        index = np.clip(place, 0, count - 1)
    return np.clip(index, 0, count - 1).astype(np.int64), inside
