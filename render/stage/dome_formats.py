"""Environments of domes in other formats than latitude-longitude, as images in that one.

UsdLux names the formats and leaves open where their middles look. Here the middle of each image is where the middle of the
latitude-longitude image is, the dome's +Z, with +Y up, so that a picture converted from one format to another lights the same.
An angular map and a cross are seen from inside, as a latitude-longitude image is; a mirrored ball shows the environment
mirrored, as a photograph of one does.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from render.model.arrays import DoubleArray, FloatArray, HalfArray
from render.model.scene import Image

_MOST_HEIGHT = 4096
_ROWS = 128
Places = tuple[DoubleArray, DoubleArray]
"""Places across and down an image, 0 to 1."""


def latlong_image(image: Image, layout: str) -> Image:
    """Image of a dome as a latitude-longitude one.

    Args:
        image: the dome's image.
        layout: its format: a key of `FORMATS`.
    """
    source = image.pixels.astype(np.float32)
    places_of, height = FORMATS[layout], _height(image, layout)
    if layout == "cubeMapVerticalCross":
        places_of = partial(cross_places, face_px=min(source.shape[0] / 4, source.shape[1] / 3))
    pixels = np.empty((height, 2 * height, 4), np.float16)
    azimuth = np.pi * (1 - (np.arange(2 * height) + 0.5) / height)  # from +Z towards +X
    for first in range(0, height, _ROWS):
        polar = (np.arange(first, min(first + _ROWS, height))[:, None] + 0.5) / height * np.pi
        x, y, z = np.sin(polar) * np.sin(azimuth), np.cos(polar) + 0 * azimuth, np.sin(polar) * np.cos(azimuth)
        pixels[first : first + _ROWS] = _sampled(source, *places_of(x, y, z))
    return Image(pixels, image.name, image.channels)


def angular_places(x: DoubleArray, y: DoubleArray, z: DoubleArray) -> Places:
    """Places in an angular map: the distance from its middle is the angle from +Z; its rim is -Z (Debevec 1998, light probes)."""
    across = np.hypot(x, y)
    radius = np.arctan2(across, z) / np.pi / np.maximum(across, 1e-9)
    return 0.5 - 0.5 * radius * x, 0.5 - 0.5 * radius * y


def mirrored_places(x: DoubleArray, y: DoubleArray, z: DoubleArray) -> Places:
    """Places in a photograph, from afar, of a mirror ball whose middle mirrors +Z: the ball's normal halves the angle to it."""
    radius = 1 / np.maximum(np.sqrt(2 * (1 + z)), 1e-9)
    rim = np.minimum(1.0, 0.999 / np.maximum(np.hypot(x, y) * radius, 1e-9))
    return 0.5 + 0.5 * radius * rim * x, 0.5 - 0.5 * radius * rim * y


def cross_places(x: DoubleArray, y: DoubleArray, z: DoubleArray, face_px: float = np.inf) -> Places:
    """Places in an upright cross of three by four faces: +Y; +X, +Z and -X; -Y; and -Z upside down.

    Args:
        x: of directions.
        y: likewise.
        z: likewise.
        face_px: side of a face; places are at least half a pixel inside of it, so that they mix no other face.
    """
    most_aside = 1 - 1 / face_px
    faces = (  # column and row; and what lies ahead, to the right and up
        (1, 0, y, -x, -z),
        (0, 1, x, z, y),
        (1, 1, z, -x, y),
        (2, 1, -x, -z, y),
        (1, 2, -y, -x, z),
        (1, 3, -z, -x, -y),
    )
    most = np.maximum(np.maximum(abs(x), abs(y)), abs(z))
    u, v = np.zeros_like(most), np.zeros_like(most)
    for column, row, ahead, right, up in faces:
        here = ahead >= most
        aside, upwards = (np.clip(part[here] / most[here], -most_aside, most_aside) for part in (right, up))
        u[here], v[here] = (column + 0.5 + 0.5 * aside) / 3, (row + 0.5 - 0.5 * upwards) / 4
    return u, v


FORMATS: dict[str, Callable[[DoubleArray, DoubleArray, DoubleArray], Places]] = {
    "angular": angular_places,
    "mirroredBall": mirrored_places,
    "cubeMapVerticalCross": cross_places,
}
"""Places in images of each format by directions ``(x, y, z)`` of the dome, of unit length."""


def _height(image: Image, layout: str) -> int:
    """Rows of the latitude-longitude image: as fine as the source is in its middle."""
    rows = image.pixels.shape[0]
    fine = {"angular": rows / 2, "mirroredBall": rows * np.pi / 4, "cubeMapVerticalCross": rows / 4 * np.pi / 2}[layout]
    return int(np.clip(np.ceil(fine), 8, _MOST_HEIGHT))


def _sampled(source: FloatArray, across: DoubleArray, down: DoubleArray) -> HalfArray:
    """Pixels at places of an image, bilinear."""
    height, width = source.shape[:2]
    column, row = across * width - 0.5, down * height - 0.5
    left, top = np.floor(column), np.floor(row)
    share_x, share_y = (column - left)[..., None], (row - top)[..., None]
    columns = [np.clip(left + i, 0, width - 1).astype(int) for i in (0, 1)]
    rows = [np.clip(top + i, 0, height - 1).astype(int) for i in (0, 1)]
    upper, lower = (source[at, columns[0]] * (1 - share_x) + source[at, columns[1]] * share_x for at in rows)
    return np.asarray(upper * (1 - share_y) + lower * share_y, np.float16)
