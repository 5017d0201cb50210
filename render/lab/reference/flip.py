"""FLIP: the error that a person sees who alternates between two pictures (Andersson et al. 2020, "FLIP: A Difference Evaluator
for Alternating Images").

This is the LDR form, for pictures clipped to [0, 1]. Colours are blurred as the eye blurs them at a distance; their differences
count more where edges and points differ too. 0 is equal, 1 is the greatest difference.
"""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray, FloatArray

PIXELS_PER_DEGREE = 0.7 * 3840 / 0.7 * np.pi / 180
"""Resolution of a screen 0.7 m wide with 3840 pixels, seen from 0.7 m: the authors' default."""

_XYZ_FROM_RGB = np.array(
    [
        [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
        [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
        [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382],
    ]
)
_RGB_FROM_XYZ = np.linalg.inv(_XYZ_FROM_RGB)
_WHITE = _XYZ_FROM_RGB.sum(axis=1)
_CONTRAST = (  # of each channel of the opponent space: pairs of amplitude and width of its Gaussians (table 1)
    ((1.0, 0.0047),),
    ((1.0, 0.0053),),
    ((34.1, 0.04), (13.5, 0.025)),
)
_COLOUR_EXPONENT, _COLOUR_CUT, _COLOUR_TARGET = 0.7, 0.4, 0.95  # section 4.1.3
_FEATURE_DEGREES, _FEATURE_EXPONENT = 0.082, 0.5  # section 4.2


def flip(test: FloatArray, reference: FloatArray, pixels_per_degree: float = PIXELS_PER_DEGREE) -> float:
    """Mean of `flip_map`."""
    return float(flip_map(test, reference, pixels_per_degree).mean())


def flip_map(test: FloatArray, reference: FloatArray, pixels_per_degree: float = PIXELS_PER_DEGREE) -> DoubleArray:
    """Difference of two radiance pictures at each pixel.

    Args:
        test: ``(h, w, 3+)`` scene-linear radiance.
        reference: the same size.
        pixels_per_degree: pixels that the eye sees in a degree.

    Returns:
        ``(h, w)`` from 0 to 1.
    """
    first, second = (
        _opponent_from_rgb(np.clip(np.nan_to_num(picture[..., :3].astype(np.float64)), 0, 1))
        for picture in (test, reference)
    )
    colour = _colour_difference(first, second, pixels_per_degree)
    feature = _feature_difference((first[..., 0] + 16) / 116, (second[..., 0] + 16) / 116, pixels_per_degree)
    return np.asarray(colour ** (1 - feature))


def _colour_difference(test: DoubleArray, reference: DoubleArray, pixels_per_degree: float) -> DoubleArray:
    seen = [_uniform_colour(_filter_contrast(picture, pixels_per_degree)) for picture in (test, reference)]
    raised = _hyab(*seen) ** _COLOUR_EXPONENT
    green, blue = (_hunt(_lab_from_xyz(_XYZ_FROM_RGB @ rgb)) for rgb in ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]))
    most = float(_hyab(green, blue)) ** _COLOUR_EXPONENT
    cut = _COLOUR_CUT * most
    above = _COLOUR_TARGET + (raised - cut) / (most - cut) * (1 - _COLOUR_TARGET)
    return np.asarray(np.clip(np.where(raised < cut, _COLOUR_TARGET / cut * raised, above), 0, 1))


def _feature_difference(test: DoubleArray, reference: DoubleArray, pixels_per_degree: float) -> DoubleArray:
    deviation = 0.5 * _FEATURE_DEGREES * pixels_per_degree
    x = np.arange(-np.ceil(3 * deviation), np.ceil(3 * deviation) + 1)
    blur = np.exp(-(x**2) / (2 * deviation**2))
    blur /= blur.sum()
    edges, points = _balanced(-x * blur), _balanced((x**2 / deviation**2 - 1) * blur)

    def strength(luminance: DoubleArray, kernel: DoubleArray) -> DoubleArray:
        across = _convolve(_convolve(luminance, kernel, 1), blur, 0)
        down = _convolve(_convolve(luminance, blur, 1), kernel, 0)
        return np.asarray(np.hypot(across, down))

    apart = [np.abs(strength(reference, kernel) - strength(test, kernel)) for kernel in (edges, points)]
    return np.asarray(np.clip((np.maximum(*apart) / np.sqrt(2)) ** _FEATURE_EXPONENT, 0, 1))


def _balanced(kernel: DoubleArray) -> DoubleArray:
    """Kernel whose positive and whose negative weights sum to 1."""
    positive, negative = kernel[kernel > 0].sum(), -kernel[kernel < 0].sum()
    return np.asarray(np.where(kernel > 0, kernel / positive, kernel / negative))


def _filter_contrast(opponent: DoubleArray, pixels_per_degree: float) -> DoubleArray:
    """Linear RGB in [0, 1] of a picture in the opponent space after the eye's blur of each channel."""
    widest = max(width for gaussians in _CONTRAST for _, width in gaussians)
    radius = int(np.ceil(3 * np.sqrt(widest / (2 * np.pi**2)) * pixels_per_degree))
    degrees = np.arange(-radius, radius + 1) / pixels_per_degree
    filtered = np.empty_like(opponent)
    for channel, gaussians in enumerate(_CONTRAST):
        kernels = [np.exp(-(np.pi**2) * degrees**2 / width) for _, width in gaussians]
        weights = [
            amplitude * np.sqrt(np.pi / width) * kernel.sum() ** 2
            for (amplitude, width), kernel in zip(gaussians, kernels, strict=True)
        ]
        filtered[..., channel] = sum(
            weight
            / sum(weights)
            * _convolve(_convolve(opponent[..., channel], kernel / kernel.sum(), 0), kernel / kernel.sum(), 1)
            for weight, kernel in zip(weights, kernels, strict=True)
        )
    return np.asarray(np.clip(_xyz_from_opponent(filtered) @ _RGB_FROM_XYZ.T, 0, 1))


def _convolve(image: DoubleArray, kernel: DoubleArray, axis: int) -> DoubleArray:
    """Convolution along an axis; the picture's edge is repeated."""
    radius = len(kernel) // 2
    padded = np.pad(image, [(radius, radius) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, len(kernel), axis=axis) @ kernel[::-1])


def _opponent_from_rgb(rgb: DoubleArray) -> DoubleArray:
    """YCxCz: a linear form of CIELAB."""
    x, y, z = np.moveaxis(rgb @ _XYZ_FROM_RGB.T / _WHITE, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def _xyz_from_opponent(opponent: DoubleArray) -> DoubleArray:
    y = (opponent[..., 0] + 16) / 116
    return np.asarray(np.stack([y + opponent[..., 1] / 500, y, y - opponent[..., 2] / 200], axis=-1) * _WHITE)


def _uniform_colour(rgb: DoubleArray) -> DoubleArray:
    return _hunt(_lab_from_xyz(rgb @ _XYZ_FROM_RGB.T))


def _lab_from_xyz(xyz: DoubleArray) -> DoubleArray:
    relative, delta = xyz / _WHITE, 6 / 29
    x, y, z = np.moveaxis(np.where(relative > delta**3, np.cbrt(relative), relative / (3 * delta**2) + 4 / 29), -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def _hunt(lab: DoubleArray) -> DoubleArray:
    """CIELAB whose colours fade where it is dark."""
    faded = 0.01 * lab[..., :1] * lab[..., 1:]
    return np.concatenate([lab[..., :1], faded], axis=-1)


def _hyab(a: DoubleArray, b: DoubleArray) -> DoubleArray:
    """Difference of lightness plus distance of colours."""
    apart = a - b
    return np.asarray(np.abs(apart[..., 0]) + np.hypot(apart[..., 1], apart[..., 2]))
