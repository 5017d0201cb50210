"""OpenImageIO's writers, as functions from arrays to bytes."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import OpenImageIO
from numpy.typing import NDArray

from render.errors import OutputError
from render.output.metadata import Attribute

_LAST_BYTES = {".png": b"IEND\xaeB`\x82", ".jpg": b"\xff\xd9"}

Part: TypeAlias = "tuple[OpenImageIO.ImageSpec, NDArray[Any] | OpenImageIO.DeepData]"


def describe(spec: OpenImageIO.ImageSpec, attributes: Iterable[Attribute]) -> OpenImageIO.ImageSpec:
    """The same spec, with the attributes set."""
    for name, kind, value in attributes:
        spec.attribute(name, kind, value)
    return spec


def file_bytes(ending: str, parts: Sequence[Part]) -> bytes:
    """The bytes of an image file with one or more parts.

    OpenImageIO's Python writes to named files only, so the bytes make a detour through the folder for temporary files.

    Args:
        ending: of the file's name; it chooses the writer.
        parts: for each part its spec and its pixels ``(height, width, channels)``, or its deep pixels.

    Raises:
        OutputError: the encoder failed.
    """
    try:
        with tempfile.TemporaryDirectory(prefix="pullfocus-") as folder:
            path = Path(folder) / f"frame{ending}"
            _write_parts(path, parts)
            content = path.read_bytes()
            if not _is_whole(path, content):
                raise OutputError(
                    f"cannot encode a {ending} file: the temporary folder {tempfile.gettempdir()} is full"
                )
            return content
    except OSError as error:
        raise OutputError(
            f"cannot encode a {ending} file in the temporary folder {tempfile.gettempdir()}: {error.strerror}"
        ) from error


def _write_parts(path: Path, parts: Sequence[Part]) -> None:
    writer = OpenImageIO.ImageOutput.create(str(path))
    if writer is None:
        raise OutputError(f"no encoder for {path.suffix} files: {_first_line(OpenImageIO.geterror())}")
    specs = tuple(spec for spec, _ in parts)
    done = writer.open(str(path), specs if len(specs) > 1 else specs[0])
    for index, (spec, pixels) in enumerate(parts):
        if index > 0:
            done = done and writer.open(str(path), spec, "AppendSubimage")
        if isinstance(pixels, OpenImageIO.DeepData):
            done = done and writer.write_deep_image(pixels)
        else:
            done = done and writer.write_image(np.ascontiguousarray(pixels))
    if not (writer.close() and done):
        raise OutputError(f"cannot encode a {path.suffix} file: {_first_line(writer.geterror())}")


def _is_whole(path: Path, content: bytes) -> bool:
    """Whether an encoded file is complete. A writer's close() does not report a full disk."""
    if path.suffix in _LAST_BYTES:
        return content.endswith(_LAST_BYTES[path.suffix])
    picture = OpenImageIO.ImageInput.open(str(path))
    if picture is None:
        OpenImageIO.geterror()  # fetched, so that it is not printed when Python ends
        return False
    part = 0
    while picture.seek_subimage(part, 0):
        spec = picture.spec()
        last = spec.y + spec.height - 1
        line = (part, 0, last, last + 1, 0, 0, spec.nchannels)
        read = picture.read_native_deep_scanlines(*line) if spec.deep else picture.read_scanlines(*line, "unknown")
        if read is None:
            picture.geterror()
            return False
        part += 1
    return True


def _first_line(message: str) -> str:
    return message.strip().splitlines()[0] if message.strip() else "the encoder gave no reason"
