"""Opacity of surfaces where lines meet them, with numpy alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.scene import Batch, Image, TextureLookup, Wrap
from render.model.udim import layers_at


def opacity_at(
    batch: Batch, corners: NDArray[np.int32], u: DoubleArray, v: DoubleArray, instances: NDArray[np.int64]
) -> DoubleArray:
    """``(n,)`` opacity from 0 to 1 at points on triangles, given by vertex indices ``(n, 3)``, as they are drawn.

    Args:
        batch: whose triangles.
        corners: the triangles' vertices.
        u: ``(n,)`` barycentric coordinate of the second one.
        v: ``(n,)`` and of the third.
        instances: ``(n,)`` index of the triangle's instance.
    """
    material, geometry = batch.material, batch.geometry
    shares = np.stack([1 - u - v, u, v], axis=1)[..., None]
    opacity = np.full(len(u), material.opacity if material.graph is None else material.graph.opacity)
    lookup = material.lookups.get("opacity")
    if lookup is not None:
        uvs = geometry.coordinates(lookup)
        uv = np.zeros((len(u), 2)) if uvs is None else np.sum(shares * uvs[corners], axis=1)
        places = np.asarray(np.concatenate([uv, np.ones((len(uv), 1))], axis=1) @ lookup.uv_transform.T, np.float64)
        channel = max(lookup.channel, 0)
        opacity = _looked_up(lookup, places)[:, channel]
    if material.uses_display_color and geometry.colors is not None:
        opacity = opacity * np.sum(shares[..., 0] * geometry.colors[corners, 3], axis=1)
    if material.uses_display_color and batch.instance_colors is not None:
        opacity = opacity * batch.instance_colors[instances, 3]
    if material.opacity_threshold > 0:
        opacity = (opacity >= material.opacity_threshold).astype(np.float64)
    return np.asarray(np.clip(opacity, 0.0, 1.0), np.float64)


def _looked_up(lookup: TextureLookup, places: DoubleArray) -> DoubleArray:
    """``(n, 4)`` values at places ``(n, 2)`` of a look-up, without filtering."""
    if not lookup.image.tiles:
        texels = _nearest_texels(lookup.image, places, (lookup.wrap_s, lookup.wrap_t))
        return np.asarray(texels * lookup.scale + lookup.bias, np.float64)
    layers = layers_at(lookup.image.tiles, places)
    height, width = lookup.image.pixels.shape[1:3]
    within = places - np.floor(places)
    column = np.floor(within[:, 0] * width).astype(np.int64)
    row = np.floor((1 - within[:, 1]) * height).astype(np.int64)
    texels = lookup.image.pixels[layers, np.minimum(row, height - 1), np.minimum(column, width - 1)].astype(np.float64)
    return np.where(layers[:, None] < 0, lookup.fallback, texels * lookup.scale + lookup.bias)


def _nearest_texels(image: Image, places: DoubleArray, wraps: tuple[Wrap, Wrap]) -> DoubleArray:
    """``(n, 4)`` texels at texture coordinates ``(n, 2)``, without filtering."""
    height, width = image.pixels.shape[:2]
    index, inside = [], np.ones(len(places), bool)
    for place, count, wrap in zip((places[:, 0], 1 - places[:, 1]), (width, height), wraps, strict=True):
        texel = np.floor(place * count).astype(np.int64)
        if wrap == "black":
            inside &= (texel >= 0) & (texel < count)
        elif wrap == "repeat":
            texel = texel % count
        elif wrap == "mirror":
            texel = texel % (2 * count)
            texel = np.minimum(texel, 2 * count - 1 - texel)
        index.append(np.clip(texel, 0, count - 1))
    return np.asarray(image.pixels[index[1], index[0]] * inside[:, None], np.float64)
