"""White balance: which light looks neutral."""

from __future__ import annotations

import math

import numpy as np

from render.colour import rgb_to_working
from render.errors import SettingsError
from render.model.arrays import DoubleArray

LEAST_K, GREATEST_K = 1000.0, 40000.0
_TINT_STEP = 1 / 3000  # of CIE 1960 uv
_REC709_FROM_XYZ = np.array(
    [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]]
)  # IEC 61966-2-1, white D65


def balance_gains(temperature_k: float, tint: float = 0.0) -> DoubleArray:
    """Channel gains of the working space that make light of a colour temperature look neutral.

    The light's colour is the black body's, as the colour temperature of USD's lights is, its luminance 1: a grey that the
    light shows at 0.18 in luminance becomes 0.18 in each channel.

    Args:
        temperature_k: colour temperature of the light; 0 for the working space's own white.
        tint: correction across the line of black bodies, in 1/3000 of CIE 1960 uv; positive turns the picture to magenta.

    Returns:
        ``(3,)``, all positive.

    Raises:
        SettingsError: the temperature is out of range, or so odd a light with that tint has no positive colour.
    """
    if temperature_k == 0 and tint == 0:
        return np.ones(3)
    if temperature_k and not LEAST_K <= temperature_k <= GREATEST_K:
        raise SettingsError(
            f"a white balance is from {LEAST_K:g} to {GREATEST_K:g} kelvin, or 0 for the working space's white; "
            f"got {temperature_k:g}",
            code="bad_white_balance",
        )
    red, green, blue = (float(c) for c in _light(temperature_k or 6504.0, tint))
    light = np.array(rgb_to_working((red, green, blue)))
    if temperature_k == 0:  # the tint alone: from the working space's white, not from the black body nearest to it
        light = light / np.array(rgb_to_working(tuple(_light(6504.0, 0.0).tolist())))
    if not (np.isfinite(light).all() and (light > 0).all()):
        raise SettingsError(
            f"a white balance of {temperature_k:g} kelvin with a tint of {tint:g} is no light's colour",
            code="bad_white_balance",
        )
    gains: DoubleArray = 1 / light
    return gains


def _light(temperature_k: float, tint: float) -> DoubleArray:
    """Linear Rec. 709 of a light of luminance 1, ``(3,)``: a black body (Krystek 1985), moved across the line by the tint."""
    u, v = _black_body_uv(temperature_k)
    du, dv = _black_body_uv(temperature_k * 1.001) - _black_body_uv(temperature_k * 0.999)
    length = math.hypot(du, dv)
    # The line runs to small v as it gets hotter: its left side, where v grows, is green.
    u, v = u - tint * _TINT_STEP * abs(dv) / length, v + tint * _TINT_STEP * abs(du) / length
    x, y = 3 * u / (2 * u - 8 * v + 4), 2 * v / (2 * u - 8 * v + 4)
    light: DoubleArray = _REC709_FROM_XYZ @ np.array([x / y, 1.0, (1 - x - y) / y])
    return light


def _black_body_uv(kelvin: float) -> DoubleArray:
    """CIE 1960 uv of a black body (Krystek 1985): within 1e-4 from 1000 to 15000 K, and smooth beyond."""
    k, k2 = kelvin, kelvin**2
    u = (0.860117757 + 1.54118254e-4 * k + 1.28641212e-7 * k2) / (1 + 8.42420235e-4 * k + 7.08145163e-7 * k2)
    v = (0.317398726 + 4.22806245e-5 * k + 4.20481691e-8 * k2) / (1 - 2.89741816e-5 * k + 1.61456053e-7 * k2)
    return np.array([u, v])
