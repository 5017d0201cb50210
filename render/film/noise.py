"""Random numbers that belong to a place: each row of a picture has a stream of its own, whoever asks for it and in what order."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from render.scene import FloatArray

_MAX_THREADS = 8
_ROWS_AT_ONCE = 32
_FIRST_ROW = 1 << 32  # rows may be negative: a kernel reaches beyond the picture


def normal_rows(rows: range, columns: int, channels: int, *, frame: int, seed: int) -> FloatArray:
    """Independent normal numbers of mean 0 and variance 1 for some rows of a picture.

    A row's numbers depend on the row, the frame and the seed alone (Philox, a generator that counts: Salmon et al. 2011), so
    tiles of a picture fit together and threads do not matter.

    Args:
        rows: which rows; they may be negative.
        columns: how many, from the leftmost on.
        channels: how many numbers for each pixel.
        frame: frame number.
        seed: which noise; any integer.

    Returns:
        ``(len(rows), columns, channels)`` float32.
    """
    numbers = np.empty((len(rows), columns, channels), np.float32)
    key = np.array([seed % 2**64, frame % 2**64], np.uint64)

    def fill(first: int) -> None:
        for i in range(first, min(first + _ROWS_AT_ONCE, len(rows))):
            counter = np.array([0, 0, 0, rows[i] + _FIRST_ROW], np.uint64)
            generator = np.random.Generator(np.random.Philox(key=key, counter=counter))
            generator.standard_normal(dtype=np.float32, out=numbers[i])

    with ThreadPoolExecutor(min(_MAX_THREADS, os.cpu_count() or 1)) as threads:
        list(threads.map(fill, range(0, len(rows), _ROWS_AT_ONCE)))
    return numbers
