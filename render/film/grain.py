"""Film grain: density that scatters by the stock's granularity, on the film's own scale.

Granularity is measured as the standard deviation of density through a round aperture of 48 µm (ISO 10505). Grain is noise of a
density whose power is level up to the grain's own size, so through any larger aperture it scatters as one over the root of the
area (Selwyn 1935): small formats and large enlargements show more of it, and pixels that cover much film show less.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from render.film.curve import Knots
from render.film.noise import normal_noise
from render.model.arrays import DoubleArray, FloatArray

APERTURE_UM = 48.0
"""Diameter of the aperture through which granularity is stated."""
GRAIN_SIZE_UM = 6.0
"""Correlation length where none is stated: what printing leaves of grains of a micrometre that lie in clumps. Our own choice:
makers do not publish it."""

_REACH = 3.0  # in standard deviations: where the kernel is cut off
_RINGS = 512


def grain_field(
    shape: tuple[int, int, int],
    pixel_um: tuple[float, float],
    size_um: float,
    *,
    frame: int,
    seed: int,
    first_row: int = 0,
    first_column: int = 0,
) -> FloatArray:
    """Grain of a stock whose density scatters by 1 through the 48 µm aperture.

    Args:
        shape: height, width and number of records of the picture, or of a tile of it.
        pixel_um: width and height of a pixel on the film, in micrometres.
        size_um: correlation length of the grain on the film: twice the standard deviation of its Gaussian.
        frame: frame number; each frame has grain of its own.
        seed: seed of the grain.
        first_row: first row of the tile in the picture.
        first_column: first column of the tile in the picture.

    Returns:
        ``shape`` float32, of mean 0; the same whether it is made at once or in tiles.
    """
    height, width, records = shape
    across, down = grain_kernels(pixel_um, size_um)
    reach_x, reach_y = len(across) // 2, len(down) // 2
    rows = range(first_row - reach_y, first_row + height + reach_y)
    columns = range(first_column - reach_x, first_column + width + reach_x)
    noise = normal_noise(rows, columns, records, frame=frame, seed=seed)
    noise = _convolve(_convolve(noise, down, 0), across, 1)
    noise *= np.float32(grain_scale(pixel_um, size_um))
    return noise


def grain_kernels(pixel_um: tuple[float, float], size_um: float) -> tuple[DoubleArray, DoubleArray]:
    """Convolution kernels, across and down, that turn white noise into grain: odd lengths, sum 1."""
    return _kernel(size_um / 2 / pixel_um[0]), _kernel(size_um / 2 / pixel_um[1])


def grain_scale(pixel_um: tuple[float, float], size_um: float) -> float:
    """Factor on such grain that makes its standard deviation 1 through the 48 µm aperture."""
    return math.sqrt(_power_um2(size_um) / (pixel_um[0] * pixel_um[1]))


def add_grain(density: FloatArray, granularity: tuple[Knots, ...], field: FloatArray, amount: float) -> FloatArray:
    """Add grain to density.

    Args:
        density: ``(height, width, records)``.
        granularity: (density, standard deviation through 48 µm) of each record; level beyond the ends.
        field: as `grain_field` makes it, of the same shape.
        amount: factor on the grain.

    Returns:
        The same shape, float32, never below 0: no film gives light.
    """
    grainy = np.empty_like(density)
    for record, table in enumerate(granularity):
        densities, deviations = np.array(table, np.float64).T
        deviation = np.interp(density[..., record], densities, amount * deviations).astype(np.float32)
        np.maximum(density[..., record] + deviation * field[..., record], 0, out=grainy[..., record])
    return grainy


@cache
def _power_um2(size_um: float) -> float:
    """Noise power at low frequencies, in square µm, of grain that scatters by 1 through the 48 µm aperture.

    The variance through the aperture is the power over its area times the share of grain that it takes in whole: the mean of
    the disc's autocorrelation over the grain's.
    """
    sigma = math.sqrt(2) * size_um / 2  # of the Gaussian's autocorrelation
    area = math.pi * APERTURE_UM**2 / 4
    if sigma == 0:
        return area
    r = np.linspace(0, min(APERTURE_UM, 6 * sigma), _RINGS)
    q = r / APERTURE_UM
    disc = 2 / math.pi * (np.arccos(q) - q * np.sqrt(1 - q**2))
    grain = np.exp(-(r**2) / (2 * sigma**2)) * r / sigma**2
    return area / float(np.trapezoid(disc * grain, r))


@cache
def _kernel(sigma_px: float) -> DoubleArray:
    """Gaussian's share in each pixel, of sum 1 and odd length; 1 alone where the grain is far smaller than a pixel."""
    reach = math.ceil(_REACH * sigma_px - 0.5)
    if reach < 1:
        return np.ones(1)
    edges = (np.arange(-reach, reach + 2) - 0.5) / (sigma_px * math.sqrt(2))
    shares = np.diff([math.erf(edge) for edge in edges])
    kernel: DoubleArray = shares / shares.sum()
    return kernel


def _convolve(field: FloatArray, kernel: DoubleArray, axis: int) -> FloatArray:
    """Convolve a field along an axis; it loses the kernel's reach at both ends."""
    size = field.shape[axis] - len(kernel) + 1
    if len(kernel) == 1:
        return field
    total = np.zeros([size if a == axis else n for a, n in enumerate(field.shape)], np.float32)
    for shift, weight in enumerate(kernel.astype(np.float32)):
        total += weight * (field[shift : shift + size] if axis == 0 else field[:, shift : shift + size])
    return total
