"""Images of back plates (UsdGeomBackPlateAPI): colour, opacity and depth.

As in usdview, a picture's own alpha is the plate's opacity where ``alpha:image`` names no other. The image's numbers are made
linear, then graded (`luma`), then brought into the working space.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from render.errors import InputError
from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.scene import Geometry, Image, Material, TextureLookup
from render.stage.camera.plate_places import PlateError, read_numbers
from render.stage.camera.plate_relief import DepthImages, compute_depths
from render.stage.findings import FindingLog
from render.stage.materials.image_files import TextureError
from render.stage.materials.textures import TextureCache
from render.stage.values import format_value

_OPAQUE = 0.999


@dataclass(frozen=True)
class Pictures:
    """Images of a plate.

    Attributes:
        color: its colour; None for black.
        opacity: image of its opacity; None for opaque.
        channel: channel of that image.
    """

    color: Image | None
    opacity: Image | None
    channel: int = 3

    def material(self, name: str) -> Material:
        """Material that shows them, whatever the lights."""
        lookups = {} if self.color is None else {"emissive": _lookup(self.color)}
        if self.opacity is not None and float(self.opacity.pixels[..., self.channel].min(initial=1.0)) < _OPAQUE:
            lookups["opacity"] = _lookup(self.opacity, self.channel)
        return Material(name, (0.0, 0.0, 0.0), unlit=True, lookups=lookups)


@dataclass(frozen=True, eq=False)
class Plate:
    """One back plate.

    Attributes:
        prim: its camera.
        name: its name.
        number: number among the camera's plates, which picking gives for its face.
    """

    prim: Usd.Prim
    name: str
    number: int

    @property
    def schema(self) -> UsdGeom.BackPlateAPI:
        """The plate as USD has it."""
        return UsdGeom.BackPlateAPI(self.prim, self.name)

    @property
    def at(self) -> str:
        """Path of the plate for findings."""
        return f"{self.prim.GetPath()}.backPlate:{self.name}"

    @property
    def words(self) -> str:
        """Words for messages."""
        return f"back plate {self.name} of {self.prim.GetPath()}"

    @property
    def key(self) -> tuple[Sdf.Path, str]:
        """Key of the plate on its stage."""
        return self.prim.GetPath(), self.name

    def surface(self, prim_id: int, positions: FloatArray, uvs: FloatArray, triangles: IntArray) -> Geometry:
        """Its surface, which is picked as the camera."""
        count = len(triangles)
        return Geometry(
            positions=positions,
            normals=np.tile(np.array([0, 0, 1], np.float32), (len(positions), 1)),
            triangles=triangles,
            prim_ids=np.full(count, prim_id, np.int32),
            face_ids=np.full(count, self.number, np.int32),
            fan_ids=np.arange(count, dtype=np.int32),
            uvs=uvs,
        )


class PlateImages:
    """Images of one plate at a time."""

    def __init__(self, cache: TextureCache, plate: Plate, time: Usd.TimeCode, log: FindingLog) -> None:
        self._cache, self._plate, self._time, self._log = cache, plate, time, log

    def pictures(self) -> Pictures:
        """The plate's colour and its opacity."""
        schema = self._plate.schema
        color = self._image(schema.GetImageAttr(), "it is black", self._grade())
        named = self._asset(schema.GetAlphaImageAttr(), "the alpha of its image is used")
        if named is None or not named.path:
            return Pictures(color, color)
        alpha = self._image(schema.GetAlphaImageAttr(), "it is opaque", ())
        return Pictures(color, alpha, 0 if alpha is not None and alpha.channels == 1 else 3)

    def depths(self, images: DepthImages) -> DoubleArray | None:
        """Depths ``(h, w)`` of the plate's places, scene units; None where it is flat."""
        schema = self._plate.schema
        asset = self._asset(schema.GetDepthImageAttr(), "it is flat")
        if asset is None or not asset.path:
            return None
        at = schema.GetDepthImageAttr().GetPath()
        if UsdGeom.Camera(self._plate.prim).GetProjectionAttr().Get(self._time) == UsdGeom.Tokens.orthographic:
            message = f"{asset.path} of {self._plate.words} is not used, since the camera is orthographic: it is flat"
            self._log.add("bad_back_plate", at, message)
            return None
        try:
            return compute_depths(schema, images.texels(str(asset.resolvedPath)), self._time)
        except TextureError as problem:
            self._log.add("texture_unreadable", at, f"{asset.path} of {self._plate.words} {problem}: it is flat")
        except PlateError as problem:
            self._log.add("bad_back_plate", at, f"{self._plate.words}: {problem}; it is flat")
        return None

    def _image(self, attribute: Usd.Attribute, instead: str, grade: tuple[tuple[float, ...], ...]) -> Image | None:
        """Image of an attribute: graded colour, or numbers as they are where there is no grade."""
        asset, at = self._asset(attribute, instead), attribute.GetPath()
        if asset is None:
            return None
        if not asset.path:
            self._log.add("texture_missing", at, f"{self._plate.words} names no image: {instead}")
            return None
        space, purpose = (attribute.GetColorSpace() or "auto", "color") if grade else ("raw", "data")
        try:
            return self._cache.image(str(asset.resolvedPath), space, purpose, *grade)
        except (TextureError, InputError) as problem:
            self._log.add("texture_unreadable", at, f"{asset.path} of {self._plate.words} {problem}: {instead}")
            return None

    def _asset(self, attribute: Usd.Attribute, instead: str) -> Sdf.AssetPath | None:
        """File that an attribute names, without a path where it names none; None, with a finding, for a value of another type."""
        value = attribute.Get(self._time)
        if value is None or isinstance(value, Sdf.AssetPath):
            return value or Sdf.AssetPath()
        message = f"{attribute.GetName()} must be an asset, got {format_value(value)}: {instead}"
        self._log.add("bad_back_plate", attribute.GetPath(), f"{self._plate.words}: {message}")
        return None

    def _grade(self) -> tuple[tuple[float, ...], ...]:
        """Slope, offset and power of the image's linear numbers, each ``rgba``."""
        schema = self._plate.schema
        slope = self._numbers(schema.GetLumaSlopeAttr(), 1.0)
        offset = self._numbers(schema.GetLumaOffsetAttr(), 0.0)
        power = self._numbers(schema.GetLumaPowerAttr(), 1.0)
        if min(power) <= 0:
            attribute = schema.GetLumaPowerAttr()
            message = f"{attribute.GetName()} of {self._plate.prim.GetPath()} must be more than 0: 1 is used"
            self._log.add("bad_back_plate", attribute.GetPath(), message)
            power = (1.0, 1.0, 1.0)
        return (*slope, 1.0), (*offset, 0.0), (*power, 1.0)

    def _numbers(self, attribute: Usd.Attribute, fallback: float) -> tuple[float, ...]:
        try:
            return tuple(read_numbers(attribute, self._time, 3).tolist())
        except PlateError as problem:
            self._log.add(
                "bad_back_plate", attribute.GetPath(), f"{self._plate.words}: {problem}; {fallback:g} is used"
            )
            return (fallback,) * 3


def _lookup(image: Image, channel: int = -1) -> TextureLookup:
    return TextureLookup(image, wrap_s="clamp", wrap_t="clamp", channel=channel)
