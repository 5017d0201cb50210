"""Graded pictures that were stored as files, read back as they were encoded."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO
from numpy.typing import NDArray

from render.errors import InputError

SMALL_WIDTH_PX = 240
"""Width of pictures on a contact sheet, and of thumbnails."""


@dataclass(frozen=True, eq=False)
class Still:
    """A stored picture.

    Attributes:
        pixels: ``(height, width, 3)`` levels.
        cicp: code points of its colours: primaries, transfer, matrix and full range (ITU-T H.273); None where it has none.
    """

    pixels: NDArray[np.uint8]
    cicp: tuple[int, ...] | None


def shrink_picture(pixels: NDArray[np.uint8], most_width: int = SMALL_WIDTH_PX) -> NDArray[np.uint8]:
    """Reduce a picture to a width; a smaller one stays as it is.

    Args:
        pixels: ``(height, width, 3)`` levels.
        most_width: px.
    """
    height, width, _ = pixels.shape
    if width <= most_width:
        return pixels
    wanted = OpenImageIO.ROI(0, most_width, 0, max(1, round(height * most_width / width)), 0, 1, 0, 3)
    small = OpenImageIO.ImageBufAlgo.resize(OpenImageIO.ImageBuf(np.ascontiguousarray(pixels)), roi=wanted)
    return np.asarray(small.get_pixels(OpenImageIO.UINT8), np.uint8)


def read_still(path: Path) -> Still:
    """Read a PNG or JPEG of three channels.

    Args:
        path: the file.

    Raises:
        InputError: it cannot be read.
    """
    picture = OpenImageIO.ImageInput.open(str(path))
    if picture is None:
        raise InputError(f"{path.name} cannot be read: {OpenImageIO.geterror().strip()}", path=str(path))
    try:
        spec = picture.spec()
        pixels = picture.read_image(0, 0, 0, 3, "uint8") if spec.nchannels >= 3 else None
        if pixels is None:
            reason = picture.geterror().strip() or f"expected three channels, got {spec.nchannels}"
            raise InputError(f"{path.name} cannot be read: {reason}", path=str(path))
        codes = spec.getattribute("CICP")
        return Still(pixels, None if codes is None else tuple(codes))
    finally:
        picture.close()
