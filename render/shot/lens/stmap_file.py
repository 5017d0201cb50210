"""STMaps as image files: read from OpenEXR or float TIFF, written as OpenEXR with 32-bit floats.

Overscan is what the data window has beyond the display window.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from render.errors import InputError
from render.optics.measured.stmap import StMap
from render.output.image_file import file_bytes
from render.stage.materials.image_files import TextureError, open_image, read_error

MAX_PIXELS = 2**26
"""Pixels of an STMap that is read or written: 8192 x 8192."""


def read_stmap(path: str | Path) -> StMap:
    """Read an STMap.

    Args:
        path: of an image file whose first two channels, or R and G, are the places.

    Raises:
        InputError: it cannot be read, or is too large.
    """
    name = Path(path).name
    try:
        with open_image(str(path), oiio.ImageSpec()) as handle:
            spec = handle.spec()
            if spec.width * spec.height > MAX_PIXELS:
                raise TextureError(f"has {spec.width} x {spec.height} pixels, at most {MAX_PIXELS} are read")
            channels = list(spec.channelnames)
            if len(channels) < 2 or spec.deep:
                raise TextureError("has no two channels for the places of an STMap")
            red = channels.index("R") if {"R", "G"} <= set(channels) else 0
            green = channels.index("G") if {"R", "G"} <= set(channels) else 1
            pixels = handle.read_image(0, 0, 0, max(red, green) + 1, "float")
            if pixels is None:
                raise read_error(handle)
            places = np.asarray(pixels, np.float64).reshape(spec.height, spec.width, -1)[..., [red, green]]
            size = (spec.full_width, spec.full_height)
            overscan = (spec.full_x - spec.x, spec.full_y - spec.y)
    except TextureError as error:
        raise InputError(f"{name} {error}", code="bad_stmap", path=str(path)) from error
    if min(size) <= 0 or not all(0 <= pad <= max(size) for pad in overscan):
        raise InputError(f"{name} has no display window that an STMap has", code="bad_stmap", path=str(path))
    return StMap(places, size, overscan)


def encode_stmap(stmap: StMap) -> bytes:
    """Encode an STMap as OpenEXR: R, G and a B of 0, 32-bit floats, lossless.

    Args:
        stmap: the map.

    Raises:
        OutputError: the encoder failed.
    """
    height, width = stmap.places.shape[:2]
    spec = oiio.ImageSpec(width, height, 3, oiio.FLOAT)
    spec.channelnames = ("R", "G", "B")
    spec.x, spec.y = -stmap.overscan_px[0], -stmap.overscan_px[1]
    spec.full_x, spec.full_y = 0, 0
    spec.full_width, spec.full_height = stmap.size
    spec.attribute("compression", "zip")
    pixels = np.zeros((height, width, 3), np.float32)
    pixels[..., :2] = stmap.places
    return file_bytes(".exr", [(spec, pixels)])
