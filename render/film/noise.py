"""Random numbers per pixel: reproducible in any order, on the CPU and on the device.

Each pixel's numbers are a hash of its position (PCG in four dimensions: Jarzynski & Olano 2020, "Hash Functions for GPU
Rendering", JCGT 9:3), made normal by Box & Muller (1958). `render/shaders/film/noise.glsl` is the same, operation by operation.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import FloatArray

_MAX_THREADS = 8
_ROWS_AT_ONCE = 16
_MULTIPLIER, _INCREMENT = np.uint32(1664525), np.uint32(1013904223)
_HALF_WORD, _KEPT = np.uint32(16), np.uint32(9)  # shifts: 23 bits of a word, and a half, fit a float's fraction
_STEP = np.float32(2.0**-23)

Words = NDArray[np.uint32]


def noise_key(frame: int, seed: int) -> tuple[int, int]:
    """Key of 64 bits that selects a noise.

    Args:
        frame: frame number, any integer.
        seed: which noise, any integer.
    """
    first, second = np.random.SeedSequence([seed % 2**64, frame % 2**64]).generate_state(2).tolist()
    return first, second


def normal_noise(rows: range, columns: range, channels: int, *, frame: int, seed: int) -> FloatArray:
    """Independent normal numbers of mean 0 and variance 1 for some rows and columns of a picture.

    Args:
        rows: which rows; they may be negative.
        columns: columns of the pixels.
        channels: numbers per pixel, up to 4.
        frame: frame number.
        seed: which noise; any integer.

    Returns:
        ``(len(rows), len(columns), channels)`` float32.
    """
    numbers = np.empty((len(rows), len(columns), channels), np.float32)
    key = noise_key(frame, seed)
    across = np.array(columns, np.int64).astype(np.uint32)[None, :]

    def fill(first: int) -> None:
        band = rows[first : first + _ROWS_AT_ONCE]
        down = np.array(band, np.int64).astype(np.uint32)[:, None]
        _fill(numbers[first : first + len(band)], _hash(across, down, key))

    with ThreadPoolExecutor(min(_MAX_THREADS, os.cpu_count() or 1)) as threads:
        list(threads.map(fill, range(0, len(rows), _ROWS_AT_ONCE)))
    return numbers


def _hash(across: Words, down: Words, key: tuple[int, int]) -> list[Words]:
    """Four words for each place."""
    shape = np.broadcast_shapes(across.shape, down.shape)
    words = [np.broadcast_to(np.asarray(part, np.uint32), shape) for part in (across, down, *key)]
    x, y, z, w = (word * _MULTIPLIER + _INCREMENT for word in words)
    _mix(x, y, z, w)
    for word in (x, y, z, w):
        word ^= word >> _HALF_WORD
    _mix(x, y, z, w)
    return [x, y, z, w]


def _mix(x: Words, y: Words, z: Words, w: Words) -> None:
    x += y * w
    y += z * x
    z += x * y
    w += y * z


def _fill(numbers: FloatArray, words: list[Words]) -> None:
    """Normal numbers of uniform words: two of either pair."""
    for pair in range((numbers.shape[2] + 1) // 2):
        radius_word, angle_word = words[2 * pair : 2 * pair + 2]
        radius = np.sqrt(np.float32(-2) * np.log(_uniform(radius_word)))
        angle = np.float32(2 * np.pi) * (_uniform(angle_word) - np.float32(0.5))
        numbers[..., 2 * pair] = radius * np.cos(angle)
        if 2 * pair + 1 < numbers.shape[2]:
            numbers[..., 2 * pair + 1] = radius * np.sin(angle)


def _uniform(words: Words) -> FloatArray:
    """Numbers between 0 and 1, neither of which they reach; exact in single precision."""
    return ((words >> _KEPT).astype(np.float32) + np.float32(0.5)) * _STEP
