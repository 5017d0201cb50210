"""A scene as rays see it without lights: triangles, their base colours, and the dome behind them.

Radiance is what the ``unlit`` shading takes for it: base colour, from its texture where it has one, times displayColor.
Textures are read at each ray's own hit, without mipmaps: the many rays of a pixel filter them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.lab.reference.triangles import Hits, IndexArray, TriangleTracer
from render.model.arrays import DoubleArray, FloatArray
from render.model.scene import Batch, Dome, Image, Scene, TextureLookup, Wrap
from render.model.udim import layers_at

OPAQUE = 0.999
"""Opacity from which a surface hides all surfaces behind it."""

_MOST_SURFACES = 64  # partly transparent ones, one behind the other
_BEHIND = 1 - 1e-9


@dataclass(frozen=True, eq=False)
class _Part:
    """The triangles of one batch.

    Attributes:
        batch: batch of the triangles.
        first: number of their first one in the scene.
        triangles: ``(n, 3)`` vertex indices, instance after instance, counter-clockwise also where an instance is mirrored.
    """

    batch: Batch
    first: int
    triangles: IndexArray


class UnlitScene:
    """Unlit scene seen from one camera."""

    def __init__(self, scene: Scene, camera_from_world: DoubleArray, *, near_m: float, far_m: float) -> None:
        """Bring the scene's triangles, instances and all, before the camera.

        Args:
            scene: scene.
            camera_from_world: ``(4, 4)``.
            near_m: nearest depth at which anything is seen.
            far_m: farthest, may be infinite.
        """
        self._parts: list[_Part] = []
        corners, two_sided = [np.zeros((0, 3, 3))], [np.zeros(0, bool)]
        count = 0
        for batch in scene.batches:
            triangles, placed = _transform_part(batch, camera_from_world)
            self._parts.append(_Part(batch, count, triangles))
            corners.append(placed)
            two_sided.append(np.full(len(placed), batch.has_backs))
            count += len(placed)
        self._tracer = TriangleTracer(np.concatenate(corners), np.concatenate(two_sided), near_m=near_m, far_m=far_m)
        self._dome = scene.dome if scene.dome is not None and scene.dome.visible else None
        self._world_from_camera = np.linalg.inv(camera_from_world)

    def radiance(self, offsets: DoubleArray, slopes: DoubleArray) -> DoubleArray:
        """Radiance along each ray.

        Args:
            offsets: ``(packets, rays, 2)`` where rays pass the entrance pupil's plane, metres to the right and up.
            slopes: ``(packets, rays, 2)`` metres to the right and up for a metre of depth; NaN for rays that do not count.

        Returns:
            ``(packets, rays, 4)`` radiance premultiplied by coverage, with the dome behind, and coverage. 0 for NaN rays.
        """
        seen, clear = np.zeros((*slopes.shape[:2], 4)), np.isfinite(slopes).all(-1).astype(np.float64)
        background = np.zeros(clear.shape)
        behind_w = np.full(clear.shape, np.inf)
        for _ in range(_MOST_SURFACES):
            hits = self._tracer.nearest(offsets, slopes, np.where(clear > 0, behind_w, 0.0))
            hit = hits.w > 0
            if not hit.any():
                break
            colour = self._shade(hits)
            alpha = np.where(colour[..., 3] >= OPAQUE, 1.0, colour[..., 3])
            share = (clear * alpha)[..., None]
            seen[..., :3] += share * colour[..., :3]
            seen[..., 3:] += share
            background = np.where(hit, background, background + clear)
            clear, behind_w = np.where(hit, clear * (1 - alpha), 0.0), hits.w * _BEHIND
        seen[..., :3] += (background + clear)[..., None] * self._behind_all(slopes)
        return seen

    def _shade(self, hits: Hits) -> DoubleArray:
        """``(packets, rays, 4)`` base colour and opacity of what was hit; 0 where nothing was."""
        colour = np.zeros((*hits.w.shape, 4))
        for part in self._parts:
            here = (hits.triangle >= part.first) & (hits.triangle < part.first + len(part.triangles))
            if here.any():
                corners = part.triangles[hits.triangle[here] - part.first]
                colour[here] = _base_colour(part.batch, corners, hits.u[here], hits.v[here])
        return colour

    def _behind_all(self, slopes: DoubleArray) -> DoubleArray:
        """``(packets, rays, 3)`` radiance of the dome in the rays' directions."""
        if self._dome is None:
            return np.zeros((*slopes.shape[:2], 3))
        ahead = np.concatenate([np.nan_to_num(slopes), -np.ones((*slopes.shape[:2], 1))], axis=-1)
        return _dome_radiance(self._dome, ahead @ self._world_from_camera[:3, :3].T)


def in_packets(image: DoubleArray, side: int = 8) -> DoubleArray:
    """``(h, w, k)`` as packets ``(tiles, side², k)`` of neighbouring pixels; tiles over the edge repeat it."""
    height, width, channels = image.shape
    padded = np.pad(image, [(0, -height % side), (0, -width % side), (0, 0)], mode="edge")
    tiles = padded.reshape(padded.shape[0] // side, side, -1, side, channels).swapaxes(1, 2)
    return tiles.reshape(-1, side * side, channels)


def from_packets(packets: DoubleArray, height: int, width: int, side: int = 8) -> DoubleArray:
    """The image ``(h, w, k)`` that `in_packets` took apart."""
    rows, columns = -(-height // side), -(-width // side)
    tiles = packets.reshape(rows, columns, side, side, -1).swapaxes(1, 2)
    return tiles.reshape(rows * side, columns * side, -1)[:height, :width]


def _transform_part(batch: Batch, camera_from_world: DoubleArray) -> tuple[IndexArray, DoubleArray]:
    """Vertex indices ``(n, 3)`` and corners ``(n, 3, 3)`` of all instances, in camera space."""
    triangles = batch.geometry.triangles.astype(np.int64)
    indices, corners = [np.zeros((0, 3), np.int64)], [np.zeros((0, 3, 3))]
    for pose in camera_from_world @ batch.poses:
        positions = batch.geometry.positions @ pose[:3, :3].T + pose[:3, 3]
        wound = triangles if np.linalg.det(pose[:3, :3]) >= 0 else triangles[:, [0, 2, 1]]
        indices.append(wound)
        corners.append(positions[wound])
    return np.concatenate(indices), np.concatenate(corners)


def _base_colour(batch: Batch, corners: IndexArray, u: DoubleArray, v: DoubleArray) -> DoubleArray:
    """``(n, 4)`` base colour and opacity at places of triangles, as ``layers/material.glsl`` has them."""
    material, geometry = batch.material, batch.geometry

    def between(values: FloatArray) -> DoubleArray:
        a, b, c = (values[corners[:, i]].astype(np.float64) for i in range(3))
        return a + u[:, None] * (b - a) + v[:, None] * (c - a)

    def places(lookup: TextureLookup) -> DoubleArray:
        uvs = geometry.coordinates(lookup)
        return np.zeros((len(u), 2)) if uvs is None else between(uvs)

    colour = np.tile([*material.base_color, material.opacity], (len(u), 1)).astype(np.float64)
    if "base_color" in material.lookups:
        lookup = material.lookups["base_color"]
        colour[:, :3] = looked_up(lookup, places(lookup))[:, :3]
    if "opacity" in material.lookups:
        lookup = material.lookups["opacity"]
        colour[:, 3] = looked_up(lookup, places(lookup))[:, max(lookup.channel, 0)]
    if material.uses_display_color and geometry.colors is not None:
        colour *= between(geometry.colors)
    colour[:, 3] = np.clip(colour[:, 3], 0, 1)
    if material.opacity_threshold > 0:
        colour[:, 3] = colour[:, 3] >= material.opacity_threshold
    return colour


def looked_up(lookup: TextureLookup, uv: DoubleArray) -> DoubleArray:
    """``(n, 4)`` values of a texture at texture coordinates ``(n, 2)``, bilinear between texels."""
    places = np.concatenate([uv, np.ones((len(uv), 1))], axis=1) @ lookup.uv_transform.T.astype(np.float64)
    if not lookup.image.tiles:
        texels = _bilinear(lookup.image, places[:, 0], 1 - places[:, 1], lookup.wrap_s, lookup.wrap_t)
        return np.asarray(texels * lookup.scale + lookup.bias)
    layers, values = (
        layers_at(lookup.image.tiles, places),
        np.tile(lookup.fallback.astype(np.float64), (len(places), 1)),
    )
    within = places - np.floor(places)
    for number, pixels in enumerate(lookup.image.pixels):
        here = layers == number
        texels = _bilinear(Image(pixels), within[here, 0], 1 - within[here, 1], "clamp", "clamp")
        values[here] = texels * lookup.scale + lookup.bias
    return values


def _bilinear(image: Image, across: DoubleArray, down: DoubleArray, wrap_s: Wrap, wrap_t: Wrap) -> DoubleArray:
    """``(..., 4)`` at places from 0 to 1 across and down the image."""
    height, width = image.pixels.shape[:2]
    x, y = across * width - 0.5, down * height - 0.5
    left, top = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    value = np.zeros((*x.shape, 4))
    for column, share_x in ((left, 1 - (x - left)), (left + 1, x - left)):
        for row, share_y in ((top, 1 - (y - top)), (top + 1, y - top)):
            (i, inside_y), (j, inside_x) = _wrap(row, height, wrap_t), _wrap(column, width, wrap_s)
            texel = image.pixels[i, j].astype(np.float64)
            value += (share_x * share_y * inside_x * inside_y)[..., None] * texel
    return value


def _wrap(index: IndexArray, count: int, wrap: Wrap) -> tuple[IndexArray, DoubleArray]:
    """Which texel stands for an index, and whether it counts."""
    inside = np.ones(index.shape)
    if wrap == "repeat":
        return index % count, inside
    if wrap == "mirror":
        folded = index % (2 * count)
        return np.minimum(folded, 2 * count - 1 - folded), inside
    if wrap == "black":
        inside = ((index >= 0) & (index < count)).astype(np.float64)
    return np.clip(index, 0, count - 1), inside


def _dome_radiance(dome: Dome, directions: DoubleArray) -> DoubleArray:
    """``(..., 3)`` from world directions; the image is laid out as `render.model.scene.Dome` says."""
    radiance = np.asarray(dome.radiance, np.float64)
    if dome.image is None:
        return np.broadcast_to(radiance, directions.shape)
    axes = dome.pose[:3, :3] / np.linalg.norm(dome.pose[:3, :3], axis=0)
    x, y, z = np.moveaxis(directions @ np.linalg.inv(axes).T, -1, 0)
    across = 0.5 - np.arctan2(x, z) / (2 * np.pi)
    down = np.arccos(np.clip(y / np.sqrt(x * x + y * y + z * z), -1, 1)) / np.pi
    return np.asarray(radiance * _bilinear(dome.image, across, down, "repeat", "clamp")[..., :3])
