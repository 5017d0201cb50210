"""Test targets for film: a grey wedge, a colour chart and a small scene, as exposed light in the working space."""

from __future__ import annotations

import numpy as np

from render.colour import to_working
from render.film.stock import MIDDLE_GREY
from render.model.arrays import DoubleArray, FloatArray

WEDGE_STEPS = 21
WEDGE_STOPS = 7.0
"""The wedge runs from this many stops below middle grey to as many above."""

# The 24 patches of the chart that McCamy, Marcus and Davidson published (1976), as 8-bit sRGB, row by row.
_CHART_SRGB = (
    *((115, 82, 68), (194, 150, 130), (98, 122, 157), (87, 108, 67), (133, 128, 177), (103, 189, 170)),
    *((214, 126, 44), (80, 91, 166), (193, 90, 99), (94, 60, 108), (157, 188, 64), (224, 163, 46)),
    *((56, 61, 150), (70, 148, 73), (175, 54, 60), (231, 199, 31), (187, 86, 149), (8, 133, 161)),
    *((243, 243, 242), (200, 200, 200), (160, 160, 160), (122, 122, 121), (85, 85, 85), (52, 52, 52)),
)
_CHART_GREY = 21  # the patch that is nearest to middle grey: the chart is exposed so that it is

# Spheres of the scene: middle and radius in picture heights, sRGB colour, gloss.
_SPHERES = (
    (0.36, 0.62, 0.20, (0.76, 0.57, 0.48), 0.25),  # skin
    (0.76, 0.66, 0.16, (0.66, 0.12, 0.10), 1.0),
    (1.10, 0.69, 0.13, (0.10, 0.32, 0.62), 1.0),
    (1.40, 0.66, 0.16, (0.22, 0.46, 0.16), 0.4),
    (0.60, 0.85, 0.07, (0.95, 0.76, 0.10), 0.6),
    (1.25, 0.86, 0.06, (0.50, 0.50, 0.50), 0.2),
)
_LAMPS = tuple((0.2 + 0.2 * i, 0.13 + 0.025 * (i % 2), 2.0 ** (3 + i)) for i in range(7))  # 1.5 to 9 stops above white
_LAMP_RADIUS = 0.012
_TO_THE_LIGHT = np.array([-0.5, -0.62, 0.6]) / np.linalg.norm([-0.5, -0.62, 0.6])
_HORIZON = 0.56


def wedge_stops() -> DoubleArray:
    """Stops from middle grey of each step of the wedge, ``(21,)``."""
    return np.linspace(-WEDGE_STOPS, WEDGE_STOPS, WEDGE_STEPS)


def grey_wedge() -> FloatArray:
    """A row of 21 greys, ``(1, 21, 3)``; the one in the middle is middle grey."""
    levels = MIDDLE_GREY * 2.0 ** wedge_stops()
    return np.repeat(levels.astype(np.float32)[None, :, None], 3, axis=2)


def colour_chart() -> FloatArray:
    """24 colours, ``(4, 6, 3)``, with the neutral patch that is nearest to middle grey at 0.18."""
    encoded = (np.array(_CHART_SRGB).reshape(4, 6, 3) / 255).astype(np.float32)
    chart = to_working(encoded, "sRGB")
    brightness = chart.reshape(24, 3)[_CHART_GREY].mean()
    return (chart * np.float32(MIDDLE_GREY / brightness)).astype(np.float32)


def small_scene(height: int) -> FloatArray:
    """Coloured balls before a wall in the light of one lamp, and a string of bare bulbs that get brighter by a stop each.

    Args:
        height: in pixels; the picture is 16:9.

    Returns:
        ``(height, width, 3)`` exposed light, twice as fine before it is averaged to this size.
    """
    rows, columns = 2 * height, 2 * round(height * 16 / 9)
    y, x = np.meshgrid((np.arange(rows) + 0.5) / rows, (np.arange(columns) + 0.5) / rows, indexing="ij")
    light = _room(x, y)
    for left, middle, radius, srgb, gloss in _SPHERES:
        _put_sphere(light, x, y, (left, middle, radius), _linear(srgb), gloss)
    for left, middle, brightness in _LAMPS:
        light[np.hypot(x - left, y - middle) < _LAMP_RADIUS] = brightness * _linear((1.0, 0.88, 0.72))
    fine: FloatArray = light.reshape(height, 2, columns // 2, 2, 3).mean((1, 3)).astype(np.float32)
    return fine


def _room(x: DoubleArray, y: DoubleArray) -> DoubleArray:
    """A wall that gets darker to the right, a table, and the shadows of the balls on it."""
    wall = 0.30 * 2.0 ** (-2.2 * x)[..., None] * (0.5 + y)[..., None] * _linear((0.62, 0.72, 0.78))
    table = 0.34 * 2.0 ** (-0.8 * np.abs(x - 0.6))[..., None] * _linear((0.80, 0.72, 0.62))
    light = np.where((y > _HORIZON)[..., None], table, wall)
    for left, middle, radius, _, _ in _SPHERES:
        away = np.hypot((x - left - 0.8 * radius) / (1.7 * radius), (y - middle - 0.92 * radius) / (0.36 * radius))
        light = light * np.where(y > _HORIZON, 1 - 0.85 * np.exp(-(away**2)), 1.0)[..., None]
    return np.asarray(light)


def _put_sphere(
    light: DoubleArray,
    x: DoubleArray,
    y: DoubleArray,
    sphere: tuple[float, float, float],
    color: DoubleArray,
    gloss: float,
) -> None:
    """Draw a sphere into the picture, seen straight on."""
    left, middle, radius = sphere
    across, down = (x - left) / radius, (y - middle) / radius
    inside = across**2 + down**2 < 1
    normal = np.stack([across[inside], down[inside], np.sqrt(1 - across[inside] ** 2 - down[inside] ** 2)], axis=-1)
    facing = np.maximum(normal @ _TO_THE_LIGHT, 0)
    mirrored = np.maximum(2 * facing * normal[:, 2] - _TO_THE_LIGHT[2], 0)
    from_below = 0.08 * (1 + normal[:, 1])
    light[inside] = color * (0.04 + from_below + 1.2 * facing)[:, None] + gloss * 8 * (mirrored**200)[:, None]


def _linear(srgb: tuple[float, float, float]) -> DoubleArray:
    return np.array(to_working(np.array([srgb], np.float32), "sRGB")[0], np.float64)
