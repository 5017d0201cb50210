"""Irradiance of a dome by direction, as a table that the device looks up."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.scene import Image

IRRADIANCE_UNIT = 14
"""Texture unit as ``layers/lighting.glsl`` binds it."""
_ROWS = 65


def irradiance_image(image: Image | None) -> Image:
    """Irradiance over pi of an environment, by the integral over its cells.

    Args:
        image: latitude-longitude image of its radiance, or None for 1 from everywhere.

    Returns:
        Latitude-longitude image in the same axes, whose first and last rows are the poles themselves.
    """
    if image is None:
        return Image(np.ones((1, 1, 4), np.float16), "irradiance of a uniform dome")
    radiance, theta_edges, phi_edges = _downsample(image.pixels)
    theta, around = (
        (theta_edges[1:] + theta_edges[:-1]) / 2,
        2 * np.pi * np.arange(radiance.shape[1]) / radiance.shape[1],
    )
    solid_angle = -np.diff(np.cos(theta_edges))[:, None] * -np.diff(phi_edges)
    # a row of the table is a circular convolution of each row of the image, as columns are evenly spaced
    normal = np.linspace(0, np.pi, _ROWS)
    upright = np.cos(normal)[:, None] * np.cos(theta)
    level = np.sin(normal)[:, None] * np.sin(theta)
    cosines = np.maximum(upright[..., None] + level[..., None] * np.cos(around), 0)
    spectra = np.fft.rfft(radiance * solid_angle[..., None] / np.pi, axis=1)
    rows = np.einsum("nrf,rfc->nfc", np.fft.rfft(cosines, axis=2), spectra, optimize=True)
    table = np.ones((_ROWS, len(around), 4), np.float16)
    table[..., :3] = np.maximum(np.fft.irfft(rows, len(around), axis=1), 0)
    return Image(table, f"irradiance of {image.name}")


def _downsample(pixels: NDArray[np.float16]) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
    """Downsample a latitude-longitude image to about 64 rows: means ``(h, w, 3)``, and polar and azimuth angles between
    cells.

    A smaller image has its pixels repeated, since the harmonics need more samples; a larger one is averaged band by
    band.
    """
    pixels = pixels.repeat(-(-32 // pixels.shape[0]), axis=0).repeat(-(-64 // pixels.shape[1]), axis=1)
    height, width = pixels.shape[:2]
    rows = np.unique(np.linspace(0, height, 65).astype(int))
    columns = np.unique(np.linspace(0, width, 129).astype(int))
    bands = [pixels[a:b, :, :3].astype(np.float32).mean(0) for a, b in pairwise(rows)]
    means = np.add.reduceat(np.stack(bands), columns[:-1], axis=1) / np.diff(columns)[:, None]
    return means.astype(np.float64), rows / height * np.pi, (0.5 - columns / width) * 2 * np.pi
