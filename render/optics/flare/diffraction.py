"""Diffraction at the iris: the star around bright points.

Light of one wavelength from a point lands as the squared Fourier transform of the iris (Goodman, "Introduction to Fourier
Optics", section 6.2), λ/D wide in slopes for a pupil of diameter D. A picture is spread so by its own Fourier transform: that of
the star is the overlap of the iris with itself, shifted by the frequency times λ over D, so that no star has to be drawn larger
than a picture, and no light is lost. Colours are the stars of the visible spectrum's wavelengths together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from render.model.arrays import DoubleArray, FloatArray
from render.model.lens import IrisShape
from render.optics.glass import D_LINE_NM
from render.optics.iris import rim_radius, transmission
from render.optics.spectrum import Spectrum, spectrum

VISIBLE = spectrum(24)
_DIRECTIONS, _SHIFTS = 720, 512  # smallest number of directions in half a turn
_ROUND = 512  # corners of the iris between two neighbouring ones of its blades, or of a round one
_CHORDS = 2048
_CORE, _LEAST_CORE_PX = 3.0, 2.0  # of a star, in λ/D and at least
_SIDE = 512
# Frequencies that alias to one of a picture's, in cycles a pixel, as offsets away from 0. As many lie on either side
# of half a cycle, so that the sum has no kink there, which would draw every other pixel too bright.
_NEIGHBOURS, _FAR = (-2, -1, 0, 1), (-2, 1)
_ROWS = 128  # of frequencies at once: it bounds the memory


@dataclass(frozen=True, eq=False)
class Star:
    """Diffraction star for pictures of one size.

    Attributes:
        transfer: ``(rows, columns / 2 + 1, 3)`` transfer function over the spatial frequencies of the padded picture.
        kept: ``(height, width, 3)`` share of its light that each pixel of a white picture on black keeps.
        padded: rows and columns.
    """

    transfer: FloatArray
    kept: FloatArray
    padded: tuple[int, int]

    def spread(self, picture: FloatArray) -> FloatArray:
        """A picture ``(height, width, 3)`` with its stars, as if it went on alike beyond its edges: an even one stays even."""
        return np.asarray(np.maximum(_convolve(picture, self.transfer, self.padded), 0.0) / self.kept, np.float32)


def star(
    iris: IrisShape,
    spread_px: tuple[float, float],
    width: int,
    height: int,
    *,
    strength: float = 1.0,
    light: Spectrum = VISIBLE,
) -> Star:
    """The star of an iris, for pictures of one size.

    Args:
        iris: the opening.
        spread_px: across and down, how many pixels wide λ/D is at a wavelength of a nanometre: the focal length in pixels over
            the entrance pupil's diameter in nanometres.
        width: of the picture in pixels.
        height: picture height in pixels.
        strength: 1 as it is; light away from its source grows in proportion.
        light: the wavelengths.
    """
    turn_rad = iris.rotation_rad if iris.mask is None else 0.0
    return _star(_Shape(replace(iris, rotation_rad=0.0)), turn_rad, spread_px, width, height, strength, light)


@lru_cache(maxsize=1)  # reused for the next frame while no setting changes
def _star(
    shape: _Shape,
    turn_rad: float,
    spread_px: tuple[float, float],
    width: int,
    height: int,
    strength: float,
    light: Spectrum,
) -> Star:
    table = _overlap(shape, light)
    padded = _pad_length(height), _pad_length(width)
    down = np.asarray(np.fft.fftfreq(padded[0])[:, None], np.float64)
    across = np.asarray(np.fft.rfftfreq(padded[1])[None], np.float64)
    shortest_nm = min(light.wavelengths_nm)
    shift = spread_px[0] * shortest_nm, spread_px[1] * shortest_nm
    transfer = np.empty((padded[0], padded[1] // 2 + 1, 3), np.float32)
    for start in range(0, padded[0], _ROWS):
        rows = slice(start, start + _ROWS)
        transfer[rows] = _transfer(table, across, down[rows], shift, turn_rad)
    if strength != 1:
        core_px = max(_CORE * max(spread_px) * D_LINE_NM, _LEAST_CORE_PX)
        for channel in range(3):
            transfer[..., channel] = _strengthen(transfer[..., channel], padded, strength, core_px)
    white = np.ones((height, width, 3), np.float32)
    return Star(transfer, _convolve(white, transfer, padded), padded)


def _transfer(
    table: FloatArray, across: DoubleArray, down: DoubleArray, shift: tuple[float, float], turn_rad: float
) -> FloatArray:
    """Transfer function at frequencies in cycles a pixel, with the light integrated over each pixel.

    A pixel of light meets a pixel of film: both are even squares, whose overlap over the distance is a triangle. So between
    pixels the star is weighed by triangles, and its transform is a sum over the frequencies that look alike on pixels.
    """
    total, whole = np.zeros(1, np.float32), np.zeros(1, np.float32)
    for right in _NEIGHBOURS:
        for below in _NEIGHBOURS:
            if right in _FAR and below in _FAR:
                continue  # they weigh some thousandths
            x, y = across + right * np.copysign(1, across), down + below * np.copysign(1, down)
            weight = (np.sinc(x) ** 2 * np.sinc(y) ** 2).astype(np.float32)[..., None]
            total = total + weight * _look_up(table, x * shift[0], -y * shift[1], turn_rad)
            whole = whole + weight
    return np.asarray(total / whole)


def _strengthen(transfer: FloatArray, padded: tuple[int, int], strength: float, core_px: float) -> DoubleArray:
    """The transfer of a star some times as strong: a weaker one all around its source, a stronger one away from the core alone,
    lest it blur the picture. What light it has more, the source has less; where that is too much, all of it is dimmed."""
    kernel = np.fft.irfft2(transfer, padded)
    down, across = (np.fft.fftfreq(side) * side for side in padded)
    away = np.clip(np.hypot(across, down[:, None]) / core_px - 1, 0.0, 1.0)
    kernel *= 1 + (strength - 1) * (away if strength > 1 else 1.0)
    kernel[0, 0] = 0.0
    kernel[0, 0] = max(1 - kernel.sum(), 0.0)
    return np.asarray(np.fft.rfft2(kernel / kernel.sum()).real)


def _convolve(picture: FloatArray, transfer: FloatArray, padded: tuple[int, int]) -> FloatArray:
    height, width = picture.shape[:2]
    made = np.empty((height, width, 3), np.float32)
    for channel in range(3):
        frequencies = np.fft.rfft2(picture[..., channel].astype(np.float64), padded)
        frequencies *= transfer[..., channel]
        made[..., channel] = np.fft.irfft2(frequencies, padded)[:height, :width]
    return made


def _pad_length(length: int) -> int:
    """At least twice the length, so that no light comes in from the other side; even, with small factors alone."""
    size = 2 * length
    while True:
        rest = size
        for factor in (2, 3, 5):
            while rest % factor == 0:
                rest //= factor
        if rest == 1:
            return size
        size += 2


class _Shape:
    """An iris that is not turned, as the key of a cache: equal where its numbers are, and its mask is the same object."""

    def __init__(self, iris: IrisShape) -> None:
        self.iris = iris
        mask = None if iris.mask is None else id(iris.mask)
        self._key = (iris.blades, iris.roundness, mask, iris.radial_weights)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Shape) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)


@lru_cache(maxsize=8)
def _overlap(shape: _Shape, light: Spectrum) -> FloatArray:
    """``(directions, _SHIFTS + 1, 3)`` share of the iris that overlaps itself, by direction over half a turn and by the root
    of the shift at the shortest wavelength, in diameters; the mean over the spectrum for each channel.
    """
    iris = shape.iris
    # Along and across a blade the overlap's change over the direction has a kink: those directions are among the table's.
    between = 2 * max(iris.blades, 1)
    directions = np.linspace(0.0, np.pi, between * -(-_DIRECTIONS // between) + 1)
    shifts = np.linspace(0.0, 1.0, _SHIFTS + 1) ** 2
    plain = iris.mask is None and not iris.radial_weights
    one = _of_outline(iris, directions, shifts) if plain else _of_image(iris, directions, shifts)
    mixed = np.zeros((*one.shape, 3))
    shortest_nm = min(light.wavelengths_nm)  # beyond the shift at which its overlap ends, so do all
    for wavelength_nm, rgb in zip(light.wavelengths_nm, light.rgb, strict=True):
        at = np.minimum(np.sqrt(shifts * wavelength_nm / shortest_nm), 1.0) * _SHIFTS
        low = np.minimum(at.astype(np.int64), _SHIFTS - 1)
        share = at - low
        mixed += (one[:, low] * (1 - share) + one[:, low + 1] * share)[..., None] * rgb
    return mixed.astype(np.float32)


def _of_outline(iris: IrisShape, directions: DoubleArray, shifts: DoubleArray) -> DoubleArray:
    """Overlap of an iris that is open within a convex outline: each chord along a shift is shorter by it."""
    corners = max(iris.blades, 1)
    within = np.arange(corners * _ROUND) / _ROUND * 2 * np.pi / corners
    radius = rim_radius(within, iris)
    x, y = radius * np.cos(within), radius * np.sin(within)
    overlaps = np.empty((len(directions), len(shifts)))
    for i, direction in enumerate(directions):
        chords = _chords(x * np.cos(direction) + y * np.sin(direction), y * np.cos(direction) - x * np.sin(direction))
        longest_first = np.sort(chords)[::-1]
        total = np.concatenate([[0.0], np.cumsum(longest_first)])
        longer = np.searchsorted(-longest_first, -2 * shifts, side="right")
        overlaps[i] = (total[longer] - longer * 2 * shifts) / total[-1]
    return overlaps


def _chords(along: DoubleArray, across: DoubleArray) -> DoubleArray:
    """Lengths of an outline's even chords; the outline's corners go around it."""
    start = int(across.argmin())
    along, across = np.roll(along, -start), np.roll(across, -start)
    top = int(across.argmax())
    low, high = across[0], across[top]
    at = low + (np.arange(_CHORDS) + 0.5) / _CHORDS * (high - low)
    one = np.interp(at, across[: top + 1], along[: top + 1])
    back = np.append(across[top:], low)[::-1], np.append(along[top:], along[0])[::-1]
    return np.asarray(np.abs(one - np.interp(at, *back)))


def _of_image(iris: IrisShape, directions: DoubleArray, shifts: DoubleArray) -> DoubleArray:
    """Overlap of any iris, by its image."""
    amplitude = np.sqrt(transmission(iris, _SIDE))
    power = np.abs(np.fft.rfft2(amplitude, (2 * _SIDE, 2 * _SIDE))) ** 2
    overlap = np.fft.fftshift(np.fft.irfft2(power, (2 * _SIDE, 2 * _SIDE)))
    reach = shifts * (_SIDE - 1)  # so that the outermost still has a neighbour
    column = _SIDE + np.cos(directions)[:, None] * reach
    row = _SIDE - np.sin(directions)[:, None] * reach
    left, top = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
    right, down = column - left, row - top
    last = 2 * _SIDE - 1
    values = sum(
        np.abs(1 - i - right) * np.abs(1 - j - down) * overlap[np.clip(top + j, 0, last), np.clip(left + i, 0, last)]
        for i in (0, 1)
        for j in (0, 1)
    )
    return np.asarray(np.maximum(values / overlap[_SIDE, _SIDE], 0.0))


def _look_up(table: FloatArray, across: DoubleArray, up: DoubleArray, turn_rad: float) -> FloatArray:
    """The table ``(directions, shifts, 3)`` at shifts in diameters; nothing overlaps beyond 1."""
    across, up = np.broadcast_arrays(across, up)
    shift = np.hypot(across, up)
    directions = len(table) - 1
    turn = np.mod(np.arctan2(up, across) - turn_rad, np.pi) / np.pi * directions
    at = np.sqrt(np.minimum(shift, 1.0)) * _SHIFTS
    i, j = np.minimum(turn.astype(np.int64), directions - 1), np.minimum(at.astype(np.int64), _SHIFTS - 1)
    turned, shifted = (turn - i).astype(np.float32)[..., None], (at - j).astype(np.float32)[..., None]
    low = table[i, j] * (1 - shifted) + table[i, j + 1] * shifted
    high = table[i + 1, j] * (1 - shifted) + table[i + 1, j + 1] * shifted
    return np.asarray((low * (1 - turned) + high * turned) * (shift < 1)[..., None])
