"""Sample patterns on the pupil and on the sensor: points of a deterministic sequence, not random draws.

The points are Owen-scrambled Sobol points in four dimensions (`render.optics.sobol`): two of the pupil, mapped to the disc
by Shirley & Chiu 1997 ("A Low Distortion Map Between Disk and Square"), and two of the pixel. Each pixel has one of 64
patterns, which are successive runs of the one sequence. In each square of 8x8 pixels every pattern occurs once, in an order
by which the pixels of each square of 2x2 and 4x4 have successive runs too (Ahmed & Wonka 2020, "Screen-Space Blue-Noise
Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels"): together they are as well spread as one
pixel's points, so that their errors cancel and what error is left lies in fine grain. Any run of successive points fills
the pupil evenly, so that a picture can be made of passes. `pullfocus bench points` compares the patterns with others.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray, IntArray
from render.model.lens import IrisShape
from render.model.limits import MAX_RAYS
from render.optics.iris import fill_iris
from render.optics.sobol import hash_words, owen_sobol

PATTERNS = 64
MASK_SIDE = 64
"""Side of the square of pixels after which the choice of patterns repeats."""
_LEVELS = (4, 2, 1)  # half sides of the squares of a block of 8x8 pixels
_PERMUTATIONS = np.array(list(permutations(range(4))))


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
    points = sample_points(rays, seed, patterns)
    disc = fill_iris(points[..., :2], IrisShape())
    plain = iris.blades == 0 and iris.mask is None and not iris.radial_weights
    pupil = disc if plain else fill_iris(points[..., :2], iris)
    return LensSamples(pupil, disc, points[..., 2:] - 0.5)


@lru_cache(maxsize=4)  # live pictures ask for the same again and again
def sample_points(rays: int, seed: int, patterns: int = 1) -> DoubleArray:
    """Points of patterns before an iris shapes them.

    Args:
        rays: points of each pattern.
        seed: of the sequence's scrambling.
        patterns: number of patterns, each of which is the next run of the sequence.

    Returns:
        ``(patterns, rays, 4)`` in the unit hypercube, read-only: squared radius, turn about the pupil's centre, sensor x and y.
    """
    points = owen_sobol(patterns * rays, seed).reshape(patterns, rays, 4)
    points[..., :2] = square_to_disc(points[..., :2])
    points.setflags(write=False)
    return points


@lru_cache(maxsize=1)
def pattern_mask() -> IntArray:
    """Pattern index ``(64, 64)`` int32 of a pixel, at ``[y % 64, x % 64]``, read-only.

    In each square of 8x8, 4x4 and 2x2 pixels the four quarters have the four quarters of the square's patterns, in random order.
    """
    y, x = np.mgrid[0:MASK_SIDE, 0:MASK_SIDE]
    mask = np.zeros((MASK_SIDE, MASK_SIDE), np.int32)
    for half in _LEVELS:
        square = (y // (2 * half) * MASK_SIDE + x // (2 * half)) * 8 + half
        order = _PERMUTATIONS[hash_words(square.astype(np.uint32)) % len(_PERMUTATIONS)]
        quarter = y // half % 2 * 2 + x // half % 2
        mask = 4 * mask + np.take_along_axis(order, quarter[..., None], axis=-1)[..., 0].astype(np.int32)
    mask.setflags(write=False)
    return mask


def ray_range(rays: int, index: int, parts: int) -> slice:
    """Successive rays that are one of several parts of a pattern; together the parts are the pattern.

    Args:
        rays: of the pattern.
        index: index of the part, from 0.
        parts: number of parts, at most the number of rays.
    """
    return slice(rays * index // parts, rays * (index + 1) // parts)


def square_to_disc(square: DoubleArray) -> DoubleArray:
    """Map points ``(..., 2)`` of the unit square to squared radius and turn, concentric squares to concentric circles."""
    x, y = 2 * square[..., 0] - 1, 2 * square[..., 1] - 1
    is_wide = np.abs(x) > np.abs(y)
    radius, along = np.where(is_wide, x, y), np.where(is_wide, y, x)
    eighth = along / np.where(radius == 0, 1.0, radius) / 8
    turn = np.where(is_wide, eighth, 0.25 - eighth) + np.where(radius < 0, 0.5, 0.0)
    return np.stack([radius**2, np.mod(turn, 1.0)], axis=-1)
