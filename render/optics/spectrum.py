"""Which wavelengths are traced, and what each gives to red, green and blue.

A picture has three numbers a pixel, not a spectrum. So each wavelength shows, through the lens as it is there, a share of each of
the scene's channels: what leaves the lens is ``channel = Σ rgb[i, channel]·channel seen at wavelength i``. Each channel's shares
add to 1: a lens without colour errors gives the scene's colours, and white stays white.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray
from render.model.limits import MAX_WAVELENGTHS
from render.optics.glass import CHANNELS_NM, D_LINE_NM

_SHORTEST_NM, _LONGEST_NM = 400.0, 700.0
_BAND = 5

# CIE 1931 2° colour matching functions as sums of Gaussian lobes that are wider on one side: amplitude, peak, width below, width
# above (nm). Wyman, Sloan & Shirley 2013, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", section 2.2.
_LOBES: tuple[tuple[tuple[float, float, float, float], ...], ...] = (
    ((1.056, 599.8, 37.9, 31.0), (0.362, 442.0, 16.0, 26.7), (-0.065, 501.1, 20.4, 26.2)),
    ((0.821, 568.8, 46.9, 40.5), (0.286, 530.9, 16.3, 31.1)),
    ((1.217, 437.0, 11.8, 36.0), (0.681, 459.0, 26.0, 13.8)),
)

# Chromaticities x, y of the working space's red, green and blue: AP1 of ACEScg (Academy S-2014-004).
_PRIMARIES = ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044))


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Wavelengths that stand for the visible light.

    Attributes:
        wavelengths_nm: long to short.
        rgb: ``(n, 3)`` share of each channel that a wavelength shows; not negative, each column sums to 1.
    """

    wavelengths_nm: tuple[float, ...]
    rgb: DoubleArray


THREE_LINES = Spectrum(CHANNELS_NM, np.eye(3))


def spectrum(count: int) -> Spectrum:
    """Wavelengths for a picture: 1 is the d line alone, 3 one for each channel, else bands through the CIE matching functions.

    The bands are equally wide, from 400 to 700 nm; each is traced at its middle and weighs as the matching functions' mean over
    it, in the primaries of ACEScg. Where that is negative (real primaries cannot match spectral colours), it counts as 0:
    negative light would draw dark seams beside bright edges, at the price of fringes somewhat less saturated than to the eye.

    Raises:
        SettingsError: the count is not from 1 to 64.
    """
    if not 1 <= count <= MAX_WAVELENGTHS:
        raise SettingsError(f"expected 1 to {MAX_WAVELENGTHS} wavelengths, got {count}")
    if count == 1:
        return Spectrum((D_LINE_NM,), np.ones((1, 3)))
    if count == 3:
        return THREE_LINES
    edges_nm = np.linspace(_LONGEST_NM, _SHORTEST_NM, count + 1)
    middles_nm = (edges_nm[1:] + edges_nm[:-1]) / 2
    return Spectrum(tuple(middles_nm.tolist()), _shares(edges_nm))


def band_nm(light: Spectrum, index: int) -> DoubleArray:
    """``(5,)`` wavelengths that one of a spectrum's stands for: of three lines, one for each channel, what makes up the channel
    in even shares; of a finer spectrum, or of one line, itself alone.
    """
    if light is not THREE_LINES:
        return np.full(_BAND, light.wavelengths_nm[index])
    fine = spectrum(MAX_WAVELENGTHS)
    channel = fine.rgb[::-1, int(np.argmax(light.rgb[index]))]
    passed = np.cumsum(channel) - channel / 2
    return np.asarray(np.interp((np.arange(_BAND) + 0.5) / _BAND, passed, fine.wavelengths_nm[::-1]))


def colour_matching(wavelengths_nm: DoubleArray) -> DoubleArray:
    """``(..., 3)`` of the CIE 1931 functions x̄, ȳ, z̄ at the given wavelengths, within 2 % of the peak."""
    lobes = [sum(_lobe(wavelengths_nm, *lobe) for lobe in function) for function in _LOBES]
    return np.stack(lobes, axis=-1)


def _lobe(wavelengths_nm: DoubleArray, amplitude: float, peak: float, below: float, above: float) -> DoubleArray:
    off = wavelengths_nm - peak
    return np.asarray(amplitude * np.exp(-0.5 * (off / np.where(off < 0, below, above)) ** 2))


def _shares(edges_nm: DoubleArray) -> DoubleArray:
    """``(n, 3)`` shares of the bands between the edges. The primaries' brightness, and so the white, falls out of them."""
    bands = np.linspace(edges_nm[:-1], edges_nm[1:], 33, axis=1)
    xyz = colour_matching(bands).mean(axis=1)
    primaries = np.array([(x, y, 1 - x - y) for x, y in _PRIMARIES]).T
    rgb = np.maximum(xyz @ np.linalg.inv(primaries).T, 0.0)
    return np.asarray(rgb / rgb.sum(axis=0))
