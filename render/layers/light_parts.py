"""Lights as the simpler ones that they are drawn as: a rect with an image as smaller rects of one colour, a mesh as disks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from render.layers.facets import gather_facets
from render.layers.lights import MAX_LIGHTS, area_m2
from render.model.arrays import DoubleArray
from render.model.scene import Light

_MOST_ACROSS = 4


def light_parts(lights: Sequence[Light]) -> tuple[tuple[Light, ...], ...]:
    """Parts that each light is drawn as, at most `MAX_LIGHTS` together: a rect with an image and a mesh have 16, or fewer where
    others need the room.

    Args:
        lights: at most `MAX_LIGHTS`.
    """
    cut = sum(light.image is not None or light.triangles is not None for light in lights)
    across = next((n for n in range(_MOST_ACROSS, 1, -1) if len(lights) + cut * (n * n - 1) <= MAX_LIGHTS), 1)
    return tuple(
        _facets(light, across**2) if light.triangles is not None else _patches(light, across) for light in lights
    )


def _patches(light: Light, across: int) -> tuple[Light, ...]:
    """A rect's image as ``across`` by ``across`` rects of its mean colours."""
    if light.image is None:
        return (light,)
    means = _means(light.image.pixels[..., :3].astype(np.float64), across)
    width_m, height_m = light.width_m / across, light.height_m / across
    patches = []
    for row, column in np.ndindex(across, across):
        # row 0 is at +Y and column 0 at +X
        centre = [(0.5 * across - column - 0.5) * width_m, (0.5 * across - row - 0.5) * height_m, 0.0, 1.0]
        pose = light.pose.copy()
        pose[:, 3] = light.pose @ centre
        red, green, blue = np.asarray(light.radiance) * means[row, column]
        patches.append(
            replace(light, radiance=(red, green, blue), pose=pose, width_m=width_m, height_m=height_m, image=None)
        )
    return tuple(patches)


def _facets(light: Light, count: int) -> tuple[Light, ...]:
    """A mesh as disks that face where it faces; as a ball that shows the same area in the mean where there is room for one."""
    assert light.triangles is not None
    plain = replace(light, triangles=None)
    if count == 1:
        return (replace(plain, kind="sphere", radius_m=float(np.sqrt(area_m2(light) / np.pi))),)
    disks = []
    for facet in gather_facets(light.triangles, count):
        pose, area = np.eye(4), float(np.linalg.norm(facet[3:]))
        z = -facet[3:] / area
        x = np.cross([0.0, 1, 0] if abs(z[1]) < 0.9 else [1.0, 0, 0], z)
        pose[:3, 0], pose[:3, 2], pose[:3, 3] = x / np.linalg.norm(x), z, facet[:3]
        pose[:3, 1] = np.cross(z, pose[:3, 0])
        disks.append(replace(plain, kind="disk", pose=pose, radius_m=float(np.sqrt(area / np.pi))))
    return tuple(disks)


def _means(pixels: DoubleArray, across: int) -> DoubleArray:
    """Means ``(across, across, 3)`` of an image ``(h, w, 3)``; pixels at the edges of cells count in part."""
    rows, columns = (_shares(side, across) for side in pixels.shape[:2])
    return np.asarray(np.einsum("ah,bw,hwc->abc", rows, columns, pixels, optimize=True))


def _shares(side: int, across: int) -> DoubleArray:
    """Share ``(across, side)`` of each pixel in the mean of each cell."""
    edges = np.linspace(0, side, across + 1)
    pixels = np.arange(side)
    overlap = np.minimum(edges[1:, None], pixels + 1) - np.maximum(edges[:-1, None], pixels)
    return np.asarray(np.clip(overlap, 0, None) * across / side)
