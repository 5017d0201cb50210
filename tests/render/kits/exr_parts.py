"""Parts of EXR files, as OpenImageIO and as OpenEXR's own package read them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import OpenImageIO
from numpy.typing import NDArray

Box = tuple[int, int, int, int]
"""Left, top, right and bottom pixel of a window, ends included."""
_OIIO_NAMES = {"aperture": "FNumber", "pixelAspectRatio": "PixelAspectRatio"}


@dataclass(frozen=True, eq=False)
class ExrPart:
    """A part of a file.

    Attributes:
        name: its name.
        channels: ``(height, width)`` samples by channel, of the type that the file has.
        data_window: of the part.
        display_window: of the file.
        header: attributes by OpenEXR's names.
    """

    name: str
    channels: dict[str, NDArray[Any]]
    data_window: Box
    display_window: Box
    header: dict[str, Any]


def read_by_openexr(file: Path) -> list[ExrPart]:
    """Read a file by OpenEXR's package."""
    found = []
    for part in OpenEXR.File(str(file), separate_channels=True).parts:
        windows = [
            (*low.tolist(), *high.tolist()) for low, high in map(part.header.get, ("dataWindow", "displayWindow"))
        ]
        channels = {name: channel.pixels for name, channel in part.channels.items()}
        found.append(ExrPart(part.header.get("name", ""), channels, *windows, part.header))
    return found


def read_by_openimageio(file: Path) -> list[ExrPart]:
    """Read a file by OpenImageIO."""
    found = []
    for i in range(OpenImageIO.ImageBuf(str(file)).nsubimages):
        image = OpenImageIO.ImageBuf(str(file), i, 0)
        spec = image.spec()
        pixels = image.get_pixels(spec.format)
        channels = {name: pixels[..., c] for c, name in enumerate(spec.channelnames)}
        data = (spec.x, spec.y, spec.x + spec.width - 1, spec.y + spec.height - 1)
        full = (
            spec.full_x,
            spec.full_y,
            spec.full_x + spec.full_width - 1,
            spec.full_y + spec.full_height - 1,
        )
        header = {attribute.name: attribute.value for attribute in spec.extra_attribs}
        for name, other in _OIIO_NAMES.items():
            if other in header:
                header[name] = header.pop(other)
        for name in ("worldToNDC", "worldToCamera"):
            header[name] = np.reshape(header[name], (4, 4))
        found.append(ExrPart(spec["oiio:subimagename"], channels, data, full, header))
    return found


READERS: dict[str, Callable[[Path], list[ExrPart]]] = {
    "OpenEXR": read_by_openexr,
    "OpenImageIO": read_by_openimageio,
}
