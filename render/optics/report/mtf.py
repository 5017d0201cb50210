"""Modulation transfer of a lens over its field and through focus, by rays and with diffraction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeGuard

import numpy as np

from render.model.arrays import DoubleArray
from render.optics.report.field import radial
from render.optics.report.film_rays import FilmRays, even_grid
from render.optics.report.glass_rays import GlassRays
from render.optics.report.wavefront import Wavefront

FREQUENCIES = (10.0, 20.0, 40.0)
"""Line pairs per mm."""
LIGHT = ((656.27, 0.035), (587.56, 0.385), (546.07, 0.49), (486.13, 0.09))
"""Wavelengths in nm and their weights: lines C, d, e and F, by the eye's sensitivity in daylight (CIE 1931)."""
_HEIGHTS, _FOCUS_PLACES, _STEPS = 11, (0.0, 0.5, 0.9), 21
_REACH = 0.1  # lines per mm times shift over f-number, where a perfect beam hardly shows 40 lines
_SIDE = 48


@dataclass(frozen=True, eq=False)
class Mtf:
    """Modulation transfer; NaN where the lens is dark. Sagittal lines run along the radius, tangential ones across it.

    Attributes:
        heights_mm: ``(k,)`` of the image.
        field: ``(frequencies, 2, k)`` with diffraction, sagittal and tangential.
        field_geometric: the same by rays alone.
        focus_heights_mm: ``(p,)`` heights through focus.
        shifts_mm: ``(z,)`` of the film, behind its place.
        focus: ``(frequencies, 2, p, z)`` with diffraction.
        is_exact: whether diffraction is that of the lens's own wavefront; else the rays' transfer times the perfect lens's.
    """

    heights_mm: DoubleArray
    field: DoubleArray
    field_geometric: DoubleArray
    focus_heights_mm: DoubleArray
    shifts_mm: DoubleArray
    focus: DoubleArray
    is_exact: bool


def measure_mtf(rays: FilmRays, corner_mm: float, f_stop: float) -> Mtf:
    """Measure the modulation transfer of a lens in white light (`LIGHT`).

    Args:
        rays: of the lens.
        corner_mm: height of the gate's corner.
        f_stop: of the lens; not 0.
    """
    heights = np.linspace(0.0, corner_mm, _HEIGHTS)
    places = np.array(_FOCUS_PLACES) * corner_mm
    shifts = np.linspace(-1.0, 1.0, _STEPS) * _REACH * f_stop
    field, geometric = (np.full((len(FREQUENCIES), 2, len(heights)), np.nan) for _ in range(2))
    focus = np.full((len(FREQUENCIES), 2, len(places), len(shifts)), np.nan)
    at = [int(np.argmin(np.abs(heights - place))) for place in places]  # they are among the heights
    for k, height in enumerate(heights):
        found = _transfer(rays, float(height), shifts if k in at else np.zeros(1), f_stop)
        if found is None:
            continue
        field[..., k], geometric[..., k] = (part[..., part.shape[-1] // 2] for part in found)  # the film's own place
        for p in (p for p, place in enumerate(at) if place == k):
            focus[:, :, p] = found[0]
    return Mtf(heights, field, geometric, places, shifts, focus, _has_wavefronts(rays))


def perfect_transfer(frequency: float, wavelength_nm: float, f_stop: float) -> float:
    """Modulation transfer of a perfect lens with a round pupil: ``2/π·(acos s − s·√(1 − s²))``, s = λνN (Goodman 2005)."""
    s = min(frequency * wavelength_nm * 1e-6 * f_stop, 1.0)
    return float(2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s * s)))


def _transfer(
    rays: FilmRays, height_mm: float, shifts_mm: DoubleArray, f_stop: float
) -> tuple[DoubleArray, DoubleArray] | None:
    """``(frequencies, 2, z)`` with diffraction and by rays, in white light."""
    if height_mm > rays.last_height_mm:
        return None
    if _has_wavefronts(rays):
        waves = [rays.wavefront(height_mm, wavelength) for wavelength, _ in LIGHT]
        if any(wave is None for wave in waves):
            return None
        return _of_waves([wave for wave in waves if wave is not None], shifts_mm)
    return _of_rays(rays, height_mm, shifts_mm, f_stop)


def _has_wavefronts(rays: FilmRays) -> TypeGuard[GlassRays]:
    return isinstance(rays, GlassRays) and not rays.has_cylinders


def _of_waves(waves: list[Wavefront], shifts_mm: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    weights = np.array([weight * wave.light for wave, (_, weight) in zip(waves, LIGHT, strict=True)])
    found = np.array(
        [
            [
                [[method(shifts_mm, frequency, axis) for axis in (0, 1)] for frequency in FREQUENCIES]
                for method in (wave.diffraction, wave.geometric)
            ]
            for wave in waves
        ]
    )
    diffraction, geometric = np.abs(np.tensordot(weights / weights.sum(), found, axes=1))
    return diffraction, geometric


def _of_rays(
    rays: FilmRays, height_mm: float, shifts_mm: DoubleArray, f_stop: float
) -> tuple[DoubleArray, DoubleArray] | None:
    grid = even_grid(_SIDE)
    grid = grid[np.hypot(*grid.T) <= 1]
    total = np.zeros((2, len(FREQUENCIES), 2, len(shifts_mm)), complex)
    for wavelength, weight in LIGHT:
        beams = rays.beams(radial(rays, np.array([height_mm])), grid, wavelength)
        light = np.where(beams.open[0], np.nan_to_num(beams.light[0]), 0.0)
        if not light.sum() > 0:
            return None
        landing = np.nan_to_num(beams.landing_mm[0] + shifts_mm[:, None, None] * beams.slopes[0])
        for f, frequency in enumerate(FREQUENCIES):
            phase = np.exp(2j * np.pi * frequency * landing)
            mean = weight * (light[:, None] * phase).sum(axis=1).T / light.sum()
            total[:, f] += np.array([perfect_transfer(frequency, wavelength, f_stop), 1.0])[:, None, None] * mean
    diffraction, geometric = np.abs(total)
    return diffraction, geometric
