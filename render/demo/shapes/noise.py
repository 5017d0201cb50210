"""Periodic noise, blur and normal maps on image grids, from which textures are made."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Plane = NDArray[np.float32]
"""``(height, width)`` values or ``(height, width, channels)`` colours."""


def lattice_noise(size: int, cells: int, seed: int) -> Plane:
    """Make ``(size, size)`` value noise in 0..1 that tiles, with ``cells`` random values along each side."""
    values = np.random.default_rng(seed).random((cells, cells), np.float32)
    position = np.arange(size, dtype=np.float32) * cells / size
    first = position.astype(int)
    blend = position - first
    blend = blend * blend * (3 - 2 * blend)
    second = (first + 1) % cells
    rows = values[first] * (1 - blend)[:, None] + values[second] * blend[:, None]
    return np.asarray(rows[:, first] * (1 - blend) + rows[:, second] * blend, np.float32)


def fractal_noise(size: int, cells: int, octaves: int, seed: int) -> Plane:
    """Make ``(size, size)`` tiling noise in 0..1: octaves of `lattice_noise`, each half as strong as the one before."""
    layers = [lattice_noise(size, cells << k, seed + k) / (1 << k) for k in range(octaves)]
    return np.asarray(sum(layers) / sum(1 / (1 << k) for k in range(octaves)), np.float32)


def blur(image: Plane, sigma_px: float) -> Plane:
    """Blur the first two axes by a Gaussian that wraps around the edges, by Fourier transform."""
    height, width = image.shape[:2]
    decay = [np.exp(-2 * (np.pi * sigma_px * np.fft.fftfreq(n)) ** 2) for n in (height, width)]
    transfer = np.outer(*decay)
    if image.ndim == 3:
        transfer = transfer[..., None]
    return np.asarray(np.fft.ifft2(np.fft.fft2(image, axes=(0, 1)) * transfer, axes=(0, 1)).real, np.float32)


def normal_map(height_m: Plane, size_m: float) -> Plane:
    """Make the tangent-space normal map of a tiling height field, normals packed into 0..1, +Y up the picture.

    Args:
        height_m: ``(h, w)`` heights, row 0 at the top.
        size_m: length of a side of the tile.
    """
    texel_m = size_m / height_m.shape[0]
    slope_x = (np.roll(height_m, -1, 1) - np.roll(height_m, 1, 1)) / (2 * texel_m)
    slope_y = (np.roll(height_m, 1, 0) - np.roll(height_m, -1, 0)) / (2 * texel_m)
    normal = np.stack([-slope_x, -slope_y, np.ones_like(height_m)], axis=-1)
    return np.asarray(normal / np.linalg.norm(normal, axis=-1, keepdims=True) * 0.5 + 0.5, np.float32)
