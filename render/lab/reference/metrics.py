"""Similarity of two pictures: PSNR and SSIM (Wang et al. 2004), on display-encoded values.

Scene-linear radiance has no white to measure noise against, and one light would outweigh a whole picture; both pictures are
clipped to [0, 1] and encoded by the sRGB curve first, as one would look at them.
"""

from __future__ import annotations

import numpy as np

from render.model.arrays import FloatArray


def encode_for_display(radiance: FloatArray) -> FloatArray:
    """Radiance ``(h, w, 3+)`` clipped to [0, 1] and encoded by the sRGB curve (IEC 61966-2-1): ``(h, w, 3)`` float32."""
    linear = np.clip(np.nan_to_num(radiance[..., :3]), 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055).astype(np.float32)


def psnr_db(a: FloatArray, b: FloatArray) -> float:
    """Peak signal-to-noise ratio of two radiance pictures in dB; infinite where they are the same."""
    error = float(np.mean((encode_for_display(a).astype(np.float64) - encode_for_display(b)) ** 2))
    return float("inf") if error == 0 else -10 * float(np.log10(error))


def worst_share(a: FloatArray, b: FloatArray, pixels: float = 0.01) -> float:
    """Share of the squared error of two radiance pictures that the worst pixels have; NaN where the pictures are the same.

    Args:
        a: radiance.
        b: radiance.
        pixels: share of pixels that count as the worst.
    """
    error = np.sum((encode_for_display(a).astype(np.float64) - encode_for_display(b)) ** 2, axis=-1).ravel()
    worst = np.sort(error)[-max(1, round(pixels * error.size)) :]
    total = float(error.sum())
    return float(worst.sum()) / total if total > 0 else float("nan")


def ssim(a: FloatArray, b: FloatArray) -> float:
    """Mean structural similarity of the luma of two radiance pictures (Gaussian window of 1.5 px; 11 taps)."""
    x, y = (encode_for_display(picture).astype(np.float64) @ [0.2126, 0.7152, 0.0722] for picture in (a, b))
    mean_x, mean_y = _blur(x), _blur(y)
    var_x, var_y = _blur(x * x) - mean_x**2, _blur(y * y) - mean_y**2
    covariance = _blur(x * y) - mean_x * mean_y
    c1, c2 = 0.01**2, 0.03**2
    similarity = (2 * mean_x * mean_y + c1) * (2 * covariance + c2)
    return float(np.mean(similarity / ((mean_x**2 + mean_y**2 + c1) * (var_x + var_y + c2))))


def _blur(
    image: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    taps = np.exp(-0.5 * (np.arange(-5, 6) / 1.5) ** 2)
    taps /= taps.sum()
    for axis in (0, 1):
        padded = np.pad(image, [(5, 5) if a == axis else (0, 0) for a in (0, 1)], mode="symmetric")
        windows = np.lib.stride_tricks.sliding_window_view(padded, 11, axis=axis)
        image = windows @ taps
    return image
