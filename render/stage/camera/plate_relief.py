"""Relief of back plates (UsdGeomBackPlateAPI): each place of a plate at the depth that ``depth:image`` gives it.

A place stays on its line of sight, so that the camera sees the same picture, and the lens blurs each part of it by its own depth.
Where depths jump, the surface goes on along the line of sight, on which the middle of the lens sees nothing of it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.stage.camera.planes import read_first_channel
from render.stage.camera.plate_places import read_numbers
from render.stage.materials.textures import require_inside

_MAX_VERTICES = 512
"""Vertices along the longer side of a plate; of larger images every so many texels count."""
_FARTHEST = 1e9  # scene units; larger numbers stand for nothing
_MOST_IMAGES = 4


class DepthImages:
    """Depth images of plates, each read once; the newest are kept.

    Args:
        confined_to: folder that every image must lie in, or None.
    """

    def __init__(self, confined_to: Path | None) -> None:
        self._confined_to = confined_to
        self._read: dict[str, DoubleArray] = {}

    def texels(self, resolved_path: str) -> DoubleArray:
        """First channel ``(h, w)`` of an image, row 0 at the top: raw numbers, 0 to 1 for integer formats.

        Args:
            resolved_path: as Ar resolves it.

        Raises:
            TextureError: the file is missing, outside the folder or damaged.
        """
        if resolved_path not in self._read:
            require_inside(resolved_path, self._confined_to)
            stored, one = read_first_channel(resolved_path)
            self._read[resolved_path] = _thin_out(stored).astype(np.float64) / one
            if len(self._read) > _MOST_IMAGES:
                self._read.pop(next(iter(self._read)))
        return self._read[resolved_path]


def compute_depths(plate: UsdGeom.BackPlateAPI, texels: DoubleArray, time: Usd.TimeCode) -> DoubleArray:
    """Depths ``(h, w)`` in front of the camera, scene units; NaN where there is none.

    Args:
        plate: the plate, for its offsets and its factor.
        texels: of its depth image.
        time: USD time code.

    Raises:
        PlateError: an offset or the factor is no finite number.
    """
    attributes = (
        plate.GetDepthMinOffsetAttr(),
        plate.GetDepthNormalizingFactorAttr(),
        plate.GetDepthCameraSpaceOffsetAttr(),
    )
    least, factor, offset = (read_numbers(attribute, time, 1)[0] for attribute in attributes)
    with np.errstate(over="ignore", invalid="ignore"):
        depths = (texels - least) * factor + offset
        return np.where((depths > 0) & (depths < _FARTHEST), depths, np.nan)


def make_relief(depths: DoubleArray, place: DoubleArray) -> tuple[FloatArray, FloatArray, IntArray]:
    """Positions ``(n, 3)`` in camera space, scene units, texture coordinates ``(n, 2)`` and triangles ``(m, 3)`` of a relief.

    Args:
        depths: ``(h, w)`` of the plate's texels, row 0 at the top, at least 2 each way; NaN for the depth of the plate itself.
        place: ``(4, 4)`` to camera space from the plate's own, in which it is a square of side 1.
    """
    height, width = depths.shape
    u, v = np.meshgrid(np.linspace(0, 1, width), np.linspace(1, 0, height))
    flat = np.stack([u - 0.5, v - 0.5, np.zeros_like(u)], axis=-1) @ place[:3, :3].T + place[:3, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = depths / -flat[..., 2]
    along = np.where(np.isfinite(along) & (along > 0), along, 1.0)
    first = (np.arange(height - 1)[:, None] * width + np.arange(width - 1)).ravel()
    upper = np.stack([first + 1, first, first + width], axis=1)
    lower = np.stack([first + 1, first + width, first + width + 1], axis=1)
    uvs = np.stack([u, v], axis=-1).reshape(-1, 2)
    positions = (flat * along[..., None]).reshape(-1, 3)
    return positions.astype(np.float32), uvs.astype(np.float32), np.concatenate([upper, lower]).astype(np.int32)


def _thin_out(texels: NDArray[np.generic]) -> NDArray[np.generic]:
    """Some texels, evenly spread, from the first to the last; of a single row or column two."""
    step = max(1.0, max(texels.shape) / _MAX_VERTICES)
    rows, columns = (np.linspace(0, side - 1, max(2, round(side / step))) for side in texels.shape)
    return np.asarray(texels[np.ix_(np.rint(rows).astype(int), np.rint(columns).astype(int))])
