"""Iris and pupil weights from a photograph of a bright point far out of focus, behind the subject and near the picture's centre.

The disc is the pupil: its brightness at a place is the light that comes through that place. The background is the median of
the picture's edge. The disc is the smallest circle around all places that are half as bright as most of it: around a polygon
of blades, that through its corners. Its mean over circles becomes radial weights, and what differs from that, the blades
among it, the mask.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from render.errors import InputError
from render.model.arrays import DoubleArray

STEPS = 17
SIDE = 256
_LEAST_RADIUS_PX = 12.0
_CIRCLE_STEPS = 1500
_CLIPPED = 0.3  # share of the disc at the picture's maximum


@dataclass(frozen=True, eq=False)
class MeasuredIris:
    """The pupil of a photograph.

    Attributes:
        weights: `STEPS` transmissions at even steps of the radius from centre to edge; the largest is 1.
        mask: ``(SIDE, SIDE)`` transmission over the square around the pupil, 0 to 1, row 0 at the top.
        centre_px: of the disc, from the left and from the top.
        radius_px: of the disc.
        notes: one sentence each.
    """

    weights: tuple[float, ...]
    mask: DoubleArray
    centre_px: tuple[float, float]
    radius_px: float
    notes: tuple[str, ...]


def measure_iris(picture: DoubleArray, name: str) -> MeasuredIris:
    """Measure the pupil of a photographed disc.

    Args:
        picture: ``(h, w)`` linear light, row 0 at the top.
        name: of the file, for messages.

    Raises:
        InputError: there is no disc in it, or not all of one.
    """
    if min(picture.shape) < 2 * _LEAST_RADIUS_PX or not np.isfinite(picture).all():
        raise _bad(name, "it is too small or has pixels that are no numbers")
    rim = np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]])
    light = picture - np.median(rim)
    level = _disc_level(light)
    lit = _smooth(light) > 0.5 * level
    if not level > 0 or not 0 < lit.mean() <= 0.9:
        raise _bad(name, "it shows no bright disc on a dark ground")
    y, x = np.nonzero(lit)
    near = np.hypot(x - np.median(x), y - np.median(y)) < 3 * np.sqrt(len(x) / np.pi)
    x, y = x[near], y[near]
    centre, radius = _enclosing_circle(_ends_of_rows(x, y))
    height, width = picture.shape
    if radius < _LEAST_RADIUS_PX:
        raise _bad(name, f"its disc is {2 * radius:.0f} pixels wide, expected {2 * _LEAST_RADIUS_PX:.0f} or more")
    if not (x.min() > 0 and y.min() > 0 and x.max() < width - 1 and y.max() < height - 1):
        raise _bad(name, "its disc is cut off by the edge of the picture")
    return _pupil(np.clip(light, 0.0, None), picture, (float(centre[0]), float(centre[1])), radius)


def _smooth(light: DoubleArray) -> DoubleArray:
    """Means over 3 x 3 pixels, so that a bright pixel alone is no part of the disc."""
    padded = np.pad(light, 1, mode="edge")
    height, width = light.shape
    return np.asarray(sum(padded[i : i + height, j : j + width] for i in range(3) for j in range(3)) / 9)


def _ends_of_rows(x: NDArray[np.int64], y: NDArray[np.int64]) -> DoubleArray:
    """Leftmost and rightmost pixel of each row, which have the same smallest circle around them as all."""
    rows, back = np.unique(y, return_inverse=True)
    left, right = np.full(len(rows), np.iinfo(np.int64).max), np.full(len(rows), -1)
    np.minimum.at(left, back, x)
    np.maximum.at(right, back, x)
    return np.concatenate([np.stack([left, rows], axis=1), np.stack([right, rows], axis=1)]).astype(np.float64)


def _enclosing_circle(points: DoubleArray) -> tuple[DoubleArray, float]:
    """Centre and radius of the smallest circle around points, within 0.1 % (Badoiu & Clarkson 2003)."""
    centre = points.mean(axis=0)
    for i in range(2, _CIRCLE_STEPS):
        farthest = points[int(np.argmax(((points - centre) ** 2).sum(axis=1)))]
        centre = centre + (farthest - centre) / i
    return centre, float(np.hypot(*(points - centre).T).max()) + 0.5


def _disc_level(light: DoubleArray) -> float:
    """Brightness of the disc: the median of what is above half of nearly the brightest."""
    peak = float(np.quantile(light, 0.9995))
    bright = light[light > 0.25 * peak]
    return float(np.median(bright)) if peak > 0 else 0.0


def _pupil(light: DoubleArray, picture: DoubleArray, centre: tuple[float, float], radius: float) -> MeasuredIris:
    line = (np.arange(SIDE) + 0.5) / SIDE * 2 - 1
    x, y = np.meshgrid(line, line)
    square = _sampled(light, centre[0] + radius * x, centre[1] + radius * y)
    distance = np.hypot(x, y)
    level = float(np.quantile(square[distance <= 1], 0.95))
    open_ = (square > 0.5 * _local_level(square, distance)) & (distance <= 1)
    steps = np.linspace(0.0, 1.0, STEPS)
    means = np.array([_ring_mean(square, distance, open_, step) for step in steps])
    weights = np.clip(np.where(np.isfinite(means), means, 0.0), 0.0, None)
    known = np.isfinite(means)
    weights = np.interp(steps, steps[known], means[known])
    weights /= weights.max()
    smooth = np.interp(distance, steps, weights)
    mask = np.clip(square / np.maximum(smooth * means[known].max(), 1e-9 * level), 0.0, 1.0)
    mask[distance > 1] = 0.0
    notes = []
    disc = picture[light > 0.5 * level]
    if (disc >= disc.max() * (1 - 1e-6)).mean() > _CLIPPED:
        notes.append(
            "Much of the disc is as bright as the picture can be: it may be overexposed, and look more even than it is."
        )
    return MeasuredIris(tuple(float(w) for w in np.round(weights, 5)), mask, centre, radius, tuple(notes))


def _local_level(square: DoubleArray, distance: DoubleArray) -> DoubleArray:
    """Brightness of the disc at each distance: the 80th percentile over the ring."""
    edges = np.linspace(0.0, 1.0, 33)
    found = [float(np.quantile(square[(distance >= low) & (distance < high)], 0.8)) for low, high in pairwise(edges)]
    return np.interp(distance, (edges[:-1] + edges[1:]) / 2, found)


def _ring_mean(square: DoubleArray, distance: DoubleArray, open_: NDArray[np.bool_], at: float) -> float:
    half = 0.5 / (STEPS - 1)
    at = min(at, 1 - half)  # the outermost ring lies within the edge
    inside = open_ & (np.abs(distance - at) <= half)
    return float(square[inside].mean()) if inside.any() else np.nan


def _sampled(picture: DoubleArray, x: DoubleArray, y: DoubleArray) -> DoubleArray:
    """Bilinear samples of a picture at pixel places."""
    height, width = picture.shape
    x, y = np.clip(x, 0, width - 1.001), np.clip(y, 0, height - 1.001)
    i, j = np.floor(y).astype(int), np.floor(x).astype(int)
    right, low = x - j, y - i
    upper = picture[i, j] * (1 - right) + picture[i, j + 1] * right
    lower = picture[i + 1, j] * (1 - right) + picture[i + 1, j + 1] * right
    return np.asarray(upper * (1 - low) + lower * low)


def _bad(name: str, what: str) -> InputError:
    return InputError(f"{name}: {what}", code="bad_photograph", path=name)
