"""Deep OpenEXR: samples in depth for each pixel (`render.model.deep`).

One part for each view, with the channels R, G, B, A and Z of single precision: exposed radiance times alpha, alpha, and the
distance along the view axis in the stage's units. Samples are points, near to far, so that compositing each over the next gives
the flat picture. A last one with alpha 0 is the background's, at the camera's far clipping plane.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import OpenImageIO

from render.film.develop import expose
from render.model.arrays import FloatArray, LongArray
from render.model.deep import DeepSamples
from render.output.exr import colour_space_attributes, file_spec, primaries, to_written_space
from render.output.image_file import Part, describe, file_bytes
from render.output.layout import COLOR_PART, FileLayout
from render.output.metadata import FrameMetadata

CHANNELS = ("R", "G", "B", "A", "Z")


def encode_deep_exr(views: Sequence[tuple[DeepSamples, FrameMetadata]], layout: FileLayout) -> bytes:
    """Encode samples as a deep EXR file. Compression is lossless (zips).

    Args:
        views: samples and metadata of the picture, or of each of several views; those have their names behind the part's.
        layout: name of the part, and the picture's place in a larger one.

    Raises:
        OutputError: the encoder failed.
    """
    name = layout.parts[0].name if layout.parts else COLOR_PART
    several = len(views) > 1
    return file_bytes(
        ".exr",
        [_part(f"{name}.{metadata.view}" if several else name, deep, metadata, layout) for deep, metadata in views],
    )


def _part(name: str, deep: DeepSamples, metadata: FrameMetadata, layout: FileLayout) -> Part:
    height, width = deep.size
    spec = file_spec(name, (width, height), list(CHANNELS), "float", layout.framing)
    spec.deep = True
    spec.attribute("compression", "zips")
    camera = metadata.exr_attributes(width, height, layout.framing)
    spec = describe(spec, [*camera, *colour_space_attributes(metadata), *primaries(metadata)])
    return spec, _deep_data(deep.pixels, _written(deep, metadata), width * height)


def _written(deep: DeepSamples, metadata: FrameMetadata) -> FloatArray:
    """``(n, 5)`` numbers of the samples as they are written."""
    camera = metadata.camera
    depths_m = np.where(np.isfinite(deep.depths_m), deep.depths_m, camera.far_m) - camera.set_back_m
    light = np.empty((len(deep.light), 4), np.float32)
    light[:, :3] = expose(deep.light[:, :3], camera.exposure_scale)
    light[:, 3] = deep.light[:, 3]
    depths = (depths_m / metadata.metres_per_unit).astype(np.float32)
    return np.column_stack([to_written_space(light, metadata), depths])


def _deep_data(pixels: LongArray, values: FloatArray, count: int) -> OpenImageIO.DeepData:
    """Deep pixels of OpenImageIO, whose Python takes one number at a time: some four million a second."""
    data = OpenImageIO.DeepData()
    data.init(count, len(CHANNELS), ("float",) * len(CHANNELS), CHANNELS)
    for pixel, samples in enumerate(np.bincount(pixels, minlength=count).tolist()):
        if samples:
            data.set_samples(pixel, samples)
    before, sample, put = -1, 0, data.set_deep_value
    for pixel, numbers in zip(pixels.tolist(), values.tolist(), strict=True):
        sample = sample + 1 if pixel == before else 0
        before = pixel
        for channel, number in enumerate(numbers):
            put(pixel, channel, sample, number)
    return data
