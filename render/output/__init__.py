"""Frames as files: EXR for scene-linear light and its measurements, PNG and JPEG for the graded picture."""

from render.output.encode import FrameArrays, encode
from render.output.formats import Format, format_of
from render.output.metadata import FrameMetadata
from render.output.write import write_frame, write_views

__all__ = ["Format", "FrameArrays", "FrameMetadata", "encode", "format_of", "write_frame", "write_views"]
