"""OpenEXR: rendered radiance and AOVs.

The first part, ``rgba``, has R, G, B and A as half floats: exposed radiance, times coverage, and coverage. It is in the working
space, or in the linear one that `FrameMetadata.color_space` names, and so is the albedo.
Each AOV is a part of its own name, in the order of `render.model.aovs`, which has their channels and types; a file with the
colour alone has a single part. The attribute ``pullfocus:primPaths`` of an AOV with ids of prims is a JSON object from the ids
in the picture to paths. A negative id, which means that nothing is there, is 4294967295. All parts carry the camera
(`FrameMetadata.exr_attributes`). Mattes are those of Cryptomatte 1.2; their attributes are in the first part too, where some
readers look for them.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np
import OpenImageIO
from numpy.typing import NDArray

from render.colour import from_working, interop_id
from render.errors import SettingsError
from render.film.develop import expose
from render.model.aovs import AOVS, Kind, find_aov
from render.model.arrays import FloatArray
from render.model.framing import Framing
from render.model.mattes import MATTES, id_bits
from render.output.image_file import Part, describe, file_bytes
from render.output.layout import PLAIN_LAYOUT, FileLayout
from render.output.metadata import Attribute, FrameMetadata

NO_ID = 0xFFFFFFFF
_PRIM_IDS = {"prim_id": 1, "primId": 0}
"""AOVs with ids of prims, and the id of the first prim."""


def encode_exr(
    color: FloatArray, aovs: Mapping[str, NDArray[Any]], metadata: FrameMetadata, layout: FileLayout = PLAIN_LAYOUT
) -> bytes:
    """Encode a frame as an EXR file (see the head of this module). Compression is lossless (zip).

    Args:
        color: ``(height, width, 4)`` scene-linear radiance, not exposed, times coverage; coverage in alpha. NaN
            becomes 0, and values beyond half-float range become the largest half float.
        aovs: measurements by name, each ``(height, width)`` or ``(height, width, channels)``; ``color``, if there, is left out.
        metadata: metadata of the file.
        layout: parts of the file, and its place in a larger picture: OpenEXR's data window in its display window.

    Raises:
        SettingsError: an AOV has no place in a file, or not the picture's size.
        OutputError: the encoder failed.
    """
    return file_bytes(".exr", _frame_parts(color, aovs, metadata, layout, is_first=True))


def encode_views(
    views: Sequence[tuple[FloatArray, Mapping[str, NDArray[Any]], FrameMetadata]], layout: FileLayout = PLAIN_LAYOUT
) -> bytes:
    """Encode the frames of several views as one EXR file: all parts of the first view, then those of the next.

    A part is called as in a file of its own, with a dot and its view's name behind, and has the standard attribute ``view``. The
    manifests of mattes have the names of all views, since some readers look for them in the first part alone.

    Args:
        views: colour, measurements and metadata of each as in `encode_exr`, all of one size.
        layout: parts of each view, and the place of each in a larger picture.

    Raises:
        SettingsError: an AOV has no place in a file, or not the picture's size.
        OutputError: the encoder failed.
    """
    names = {
        matte: tuple(dict.fromkeys(chain.from_iterable(each.matte_names.get(matte, ()) for _, _, each in views)))
        for matte in MATTES
    }
    parts: list[Part] = []
    for color, aovs, metadata in views:
        own = tuple(replace(part, name=f"{part.name}.{metadata.view}") for part in layout.parts_for(list(aovs)))
        named = replace(metadata, matte_names=names)
        parts += _frame_parts(color, aovs, named, replace(layout, parts=own), is_first=not parts)
    return file_bytes(".exr", parts)


def _frame_parts(
    color: FloatArray,
    aovs: Mapping[str, NDArray[Any]],
    metadata: FrameMetadata,
    layout: FileLayout,
    *,
    is_first: bool,
) -> list[Part]:
    """Parts of one frame; the first part of a file has attributes of later ones too."""
    _check_arrays(color, aovs)
    height, width = color.shape[:2]
    camera = metadata.exr_attributes(width, height, layout.framing)
    layout_parts = layout.parts_for(list(aovs))
    shared = primaries(metadata) if any(_is_colour(part.aov) for part in layout_parts) else []
    mattes = {name: _cryptomatte(name, metadata.matte_names.get(name, ())) for name in MATTES if name in aovs}
    parts: list[Part] = []
    for part in layout_parts:
        if part.aov == "color":
            own, pixels = _colour(color, metadata)
            channels, kind = tuple("RGBA"), _kind_of("half", part.kind)
        else:
            own, pixels, channels, kind = _measured(part.aov, aovs[part.aov], metadata)
            kind = _kind_of(kind, part.kind)
        if _is_colour(part.aov) or (is_first and not parts):  # OpenEXR wants in the first part what a later one has
            own = [*own, *shared]
        theirs = mattes.get(part.aov, []) if parts else list(chain.from_iterable(mattes.values()))
        channels = channels[: part.channels]
        spec = file_spec(part.name, (width, height), list(channels), kind, layout.framing)
        parts.append((describe(spec, [*camera, *theirs, *own]), np.ascontiguousarray(pixels[..., : len(channels)])))
    return parts


def _is_colour(aov: str) -> bool:
    """Whether an AOV, or ``color``, is in a colour space."""
    return aov == "color" or any(known.name == aov and known.is_color for known in AOVS)


def _colour(color: FloatArray, metadata: FrameMetadata) -> tuple[list[Attribute], FloatArray]:
    """Attributes of the colour, and its samples, exposed."""
    pixels = np.empty_like(color, np.float32)
    pixels[..., :3] = expose(color[..., :3], metadata.camera.exposure_scale)
    pixels[..., 3] = np.clip(np.nan_to_num(color[..., 3]), 0, 1)
    return colour_space_attributes(metadata), to_written_space(pixels, metadata)


def to_written_space(pixels: FloatArray, metadata: FrameMetadata) -> FloatArray:
    """Colours in the space that they are written in."""
    if not metadata.color_space:
        return pixels
    most = np.finfo(np.float16).max
    return np.clip(from_working(pixels, metadata.color_space), -most, most)


def _measured(
    name: str, measured: NDArray[Any], metadata: FrameMetadata
) -> tuple[list[Attribute], NDArray[Any], tuple[str, ...], Kind]:
    """Attributes of an AOV, its samples, their channels and their type."""
    pixels = measured.reshape(*measured.shape[:2], -1)
    aov = find_aov(name, pixels.shape[2])
    if aov.is_color:
        colours = to_written_space(pixels.astype(np.float32), metadata)
        return colour_space_attributes(metadata), colours, aov.channels, aov.kind
    own: list[Attribute] = [("colorInteropID", "string", "data")]
    if name in _PRIM_IDS:
        paths = _manifest(measured - _PRIM_IDS[name], metadata.prim_paths, _PRIM_IDS[name])
        own.append(("pullfocus:primPaths", "string", paths))
    return own, _ids(pixels) if aov.kind == "uint" else pixels.astype(np.float32), aov.channels, aov.kind


def _kind_of(kind: Kind, wanted: Kind | None) -> Kind:
    """Type of samples: as wanted, but for ids, which no floating-point number holds exactly, and for what is no id."""
    return kind if wanted is None or "uint" in (kind, wanted) else wanted


def colour_space_attributes(metadata: FrameMetadata) -> list[Attribute]:
    """Name of the working space, and of the space that is written, with its interop id as far as it is known."""
    own: list[Attribute] = [("pullfocus:workingSpace", "string", metadata.grade.working_space)]
    if space := metadata.color_space:
        own.append(("pullfocus:colorSpace", "string", space))
    if space_id := _space_id(metadata):
        own.append(("colorInteropID", "string", space_id))
    return own


def _space_id(metadata: FrameMetadata) -> str:
    """Colour interop id of the space that colours are written in; empty where it is not known."""
    return interop_id(metadata.color_space) if metadata.color_space else metadata.grade.working_space_id


def primaries(metadata: FrameMetadata) -> list[Attribute]:
    """Primaries of the space that colours are written in, as far as they are known."""
    space_id = _space_id(metadata)
    found = OpenImageIO.ColorConfig("ocio://default").get_chromaticities(space_id) if space_id else None
    return [("chromaticities", "float[8]", tuple(found))] if found else []


def file_spec(
    name: str, size: tuple[int, int], channels: list[str], kind: str, framing: Framing
) -> OpenImageIO.ImageSpec:
    """Specification of a part of a file, ``size`` being width and height, without its attributes."""
    spec = OpenImageIO.ImageSpec(*size, len(channels), kind)
    spec.channelnames = tuple(channels)
    spec.attribute("oiio:subimagename", name)
    spec.attribute("compression", "zip")
    # OpenImageIO fills in the time of day unless a date is given; the same frame must give the same bytes.
    spec.attribute("DateTime", "")
    spec.attribute("PixelAspectRatio", float(framing.pixel_aspect))
    if framing.window is not None:
        spec.x, spec.y = framing.window.left, framing.window.top
        spec.full_width, spec.full_height = framing.window.whole_width, framing.window.whole_height
    return spec


def _ids(ids: NDArray[Any]) -> NDArray[np.uint32]:
    """Ids with `NO_ID` in place of negative ones, which are empty."""
    return np.where(ids < 0, np.uint32(NO_ID), ids.astype(np.uint32))


def _manifest(indices: NDArray[Any], prim_paths: tuple[str, ...], first_id: int) -> str:
    """JSON object from id to prim path, for the prims that are in the picture; the first prim has ``first_id``."""
    present = [int(i) for i in np.unique(indices) if 0 <= i < len(prim_paths)]
    return json.dumps({str(i + first_id): prim_paths[i] for i in present}, ensure_ascii=False)


def _cryptomatte(matte: str, names: tuple[str, ...]) -> list[Attribute]:
    """Attributes of a matte, with the names whose ids it has (Cryptomatte Specification 1.2.0, "Metadata")."""
    key = f"cryptomatte/{id_bits(matte):08x}"[: len("cryptomatte/") + 7]
    manifest = json.dumps({name: f"{id_bits(name):08x}" for name in names}, ensure_ascii=False)
    values = {"name": matte, "hash": "MurmurHash3_32", "conversion": "uint32_to_float32", "manifest": manifest}
    return [(f"{key}/{name}", "string", value) for name, value in values.items()]


def _check_arrays(color: FloatArray, aovs: Mapping[str, NDArray[Any]]) -> None:
    """Raise `SettingsError` unless the arrays make a file."""
    if color.ndim != 3 or color.shape[2] != 4:
        raise SettingsError(f"a frame's colour must be (height, width, 4), got {color.shape}")
    for name, pixels in aovs.items():
        if name == "color":
            continue
        numbers = pixels.shape[2] if pixels.ndim == 3 else 1
        channels = len(find_aov(name, numbers).channels)
        if pixels.shape[:2] != color.shape[:2] or numbers != channels:
            expected = (*color.shape[:2], channels) if channels > 1 else color.shape[:2]
            raise SettingsError(f"AOV '{name}' must be {expected} like the picture, got {pixels.shape}")
