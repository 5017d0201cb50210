"""Deep pictures: samples of each pixel in depth, that give the flat picture when they are composited front to back.

Through a lens a pixel sees surfaces side by side as well as behind each other: what its rays meet adds up. A surface that has
the coverage ``a`` and the premultiplied light ``c`` of the pixel, where those in front of it have the coverage ``b`` together,
becomes a sample of alpha ``a / (1 - b)`` and light ``c / (1 - b)``. Composited *over* each other, the samples' light and alpha
are the sums of all ``c`` and ``a``, which are those of the flat picture.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from render.model.arrays import DoubleArray, FloatArray, LongArray

_LEAST_LEFT = 1e-4
"""Share of a pixel that its surfaces leave free, from which on the background shows."""
_LEAST_LIGHT = 1e-5
"""Light of the background, relative to the picture's brightest channel of that pixel, that is more than rounding."""


@dataclass(frozen=True, eq=False)
class DeepSamples:
    """Samples of a picture.

    Attributes:
        size: height and width of the picture in pixels.
        pixels: ``(n,)`` pixel of each sample, counted row by row, ascending; nearest samples first.
        light: ``(n, 4)`` float32 radiance premultiplied by alpha, and alpha; of the background, alpha is 0.
        depths_m: ``(n,)`` float64 metres along the view axis, from the pupil; infinite for the background.
    """

    size: tuple[int, int]
    pixels: LongArray
    light: FloatArray
    depths_m: DoubleArray

    def dim(self, gain: FloatArray) -> DeepSamples:
        """Samples whose radiance is multiplied by that of a picture ``(height, width, 3 or more)``."""
        light = self.light.copy()
        light[:, :3] *= gain[..., :3].reshape(-1, 3)[self.pixels]
        return replace(self, light=light)


def layer_samples(pixels: LongArray, values: DoubleArray, color: FloatArray) -> DeepSamples:
    """Make samples of what surfaces add to pixels.

    Args:
        pixels: ``(n,)`` pixel of each entry, counted row by row.
        values: ``(n, 5)`` coverage, red, green and blue, and inverse depth in 1/m times coverage.
        color: ``(height, width, 4)`` flat picture: light that the entries do not have is the background's.
    """
    height, width, _ = color.shape
    there = values[:, 0] > 0
    pixels, values = pixels[there], values[there]
    depths = values[:, 0] / np.maximum(values[:, 4], 1e-30)
    order = np.lexsort((depths, pixels))
    pixels, values, depths = pixels[order], values[order], depths[order]
    in_front = _sums_before(pixels, values[:, 0])
    left = np.maximum(1 - in_front, 1e-9)
    light = np.column_stack([values[:, 1:4], values[:, 0]]) / left[:, None]
    light[:, 3] = np.minimum(light[:, 3], 1.0)

    behind = _background(pixels, values, color)
    places = np.flatnonzero(behind.any(axis=1))
    pixels = np.concatenate([pixels, places])
    light = np.concatenate([light, np.column_stack([behind[places], np.zeros(len(places))])])
    depths = np.concatenate([depths, np.full(len(places), np.inf)])
    order = np.argsort(pixels, kind="stable")  # the background comes last
    return DeepSamples((height, width), pixels[order], light[order].astype(np.float32), depths[order])


def _sums_before(pixels: LongArray, values: DoubleArray) -> DoubleArray:
    """Sum of the values that come before each in its pixel."""
    total = np.cumsum(values) - values
    starts = np.flatnonzero(np.diff(pixels, prepend=-1))
    sums: DoubleArray = total - np.repeat(total[starts], np.diff(starts, append=len(pixels)))
    return sums


def _background(pixels: LongArray, values: DoubleArray, color: FloatArray) -> DoubleArray:
    """Light of the background ``(height * width, 3)``, as bright as it is where no surface is; 0 where none shows."""
    flat = color.reshape(-1, 4).astype(np.float64)
    sums = np.stack([np.bincount(pixels, column, len(flat)) for column in values[:, :4].T], axis=1)
    rest, left = np.maximum(flat[:, :3] - sums[:, 1:], 0.0), 1 - sums[:, 0]
    shows = (left > _LEAST_LEFT) & (rest.max(axis=1) > _LEAST_LIGHT * flat[:, :3].max(axis=1))
    return np.where(shows[:, None], rest / np.maximum(left, _LEAST_LEFT)[:, None], 0.0)
