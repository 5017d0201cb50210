"""Encoding of maps: a number for each pixel of a frame, or several."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from service.models.base import Model


def encode_map(head: Model, numbers: NDArray[np.uint16] | NDArray[np.uint32]) -> bytes:
    """Encode a map without loss: the length of its head, its head, and compressed differences along rows, byte by byte.

    The format is the one that `service.http.routes.frames.get_focus_map` describes.

    Args:
        head: size of the map, and what its numbers mean.
        numbers: ``(n, height, width)`` bits of the numbers, little-endian.
    """
    steps = np.diff(numbers, axis=-1, prepend=numbers.dtype.type(0))
    planes = np.moveaxis(steps[..., None].view(np.uint8), -1, 1)
    text = head.model_dump_json(by_alias=True).encode()
    return struct.pack(">I", len(text)) + text + zlib.compress(planes.tobytes(), 1)
