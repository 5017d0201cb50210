"""A frame as the bytes of a file. The same frame always gives the same bytes: no dates, no machine names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import OpenImageIO
from numpy.typing import NDArray

from render.errors import SettingsError
from render.film import Grade
from render.model.arrays import FloatArray
from render.model.deep import DeepSamples
from render.output.deep_exr import encode_deep_exr
from render.output.exr import encode_exr
from render.output.formats import check_format
from render.output.image_file import describe, file_bytes
from render.output.layout import PLAIN_LAYOUT, FileLayout
from render.output.metadata import SOFTWARE, FrameMetadata

JPEG_QUALITY = 92


class FrameArrays(Protocol):
    """Arrays of a rendered frame."""

    @property
    def color(self) -> FloatArray:
        """``(height, width, 4)`` scene-linear radiance, not exposed; coverage in alpha, which the colour is times."""

    @property
    def deep(self) -> DeepSamples | None:
        """Samples in depth; None for a flat picture."""

    @property
    def aovs(self) -> Mapping[str, NDArray[Any]]:
        """Measurements by name, each ``(height, width)``."""


def encode(
    file_format: str,
    frame: FrameArrays,
    graded: FloatArray,
    metadata: FrameMetadata,
    layout: FileLayout = PLAIN_LAYOUT,
) -> bytes:
    """A frame as the bytes of a file.

    Args:
        file_format: ``exr`` writes the frame; ``png`` and ``jpeg`` write the graded picture.
        frame: the rendered frame.
        graded: ``(height, width, 3)`` display-referred, 0 to 1.
        metadata: metadata of the file.
        layout: parts of an EXR file, and its place in a larger picture.

    Raises:
        SettingsError: no such format, or an AOV that has no place in a file.
        OutputError: the encoder failed, for instance because the disk for temporary files is full.
    """
    match check_format(file_format):
        case "exr":
            if layout.is_deep and frame.deep is not None:
                return encode_deep_exr([(frame.deep, metadata)], layout)
            return encode_exr(frame.color, frame.aovs, metadata, layout)
        case "png":
            return encode_png(graded, metadata)
        case "jpeg":
            return encode_jpeg(graded, metadata)


def encode_png(graded: FloatArray, metadata: FrameMetadata) -> bytes:
    """The graded picture as an 8-bit PNG, marked with the display's colour space (cICP) where it has a code.

    Args:
        graded: ``(height, width, 3)`` display-referred, 0 to 1.
        metadata: metadata of the file.
    """
    spec, pixels = _picture(graded, metadata)
    if code_points := cicp_of(metadata.grade):
        primaries, transfer, _, full_range = code_points
        # PNG holds RGB, whose matrix code is 0 (PNG 3rd edition, 11.3.2.6).
        spec.attribute("CICP", "int[4]", (primaries, transfer, 0, full_range))
    return file_bytes(".png", [(spec, pixels)])


def encode_jpeg(graded: FloatArray, metadata: FrameMetadata | None = None) -> bytes:
    """The graded picture as a JPEG of high quality, its colour at full resolution.

    Args:
        graded: ``(height, width, 3)`` display-referred, 0 to 1.
        metadata: metadata of the file; None for none, as in live pictures.
    """
    spec, pixels = _picture(graded, metadata)
    spec.attribute("compression", f"jpeg:{JPEG_QUALITY}")
    spec.attribute("jpeg:subsampling", "4:4:4")
    return file_bytes(".jpg", [(spec, pixels)])


def cicp_of(grade: Grade) -> tuple[int, int, int, int] | None:
    """Code points of a grade's picture: primaries, transfer, matrix and full range (ITU-T H.273); None where it has none.

    Args:
        grade: it names the display.
    """
    codes = OpenImageIO.ColorConfig("ocio://default").get_cicp(grade.picture_space_id or "unknown")
    if not codes:
        return None
    primaries, transfer, matrix, full_range = codes
    return primaries, transfer, matrix, full_range


def to_8_bit(graded: FloatArray) -> NDArray[np.uint8]:
    """Display-referred values rounded to the nearest of 256 levels, halves up; no dither.

    Args:
        graded: any shape, 0 to 1; values outside are clipped.
    """
    levels: NDArray[np.uint8] = np.floor(np.clip(graded, 0, 1) * np.float32(255) + np.float32(0.5)).astype(np.uint8)
    return levels


def _picture(graded: FloatArray, metadata: FrameMetadata | None) -> tuple[OpenImageIO.ImageSpec, NDArray[np.uint8]]:
    """The 8-bit picture and its description."""
    if graded.ndim != 3 or graded.shape[2] != 3:
        raise SettingsError(f"a graded picture must be (height, width, 3), got {graded.shape}")
    height, width, _ = graded.shape
    spec = OpenImageIO.ImageSpec(width, height, 3, "uint8")
    if metadata is None:
        return spec, to_8_bit(graded)
    spec = describe(spec, metadata.exif_attributes())
    spec.attribute("Software", SOFTWARE)
    spec.attribute("ImageDescription", metadata.description)
    spec.attribute("oiio:ColorSpace", metadata.grade.picture_space_id)
    return spec, to_8_bit(graded)
