"""Picture that is put together from tiles."""

from __future__ import annotations

import numpy as np

from render.model.area import Area
from render.model.arrays import FloatArray


class TiledPicture:
    """Picture of which some tiles are finished.

    Attributes:
        color: ``(height, width, 4)`` float32, premultiplied; 0 where no tile is finished.
    """

    def __init__(self, width: int, height: int) -> None:
        self.color = np.zeros((height, width, 4), np.float32)
        self._finished = np.zeros((height, width, 1), np.float32)

    def put(self, area: Area, color: FloatArray) -> None:
        """Add a finished tile."""
        place = _place(area)
        self.color[place] = color
        self._finished[place] = 1.0

    def with_unfinished(self, area: Area, color: FloatArray, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return copies of the picture and of the share of each pixel's rays, ``(height, width, 1)``, with a tile at work."""
        picture, finished, place = self.color.copy(), self._finished.copy(), _place(area)
        picture[place], finished[place] = color, shares
        return picture, finished


def _place(area: Area) -> tuple[slice, slice]:
    left, top, width, height = area
    return slice(top, top + height), slice(left, left + width)
