"""Textures of the generated scenes, painted by arithmetic: no files.

Colours are painted as the eye grades them (0..1, encoded with a gamma of 2.2) and stored scene-linear. Row 0 is the top.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.demo.shapes.noise import Plane, blur, fractal_noise
from render.model.scene import Image

Colour = tuple[float, float, float]
Doubles = NDArray[np.float64]


def linear(encoded: Plane | Doubles, alpha: Plane | Doubles | None = None, name: str = "") -> Image:
    """An image from encoded colour ``(h, w, 3)`` or grey ``(h, w)``, and opacity ``(h, w)``; None is opaque."""
    colour = encoded if encoded.ndim == 3 else np.repeat(encoded[..., None], 3, axis=2)
    opacity = np.ones(colour.shape[:2]) if alpha is None else alpha
    return Image(np.concatenate([np.clip(colour, 0, 1) ** 2.2, opacity[..., None]], axis=2).astype(np.float16), name)


def bricks(brick: Colour, mortar: Colour, seed: int, size: int = 512) -> Image:
    """A tile of running bond: 8 bricks across, 16 courses."""
    across, up = _grid(size)
    course = np.floor(up * 16).astype(int)
    shifted = (across * 8 + 0.5 * (course % 2)) % 8
    stone, along, rise = shifted.astype(int), shifted % 1, (up * 16) % 1
    # A course is half as high as a brick is long: distances to the joint in units of its height.
    edge = np.minimum(2 * np.minimum(along, 1 - along), np.minimum(rise, 1 - rise))
    face = np.clip((edge - 0.07) / 0.07, 0, 1)[..., None]
    random = np.random.default_rng(seed)
    tone = random.uniform(0.72, 1.12, (16, 8))[course, stone]
    warm = random.uniform(-0.06, 0.06, (16, 8))[course, stone]
    grain = 0.86 + 0.28 * fractal_noise(size, 24, 4, seed)
    body = np.array(brick) * (tone * grain)[..., None] + warm[..., None] * np.array([1.0, 0.4, 0.0])
    return linear(face * body + (1 - face) * np.array(mortar) * grain[..., None], name="bricks")


def plaster(tint: Colour, seed: int, size: int = 512) -> Image:
    """A tile of weathered plaster: stains, and patches where the top coat has gone."""
    stains = fractal_noise(size, 4, 5, seed)
    pores = fractal_noise(size, 48, 3, seed + 9)
    worn = np.clip((fractal_noise(size, 6, 4, seed + 20) - 0.60) * 14, 0, 1)[..., None]
    shade = (0.72 + 0.40 * stains + 0.12 * (pores - 0.5))[..., None]
    bare = np.array([0.60, 0.55, 0.48]) * (0.8 + 0.4 * pores)[..., None]
    return linear(shade * np.array(tint) * (1 - worn) + worn * bare, name="plaster")


def roof_tiles(tint: Colour, seed: int, size: int = 512) -> Image:
    """A tile of beaver-tail roof tiles: 10 across, 10 courses, each with its shadow on the one below."""
    across, up = _grid(size)
    course = np.floor(up * 10).astype(int)
    shifted = (across * 10 + 0.5 * (course % 2)) % 10
    tile, along, rise = shifted.astype(int), shifted % 1, (up * 10) % 1
    tone = np.random.default_rng(seed).uniform(0.65, 1.15, (10, 10))[course, tile]
    tongue = 0.10 + 0.26 * (2 * np.abs(along - 0.5)) ** 2.2  # the round lower end hangs over the course below
    shadow = np.clip((rise - tongue + 0.10) / 0.14, 0, 1)
    joint = np.clip(np.minimum(along, 1 - along) / 0.06, 0.35, 1)
    moss = np.clip((fractal_noise(size, 5, 4, seed + 4) - 0.56) * 5, 0, 1)[..., None]
    grain = 0.85 + 0.3 * fractal_noise(size, 40, 3, seed)
    body = np.array(tint) * (tone * grain)[..., None] * (1 - moss) + moss * np.array([0.36, 0.40, 0.20])
    return linear(body * (0.35 + 0.65 * shadow * joint)[..., None], name="roof tiles")


def cobbles(seed: int, size: int = 1024) -> Image:
    """A tile of cobblestones in a shaken grid (Worley 1996): 18 by 18 stones, sand between them."""
    count = 18
    random = np.random.default_rng(seed)
    centres = random.uniform(0.18, 0.82, (count, count, 2))
    tones = random.uniform(0.62, 1.10, (count, count))
    across, up = _grid(size)
    x, y = across * count, up * count
    distances = []
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            cx, cy = np.floor(x).astype(int) + dx, np.floor(y).astype(int) + dy
            centre = centres[cy % count, cx % count]
            distances.append(np.hypot(cx + centre[..., 0] - x, cy + centre[..., 1] - y))
    stacked = np.stack(distances)
    order = np.argsort(stacked, axis=0)[:2]
    first, second = np.take_along_axis(stacked, order, axis=0)
    nearest = order[0]
    tone = tones[
        (np.floor(y).astype(int) + nearest // 3 - 1) % count, (np.floor(x).astype(int) + nearest % 3 - 1) % count
    ]
    stone = np.clip((second - first - 0.06) / 0.22, 0, 1)[..., None]
    grain = 0.82 + 0.36 * fractal_noise(size, 48, 4, seed)
    body = np.array([0.56, 0.54, 0.52]) * (tone * grain)[..., None] * (0.7 + 0.3 * stone)
    return linear(stone * body + (1 - stone) * np.array([0.30, 0.26, 0.21]) * grain[..., None], name="cobbles")


def planks(tint: Colour, seed: int, boards: int = 5, size: int = 512) -> Image:
    """A tile of upright boards with grain along them."""
    across, up = _grid(size)
    board = np.floor(across * boards).astype(int)
    random = np.random.default_rng(seed)
    tone, offset = random.uniform(0.78, 1.12, boards)[board], random.random(boards)[board]
    wander = fractal_noise(size, 4, 3, seed) - 0.5
    rings = 0.5 + 0.5 * np.sin(
        2 * np.pi * ((across + offset) * 22 + 2.2 * wander + 0.6 * np.sin(2 * np.pi * (up + offset)))
    )
    joint = np.clip(np.minimum((across * boards) % 1, 1 - (across * boards) % 1) * 22, 0.25, 1)
    shade = tone * joint * (0.80 + 0.20 * rings + 0.2 * (fractal_noise(size, 32, 3, seed + 5) - 0.5))
    return linear(shade[..., None] * np.array(tint), name="planks")


def marble(light: Colour, vein: Colour, seed: int, size: int = 512) -> Image:
    """A tile of marble: veins where folded noise crosses its middle."""
    warp = fractal_noise(size, 4, 5, seed)
    cloud = fractal_noise(size, 3, 4, seed + 30)
    veins = np.exp(-np.abs(warp - 0.5) / 0.018) * 0.55 + np.exp(-np.abs(cloud - 0.47) / 0.03) * 0.25
    shade = np.clip(veins, 0, 1)[..., None]
    return linear(
        (0.92 + 0.14 * (cloud[..., None] - 0.5)) * np.array(light) * (1 - shade) + shade * np.array(vein), name="marble"
    )


def checkers(light: Colour, dark: Colour, seed: int, cells: int = 4, size: int = 512) -> Image:
    """A tile of polished floor: squares of two marbles with a fine joint."""
    across, up = _grid(size)
    x, y = across * cells, up * cells
    odd = ((np.floor(x) + np.floor(y)) % 2)[..., None]
    tone = np.random.default_rng(seed).uniform(0.86, 1.06, (cells, cells))[
        np.floor(y).astype(int), np.floor(x).astype(int)
    ]
    veins = np.exp(-np.abs(fractal_noise(size, 6, 5, seed) - 0.5) / 0.02)[..., None]
    body = odd * np.array(light) * (1 - 0.25 * veins) + (1 - odd) * (np.array(dark) + 0.22 * veins)
    edge = np.minimum(np.minimum(x % 1, 1 - x % 1), np.minimum(y % 1, 1 - y % 1))
    return linear(body * (tone * np.clip(0.45 + edge / 0.03, 0, 1))[..., None], name="checkered floor")


def leaf_card(tint: Colour, seed: int, leaves: int = 26, size: int = 256) -> Image:
    """A twig with leaves, cut out by its opacity; it grows from the middle of the lower edge."""
    across, up = _grid(size)
    random = np.random.default_rng(seed)
    alpha = np.exp(-np.abs(across - 0.5 - 0.03 * np.sin(7 * up)) / 0.010) * (up < 0.86)
    colour = np.broadcast_to(np.array([0.30, 0.22, 0.13]), (size, size, 3)).copy()
    for k in range(leaves):
        t = 0.06 + 0.86 * k / leaves
        side, reach = (-1 if k % 2 else 1), random.uniform(0.20, 0.36) * (1.15 - 0.6 * t)
        tilt = side * random.uniform(0.5, 1.25)
        x, y = across - 0.5 - side * 0.01, up - t
        along, off = x * np.sin(tilt) + y * np.cos(tilt), x * np.cos(tilt) - y * np.sin(tilt)
        s = np.clip(along / reach, 0, 1)
        half = 0.30 * reach * np.sin(np.pi * s**0.8)
        inside = np.clip((half - np.abs(off)) * size / 1.5, 0, 1) * ((along > 0) & (along < reach))
        rib = np.exp(-np.abs(off) / (0.012 * reach + 0.002))
        shade = random.uniform(0.72, 1.18) * (0.85 + 0.3 * rib) * (0.85 + 0.2 * s)
        colour = np.where(inside[..., None] > 0.5, shade[..., None] * np.array(tint), colour)
        alpha = np.maximum(alpha, inside)
    return linear(blur(colour.astype(np.float32), 0.7), np.clip(alpha, 0, 1), "leaves")


def lit_window(light: Colour, seed: int, size: int = 128) -> Image:
    """A room behind curtains, its lamp low in the middle."""
    across, up = _grid(size)
    x = across * 2 - 1
    lamp = np.exp(-((x * 1.2) ** 2 + ((up - 0.4) * 2) ** 2))
    curtain = np.clip((np.abs(x) - 0.25 - 0.4 * up**2) * 8, 0, 1)
    folds = 0.8 + 0.2 * np.sin(x * 26 + seed)
    shade = (0.45 + 0.55 * lamp) * (1 - curtain) + curtain * folds * (0.25 + 0.45 * lamp)
    return linear(shade[..., None] * np.array(light), name="lit window")


def evening_sky(zenith: Colour, horizon: Colour, ground: Colour, seed: int, height: int = 256) -> Image:
    """A latitude-longitude sky of soft cloud over a dim ground."""
    width = 2 * height
    up = 1 - (np.arange(height) + 0.5) / height * 2  # 1 straight up, -1 straight down
    sky = np.clip(up, 0, 1)[:, None, None] ** 0.55
    colour = np.array(zenith) * sky + np.array(horizon) * (1 - sky)
    cloud = (
        np.clip(fractal_noise(width, 5, 5, seed)[:height] - 0.46, 0, 1)[..., None]
        * 1.6
        * np.sin(np.pi * np.clip(sky, 0, 1))
    )
    colour = colour + cloud * (np.array([0.95, 0.86, 0.80]) - colour)
    below = np.clip(-up * 18, 0, 1)[:, None, None]
    return linear(blur((colour * (1 - below) + below * np.array(ground)).astype(np.float32), 1.0), name="evening sky")


def stripes(tint: Colour, size: int = 128) -> Image:
    """A tile of canvas with two stripes."""
    across, up = _grid(size)
    band = (np.floor(across * 4) % 2)[..., None]
    weave = 0.94 + 0.06 * np.sin(2 * np.pi * 16 * across) * np.sin(2 * np.pi * 16 * up)
    return linear(
        weave[..., None] * (band * np.array(tint) + (1 - band) * np.array([0.90, 0.86, 0.78])), name="stripes"
    )


def _grid(size: int) -> tuple[Doubles, Doubles]:
    """Texture coordinates of the texels' centres, both ``(size, size)`` in 0..1: across, and up from the lower edge."""
    t = (np.arange(size) + 0.5) / size
    across, down = np.meshgrid(t, t)
    return across, 1 - down
