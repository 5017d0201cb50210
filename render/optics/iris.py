"""The iris: even filling of its opening, and its transmission as an image.

A mask or radial weights make the bokeh soft or ring-shaped; they change the shape of the light and not its amount, so that the
exposure follows the f-number.
"""

from __future__ import annotations

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray
from render.model.lens import IrisShape

_STEPS = 512


def fill_iris(square: DoubleArray, iris: IrisShape) -> DoubleArray:
    """Map points of the unit square onto the iris, as densely as it lets light through.

    The first coordinate is the squared radius on a disc, the second the turn. Radial weights warp the radius by the inverse of
    their share of light; a bladed iris stretches each of its sectors from circle to edge, after the angle within the sector is
    warped so that area stays even; a mask is inverted row by row.

    Args:
        square: ``(..., 2)`` in [0, 1).
        iris: the opening.

    Returns:
        ``(..., 2)`` on the iris, whose vertices (or rim) lie on the unit circle, +x right and +y up.

    Raises:
        SettingsError: the mask or the weights let nothing through.
    """
    if iris.mask is not None:
        return _fill_image(square, transmission(iris))
    radius, angle = np.sqrt(square[..., 0]), 2 * np.pi * square[..., 1]
    if iris.radial_weights:
        radius = _weighted_radius(square[..., 0], iris)
    if iris.blades:
        radius, angle = _clip_to_blades(radius, angle, iris)
    angle = angle + iris.rotation_rad
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def transmission(iris: IrisShape, side: int = 256) -> DoubleArray:
    """Image ``(side, side)`` of the iris over the square around the unit circle, row 0 at the top: 0 blocks, 1 passes."""
    sub = 4
    line = (np.arange(side * sub) + 0.5) / (side * sub) * 2 - 1
    x, y = np.meshgrid(line, -line)
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    relative = radius / rim_radius(angle - iris.rotation_rad, iris)
    light = (relative <= 1).astype(np.float64)
    if iris.radial_weights:
        weights = np.asarray(iris.radial_weights, np.float64)
        light *= np.interp(relative, np.linspace(0, 1, len(weights)), weights)
    if iris.mask is not None:
        rows, columns = iris.mask.shape
        row = np.minimum(((1 - y) / 2 * rows).astype(int), rows - 1)
        light *= iris.mask[row, np.minimum(((x + 1) / 2 * columns).astype(int), columns - 1)]
    return np.asarray(light.reshape(side, sub, side, sub).mean(axis=(1, 3)))


def rim_radius(angle: DoubleArray, iris: IrisShape) -> DoubleArray:
    """Radius of the rim at angles from the first blade's corner: a blend of the blades' chords and the circle."""
    if not iris.blades:
        return np.ones_like(angle)
    half = np.pi / iris.blades
    within = np.mod(angle, 2 * half) - half
    return np.asarray(iris.roundness + (1 - iris.roundness) * np.cos(half) / np.cos(within))


def _weighted_radius(share: DoubleArray, iris: IrisShape) -> DoubleArray:
    weights = np.asarray(iris.radial_weights, np.float64)
    if not np.isfinite(weights).all() or (weights < 0).any() or weights.max(initial=0.0) <= 0:
        raise SettingsError("an iris's radial weights must be numbers of 0 or more, and one of them above 0")
    radius = np.linspace(0, 1, _STEPS + 1)
    light = np.interp(radius, np.linspace(0, 1, len(weights)), weights) * radius
    total = np.concatenate([[0.0], np.cumsum((light[1:] + light[:-1]) / 2)])
    return np.asarray(np.interp(share * total[-1], total, radius))


def _clip_to_blades(radius: DoubleArray, angle: DoubleArray, iris: IrisShape) -> tuple[DoubleArray, DoubleArray]:
    """Stretch the disc's sectors to the blades: equal shares of a sector's angle become equal shares of its area."""
    half = np.pi / iris.blades
    t = np.linspace(-half, half, _STEPS + 1)
    rim = rim_radius(t + half, iris)
    area = np.concatenate([[0.0], np.cumsum((rim[1:] ** 2 + rim[:-1] ** 2) / 2)])
    sector = np.floor(angle / (2 * half))
    share = angle / (2 * half) - sector
    within = np.interp(share * area[-1], area, t)
    return radius * np.interp(within, t, rim), (sector + 0.5) * 2 * half + within


def _fill_image(square: DoubleArray, light: DoubleArray) -> DoubleArray:
    """Invert the image's distribution: the second coordinate selects the row, the first the position in it."""
    if not np.isfinite(light).all() or (light < 0).any() or light.max(initial=0.0) <= 0:
        raise SettingsError(
            "an iris mask must hold numbers of 0 or more, and let light through somewhere within the iris"
        )
    rows = np.concatenate([[0.0], np.cumsum(light.sum(axis=1))])
    rows /= rows[-1]
    row = np.clip(np.searchsorted(rows, square[..., 1], side="right") - 1, 0, len(light) - 1)
    y = row + (square[..., 1] - rows[row]) / np.maximum(rows[row + 1] - rows[row], 1e-300)
    columns = np.concatenate([np.zeros((len(light), 1)), np.cumsum(light, axis=1)], axis=1)
    columns /= np.maximum(columns[:, -1:], 1e-300)
    flat = (columns + np.arange(len(light))[:, None]).ravel()
    wanted = square[..., 0] + row
    at = np.clip(np.searchsorted(flat, wanted, side="right") - 1, 0, len(flat) - 2)
    x = at - row * columns.shape[1] + (wanted - flat[at]) / np.maximum(flat[at + 1] - flat[at], 1e-300)
    side = len(light)
    return np.stack([2 * np.clip(x, 0, side) / side - 1, 1 - 2 * y / side], axis=-1)
