"""OpenEXR: rendered radiance and AOVs.

Parts, in this order; a file with the colour alone has a single part:

===========  ===========  ======  ==================================================================
part         channels     type    what it holds
===========  ===========  ======  ==================================================================
rgba         R, G, B, A   half    exposed radiance in the working space, times coverage; coverage
depth        Z            float   metres along the view axis; infinite where there is nothing
coc          radius       float   circle of confusion in pixels, negative in front of the focus
defocus      w            float   1/m, inverse depth less that in focus, negative behind it
focus_depth  Z            float   metres along the view axis at which the pixel is sharpest
albedo       R, G, B      half    base colours through the lens
prim_id      id           uint    index of the prim in the attribute ``pullfocus:primPaths``
face_id      id           uint    index of the authored face
===========  ===========  ======  ==================================================================

An id of 4294967295 means nothing is there. All parts carry the camera (`FrameMetadata.exr_attributes`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import OpenImageIO
from numpy.typing import NDArray

from render.errors import SettingsError
from render.film.develop import expose
from render.model.arrays import FloatArray
from render.output.image_file import Part, describe, file_bytes
from render.output.metadata import Attribute, FrameMetadata

NO_ID = 0xFFFFFFFF

# The channels and the type of each measurement, in the order of the file.
_AOV_CHANNELS = {
    "depth": (["Z"], "float"),
    "coc": (["radius"], "float"),
    "defocus": (["w"], "float"),
    "focus_depth": (["Z"], "float"),
    "albedo": (["R", "G", "B"], "half"),
    "prim_id": (["id"], "uint"),
    "face_id": (["id"], "uint"),
}


def encode_exr(color: FloatArray, aovs: Mapping[str, NDArray[Any]], metadata: FrameMetadata) -> bytes:
    """Encode a frame as an EXR file (see the head of this module). Compression is lossless (zip).

    Args:
        color: ``(height, width, 4)`` scene-linear radiance, not exposed, times coverage; coverage in alpha. NaN
            becomes 0, and values beyond half-float range become the largest half float.
        aovs: measurements by name, each ``(height, width)``; ``color``, if there, is left out.
        metadata: metadata of the file.

    Raises:
        SettingsError: an AOV has no place in a file, or not the picture's size.
        OutputError: the encoder failed.
    """
    _check_arrays(color, aovs)
    height, width = color.shape[:2]
    camera = metadata.exr_attributes(width, height)
    parts = [_colour_part(color, camera, metadata)]
    for name, (channels, kind) in _AOV_CHANNELS.items():
        if name in aovs:
            own: list[Attribute] = [("colorInteropID", "string", "data")]
            if name == "prim_id":
                own.append(("pullfocus:primPaths", "string", _manifest(aovs[name], metadata.prim_paths)))
            pixels = _ids(aovs[name]) if kind == "uint" else aovs[name].astype(np.float32)
            spec = describe(_spec(name, (width, height), channels, kind), [*camera, *own])
            parts.append((spec, pixels.reshape(height, width, len(channels))))
    return file_bytes(".exr", parts)


def _colour_part(color: FloatArray, camera: list[Attribute], metadata: FrameMetadata) -> Part:
    pixels = np.empty_like(color, np.float32)
    pixels[..., :3] = expose(color[..., :3], metadata.camera.exposure_scale)
    pixels[..., 3] = np.clip(np.nan_to_num(color[..., 3]), 0, 1)
    height, width = color.shape[:2]
    own = _colour_space_attributes(metadata)
    return describe(_spec("rgba", (width, height), list("RGBA"), "half"), [*camera, *own]), pixels


def _colour_space_attributes(metadata: FrameMetadata) -> list[Attribute]:
    """Name, interop id and primaries of the working space, as far as they are known."""
    own: list[Attribute] = [("pullfocus:workingSpace", "string", metadata.grade.working_space)]
    if space_id := metadata.grade.working_space_id:
        own.append(("colorInteropID", "string", space_id))
        if primaries := OpenImageIO.ColorConfig("ocio://default").get_chromaticities(space_id):
            own.append(("chromaticities", "float[8]", tuple(primaries)))
    return own


def _spec(name: str, size: tuple[int, int], channels: list[str], kind: str) -> OpenImageIO.ImageSpec:
    spec = OpenImageIO.ImageSpec(*size, len(channels), kind)
    spec.channelnames = tuple(channels)
    spec.attribute("oiio:subimagename", name)
    spec.attribute("compression", "zip")
    # OpenImageIO fills in the time of day unless a date is given; the same frame must give the same bytes.
    spec.attribute("DateTime", "")
    return spec


def _ids(ids: NDArray[Any]) -> NDArray[np.uint32]:
    """Ids with `NO_ID` in place of negative ones, which are empty."""
    return np.where(ids < 0, NO_ID, ids).astype(np.uint32)


def _manifest(ids: NDArray[Any], prim_paths: tuple[str, ...]) -> str:
    """JSON object from id to prim path, for the prims that are in the picture."""
    present = [int(i) for i in np.unique(ids) if 0 <= i < len(prim_paths)]
    return json.dumps({str(i): prim_paths[i] for i in present}, ensure_ascii=False)


def _check_arrays(color: FloatArray, aovs: Mapping[str, NDArray[Any]]) -> None:
    """Raise `SettingsError` unless the arrays make a file."""
    if color.ndim != 3 or color.shape[2] != 4:
        raise SettingsError(f"a frame's colour must be (height, width, 4), got {color.shape}")
    for name, pixels in aovs.items():
        if name != "color" and name not in _AOV_CHANNELS:
            raise SettingsError(f"unknown AOV '{name}': expected one of color, {', '.join(_AOV_CHANNELS)}")
        expected = (*color.shape[:2], 3) if name == "albedo" else color.shape[:2]
        if name != "color" and pixels.shape != expected:
            raise SettingsError(f"AOV '{name}' must be {expected} like the picture, got {pixels.shape}")
