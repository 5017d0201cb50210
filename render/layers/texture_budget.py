"""Textures held to a budget of memory, at the resolution that they are seen at.

As long as all textures of a scene fit the budget, they are held as they were read. Where they do not, each is held without its
first mip levels: those that no look-up of the view can reach.

**Bound.** Let J map a step on a triangle, in metres, to a step in texels, and let sigma be its larger singular value. A pixel of
a view of focal length ``f_px`` covers, at depth z and ``phi`` off the axis, at least ``z·cos(phi) / f_px`` metres of a surface in
any direction. One of the two screen axes then has at least ``1 / sqrt(2)`` of that times sigma in texels, so that the look-up's
level is at least

    log2(sigma·z·cos(phi) / (sqrt(2)·f_px)) - log2(detail) - log2(anisotropy)

with the sharpening of `render.layers.surface_sampling`, and as much again where anisotropic look-ups take finer levels. It is
bounded over the clusters of triangles in view (`render.layers.clusters`): least sigma, least depth. Textures beside the view are
held as a single texel, opacities at 1024 texels across.

**Exactness.** The levels that are left are those of the whole image, to the bit, so that pictures stay the same. Only where what
is seen does not fit the budget are more levels left out, of the largest textures first, and pictures become softer.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from render.layers.bounds import CLUSTER_TRIANGLES
from render.layers.index import Draw, SceneIndex
from render.layers.materials import HalfTexture
from render.model.arrays import DoubleArray
from render.model.scene import Geometry, TextureLookup
from render.optics.view import PinholeView

TEXTURE_BUDGET_BYTES = 1 << 30
"""Memory of surfaces' textures on the device above which they are held without the levels that are not seen."""
_UNSEEN_SIDE_PX, _UNSEEN_OPACITY_SIDE_PX = 1, 1024
"""Longest side of a texture that is not seen; that of an opacity, which may cut out a shadow that is seen."""
_SLACK = 0.6
"""Levels by which look-ups may be finer: a device may take the largest component of a step for its length (OpenGL 4.5, section
8.14.1), and takes differences between pixels in place of derivatives."""
_EVERYTHING = 1e-30  # texels per metre of a triangle with a single texture coordinate


class TextureBudget:
    """Chooses the levels that the textures of a render index hold.

    Args:
        index: render index.
        memory_bytes: memory of the GPU, of which an eighth is the budget if that is more than `TEXTURE_BUDGET_BYTES`; 0 where it
            is not known, and for a CPU rasteriser.

    Attributes:
        bytes: the budget.
    """

    def __init__(self, index: SceneIndex, memory_bytes: int = 0) -> None:
        self._index = index
        self.bytes = max(TEXTURE_BUDGET_BYTES, memory_bytes // 8)
        self._densities: dict[int, tuple[Geometry, DoubleArray]] = {}

    def prepare(self) -> None:
        """Choose the levels of new textures before they are uploaded, when no view is known."""
        textures = self._index.textures
        if self._is_within(dict.fromkeys(textures, 0)):
            self._apply(dict.fromkeys(textures, 0))
            return
        unseen = self._unseen_levels()
        self._apply({texture: texture.first_level if texture.is_held else unseen[texture] for texture in textures})

    def fit(self, view: PinholeView, detail: float) -> None:
        """Hold what a view needs.

        Args:
            view: view that surfaces are drawn for.
            detail: how many times finer than its pixels textures are looked up.
        """
        textures = self._index.textures
        if self._is_within(dict.fromkeys(textures, 0)):
            self._apply(dict.fromkeys(textures, 0))
            return
        needed = self._needed_levels(view, detail)
        levels = {texture: min(needed[texture], texture.first_level) for texture in textures}
        if not self._is_within(levels):
            levels = needed
        while not self._is_within(levels):
            largest = max(textures, key=lambda texture: texture.bytes_from(levels[texture]))
            if levels[largest] == largest.last_level:
                break
            levels[largest] += 1
        self._apply(levels)

    def _is_within(self, levels: Mapping[HalfTexture, int]) -> bool:
        return sum(texture.bytes_from(level) for texture, level in levels.items()) <= self.bytes

    def _apply(self, levels: Mapping[HalfTexture, int]) -> None:
        """Hold textures from other levels on: first those that shrink, so that there is room for the others."""
        for texture, level in sorted(levels.items(), key=lambda item: item[0].first_level - item[1]):
            texture.hold_from(level)

    def _unseen_levels(self) -> dict[HalfTexture, int]:
        """Levels of textures that no view shows."""
        sides = dict.fromkeys(self._index.textures, _UNSEEN_SIDE_PX)
        for draw in self._index.draws:
            material = draw.batch.material
            is_clear = material.graph is not None and material.graph.may_be_transparent
            for name in material.lookups if is_clear else ("opacity",):
                opacity = self._index.texture_of(material, name)
                if opacity is not None:
                    sides[opacity] = _UNSEEN_OPACITY_SIDE_PX
        return {texture: texture.level_of_side(side) for texture, side in sides.items()}

    def _needed_levels(self, view: PinholeView, detail: float) -> dict[HalfTexture, int]:
        """First levels that look-ups of a view may reach."""
        levels = self._unseen_levels()
        per_metre = self._densities_in(view)
        corner = (
            max(abs(view.cx), abs(view.width - view.cx)) / view.fx,
            max(abs(view.cy), abs(view.height - view.cy)) / view.fy,
        )
        metres_at_1_m = 1 / (np.sqrt(1 + corner[0] ** 2 + corner[1] ** 2) * max(view.fx, view.fy))
        for draw, density in per_metre:
            for name, lookup in draw.batch.material.lookups.items():
                texture = self._index.texture_of(draw.batch.material, name)
                if texture is None:
                    continue
                texels = density * metres_at_1_m * _least_stretch(texture, lookup) / np.sqrt(2)
                if lookup.uv_at >= 0:  # densities are those of the first texture coordinates
                    texels = 0.0
                level = np.log2(max(texels, _EVERYTHING)) - np.log2(detail * texture.anisotropy) - _SLACK
                levels[texture] = min(levels[texture], max(0, int(np.floor(level))))
        return levels

    def _densities_in(self, view: PinholeView) -> list[tuple[Draw, float]]:
        """Draws in view, each with the least change of its texture coordinates per metre, times the depth in metres."""
        index = self._index
        self._forget(draw.batch.geometry for draw in index.draws)
        clip_from_world = view.projection_matrix() @ view.camera_from_world
        clusters = index.clusters.select(clip_from_world)
        owner, first, instance = index.clusters.members(clusters)
        depth = index.clusters.nearest_depths(clusters, view)
        found = []
        for number in index.clusters.draws_of(clusters):
            draw, own = index.draws[number], owner == number
            if not draw.batch.material.lookups:
                continue
            density = self._density(draw.batch.geometry)
            is_whole = index.clusters.is_whole(clusters[own])
            per_metre = np.where(is_whole, density.min(), density[first[own] // CLUSTER_TRIANGLES])
            poses = draw.batch.poses[draw.instances]
            scale = np.linalg.norm(poses[:, :3, :3], ord=2, axis=(1, 2))[instance[own]]
            found.append((draw, float((per_metre / np.maximum(scale, 1e-20) * depth[own]).min())))
        return found

    def _density(self, geometry: Geometry) -> DoubleArray:
        if id(geometry) not in self._densities:
            self._densities[id(geometry)] = geometry, uv_densities(geometry)
        return self._densities[id(geometry)][1]

    def _forget(self, drawn: Iterable[Geometry]) -> None:
        used = {id(geometry) for geometry in drawn}
        self._densities = {key: value for key, value in self._densities.items() if key in used}


def uv_densities(geometry: Geometry) -> DoubleArray:
    """Bound the change of texture coordinates over a geometry.

    Args:
        geometry: geometry, of one triangle or more.

    Returns:
        ``(c,)`` for each cluster the least over its triangles of the larger singular value of the map from a step on the
        triangle to a step of texture coordinates, 1/m; infinite where no triangle has an area, 0 without coordinates.
    """
    first = np.arange(0, len(geometry.triangles), CLUSTER_TRIANGLES)
    if geometry.uvs is None:
        return np.zeros(len(first))
    points = geometry.positions.astype(np.float64)[geometry.triangles]
    uvs = geometry.uvs.astype(np.float64)[geometry.triangles]
    edges, steps = points[:, 1:] - points[:, :1], uvs[:, 1:] - uvs[:, :1]
    gram = edges @ edges.transpose(0, 2, 1)
    area2 = gram[:, 0, 0] * gram[:, 1, 1] - gram[:, 0, 1] ** 2
    is_flat = area2 <= 1e-12 * gram[:, 0, 0] * gram[:, 1, 1]
    turned = gram[:, ::-1, ::-1] * np.array([[1, -1], [-1, 1]]) / np.where(is_flat, 1, area2)[:, None, None]
    metric = steps.transpose(0, 2, 1) @ turned @ steps
    half = (metric[:, 0, 0] + metric[:, 1, 1]) / 2
    apart = np.hypot((metric[:, 0, 0] - metric[:, 1, 1]) / 2, metric[:, 0, 1])
    per_metre = np.where(is_flat, np.inf, np.sqrt(np.maximum(half + apart, 0)))
    return np.asarray(np.minimum.reduceat(per_metre, first))


def _least_stretch(texture: HalfTexture, lookup: TextureLookup) -> float:
    """Least number of texels by which a step of one in texture coordinates moves the look-up."""
    linear = np.diag([texture.width, texture.height]) @ lookup.uv_transform[:, :2].astype(np.float64)
    return float(np.linalg.svd(linear, compute_uv=False)[-1])
