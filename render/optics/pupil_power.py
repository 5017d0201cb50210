"""Spherical aberration drawn by hand: refractive power over the pupil (Lee, Eisemann & Seidel 2010, section 5.3).

A thin lens whose power at the radius ρ of its pupil is ``P(ρ)`` times that at the centre focuses the rays that pass there on
``w(ρ) = P(ρ)/f − 1/v``, in place of ``w_f = 1/f − 1/v``. Rays through the centre stay in focus where the lens is focused; a point
there is drawn on the film, which is f behind the lens, as a disc of radius ``max ρ·R·|P(ρ) − 1|`` with R the pupil's radius.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import AberrationScales, Lens


def is_drawn(lens: Lens) -> bool:
    """Whether a lens has power drawn by hand that bends any ray."""
    return lens.expressive_blend > 0 and any(power != lens.pupil_power[0] for power in lens.pupil_power)


def own_scales(lens: Lens) -> AberrationScales:
    """Factors on the lens's own errors: drawn power replaces its spherical aberration by the blend."""
    if not lens.pupil_power:
        return lens.scales
    return replace(lens.scales, spherical=lens.scales.spherical * (1 - lens.expressive_blend))


def drawn_defocus(lens: Lens, focal_length_mm: float, radius: DoubleArray) -> DoubleArray:
    """Additional inverse depth at which rays are focused, relative to those through the pupil's centre, from drawn power.

    Args:
        lens: with its power, and how far it is blended in.
        focal_length_mm: of the lens.
        radius: where on the pupil, over the pupil's own radius.

    Returns:
        Change of w in 1/m, of the radius's shape.
    """
    relative = relative_power(lens.pupil_power, radius)
    return np.asarray(lens.expressive_blend * (relative - 1) * 1000 / focal_length_mm)


def relative_power(powers: tuple[float, ...], radius: DoubleArray) -> DoubleArray:
    """Power over the pupil relative to its centre's: smooth through the given values, and monotone between two of them.

    Piecewise cubic with the slopes of Fritsch & Butland (1984). It is even: at the centre it is level.

    Args:
        powers: at even steps of the radius from centre to edge; the first is not 0. One alone, or none, is the same everywhere.
        radius: where, over the pupil's own radius; beyond the edge it stays as there.
    """
    if len(powers) < 2:
        return np.ones_like(radius)
    values = np.array(powers) / powers[0]
    slopes = _level_slopes(np.diff(values))
    at = np.clip(radius, 0.0, 1.0) * (len(values) - 1)
    index = np.minimum(at.astype(np.int64), len(values) - 2)
    t = at - index
    rise = 3 * t**2 - 2 * t**3
    bend = slopes[index] * (t - 2 * t**2 + t**3) + slopes[index + 1] * (t**3 - t**2)
    return np.asarray(values[index] + rise * (values[index + 1] - values[index]) + bend)


def _level_slopes(steps: DoubleArray) -> DoubleArray:
    """Slopes ``(n + 1,)`` at even nodes with ``(n,)`` steps between them; 0 at the first and at every extreme."""
    before, after = steps[:-1], steps[1:]
    agree = before * after > 0
    total = np.where(agree, before + after, 1.0)
    inner = np.where(agree, 2 * before * after / total, 0.0)
    last = 1.5 * steps[-1] - 0.5 * inner[-1] if len(inner) else steps[-1]
    return np.concatenate([[0.0], inner, [last]])
