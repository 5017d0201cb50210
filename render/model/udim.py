"""Numbering of UDIM tiles: ten to a row from 1001 on, each for a unit square of texture coordinates."""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray, LongArray

FIRST_TILE = 1001
TILES_A_ROW = 10
MOST_ROWS = 10
LAST_TILE = FIRST_TILE + TILES_A_ROW * MOST_ROWS - 1


def tiles_at(places: DoubleArray) -> LongArray:
    """``(n,)`` numbers of the tiles at texture coordinates ``(n, 2)``; 0 where no tile can be."""
    within = np.all((places >= 0) & (places < (TILES_A_ROW, MOST_ROWS)), axis=1)
    column, row = np.floor(np.where(within[:, None], places, 0)).astype(np.int64).T
    return np.where(within, FIRST_TILE + column + TILES_A_ROW * row, 0)


def layers_at(tiles: tuple[int, ...], places: DoubleArray) -> LongArray:
    """``(n,)`` which of some tiles, given by ascending numbers, are at texture coordinates ``(n, 2)``; -1 for none of them."""
    numbers, known = tiles_at(places), np.array(tiles, np.int64)
    layer = np.minimum(np.searchsorted(known, numbers), len(known) - 1)
    return np.where(known[layer] == numbers, layer, -1)


def tile_bits(tiles: tuple[int, ...]) -> tuple[int, int, int, int]:
    """Four words of 32 bits, least first, with a bit for each tile."""
    bits = sum(1 << (number - FIRST_TILE) for number in tiles)
    first, second, third, fourth = (bits >> (32 * word) & 0xFFFFFFFF for word in range(4))
    return first, second, third, fourth
