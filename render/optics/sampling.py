"""Where rays start on the pupil and on the sensor: patterns that are written down, not drawn.

On the pupil the points follow the R2 sequence of Roberts 2018 ("The unreasonable effectiveness of quasirandom sequences"):
point i is ``frac(s + i·(1/g, 1/g²))`` with g the positive root of x³ = x + 1. On the pixel they follow the Halton sequence in
bases 2 and 3 (Halton 1960). Each pixel of an 8x8 tile shifts both to another start, so that
neighbours do not repeat each other's error (Cranley & Patterson 1976).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import SettingsError
from render.lens import IrisShape
from render.scene import DoubleArray, IntArray

MAX_RAYS = 4096
TILE = 8
_R2 = 1.0 / 1.32471795724474602596 ** np.arange(1, 3)
_R4 = 1.0 / 1.16730397826141868426 ** np.arange(1, 5)  # the same in four dimensions: where tiles and seeds start


@dataclass(frozen=True, eq=False)
class LensSamples:
    """Where each ray passes the pupil and the pixel.

    Attributes:
        pupil: ``(tiles, n, 2)`` float64 on the unit pupil, +x right and +y up.
        pixel: ``(tiles, n, 2)`` float64 offset on the sensor from the pixel's centre, in pixels, -0.5 to 0.5, y down.
    """

    pupil: DoubleArray
    pixel: DoubleArray

    @property
    def count(self) -> int:
        """Rays per pixel."""
        return int(self.pupil.shape[1])


def lens_samples(rays: int, iris: IrisShape, *, seed: int = 0, tiled: bool = True) -> LensSamples:
    """The pattern of ``rays`` rays.

    Args:
        rays: 1 to `MAX_RAYS`. A single ray passes the centre of pupil and pixel.
        iris: the opening to fill evenly.
        seed: another seed starts the sequence elsewhere.
        tiled: one pattern for each pixel of an 8x8 tile (``tiles`` = 64), or the same for all (1).

    Raises:
        SettingsError: the number of rays or the seed is out of range.
    """
    if not 1 <= rays <= MAX_RAYS:
        raise SettingsError(f"rays must be from 1 to {MAX_RAYS}, got {rays}")
    if not 0 <= seed < 2**31:
        raise SettingsError(f"seed must be from 0 to {2**31 - 1}, got {seed}")
    tiles = TILE * TILE if tiled else 1
    if rays == 1:
        zero = np.zeros((tiles, 1, 2))
        return LensSamples(zero, zero)
    starts = np.mod(0.5 + seed * _R4[::-1] + _tile_rank(tiles)[:, None] * _R4, 1.0)
    index = np.arange(rays, dtype=np.int32)
    steps = np.concatenate(
        [index[:, None] * _R2, np.stack([_radical_inverse(index, 2), _radical_inverse(index, 3)], -1)], 1
    )
    points = np.mod(starts[:, None, :] + steps, 1.0)
    return LensSamples(fill_iris(points[..., :2], iris), points[..., 2:] - 0.5)


def fill_iris(square: DoubleArray, iris: IrisShape) -> DoubleArray:
    """Map points of the unit square evenly onto the iris.

    The concentric map of Shirley & Chiu 1997 fills the disc; a bladed iris then stretches each of its sectors radially from
    circle to edge, after the angle within the sector is warped so that area stays even.

    Args:
        square: ``(..., 2)`` in [0, 1).
        iris: the opening.

    Returns:
        ``(..., 2)`` on the iris, whose vertices (or rim) lie on the unit circle.
    """
    radius, angle = _concentric(square)
    if iris.blades:
        radius, angle = _bladed(radius, angle, iris)
    angle = angle + iris.rotation_rad
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def _concentric(square: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    x, y = 2 * square[..., 0] - 1, 2 * square[..., 1] - 1
    wide = np.abs(x) > np.abs(y)
    radius = np.where(wide, x, y)
    safe = np.where(radius == 0, 1.0, radius)
    angle = np.where(wide, np.pi / 4 * y / safe, np.pi / 2 - np.pi / 4 * x / safe)
    return np.abs(radius), np.where(radius < 0, angle + np.pi, angle)


def _bladed(radius: DoubleArray, angle: DoubleArray, iris: IrisShape) -> tuple[DoubleArray, DoubleArray]:
    """Stretch the disc's sectors to the blades. The rim's radius at angle t from a blade's middle is a blend of the chord's
    and the circle's; equal shares of sector angle are moved to equal shares of the rim's area by its tabulated integral."""
    half = np.pi / iris.blades
    t = np.linspace(-half, half, 513)
    rim = iris.roundness + (1 - iris.roundness) * np.cos(half) / np.cos(t)
    area = np.concatenate([[0.0], np.cumsum((rim[1:] ** 2 + rim[:-1] ** 2) / 2)])
    sector = np.floor(angle / (2 * half))
    share = angle / (2 * half) - sector
    within = np.interp(share * area[-1], area, t)
    return radius * np.interp(within, t, rim), (sector + 0.5) * 2 * half + within


def _radical_inverse(index: IntArray, base: int) -> DoubleArray:
    """The digits of ``index`` mirrored at the point: ``(n,)`` in [0, 1)."""
    left, inverse, place = np.array(index), np.zeros(len(index)), 1.0
    while left.any():
        place /= base
        inverse += place * (left % base)
        left //= base
    return inverse


def _tile_rank(tiles: int) -> DoubleArray:
    """``(tiles,)`` place of each pixel of the tile in the sequence: the R2 dither of Roberts 2018, ranked."""
    if tiles == 1:
        return np.zeros(1)
    y, x = np.divmod(np.arange(tiles), TILE)
    dither = np.mod(x * 0.7548776662466927 + y * 0.5698402909980532, 1.0)
    rank = np.empty(tiles)
    rank[np.argsort(dither, kind="stable")] = np.arange(tiles)
    return rank
