"""The image-space passes of `render.postblur.aberrate_passes` in numpy, which their shaders are tested against."""

from __future__ import annotations

import math

import numpy as np

from render.model.arrays import DoubleArray, FloatArray
from render.optics.view import PinholeView
from render.postblur.aberrate_passes import COMA_POINTS, LEAST_COMA_PX, THREE_TAPS, coma_points
from render.postblur.picture_errors import SIGMAS, PictureErrors


def aberrate(picture: FloatArray, view: PinholeView, errors: PictureErrors) -> FloatArray:
    """Apply a lens's picture errors to a sharp picture.

    Args:
        picture: ``(height, width, 4)`` scene-linear, premultiplied, sharp everywhere.
        view: view of the picture, of the same size.
        errors: picture errors of the lens.

    Returns:
        ``(height, width, 4)`` float32; alpha is treated as green.
    """
    place = _pixel_slopes(view)
    height = np.hypot(place[..., 0], place[..., 1])
    rows = errors.at(height)
    outward = np.where(height[..., None] > 0, place / np.maximum(height, 1e-12)[..., None], [1.0, 0.0])
    focal = np.array([view.fx / errors.squeeze, view.fy])
    bent = _bend(picture.astype(np.float64), place, rows[..., :3], focal)
    for axis in np.eye(2):
        bent = _blur(bent, np.broadcast_to(axis, place.shape) * focal, rows[..., 3:6])
    along = _blur(bent, outward * focal, rows[..., 6:9])
    across = _blur(along, outward[..., ::-1] * [-1, 1] * focal, rows[..., 9:12])
    smeared = _add_coma(across, outward, focal, rows[..., 12])
    smeared[..., :3] *= rows[..., 13:]
    return smeared.astype(np.float32)


def _pixel_slopes(view: PinholeView) -> DoubleArray:
    """``(height, width, 2)`` slopes of pixel centres, y down."""
    x = (np.arange(view.width) + 0.5 - view.cx) / view.fx
    y = (np.arange(view.height) + 0.5 - view.cy) / view.fy
    return np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1)


def _bend(picture: DoubleArray, place: DoubleArray, source: DoubleArray, focal: DoubleArray) -> DoubleArray:
    """Apply distortion and lateral colour: sample each channel at its source by a Catmull-Rom cubic, clamped to its
    neighbours.
    """
    bent = np.empty_like(picture)
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]].astype(np.float64)
    for channel, source_channel in ((0, 0), (1, 1), (2, 2), (3, 1)):
        off = place * (source[..., source_channel, None] - 1) * focal
        bent[..., channel] = _cubic(picture[..., channel], x + off[..., 0], y + off[..., 1])
    return bent


def _cubic(image: DoubleArray, x: DoubleArray, y: DoubleArray) -> DoubleArray:
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    part_x, part_y = x - left, y - top
    total, low, high = np.zeros_like(x), np.full_like(x, np.inf), np.full_like(x, -np.inf)
    for j in range(-1, 3):
        for i in range(-1, 3):
            value = _texel(image, left + i, top + j)
            total += _catmull_rom(part_x - i) * _catmull_rom(part_y - j) * value
            if i in (0, 1) and j in (0, 1):
                low, high = np.minimum(low, value), np.maximum(high, value)
    return np.clip(total, low, high)


def _catmull_rom(distance: DoubleArray) -> DoubleArray:
    t = np.abs(distance)
    near, far = 1 + t**2 * (1.5 * t - 2.5), 2 + t * (t * (2.5 - 0.5 * t) - 4)
    return np.where(t < 1, near, np.where(t < 2, far, 0.0))


def _blur(picture: DoubleArray, direction: DoubleArray, deviation: DoubleArray) -> DoubleArray:
    """Gaussian blur along a line through each pixel, in steps of a pixel along the axis that the line is nearer to.

    Args:
        picture: ``(height, width, 4)``.
        direction: ``(height, width, 2)`` in pixels for a slope.
        deviation: ``(height, width, 3)`` slope.
    """
    longest = np.abs(direction).max(axis=-1)
    step = direction / longest[..., None]
    steps = (longest[..., None] * deviation)[..., [0, 1, 2, 1]]  # standard deviations, in steps
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]].astype(np.float64)
    total, weights = picture.copy(), np.ones_like(picture)
    for k in range(1, math.ceil(SIGMAS * float(steps.max())) + 1):
        weight = _weights(k, steps)
        if not weight.any():
            break
        for side in (k, -k):
            total += weight * _bilinear(picture, x + side * step[..., 0], y + side * step[..., 1])
        weights += 2 * weight
    return total / weights


def _weights(k: int, steps: DoubleArray) -> DoubleArray:
    """Weights of a tap k steps away, relative to the middle tap's."""
    narrow = steps**2 / 2 / np.maximum(1 - steps**2, 1e-9) if k == 1 else np.zeros_like(steps)
    gauss = np.exp(-0.5 * (k / np.maximum(steps, 1e-9)) ** 2)
    return np.where(steps < THREE_TAPS, narrow, np.where(k <= np.ceil(SIGMAS * steps), gauss, 0.0))


def _add_coma(picture: DoubleArray, outward: DoubleArray, focal: DoubleArray, third: DoubleArray) -> DoubleArray:
    """Apply coma: the mean of the picture over the pupil, shifted by ``third·(3x² + y², 2xy)``, x along the radius."""
    if float(np.abs(third).max()) * focal.max() < LEAST_COMA_PX:
        return picture
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]].astype(np.float64)
    total = np.zeros_like(picture)
    for along, across in coma_points():
        off = third[..., None] * (along * outward + across * outward[..., ::-1] * [-1, 1]) * focal
        total += _bilinear(picture, x - off[..., 0], y - off[..., 1])
    return total / COMA_POINTS


def _bilinear(image: DoubleArray, x: DoubleArray, y: DoubleArray) -> DoubleArray:
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    part_x, part_y = (x - left)[..., None], (y - top)[..., None]
    upper = (1 - part_x) * _texel(image, left, top) + part_x * _texel(image, left + 1, top)
    lower = (1 - part_x) * _texel(image, left, top + 1) + part_x * _texel(image, left + 1, top + 1)
    return np.asarray((1 - part_y) * upper + part_y * lower)


def _texel(image: DoubleArray, x: np.ndarray, y: np.ndarray) -> DoubleArray:
    return np.asarray(image[np.clip(y, 0, image.shape[0] - 1), np.clip(x, 0, image.shape[1] - 1)])
