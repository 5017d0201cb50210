"""Domes light the same, whatever the format of their texture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import UsdLux

from render.model.arrays import DoubleArray, FloatArray
from render.model.scene import Image
from render.stage import StageReader, find_not_honoured
from render.stage.dome_formats import FORMATS, latlong_image
from tests.render.kits.stages import codes, new_stage, read, write_picture

TOP, BOTTOM = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)
AHEAD, BEHIND = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
PLUS_X, MINUS_X = (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)


def sky(x: DoubleArray, y: DoubleArray, z: DoubleArray) -> FloatArray:
    """A smooth environment that is another one in each direction."""
    return np.stack([1 + x + 0.5 * y, 1 + 0.7 * y - 0.3 * z, 1 + 0.9 * z + 0.2 * x * y], axis=-1).astype(np.float32) + 1


def picture_of_sky(layout: str, side_px: int) -> FloatArray:
    """The environment drawn in a format, pixel by pixel, from that format's definition."""
    if layout == "cubeMapVerticalCross":
        picture = np.zeros((4 * side_px, 3 * side_px, 3), np.float32)
        at = 2 * (np.arange(side_px) + 0.5) / side_px - 1
        right, up = at[None, :] + 0 * at[:, None], -at[:, None] + 0 * at
        one = np.ones_like(right)
        faces = {
            (0, 1): (-right, one, -up),  # the top, whose lower edge is the front's upper one
            (1, 0): (one, up, right),
            (1, 1): (-right, up, one),
            (1, 2): (-one, up, -right),
            (2, 1): (-right, -one, up),
            (3, 1): (-right, -up, -one),
        }
        for (row, column), directions in faces.items():
            length = np.sqrt(sum(part**2 for part in directions))
            face = sky(*(part / length for part in directions))
            picture[row * side_px : (row + 1) * side_px, column * side_px : (column + 1) * side_px] = face
        return picture
    at = 2 * (np.arange(side_px) + 0.5) / side_px - 1
    right, up = at[None, :] + 0 * at[:, None], -at[:, None] + 0 * at
    radius = np.minimum(np.hypot(right, up), 1.0)
    if layout == "angular":
        polar, x_sign = np.pi * radius, -1.0
    else:  # a ray along -Z, reflected by a ball whose normal is (right, up, ...)
        polar, x_sign = 2 * np.arcsin(radius), 1.0
    around = np.arctan2(up, x_sign * right)
    return sky(np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar))


def seen(image: Image, direction: tuple[float, float, float]) -> DoubleArray:
    """Pixel of a latitude-longitude image in a direction (OpenEXR: its middle is +Z, and +X a quarter to the left)."""
    x, y, z = direction
    height, width = image.pixels.shape[:2]
    row = min(int(np.arccos(y) / np.pi * height), height - 1)
    column = int((0.5 - np.arctan2(x, z) / (2 * np.pi)) * width) % width
    return image.pixels[row, column, :3].astype(np.float64)


@pytest.mark.parametrize("layout", FORMATS)
def test_each_direction_is_where_the_format_has_it(layout: str) -> None:
    pixels = picture_of_sky(layout, 64)
    found = latlong_image(Image(np.dstack([pixels, np.ones(pixels.shape[:2])]).astype(np.float16)), layout)
    directions = [TOP, BOTTOM, AHEAD, PLUS_X, MINUS_X, (0.6, 0.48, 0.64), (-0.6, -0.48, -0.64), (0.6, 0.0, -0.8)]
    for direction in directions if layout == "mirroredBall" else (*directions, BEHIND):
        expected = sky(*(np.array(part) for part in direction))
        np.testing.assert_allclose(seen(found, direction), expected, atol=0.12, err_msg=str(direction))


@pytest.mark.parametrize("layout", FORMATS)
def test_a_dome_reads_its_format(tmp_path: Path, layout: str) -> None:
    stage = new_stage()
    dome = UsdLux.DomeLight.Define(stage, "/dome")
    dome.CreateTextureFileAttr(write_picture(tmp_path / "sky.exr", picture_of_sky(layout, 16)))
    dome.CreateTextureFormatAttr(layout)
    reader = StageReader(stage)
    first, again = (reader.read(time).dome for time in (0, 1))
    assert first is not None
    assert first.image is not None
    assert again is not None
    assert again.image is first.image
    assert first.image.pixels.shape[1] == 2 * first.image.pixels.shape[0]
    assert reader.findings == find_not_honoured(stage) == []


def test_a_format_that_usd_does_not_know_is_a_finding(tmp_path: Path) -> None:
    stage = new_stage()
    dome = UsdLux.DomeLight.Define(stage, "/dome")
    dome.CreateTextureFileAttr(write_picture(tmp_path / "sky.exr", np.ones((8, 16, 3), np.float32)))
    dome.CreateTextureFormatAttr("octahedral")
    reader = StageReader(stage)
    found = reader.read(0).dome
    assert found is not None
    assert found.image is None
    assert codes(reader) == {"dome_format"}
    dome.GetTextureFormatAttr().Set("automatic")
    assert read(stage).dome is not None
