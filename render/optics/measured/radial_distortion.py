"""Distortion of a data sheet from pairs of points: where a lens shows what an ideal one shows elsewhere.

A data sheet has distortion over the image height alone. It is fitted in least squares, at even steps of the height in the
picture; by how much the pairs are off it is stated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import InputError
from render.model.arrays import DoubleArray

_HEIGHTS = 49
_SMOOTHING = 1e-9
_FEWEST = 16
_LEAST = 0.07
_MOST = 10.0  # share by which an image may be farther out: the data sheet's own limit


@dataclass(frozen=True, eq=False)
class RadialDistortion:
    """Distortion over the image height.

    Attributes:
        heights_mm: ``(n,)`` from 0.
        distortion: ``(n,)`` share by which the image is farther out than an ideal lens's; 0 on the axis.
        centre_scale: magnification of the middle of the picture, which is part of the focal length and not of distortion.
        rms_mm: root mean square of what is left on the film.
        worst_mm: the largest of it.
        cut_mm: height beyond which the lens sees wider than a data sheet can say, and which was left out; infinite for none.
    """

    heights_mm: DoubleArray
    distortion: DoubleArray
    centre_scale: float
    rms_mm: float
    worst_mm: float
    cut_mm: float


def fit_radial(shown_mm: DoubleArray, ideal_mm: DoubleArray, name: str) -> RadialDistortion:
    """Fit distortion to pairs of points.

    Args:
        shown_mm: ``(n, 2)`` in the picture, from the optical centre.
        ideal_mm: ``(n, 2)`` where an ideal lens shows the same.
        name: of the file, for messages.

    Raises:
        InputError: there are too few pairs, they fold the picture, or no lens distorts so.
    """
    usable = np.isfinite(shown_mm).all(axis=1) & np.isfinite(ideal_mm).all(axis=1)
    # a fisheye's edge: an ideal lens shows it farther out than a data sheet can say
    held = np.hypot(*shown_mm.T) >= _LEAST * np.hypot(*ideal_mm.T)
    cut_mm = float(np.hypot(*shown_mm[usable & ~held].T).min(initial=np.inf))
    usable &= held & (np.hypot(*shown_mm.T) < cut_mm)
    shown, ideal = shown_mm[usable], ideal_mm[usable]
    heights, wanted = np.hypot(*shown.T), np.hypot(*ideal.T)
    reach = float(heights.max(initial=0.0))
    away = (heights > 1e-3 * reach) & (wanted > 0)
    if away.sum() < _FEWEST or not 0 < reach < 1e4:
        raise _bad(name, f"it has distortion at {int(away.sum())} places of the picture, expected {_FEWEST} or more")
    ratio = heights[away] / wanted[away]
    if not (ratio.min() > 0 and ratio.max() < _MOST):
        raise _bad(name, f"it moves points by a factor of up to {ratio.max():g}, which no lens does")
    basis = _hats(heights[away] / reach)
    # what counts is the distance on the film
    weighted = basis * (heights[away] / reach)[:, None] ** 2
    bends = np.diff(np.eye(_HEIGHTS), 2, axis=0)
    level = np.zeros(_HEIGHTS)
    level[:2] = 1.0, -1.0  # the curve is even
    smooth = _SMOOTHING * len(basis) * (bends.T @ bends + np.outer(level, level))
    terms = np.linalg.solve(weighted.T @ basis + smooth, weighted.T @ (1 / ratio))
    # 1 / (1 + distortion) is what is fitted: it stays finite, and rays follow from it at once
    axis = float(terms[0])
    nodes = np.linspace(0.0, reach, _HEIGHTS)
    if axis <= 0 or not (np.diff(nodes * terms) > 0).all():
        raise _bad(name, "it folds the picture: what is seen must lie farther out toward the edge too")
    bend = terms / axis
    left = ideal[away] - shown[away] * (basis @ terms)[:, None]
    misses = np.hypot(*left.T) / axis
    return RadialDistortion(
        nodes, 1 / bend - 1, 1 / axis, float(np.sqrt((misses**2).mean())), float(misses.max(initial=0.0)), cut_mm
    )


def _hats(relative: DoubleArray) -> DoubleArray:
    """``(n, _HEIGHTS)`` shares that the even steps from 0 to 1 have in what is joined linearly between them."""
    steps = np.arange(_HEIGHTS)
    return np.asarray(np.clip(1 - np.abs(relative[:, None] * (_HEIGHTS - 1) - steps), 0.0, None))


def _bad(name: str, what: str) -> InputError:
    return InputError(f"{name}: {what}", code="bad_calibration", path=name)
