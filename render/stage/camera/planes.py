"""Image files that hold numbers and not colours: iris masks and height fields."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pxr import Ar

from render.model.arrays import DoubleArray
from render.stage.materials.image_files import TextureError
from render.stage.materials.textures import as_file, read_pixels, require_inside

MAX_SIDE = 2048  # beyond it, neighbours are averaged: a pupil has no finer detail


def read_plane(resolved_path: str, confined_to: Path | None) -> DoubleArray:
    """Read the first channel of an image as raw numbers, 0 to 1 for integer formats.

    The same file gives the same array, until it is rewritten.

    Args:
        resolved_path: as Ar resolves it; may be inside a package.
        confined_to: the folder that the file must lie in, or None.

    Returns:
        ``(h, w)`` float64, row 0 at the top.

    Raises:
        TextureError: the file is missing, outside the folder, damaged or holds invalid numbers; the message ends a sentence.
    """
    if not resolved_path:
        raise TextureError("is missing")
    require_inside(resolved_path, confined_to)
    return _read(resolved_path, _stamp(resolved_path))


def read_first_channel(resolved_path: str) -> tuple[NDArray[np.generic], int]:
    """First channel ``(h, w)`` of an image as it is stored, row 0 at the top, and the number in it that stands for 1.

    Raises:
        TextureError: the file is missing or damaged.
    """
    with as_file(resolved_path) as file:
        pixels, _ = read_pixels(file, "raw")
    return pixels[..., 0], 2 ** (8 * pixels.dtype.itemsize) - 1 if pixels.dtype.kind == "u" else 1


def rotate_plane(plane: DoubleArray, angle_rad: float) -> DoubleArray:
    """An image turned counter-clockwise about its centre, as large as before; 0 comes in at the corners.

    Args:
        plane: ``(h, w)``, row 0 at the top; it covers a square, whatever its shape.
        angle_rad: the turn.
    """
    if angle_rad == 0:
        return plane
    height, width = plane.shape
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, 1 - (np.arange(height) + 0.5) / height * 2)
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    column = (cos * x + sin * y + 1) / 2 * width - 0.5
    row = (1 - (cos * y - sin * x)) / 2 * height - 0.5
    padded = np.pad(plane, 1)
    left, top = np.clip(np.floor(column), -1, width - 1), np.clip(np.floor(row), -1, height - 1)
    right_share, lower_share = np.clip(column - left, 0, 1), np.clip(row - top, 0, 1)
    i, j = top.astype(int) + 1, left.astype(int) + 1
    upper = padded[i, j] * (1 - right_share) + padded[i, j + 1] * right_share
    lower = padded[i + 1, j] * (1 - right_share) + padded[i + 1, j + 1] * right_share
    return np.asarray(upper * (1 - lower_share) + lower * lower_share)


@lru_cache(maxsize=32)
def _read(resolved_path: str, stamp: tuple[int, int]) -> DoubleArray:
    stored, one = read_first_channel(resolved_path)
    values = stored.astype(np.float64) / one
    if not np.isfinite(values).all():
        raise TextureError("holds what is no finite number")
    values = _downsample(values, -(-max(values.shape) // MAX_SIDE))
    values.setflags(write=False)
    return values


def _downsample(values: DoubleArray, factor: int) -> DoubleArray:
    """Means of ``factor`` by ``factor`` blocks; the last row and column are repeated to fill whole blocks."""
    height, width = values.shape
    padded = np.pad(values, ((0, -height % factor), (0, -width % factor)), mode="edge")
    blocks = padded.reshape(padded.shape[0] // factor, factor, padded.shape[1] // factor, factor)
    return np.asarray(blocks.mean(axis=(1, 3)))


def _stamp(resolved_path: str) -> tuple[int, int]:
    """Stamp that changes when a file is rewritten."""
    while Ar.IsPackageRelativePath(resolved_path):
        resolved_path = Ar.SplitPackageRelativePathOuter(resolved_path)[0]
    try:
        status = os.stat(resolved_path)
    except OSError as error:
        raise TextureError("is missing") from error
    return status.st_mtime_ns, status.st_size
