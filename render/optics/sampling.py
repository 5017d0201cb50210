"""Sample patterns on the pupil and on the sensor: deterministic sequences, not random draws.

On the pupil the points follow the R2 sequence of Roberts 2018 ("The unreasonable effectiveness of quasirandom sequences"):
point i is ``frac(s + i·(1/g, 1/g²))`` with g the positive root of x³ = x + 1; its first coordinate is the squared radius and its
second the turn about the pupil's centre. On the pixel they follow the Halton sequence in bases 2 and 3 (Halton 1960). Each pixel
has one of 64 patterns by a blue-noise mask (`render.optics.blue_noise`): the same points turned by as many 64ths of a circle and
shifted in radius and on the sensor (Cranley & Patterson 1976), so that neighbours do not repeat each other's error and what error
there is lies in fine grain. Any number of first points fills the pupil evenly, so that a picture can be made of passes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray, IntArray
from render.model.lens import IrisShape
from render.model.limits import MAX_RAYS
from render.optics.blue_noise import SIDE, blue_noise_ranks
from render.optics.iris import fill_iris

PATTERNS = 64
_R2 = 1.0 / 1.32471795724474602596 ** np.arange(1, 3)
_R4 = 1.0 / 1.16730397826141868426 ** np.arange(1, 5)  # the same in four dimensions: where patterns and seeds start
_TURN = 1  # the coordinate that goes around the pupil


@dataclass(frozen=True, eq=False)
class LensSamples:
    """Sample points of rays on the pupil and in the pixel.

    Attributes:
        pupil: ``(patterns, n, 2)`` float64 on the unit pupil, within the iris, +x right and +y up.
        disc: the same where the iris is round and clear; else points that fill the whole disc.
        pixel: ``(patterns, n, 2)`` float64 offset on the sensor from the pixel's centre, in pixels, -0.5 to 0.5, y down.
    """

    pupil: DoubleArray
    disc: DoubleArray
    pixel: DoubleArray

    @property
    def count(self) -> int:
        """Rays per pixel."""
        return int(self.pupil.shape[1])


def lens_samples(rays: int, iris: IrisShape, *, seed: int = 0, tiled: bool = True) -> LensSamples:
    """Make the patterns of ``rays`` rays.

    Args:
        rays: 1 to `MAX_RAYS`. A single ray passes the centre of pupil and pixel.
        iris: the opening to fill evenly, or as its mask and radial weights say.
        seed: another seed starts the sequence elsewhere.
        tiled: all `PATTERNS` patterns, or the first alone, for all pixels.

    Raises:
        SettingsError: the number of rays or the seed is out of range, or the iris lets nothing through.
    """
    if not 1 <= rays <= MAX_RAYS:
        raise SettingsError(f"rays must be from 1 to {MAX_RAYS}, got {rays}")
    if not 0 <= seed < 2**31:
        raise SettingsError(f"seed must be from 0 to {2**31 - 1}, got {seed}")
    patterns = PATTERNS if tiled else 1
    if rays == 1:
        zero = np.zeros((patterns, 1, 2))
        return LensSamples(zero, zero, zero)
    points = np.mod(base_points(rays, seed) + pattern_shifts(patterns)[:, None, :], 1.0)
    disc = fill_iris(points[..., :2], IrisShape())
    plain = iris.blades == 0 and iris.mask is None and not iris.radial_weights
    pupil = disc if plain else fill_iris(points[..., :2], iris)
    return LensSamples(pupil, disc, points[..., 2:] - 0.5)


def base_points(rays: int, seed: int) -> DoubleArray:
    """Points ``(rays, 4)`` in the unit hypercube before a pattern shifts them: squared radius, turn, sensor x and y."""
    index = np.arange(rays, dtype=np.int32)
    halton = np.stack([_radical_inverse(index, 2), _radical_inverse(index, 3)], -1)
    start = np.mod(0.5 + seed * _R4[::-1], 1.0)
    return np.asarray(np.mod(start + np.concatenate([index[:, None] * _R2, halton], 1), 1.0))


def pattern_shifts(patterns: int) -> DoubleArray:
    """Shifts ``(patterns, 4)`` of the patterns in the unit hypercube; the turn grows evenly, so that blue noise stays blue."""
    index = np.arange(patterns)[:, None]
    shifts = np.mod(index * _R4, 1.0)
    shifts[:, _TURN] = index[:, 0] / PATTERNS
    return np.asarray(shifts)


def pattern_mask() -> IntArray:
    """Pattern index ``(64, 64)`` int32 of a pixel, at ``[y % 64, x % 64]``."""
    return np.asarray(blue_noise_ranks() * PATTERNS // SIDE**2, np.int32)


def _radical_inverse(index: IntArray, base: int) -> DoubleArray:
    """Radical inverse ``(n,)`` in [0, 1): the digits of ``index`` mirrored at the point."""
    left, inverse, place = np.array(index), np.zeros(len(index)), 1.0
    while left.any():
        place /= base
        inverse += place * (left % base)
        left //= base
    return inverse
