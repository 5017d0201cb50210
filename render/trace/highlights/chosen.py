"""Highlights that are to be carried, as they were found in the layers of a picture or in a strip of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.area import Area

CARRIED = np.dtype([("box", "f4", 4), ("excess", "f4", 4), ("place", "f4", 4), ("cells", "u4")])
"""First and last place of a blurred image in the picture, pixels; radiance over the surroundings times opacity and area, and
inverse depth seen from the picture's camera; place in the picture's frame, inverse depth on the layers from which on surfaces are
in the way, and side, layer pixels; cells of the pupil across and down by which it is scattered, or 0 where it is joined to
pixels."""
TAKEN = np.dtype([("texel", "u4", 3), ("base", "u4", 2), ("exact", "u4", 2)])
"""Place in the whole picture's layers and layer; radiance that rays are to see, and the texel's own, four halves each."""


@dataclass(frozen=True, eq=False)
class Highlights:
    """Highlights that were chosen.

    Attributes:
        carried: `CARRIED` of each.
        taken: `TAKEN` of the texels that they consist of.
    """

    carried: NDArray[np.void]
    taken: NDArray[np.void]

    def taken_within(self, origin: tuple[int, int], size: tuple[int, int]) -> NDArray[np.uint32]:
        """Texels that are within a part of the layers, ``(n, 6)`` as ``highlights/take.comp`` reads them; places in that part."""
        place = self.taken["texel"][:, :2].astype(np.int64) - origin
        inside = ((place >= 0) & (place < size)).all(axis=1)
        taken, place = self.taken[inside], place[inside].astype(np.uint32)
        packed = np.stack([place[:, 0] | place[:, 1] << np.uint32(16), taken["texel"][:, 2]], axis=1)
        return np.concatenate([packed, taken["base"], taken["exact"]], axis=1)


NONE = Highlights(np.zeros(0, CARRIED), np.zeros(0, TAKEN))
"""No highlights."""


def join_highlights(some: Iterable[Highlights]) -> Highlights:
    """All highlights of several lists, in their order."""
    lists = [NONE, *some]
    return Highlights(np.concatenate([each.carried for each in lists]), np.concatenate([each.taken for each in lists]))


def pixels_seen(boxes: NDArray[np.float32], area: Area) -> NDArray[np.float64]:
    """Pixels of an area that boxes ``(n, 4)`` cover, ``(n,)``."""
    left, top, width, height = area
    low = np.maximum(np.floor(boxes[:, :2]), (left, top)).astype(np.float64)
    high = np.minimum(np.ceil(boxes[:, 2:]), (left + width, top + height))
    return np.asarray(np.prod(np.maximum(high - low, 0.0), axis=1))
