"""A reader of Cryptomatte files, written from the specification alone."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from render.model.arrays import FloatArray
from tests.render.kits.exr_parts import ExrPart, read_by_openimageio


@dataclass(frozen=True)
class Cryptomatte:
    """One matte of a file.

    Attributes:
        ids: ``(height, width, ranks)`` uint32 bits.
        coverage: ``(height, width, ranks)`` float32.
        manifest: id bits by name.
    """

    ids: np.ndarray
    coverage: FloatArray
    manifest: dict[str, int]

    def of(self, name: str) -> FloatArray:
        """``(height, width)`` coverage of a name."""
        return np.where(self.ids == self.manifest[name], self.coverage, 0).sum(axis=-1)


def read_cryptomattes(
    file: Path, read: Callable[[Path], list[ExrPart]] = read_by_openimageio
) -> dict[str, Cryptomatte]:
    """Read all mattes of an EXR by name: header of the first part, channels of all parts."""
    parts = read(file)
    channels = {name: pixels for part in parts for name, pixels in part.channels.items()}
    assert all(pixels.dtype == np.float32 for name, pixels in channels.items() if name[-4:-2].isdigit())
    headers = {name: value for name, value in parts[0].header.items() if name.startswith("cryptomatte/")}
    mattes = {}
    for key in {name.split("/")[1] for name in headers}:
        own = {what: headers[f"cryptomatte/{key}/{what}"] for what in ("name", "hash", "conversion", "manifest")}
        assert (own["hash"], own["conversion"]) == ("MurmurHash3_32", "uint32_to_float32")
        ids, coverage = [], []
        layer = 0
        while f"{own['name']}{layer:02}.R" in channels:
            ids += [channels[f"{own['name']}{layer:02}.{c}"] for c in "RB"]
            coverage += [channels[f"{own['name']}{layer:02}.{c}"] for c in "GA"]
            layer += 1
        bits = np.ascontiguousarray(np.stack(ids, axis=-1)).view(np.uint32)
        manifest = {name: int(value, 16) for name, value in json.loads(own["manifest"]).items()}
        mattes[own["name"]] = Cryptomatte(bits, np.stack(coverage, axis=-1), manifest)
    return mattes
