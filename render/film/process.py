"""From exposed light to the print on the screen: light, density, print, light again."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from render.errors import SettingsError
from render.film.balance import balance_gains
from render.film.grain import GRAIN_SIZE_UM, add_grain, grain_field
from render.film.halation import add_halation
from render.film.sensor import SensorSettings, expose_sensor
from render.film.settings import FilmSettings
from render.film.stock import MIDDLE_GREY, Stock
from render.model.arrays import FloatArray

STOP = math.log10(2.0)
"""A stop in log10 exposure."""
PANCHROMATIC = (1 / 3, 1 / 3, 1 / 3)
"""Weights of red, green and blue light in the exposure of a black-and-white stock: its sensitivity is level over the visible."""
_DARKEST = 1e-7  # scene-linear: far below any toe, so that the logarithm is finite


def develop_on_film(
    exposed: FloatArray, film: FilmSettings, *, frame: int, gate_mm: tuple[float, float], seed: int = 0
) -> FloatArray:
    """Develop an exposed picture on a film or a sensor.

    Negatives are printed: the printer's lights are set so that a metered grey of an unpushed roll lands at the print's aim, and
    stay there, so that under- and overexposure and push show.

    Args:
        exposed: ``(height, width, 3)`` scene-linear in the working space, times the camera's exposure: a metered middle grey
            is 0.18. Finite.
        film: film or sensor that the light falls on.
        frame: frame number; grain and noise are the same for the same frame and seeds, and new in each frame.
        gate_mm: width and height of the film that the picture covers: grain and halation have a size on the film.
        seed: seed of the render, beside the film's own.

    Returns:
        ``(height, width, 3)`` float32. For negative, reversal and monochrome: display-referred linear light of the projected
        print or positive, 1 where it is clear film, in the primaries of the working space (shown as in
        `render.film.print_space`). For digital and none: scene-linear light, with the sensor's noise and clipping.

    Raises:
        SettingsError: the picture or the gate has an impossible shape.
    """
    if exposed.ndim != 3 or exposed.shape[2] != 3:
        raise SettingsError(f"exposed light must be (height, width, 3), got {exposed.shape}")
    if not (min(gate_mm) > 0 and all(map(math.isfinite, gate_mm))):
        raise SettingsError(f"a film gate needs a width and a height above 0 mm, got {gate_mm[0]:g} x {gate_mm[1]:g}")
    if film.process in ("none", "digital"):
        gains = balance_gains(film.white_balance_k, film.tint)
        balanced = (exposed * gains.astype(np.float32)).astype(np.float32, copy=False)
        if film.process == "none":
            return balanced
        return expose_sensor(balanced, balance_sensor(film), frame=frame, seed=seed + film.grain.seed)
    density = densities(exposed, film, gate_mm=gate_mm)
    return project_print(apply_grain(density, film, frame=frame, gate_mm=gate_mm, seed=seed), film)


def balance_sensor(film: FilmSettings) -> SensorSettings:
    """Sensor settings for balanced light: a channel with a higher gain has had less light.

    Args:
        film: digital.
    """
    red, green, blue = (np.array(film.sensor.sensitivity) / balance_gains(film.white_balance_k, film.tint)).tolist()
    return replace(film.sensor, sensitivity=(red, green, blue))


def log_exposures(exposed: FloatArray, film: FilmSettings, *, gate_mm: tuple[float, float] | None = None) -> FloatArray:
    """Log10 exposure of each record of the stock, on the axis of its curves; a push counts as exposure.

    Longer development makes a stock faster: here it moves the curve by log10 2 for each stop and leaves its shape alone. (How
    much steeper it gets depends on the developer, and the makers' numbers do not say; a shot may draw a curve of its own.)

    Args:
        exposed: as for `develop_on_film`.
        film: with a stock.
        gate_mm: width and height of the film, for halation; None for none.

    Returns:
        ``(height, width, 3)``, or ``(height, width, 1)`` on a black-and-white stock; float32.
    """
    stock = _stock(film)
    light = exposed * balance_gains(film.white_balance_k, film.tint).astype(np.float32)
    if gate_mm is not None and film.halation.amount > 0:
        halation, pixel_mm = film.halation, _pixel_mm(exposed, gate_mm)
        light = add_halation(light, halation.amount, halation.radius_mm, halation.color, pixel_mm)
    if len(stock.curves) == 1:
        light = light @ np.array(PANCHROMATIC, np.float32)[:, None]
    log_light = np.log10(np.maximum(light, np.float32(_DARKEST)), dtype=np.float32)
    offset = np.array(stock.middle_log_exposure) - math.log10(MIDDLE_GREY) + film.push * STOP
    exposures: FloatArray = log_light + offset.astype(np.float32)
    return exposures


def densities(exposed: FloatArray, film: FilmSettings, *, gate_mm: tuple[float, float] | None = None) -> FloatArray:
    """Density of the developed camera stock, without grain.

    Args:
        exposed: as for `develop_on_film`.
        film: with a stock.
        gate_mm: width and height of the film, for halation; None for none.

    Returns:
        ``(height, width, 3)``, or ``(height, width, 1)`` on a black-and-white stock; float32, base included.
    """
    return _apply_curves(log_exposures(exposed, film, gate_mm=gate_mm), _stock(film))


def apply_grain(
    density: FloatArray, film: FilmSettings, *, frame: int, gate_mm: tuple[float, float], seed: int = 0
) -> FloatArray:
    """Add grain to the camera stock's density.

    Args:
        density: as `densities` gives it.
        film: with a stock; the same array comes back where its grain's amount is 0.
        frame: as for `develop_on_film`.
        gate_mm: width and height of the film that the picture covers.
        seed: seed of the render.

    Returns:
        The same shape, float32.
    """
    grain = film.grain
    if grain.amount == 0:
        return density
    across, down = _pixel_mm(density, gate_mm)
    height, width, records = density.shape
    field = grain_field(
        (height, width, records),
        (1000 * across, 1000 * down),
        grain.size_um or GRAIN_SIZE_UM,
        frame=frame,
        seed=seed + grain.seed,
    )
    return add_grain(density, _stock(film).granularity, field, grain.amount)


def print_densities(density: FloatArray, film: FilmSettings) -> FloatArray:
    """Density of a negative's print, exposed through the negative.

    Args:
        density: of the negative, as `densities` gives it.
        film: with a print stock.

    Returns:
        The same shape, float32, base included.
    """
    stock, printed = _stock(film), film.print_stock
    if printed is None:
        raise SettingsError(f"film process {film.process} has no print")
    lights = np.array(printed.middle_log_exposure) + np.array(stock.middle_density)
    return _apply_curves(lights.astype(np.float32) - density, printed)


def project_print(density: FloatArray, film: FilmSettings) -> FloatArray:
    """Light of the print or positive on the screen, 1 where it is clear.

    Args:
        density: of the camera stock, as `densities` gives it.
        film: with a stock, and a print stock where it is a negative.

    Returns:
        ``(height, width, 3)`` float32; three equal channels of a black-and-white print.
    """
    shown = _stock(film) if film.process == "reversal" else film.print_stock
    if shown is None:
        raise SettingsError(f"film process {film.process} has no print")
    seen = density if film.process == "reversal" else print_densities(density, film)
    light = np.power(np.float32(10), np.array(shown.base, np.float32) - seen)
    return np.ascontiguousarray(np.broadcast_to(light, (*density.shape[:2], 3)))


def _apply_curves(log_exposure: FloatArray, stock: Stock) -> FloatArray:
    density = np.empty_like(log_exposure)
    for record, curve in enumerate(stock.curves):
        density[..., record] = curve.densities(log_exposure[..., record])
    return density


def _pixel_mm(picture: FloatArray, gate_mm: tuple[float, float]) -> tuple[float, float]:
    return gate_mm[0] / picture.shape[1], gate_mm[1] / picture.shape[0]


def _stock(film: FilmSettings) -> Stock:
    if film.stock is None:
        raise SettingsError(f"film process {film.process} has no stock, so it has no density")
    return film.stock
