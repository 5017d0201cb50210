"""Lights as the simpler ones that they are drawn as: a rect with an image as smaller rects of one colour."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from render.layers.lights import MAX_LIGHTS
from render.model.arrays import DoubleArray
from render.model.scene import Light

_MOST_ACROSS = 4


def light_parts(lights: Sequence[Light]) -> tuple[tuple[Light, ...], ...]:
    """Parts that each light is drawn as, at most `MAX_LIGHTS` together: a rect with an image has 16, or fewer where others need
    the room.

    Args:
        lights: at most `MAX_LIGHTS`.
    """
    pictured = sum(light.image is not None for light in lights)
    across = next((n for n in range(_MOST_ACROSS, 1, -1) if len(lights) + pictured * (n * n - 1) <= MAX_LIGHTS), 1)
    return tuple(_patches(light, across) for light in lights)


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
