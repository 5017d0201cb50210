"""Back plates of cameras (UsdGeomBackPlateAPI) as quads that show a picture as radiance, whatever the lights.

As in usdview, a picture's own alpha is the plate's opacity where ``alpha:image`` names no other. The image's numbers are made
linear, then graded (`luma`), then brought into the working space.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.scene import Batch, CameraRole, Geometry, Image, Material, TextureLookup
from render.stage.assembly.poses import world_pose
from render.stage.camera.plate_places import CORNERS, PlateError, plate_names, read_numbers, read_plate_place
from render.stage.findings import FindingLog
from render.stage.geometry.distances import is_placeable
from render.stage.limits import PlaceError
from render.stage.materials.textures import TextureCache, TextureError
from render.stage.values import format_value
from render.stage.world import rigid_frame

_MAX_SIDE = 4096  # a plate fills the picture
_MOST_IMAGES = 8  # kept; a sequence has one for each frame
_OPAQUE = 0.999
_VISIBILITIES = ("solo", "all", "mute")


@dataclass(frozen=True)
class _Pictures:
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
class _Plate:
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

    def blank(self, prim_id: Callable[[str], int], culls_backs: bool, role: CameraRole) -> Batch:
        """Its square at the origin, without an image; it is picked as the camera."""
        geometry = Geometry(
            positions=CORNERS.astype(np.float32),
            normals=np.tile(np.array([0, 0, 1], np.float32), (4, 1)),
            triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
            prim_ids=np.full(2, prim_id(str(self.prim.GetPath())), np.int32),
            face_ids=np.full(2, self.number, np.int32),
            fan_ids=np.arange(2, dtype=np.int32),
            uvs=(CORNERS[:, :2] + 0.5).astype(np.float32),
        )
        return Batch(geometry, Material(unlit=True), np.eye(4)[None], culls_backs=culls_backs, camera_role=role)


class PlateReader:
    """Reads the back plates of cameras at a time; plates that stay the same are the same objects.

    Args:
        cameras: camera prims, each with what cameras make of its plates.
        confined_to: folder that every image must lie in, or None.
        culls_backs: whether plates are left out where they face away.
        log: receives plates that cannot be drawn.
    """

    def __init__(
        self,
        cameras: Mapping[Usd.Prim, CameraRole],
        confined_to: Path | None,
        culls_backs: bool,
        log: FindingLog,
    ) -> None:
        self._cameras, self._roles = {prim.GetPath(): prim for prim in cameras}, cameras
        self._culls_backs, self._log = culls_backs, log
        self._images = TextureCache(_MAX_SIDE, confined_to, most=_MOST_IMAGES)
        self._drawn: dict[tuple[Sdf.Path, str], tuple[_Pictures, Batch]] = {}

    def is_camera(self, path: Sdf.Path) -> bool:
        """Whether a path is one of the cameras'."""
        return path in self._cameras

    def batches(
        self, transforms: UsdGeom.XformCache, world: DoubleArray, scale: float, prim_id: Callable[[str], int]
    ) -> list[Batch]:
        """The plates at a time.

        Args:
            transforms: transforms at that time.
            world: ``(4, 4)`` world from stage.
            scale: metres in a stage unit.
            prim_id: number of a prim path in ``Scene.prim_paths``.
        """
        drawn, time = [], transforms.GetTime()
        for plate in self._plates():
            visibility = self._visibility(plate, time)
            if visibility == "mute":
                continue
            try:
                frame = rigid_frame(world_pose(plate.prim, transforms, world))
                place = read_plate_place(UsdGeom.Camera(plate.prim), plate.name, time)
            except PlateError as problem:
                self._note(plate, str(problem))
                continue
            except PlaceError as problem:
                self._note(plate, problem.detail)
                continue
            pose = frame @ np.diag([scale, scale, scale, 1.0]) @ place
            if is_placeable(CORNERS.astype(np.float32), pose, plate.at, self._log) and np.linalg.det(pose) != 0:
                seen_by = str(plate.prim.GetPath()) if visibility == "solo" else None
                known = self._drawn.get(plate.key)
                first = plate.blank(prim_id, self._culls_backs, self._roles[plate.prim]) if known is None else known[1]
                drawn.append(self._update(plate, first, pose, seen_by, time))
        return drawn

    def _plates(self) -> Iterator[_Plate]:
        for prim in self._cameras.values():
            for number, name in enumerate(plate_names(prim)):
                yield _Plate(prim, name, number)

    def _note(self, plate: _Plate, reason: str) -> None:
        self._log.add("bad_back_plate", plate.at, f"{plate.words} is not drawn: {reason}")

    def _visibility(self, plate: _Plate, time: Usd.TimeCode) -> str:
        attribute = plate.schema.GetPlateVisibilityAttr()
        value = attribute.Get(time)
        if value in _VISIBILITIES:
            return str(value)
        expected = f"{attribute.GetName()} of {plate.prim.GetPath()} must be one of {', '.join(_VISIBILITIES)}"
        self._log.add("bad_back_plate", attribute.GetPath(), f"{expected}, got {format_value(value)}: solo is used")
        return "solo"

    def _update(self, plate: _Plate, batch: Batch, pose: DoubleArray, seen_by: str | None, time: Usd.TimeCode) -> Batch:
        """Give a batch its images, place and visibility at a time; the same object where nothing changes."""
        pictures = _PlateImages(self._images, plate, time, self._log).pictures()
        known = self._drawn.get(plate.key)
        if known is None or known[0] != pictures:
            batch = replace(batch, material=pictures.material(plate.at))
        if batch.seen_by != seen_by or not np.array_equal(batch.poses[0], pose):
            batch = replace(batch, poses=pose[None], seen_by=seen_by)
        self._drawn[plate.key] = pictures, batch
        return batch


class _PlateImages:
    """Images of one plate at a time."""

    def __init__(self, cache: TextureCache, plate: _Plate, time: Usd.TimeCode, log: FindingLog) -> None:
        self._cache, self._plate, self._time, self._log = cache, plate, time, log

    def pictures(self) -> _Pictures:
        """The plate's colour and its opacity."""
        schema = self._plate.schema
        color = self._image(schema.GetImageAttr(), "it is black", self._grade())
        if not getattr(schema.GetAlphaImageAttr().Get(self._time), "path", ""):
            return _Pictures(color, color)
        alpha = self._image(schema.GetAlphaImageAttr(), "it is opaque", ())
        return _Pictures(color, alpha, 0 if alpha is not None and alpha.channels == 1 else 3)

    def _image(self, attribute: Usd.Attribute, instead: str, grade: tuple[tuple[float, ...], ...]) -> Image | None:
        """Image of an attribute: graded colour, or numbers as they are where there is no grade."""
        asset, at = attribute.Get(self._time), attribute.GetPath()
        if not isinstance(asset, Sdf.AssetPath) or not asset.path:
            self._log.add("texture_missing", at, f"{self._plate.words} names no image: {instead}")
            return None
        space, purpose = (attribute.GetColorSpace() or "auto", "color") if grade else ("raw", "data")
        try:
            return self._cache.image(str(asset.resolvedPath), space, purpose, *grade)
        except (TextureError, InputError) as problem:
            self._log.add("texture_unreadable", at, f"{asset.path} of {self._plate.words} {problem}: {instead}")
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
