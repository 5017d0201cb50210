"""Mattes: which share of each pixel shows which prim and which material, summed up and ranked as Cryptomatte 1.2 has it.

Source: Friedman & Jones 2015, "Fully Automatic ID Mattes with Support for Motion Blur and Transparency", and Psyop's Cryptomatte
Specification 1.2.0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.model.area import Area
from render.model.arrays import DoubleArray, FloatArray, IndexArray, LongArray
from render.model.deep import DeepSamples, layer_samples

OBJECT, MATERIAL = "cryptoObject", "cryptoMaterial"
MATTES = (OBJECT, MATERIAL)
"""Names of the mattes, which are AOVs."""
RANKS = 6
"""Ids of a pixel that a file holds: those of the greatest coverage."""
NO_MATERIAL = "default"
"""Name of the material of prims with none bound."""


class MatteSum:
    """Coverage of a picture's pixels by surfaces, summed over the moments of the shutter's opening.

    A surface is numbered by its prim and its material together, so that one pass serves both mattes.

    Args:
        width: of the picture in pixels.
        height: of the picture in pixels.
        is_deep: whether the light and the depth of surfaces are summed too, and surfaces at depths apart are kept apart. There
            are no mattes then: a number stands for a surface at a depth.

    Attributes:
        is_deep: as given.
    """

    def __init__(self, width: int, height: int, *, is_deep: bool = False) -> None:
        self._width, self._height = width, height
        self.is_deep = is_deep
        self._numbers: dict[tuple[str, str], int] = {}
        self._new: list[tuple[LongArray, LongArray, DoubleArray]] = []
        self._pixels, self._surfaces = np.zeros(0, np.int64), np.zeros(0, np.int64)
        self._values = np.zeros((0, 5 if is_deep else 1))

    def number(self, prim: str, material: str) -> int:
        """Return the number of the surfaces of a prim with a material, from 1 on.

        Args:
            prim: path.
            material: path of the bound material, empty for none.
        """
        return self._numbers.setdefault((prim, material or NO_MATERIAL), len(self._numbers) + 1)

    def put(self, area: Area, surfaces: NDArray[np.uint32], values: FloatArray, base_w: float = 0.0) -> None:
        """Add the coverage of a part of the picture.

        Args:
            area: left, top, width and height in pixels.
            surfaces: ``(slots, height, width)`` numbers; 0 in slots that are not used.
            values: ``(slots, height, width, 1)`` coverage; of a deep sum ``(slots, height, width, 5)`` coverage, red, green and
                blue, and inverse depth in 1/m times coverage.
            base_w: inverse depth that those of the values count from, 1/m.
        """
        left, top, _, _ = area
        slot, row, column = np.nonzero(surfaces)
        place = slot, row, column
        pixels = (top + row.astype(np.int64)) * self._width + left + column
        entries = values[place].astype(np.float64)
        entries[:, 4:] += base_w * entries[:, :1]
        self._new.append((pixels, surfaces[place].astype(np.int64), entries))

    def end_moment(self, share: float | FloatArray) -> None:
        """Weigh what was put since the last moment.

        Args:
            share: of the picture's light, that broadcasts to ``(height, width, 1)``.
        """
        shares = np.broadcast_to(share, (self._height, self._width, 1)).reshape(-1)
        weighed = [(pixels, surfaces, values * shares[pixels, None]) for pixels, surfaces, values in self._new]
        columns = zip((self._pixels, self._surfaces, self._values), *weighed, strict=True)
        self._pixels, self._surfaces, self._values = _gather(*(np.concatenate(column) for column in columns))
        self._new = []

    def layer(self, color: FloatArray) -> DeepSamples:
        """Samples of a deep sum, for the flat picture ``(height, width, 4)`` that they belong to."""
        return layer_samples(self._pixels, self._values, color)

    def rank(self, matte: str) -> tuple[FloatArray, tuple[str, ...]]:
        """Rank what covers each pixel.

        Args:
            matte: one of `MATTES`.

        Returns:
            ``(height, width, 2 * RANKS)`` float32: ids (`id_of`) and coverage of each pixel in turn, greatest coverage first, 0
            where there are fewer; and the names in the picture, sorted.
        """
        of = MATTES.index(matte)
        names = sorted({key[of] for key in self._numbers})
        rank_of_name = {name: i for i, name in enumerate(names)}
        name_of_surface = np.array([0, *(rank_of_name[key[of]] for key in self._numbers)], np.int64)
        pixels, numbers, values = _gather(self._pixels, name_of_surface[self._surfaces], self._values)
        weights = values[:, 0]
        ids = np.array([id_of(name) for name in names], np.float32)
        order = np.lexsort((numbers, -weights, pixels))
        pixels, numbers, weights = pixels[order], numbers[order], weights[order]
        starts = np.flatnonzero(np.diff(pixels, prepend=-1))
        rank = np.arange(len(pixels)) - np.repeat(starts, np.diff(starts, append=len(pixels)))
        kept = (rank < RANKS) & (weights > 0)
        pixels, numbers, weights, rank = pixels[kept], numbers[kept], weights[kept], rank[kept]
        ranked = np.zeros((self._height * self._width, RANKS, 2), np.float32)
        ranked[pixels, rank, 0], ranked[pixels, rank, 1] = ids[numbers], weights
        present = tuple(names[i] for i in np.unique(numbers))
        return ranked.reshape(self._height, self._width, 2 * RANKS), present


def make_matte_sum(width: int, height: int, aovs: tuple[str, ...], *, deep: bool = False) -> MatteSum | None:
    """Make a sum for a picture, where it is deep or its AOVs include a matte."""
    return MatteSum(width, height, is_deep=deep) if deep or set(aovs) & set(MATTES) else None


def murmur3(text: str) -> int:
    """Hash a text in UTF-8: MurmurHash3_x86_32 with the seed 0 (Appleby 2011), from 0 to 2^32 - 1."""
    data, mask = text.encode(), 0xFFFFFFFF

    def scramble(k: int) -> int:
        k = k * 0xCC9E2D51 & mask
        return (k << 15 | k >> 17) * 0x1B873593 & mask

    h, whole = 0, len(data) // 4 * 4
    for i in range(0, whole, 4):
        h ^= scramble(int.from_bytes(data[i : i + 4], "little"))
        h = ((h << 13 | h >> 19) * 5 + 0xE6546B64) & mask
    h ^= scramble(int.from_bytes(data[whole:], "little"))
    h ^= len(data)
    h = (h ^ h >> 16) * 0x85EBCA6B & mask
    h = (h ^ h >> 13) * 0xC2B2AE35 & mask
    return h ^ h >> 16


def id_bits(name: str) -> int:
    """Bits of the id of a name: its hash with the exponent kept from 1 to 254, so that they are a finite normal float."""
    h = murmur3(name)
    exponent = min(max(h >> 23 & 0xFF, 1), 254)
    return h & 0x807FFFFF | exponent << 23


def id_of(name: str) -> np.float32:
    """Return the id of a name, as pixels hold it."""
    return np.float32(np.array(id_bits(name), np.uint32).view(np.float32))


def _gather(pixels: LongArray, numbers: LongArray, values: DoubleArray) -> tuple[LongArray, LongArray, DoubleArray]:
    """Add the values ``(n, k)`` of entries of the same pixel and number; sorted by pixel, then number."""
    if not len(pixels):
        return pixels, numbers, values
    count = int(numbers.max()) + 1
    keys, inverse = np.unique(pixels * count + numbers, return_inverse=True)
    which: IndexArray = inverse
    sums = [np.bincount(which, column, len(keys)) for column in values.T]
    return keys // count, keys % count, np.stack(sums, axis=1).astype(np.float64)
