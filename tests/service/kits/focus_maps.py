"""Decoding of focus maps, written from the description of `getFocusMap`."""

from __future__ import annotations

import json
import struct
import zlib
from typing import Any

import numpy as np

from render.model.arrays import FloatArray


def decode_focus_map(content: bytes) -> tuple[dict[str, Any], FloatArray, FloatArray]:
    """Decode a focus map: its head, and ``(height, width)`` circles of confusion and depths."""
    (size,) = struct.unpack_from(">I", content)
    head = json.loads(content[4 : 4 + size])
    planes = np.frombuffer(zlib.decompress(content[4 + size :]), np.uint8).reshape(2, 4, head["height"], head["width"])
    steps = sum(planes[:, i].astype(np.uint32) << (8 * i) for i in range(4))
    coc_px, depth_m = np.cumsum(steps, axis=-1, dtype=np.uint32).view(np.float32)
    return head, coc_px, depth_m
