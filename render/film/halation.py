"""Halation: light that passes the emulsion, is reflected by the far side of the base, and exposes the film again.

A point of light is scattered in the emulsion and shines into the base in all directions. Seen from the far side at an angle θ, a
base of thickness t reflects it at the distance ρ = 2t·tan θ, and spreads it there by cos⁴θ = (1 + (ρ/2t)²)⁻². Beyond the
critical angle all of it is reflected, within it about 4 %: so it comes back as a ring with a sharp inner edge, of the radius
2t·tan θc, and a skirt (Mees and James 1966, The Theory of the Photographic Process, ch. 20).
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray, FloatArray
from usd_schemas.settings.tables import FILM_SETTINGS

BASE_INDEX = 1.48
"""Refractive index of a film base of cellulose triacetate."""
_WITHIN = ((BASE_INDEX - 1) / (BASE_INDEX + 1)) ** 2  # Fresnel's reflection at right angles
_TAN_CRITICAL = 1 / math.sqrt(BASE_INDEX**2 - 1)
_SKIRT = 4.0  # radii of the ring at which the skirt, then under 1/100 of the ring, is cut off
MAX_RADIUS_MM = FILM_SETTINGS["halation_radius_mm"].accepted.most
"""The widest ring: twenty times that of a film base of 0.13 mm."""
_FINE_PX = 256  # pixels, or parts of pixels, of a ring's radius that are fine enough for its edge
_SUPERSAMPLE = 2, 8
_LEAST_PX = 0.25  # a smaller ring is drawn of this size: it lies within its pixel


def add_halation(
    light: FloatArray, amount: float, radius_mm: float, color: tuple[float, float, float], pixel_mm: tuple[float, float]
) -> FloatArray:
    """Add halation: light reflected by the film base. Energy is conserved: reflected light is missing where it entered.

    What leaves the gate counts as matched by what its dark surroundings do not send: the picture is mirrored at its edges.

    Args:
        light: ``(height, width, 3)`` exposure of the film.
        amount: part of the light that is thrown back, 0 to 1.
        radius_mm: of the ring, on the film.
        color: of the light that comes back, as a ratio for each channel; the red layer lies deepest, so it gets the most.
        pixel_mm: width and height of a pixel on the film.

    Returns:
        The same shape, float32.

    Raises:
        SettingsError: more light would come back than there is, or a number is negative.
    """
    shares = halation_shares(amount, radius_mm, color)
    if radius_mm == 0 or not any(shares):
        return light
    kernel = halation_kernel(radius_mm / pixel_mm[0], radius_mm / pixel_mm[1])
    result = light.copy()
    for channel, share in enumerate(shares):
        if share:
            spread = _convolve(light[..., channel], kernel)
            result[..., channel] += np.float32(share) * (spread - light[..., channel])
    return result


def halation_shares(amount: float, radius_mm: float, color: tuple[float, float, float]) -> tuple[float, float, float]:
    """Reflected share of each channel; arguments and errors as in `add_halation`."""
    red, green, blue = color
    shares = (amount * red, amount * green, amount * blue)
    if not (0 <= radius_mm <= MAX_RADIUS_MM and all(0 <= share <= 1 for share in shares)):
        raise SettingsError(
            f"halation needs a radius from 0 to {MAX_RADIUS_MM:g} mm and throws back from 0 to 1 of each channel, "
            f"got radius {radius_mm:g} mm and {', '.join(f'{share:g}' for share in shares)}",
            code="bad_halation",
        )
    return shares


@lru_cache(maxsize=8)
def halation_kernel(radius_x_px: float, radius_y_px: float) -> DoubleArray:
    """Halation kernel of one point, of sum 1.

    Args:
        radius_x_px: of the ring, across, in pixels.
        radius_y_px: of the ring, down, in pixels.

    Returns:
        ``(odd, odd)``, the point in the middle.
    """
    finer = int(np.clip(_FINE_PX / max(radius_x_px, radius_y_px, _LEAST_PX), *_SUPERSAMPLE))
    x, y = (_pixels(max(radius, _LEAST_PX), finer) for radius in (radius_x_px, radius_y_px))
    distance = np.hypot(x[None, :], y[:, None])  # in radii of the ring
    spread = (1 + (distance * _TAN_CRITICAL) ** 2) ** -2.0
    fine = spread * np.where(distance >= 1, 1.0, _WITHIN) * (distance <= _SKIRT)
    quarter: DoubleArray = fine.reshape(len(y) // finer, finer, len(x) // finer, finer).sum((1, 3))
    half = np.concatenate([quarter[:0:-1], quarter])
    kernel: DoubleArray = np.concatenate([half[:, :0:-1], half], axis=1)
    kernel /= kernel.sum()
    return kernel


def _pixels(radius_px: float, finer: int) -> DoubleArray:
    """Positions along an axis from the middle pixel outwards, in radii of the ring, ``finer`` per pixel."""
    reach = math.ceil(_SKIRT * radius_px)
    return ((np.arange((reach + 1) * finer) + 0.5) / finer - 0.5) / radius_px


def _convolve(channel: FloatArray, kernel: DoubleArray) -> FloatArray:
    """Convolve a channel, mirrored at its edges, with the kernel, by its Fourier transform."""
    reach = [n // 2 for n in kernel.shape]
    padded = np.pad(channel, [(r, r) for r in reach], mode="symmetric")
    shape = [_fast_size(n + 2 * r) for n, r in zip(padded.shape, reach, strict=True)]
    spectrum = np.fft.rfft2(padded, shape) * np.fft.rfft2(kernel.astype(np.float32), shape)
    whole = np.fft.irfft2(spectrum, shape)
    first_row, first_column = (2 * r for r in reach)
    return whole[first_row : first_row + channel.shape[0], first_column : first_column + channel.shape[1]].astype(
        np.float32
    )


def _fast_size(size: int) -> int:
    """Smallest length of at least ``size`` without a prime factor above 5, which transforms fast."""
    while True:
        rest = size
        for prime in (2, 3, 5):
            while rest % prime == 0:
                rest //= prime
        if rest == 1:
            return size
        size += 1
