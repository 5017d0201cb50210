"""The demo's textures, painted by arithmetic and written as PNG and JPEG beside the shot.

Images are ``(height, width, channels)`` float32 in 0..1 with row 0 at the top; colours are sRGB-encoded, as their files are.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO

from render.demo.shapes.noise import Plane, blur, fractal_noise, lattice_noise, normal_map
from render.errors import OutputError

SETTS_TILE_M = 2.0


def write_image(path: Path, pixels: Plane) -> None:
    """Writes an 8-bit image; its suffix names the format.

    Raises:
        OutputError: if it cannot be written.
    """
    planes = pixels[..., None] if pixels.ndim == 2 else pixels
    height, width, channels = planes.shape
    spec = OpenImageIO.ImageSpec(width, height, channels, "uint8")
    spec.attribute("Compression", "jpeg:88" if path.suffix == ".jpg" else "zip")
    spec.attribute("oiio:dither", 0)
    output = OpenImageIO.ImageOutput.create(str(path))
    if output is None or not output.open(str(path), spec):
        raise OutputError(f"{path} could not be opened for writing: {OpenImageIO.geterror()}", path=str(path))
    data = np.ascontiguousarray(np.clip(planes, 0, 1) * 255 + 0.5).astype(np.uint8)
    if not output.write_image(data):
        raise OutputError(f"{path} could not be written: {output.geterror()}", path=str(path))
    output.close()


def setts_height(size: int = 1024) -> tuple[Plane, Plane]:
    """Granite setts laid in scalloped courses, as a tiling height field.

    Returns:
        ``(size, size)`` heights in metres, and a random number 0..1 for each stone.
    """
    courses, stones = 16, 14
    across, up = np.meshgrid((np.arange(size) + 0.5) / size, 1 - (np.arange(size) + 0.5) / size)
    # Courses bow upwards in scallops one metre wide, as they do on old squares.
    bow = np.abs((across * 2) % 1 - 0.5) * 2
    lane = (up + 0.06 * (1 - bow**2)) * courses
    course = np.floor(lane).astype(int) % courses
    random = np.random.default_rng(7)
    ends = np.sort((np.arange(stones) + random.uniform(-0.22, 0.22, (courses, stones))) / stones, axis=1)
    shifted = (across + random.random(courses)[course]) % 1
    stone = (shifted[..., None] > ends[course]).sum(axis=-1)
    left = np.take_along_axis(np.c_[ends[:, -1:] - 1, ends][course], stone[..., None], -1)[..., 0]
    right = np.take_along_axis(np.c_[ends, ends[:, :1] + 1][course], stone[..., None], -1)[..., 0]
    tile = SETTS_TILE_M
    to_side = np.minimum(shifted - left, right - shifted) * tile
    to_lane = np.minimum(lane % 1, 1 - lane % 1) / courses * tile
    # Rounded stones: distances to the two nearest joints meet in a smooth minimum.
    edge = -np.log(np.exp(-to_side / 0.008) + np.exp(-to_lane / 0.008)) * 0.008
    dome = 1 - np.clip(1 - edge / 0.045, 0, 1) ** 2.4
    tone = random.random((courses, stones))[course, stone % stones]
    tilt = random.uniform(-0.07, 0.07, (2, courses, stones))[:, course, stone % stones]
    lean = tilt[0] * (shifted - (left + right) / 2) * tile + tilt[1] * (lane % 1 - 0.5) / courses * tile
    rough = fractal_noise(size, 32, 4, 20) - 0.5
    return (0.007 * dome + 0.4 * lean * dome + 0.0003 * rough).astype(np.float32), tone.astype(np.float32)


def _setts() -> dict[str, Plane]:
    height, tone = setts_height()
    wet = np.clip(1.35 - height / 0.010 + 0.5 * (fractal_noise(1024, 3, 3, 40) - 0.5), 0, 1)
    grain = fractal_noise(1024, 64, 3, 50)
    shade = (0.17 + 0.13 * tone + 0.10 * (grain - 0.5)) * (1 - 0.42 * wet)
    tint = np.stack([0.96 + 0.10 * tone, np.full_like(tone, 0.99), 1.12 - 0.12 * tone], axis=-1)
    return {
        "setts_colour.jpg": shade[..., None] * tint,
        "setts_roughness.png": np.clip(0.34 + 0.16 * (1 - wet) + 0.06 * (grain - 0.5), 0.2, 1),
        "setts_normal.png": normal_map(height, SETTS_TILE_M),
    }


def _plaster(tint: tuple[float, float, float], seed: int) -> Plane:
    stains = fractal_noise(512, 4, 5, seed)
    pores = fractal_noise(512, 64, 3, seed + 9)
    shade = 0.62 + 0.34 * stains + 0.16 * (pores - 0.5)
    worn = np.clip((stains - 0.58) * 6, 0, 1)[..., None]
    return np.asarray(shade[..., None] * (np.array(tint) * (1 - 0.35 * worn) + 0.35 * worn * 0.55), np.float32)


def _wood() -> Plane:
    size, boards = 512, 5
    across = np.arange(size)[None, :] / size * boards
    board = across.astype(int) % boards
    grain = (
        lattice_noise(size, 64, 3)[:, :] * 0.5 + np.repeat(lattice_noise(size, 128, 4)[:8].repeat(64, 0), 1, 1) * 0.5
    )
    tone = np.random.default_rng(5).uniform(0.75, 1.1, boards)[board]
    joint = np.clip(np.minimum(across % 1, 1 - across % 1) * 40, 0.15, 1)
    shade = (0.34 + 0.22 * grain) * tone * joint
    return np.asarray(shade[..., None] * np.array([1.0, 0.66, 0.42]), np.float32)


def _stripes(colour: tuple[float, float, float]) -> Plane:
    band = (np.arange(256) // 64 % 2)[None, :, None]
    weave = 0.92 + 0.08 * np.random.default_rng(2).random((256, 256, 1))
    return np.asarray(weave * (band * np.array(colour) + (1 - band) * np.array([0.88, 0.83, 0.72])), np.float32)


def _window_warm() -> Plane:
    """Draw a lit room behind curtains: brightest low in the middle, at the lamp."""
    size = 256
    across, up = np.meshgrid(np.linspace(-1, 1, size), np.linspace(1, 0, size))
    lamp = np.exp(-((across * 1.1) ** 2 + ((up - 0.42) * 1.9) ** 2))
    parting = 0.28 + 0.45 * up**2
    folds = 0.8 + 0.2 * np.sin(across * 46 + 3 * np.sin(up * 5))
    curtain = np.clip((np.abs(across) - parting) * 12, 0, 1)
    room = 0.55 + 0.45 * lamp
    light = room * (1 - curtain) + curtain * folds * (0.28 + 0.5 * lamp)
    cool = np.array([1.0, 0.78, 0.52]) * (1 - curtain[..., None]) + curtain[..., None] * np.array([1.0, 0.58, 0.30])
    return np.asarray(light[..., None] * cool, np.float32)


def _shop() -> Plane:
    """A shop window, three panes wide: pendant lamps, shelves of bright goods, a dim back wall, a counter."""
    height, width = 512, 1024
    random = np.random.default_rng(11)
    across, up = np.meshgrid(np.linspace(0, 3, width), np.linspace(1, 0, height))
    picture = np.ones((height, width, 3)) * np.array([0.48, 0.28, 0.13])
    palette = np.array(
        [[0.95, 0.30, 0.16], [0.20, 0.50, 0.46], [1.0, 0.82, 0.46], [0.50, 0.16, 0.12], [0.9, 0.58, 0.18]]
    )
    for shelf in range(4):
        floor = height - 96 - shelf * 92
        picture[floor : floor + 6] = [0.22, 0.12, 0.05]
        left = 8
        while left < width - 40:
            wide, tall = int(random.integers(10, 34)), int(random.integers(24, 70))
            shade = palette[random.integers(len(palette))] * random.uniform(0.3, 0.9)
            picture[floor - tall : floor, left : left + wide] = shade
            left += wide + int(random.integers(3, 40))
    picture[height - 84 :] = np.array([0.26, 0.13, 0.06])
    light = 0.30 + 0.30 * up
    for x in (0.45, 1.2, 1.85, 2.6):
        radius = np.hypot((across - x) * 1.15, up - 0.80)
        light = light + 0.85 * np.exp(-((radius / 0.30) ** 2))
        picture = np.where((radius < 0.075)[..., None], np.array([1.0, 0.80, 0.46]) * 1.2, picture)
        picture[(np.abs(across - x) < 0.006) & (up > 0.86)] = 0.05
    return np.asarray(np.clip(blur(picture.astype(np.float32), 1.3) * light[..., None], 0, 1), np.float32)


def _tram() -> Plane:
    """Inside the tram: a lamp along the ceiling, poles, the heads and shoulders of a few passengers."""
    size = 256
    across, up = np.meshgrid(np.linspace(-1, 1, size), np.linspace(1, 0, size))
    light = 0.42 + 0.30 * up + 0.9 * np.exp(-(((up - 0.93) / 0.05) ** 2))
    light = light * np.where(np.minimum(np.abs(across - 0.38), np.abs(across + 0.52)) < 0.022, 0.35, 1.0)
    for x, shoulder in ((-0.2, 0.30), (0.62, 0.22), (-0.78, 0.34)):
        head = ((across - x) / 0.13) ** 2 + ((up - shoulder - 0.15) / 0.11) ** 2 < 1
        body = ((across - x) / 0.26) ** 2 + ((up - shoulder + 0.16) / 0.24) ** 2 < 1
        light = np.where(head | body, 0.13, light)
    return blur(np.asarray(light[..., None] * np.array([1.0, 0.80, 0.52]), np.float32), 1.0)


def _sky() -> Plane:
    """Dusk's last blue over the roofs, thin cloud lit by the town, a few stars."""
    height, width = 512, 1024
    up = np.linspace(1, 0, height)[:, None, None]
    colour = np.array([0.030, 0.055, 0.13]) * up + np.array([0.12, 0.17, 0.30]) * (1 - up)
    cloud = np.clip(fractal_noise(1024, 4, 6, 201)[:height] - 0.48, 0, 1)[..., None] * (1.2 - 0.6 * up)
    stars = np.random.default_rng(77).random((height, width)) > 0.99985
    shining = blur(stars.astype(np.float32), 0.8)[..., None] * 4 * (up > 0.3)
    encoded = np.sqrt(np.clip(colour, 0, 1)) + cloud * np.array([0.30, 0.26, 0.30]) + shining
    return np.asarray(encoded, np.float32)


def _paper() -> Plane:
    """Oiled paper with a flame behind it: hottest a little below its middle, dark at its wire ribs."""
    across, up = np.meshgrid(np.linspace(0, 1, 128), np.linspace(1, 0, 256))
    flame = 0.16 + 0.84 * np.exp(-(((up - 0.42) / 0.27) ** 2))
    ribs = 1 - 0.30 * np.exp(-((np.abs((up * 12) % 1 - 0.5) / 0.10) ** 2))
    fibres = 0.90 + 0.20 * (fractal_noise(256, 16, 3, 63)[:, ::2] - 0.5)
    light = flame * ribs * fibres + 0 * across
    hue = np.stack([light, light**1.35 * 0.72, light**1.9 * 0.36], axis=-1)
    return np.asarray(hue, np.float32)


def _leaf() -> Plane:
    across, up = np.meshgrid(np.linspace(-1, 1, 128), np.linspace(1, 0, 128))
    veins = np.maximum(
        np.exp(-np.abs(across) * 24), 0.6 * np.exp(-np.abs(np.sin((up * 7 - np.abs(across) * 2.4) * np.pi)) * 9)
    )
    shade = 0.42 + 0.12 * fractal_noise(128, 8, 3, 31)
    return np.asarray(
        shade[..., None] * np.array([0.50, 0.92, 0.36]) + veins[..., None] * [0.10, 0.12, 0.05], np.float32
    )


def _knit() -> dict[str, Plane]:
    """Two stitches of stocking knit, tiling."""
    size = 128
    across, up = np.meshgrid(np.arange(size) / size, 1 - np.arange(size) / size)
    column = np.abs((across * 4) % 1 - 0.5) * 2
    strand = np.abs(((up * 4 + 0.6 * column) % 1) - 0.5) * 2
    height = (1 - strand**2) * (0.35 + 0.65 * np.sqrt(np.clip(1 - (2 * column - 1) ** 2, 0, 1)))
    fuzz = np.random.default_rng(3).random((size, size))
    colour = (0.55 + 0.40 * height + 0.08 * fuzz)[..., None] * np.array([0.86, 0.16, 0.10])
    return {
        "knit_colour.jpg": colour.astype(np.float32),
        "knit_normal.png": normal_map((0.004 * height).astype(np.float32), 0.08),
    }


def write_textures(directory: Path) -> None:
    """Writes every texture into ``directory``.

    Raises:
        OutputError: if one cannot be written.
    """
    images: dict[str, Plane] = {
        **_setts(),
        **_knit(),
        "plaster_ochre.jpg": _plaster((0.66, 0.47, 0.27), 100),
        "plaster_blue.jpg": _plaster((0.36, 0.43, 0.50), 140),
        "wood_colour.jpg": _wood(),
        "stripes_red.png": _stripes((0.72, 0.12, 0.09)),
        "stripes_teal.png": _stripes((0.08, 0.42, 0.42)),
        "window_warm.jpg": _window_warm(),
        "shop.jpg": _shop(),
        "sky.jpg": _sky(),
        "tram.jpg": _tram(),
        "paper.jpg": _paper(),
        "leaf_colour.png": _leaf(),
    }
    for name, pixels in images.items():
        write_image(directory / name, pixels)
