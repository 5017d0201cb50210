"""Owen-scrambled Sobol points in four dimensions.

Direction numbers: Joe & Kuo 2008, "Constructing Sobol Sequences with Better Two-Dimensional Projections" (new-joe-kuo-6), their
first four dimensions. Scrambling: Owen 1995, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", by a hash on reversed bits
(Laine & Karras 2011; Burley 2020, "Practical Hash-based Owen Scrambling", with Vegdahl's constants of 2021).
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray

DIMENSIONS = 4
_BITS = 32
_PRIMITIVE = ((0, ()), (0, (1,)), (1, (1, 3)), (1, (1, 3, 1)))  # inner coefficients and first direction numbers

Words: TypeAlias = NDArray[np.uint32]


def owen_sobol(count: int, seed: int) -> DoubleArray:
    """Make the first points of the sequence.

    Args:
        count: number of points; any run of successive points is well spread, best where its length is a power of two and divides
            the index of its first point.
        seed: of the scrambling, 0 to 2³¹ - 1.

    Returns:
        ``(count, 4)`` in [0, 1).
    """
    points = np.empty((count, DIMENSIONS))
    for dimension, salt in enumerate(
        hash_words(np.arange(DIMENSIONS, dtype=np.uint32) + np.uint32(seed * DIMENSIONS % 2**32))
    ):
        points[:, dimension] = _scramble(_sobol(count, dimension), salt) * 2.0**-_BITS
    return points


def hash_words(words: Words) -> Words:
    """Hash 32-bit words (Wellons 2018, "lowbias32")."""
    words = (words ^ (words >> np.uint32(16))) * np.uint32(0x7FEB352D)
    words = (words ^ (words >> np.uint32(15))) * np.uint32(0x846CA68B)
    return words ^ (words >> np.uint32(16))


def _sobol(count: int, dimension: int) -> Words:
    """Coordinates ``(count,)`` of the unscrambled sequence, as 32-bit fractions."""
    points = np.zeros(1, np.uint32)
    for number in _direction_numbers(dimension)[: (count - 1).bit_length()]:
        points = np.concatenate([points, points ^ np.uint32(number)])
    return points[:count]


def _direction_numbers(dimension: int) -> list[int]:
    """Direction numbers as 32-bit fractions, by Joe & Kuo's recurrence; the first dimension is van der Corput's."""
    inner, first = _PRIMITIVE[dimension]
    if not first:
        return [1 << (_BITS - 1 - i) for i in range(_BITS)]
    degree, numbers = len(first), list(first)
    for i in range(degree, _BITS):
        number = numbers[i - degree] ^ (numbers[i - degree] << degree)
        for k in range(1, degree):
            number ^= (inner >> (degree - 1 - k) & 1) * (numbers[i - k] << k)
        numbers.append(number)
    return [number << (_BITS - 1 - i) for i, number in enumerate(numbers)]


def _scramble(words: Words, salt: np.uint32) -> Words:
    """Permute each digit by a hash of the digits before it."""
    words = _reverse_bits(words)
    words = words ^ (words * np.uint32(0x3D20ADEA))
    words = words + salt
    words = words * ((salt >> np.uint32(16)) | np.uint32(1))
    words = words ^ (words * np.uint32(0x05526C56))
    words = words ^ (words * np.uint32(0x53A22864))
    return _reverse_bits(words)


def _reverse_bits(words: Words) -> Words:
    for shift, mask in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF), (16, 0x0000FFFF)):
        step, low = np.uint32(shift), np.uint32(mask)
        words = ((words >> step) & low) | ((words & low) << step)
    return words
