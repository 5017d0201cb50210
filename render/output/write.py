"""Frames as files that are either there and whole, or not there."""

from __future__ import annotations

import os
from collections.abc import Sequence

from render.files import write_atomic
from render.model.arrays import FloatArray
from render.output.deep_exr import encode_deep_exr
from render.output.encode import FrameArrays, encode
from render.output.exr import encode_views
from render.output.formats import format_of
from render.output.layout import PLAIN_LAYOUT, FileLayout
from render.output.metadata import FrameMetadata


def write_frame(
    path: str | os.PathLike[str],
    frame: FrameArrays,
    graded: FloatArray,
    metadata: FrameMetadata,
    layout: FileLayout = PLAIN_LAYOUT,
) -> None:
    """Write a frame in the format of the file's name.

    Args:
        path: ends in ``.exr``, ``.png``, ``.jpg`` or ``.jpeg``. Its folder must exist; a file there is replaced.
        frame: the rendered frame, for EXR.
        graded: ``(height, width, 3)`` display-referred, 0 to 1, for PNG and JPEG.
        metadata: metadata of the file.
        layout: parts of an EXR file, and its place in a larger picture.

    Raises:
        SettingsError: the name's ending is not known.
        OutputError: the file cannot be written; an existing file is unchanged.
    """
    write_atomic(path, encode(format_of(path), frame, graded, metadata, layout))


def write_views(
    path: str | os.PathLike[str],
    views: Sequence[tuple[FrameArrays, FrameMetadata]],
    layout: FileLayout = PLAIN_LAYOUT,
) -> None:
    """Write the frames of several views into one EXR file (`render.output.exr.encode_views`).

    Args:
        path: the file. Its folder must exist; a file there is replaced.
        views: frame and metadata of each; the metadata name it.
        layout: parts of each view.

    Raises:
        OutputError: the file cannot be written; an existing file is unchanged.
    """
    deep = [(frame.deep, metadata) for frame, metadata in views if frame.deep is not None]
    if layout.is_deep and deep:
        content = encode_deep_exr(deep, layout)
    else:
        content = encode_views([(frame.color, frame.aovs, metadata) for frame, metadata in views], layout)
    write_atomic(path, content)
