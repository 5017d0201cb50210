"""Back plates of cameras (UsdGeomBackPlateAPI) as surfaces that show a picture as radiance, whatever the lights."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from render.model.arrays import DoubleArray
from render.model.scene import Batch, CameraRole, Geometry
from render.stage.assembly.poses import world_pose
from render.stage.camera.plate_images import Pictures, Plate, PlateImages
from render.stage.camera.plate_places import CORNERS, PlateError, plate_names, read_plate_place
from render.stage.camera.plate_relief import DepthImages, make_relief
from render.stage.findings import FindingLog
from render.stage.geometry.distances import is_placeable
from render.stage.limits import PlaceError
from render.stage.materials.textures import TextureCache
from render.stage.values import format_value
from render.stage.world import rigid_frame

_MAX_SIDE = 4096  # a plate fills the picture
_MOST_IMAGES = 8  # kept; a sequence has one for each frame
_VISIBILITIES = ("solo", "all", "mute")
_SQUARE = (
    CORNERS.astype(np.float32),
    (CORNERS[:, :2] + 0.5).astype(np.float32),
    np.array([[0, 1, 2], [0, 2, 3]], np.int32),
)
"""Positions, texture coordinates and triangles of a flat plate."""


@dataclass(frozen=True, eq=False)
class _Drawn:
    """Last state of a plate that was drawn.

    Attributes:
        square: its flat surface.
        depths: ``(h, w)`` depths of its relief, and the plate's place; None where it is flat.
        pictures: its images.
        batch: the draw.
    """

    square: Geometry
    depths: tuple[DoubleArray, DoubleArray] | None
    pictures: Pictures
    batch: Batch


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
        self._images = TextureCache(_MAX_SIDE, confined_to, log, most=_MOST_IMAGES)
        self._depths = DepthImages(confined_to)
        self._drawn: dict[tuple[Sdf.Path, str], _Drawn] = {}

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
            seen_by = str(plate.prim.GetPath()) if visibility == "solo" else None
            from_camera = frame @ np.diag([scale, scale, scale, 1.0])
            now = self._update(plate, from_camera, place, prim_id(str(plate.prim.GetPath())), time)
            batch = now.batch if now.batch.seen_by == seen_by else replace(now.batch, seen_by=seen_by)
            self._drawn[plate.key] = now if batch is now.batch else replace(now, batch=batch)
            if is_placeable(batch.geometry.positions, batch.poses[0], plate.at, self._log):
                drawn.append(batch)
        return drawn

    def _plates(self) -> Iterator[Plate]:
        for prim in self._cameras.values():
            for number, name in enumerate(plate_names(prim)):
                yield Plate(prim, name, number)

    def _note(self, plate: Plate, reason: str) -> None:
        self._log.add("bad_back_plate", plate.at, f"{plate.words} is not drawn: {reason}")

    def _visibility(self, plate: Plate, time: Usd.TimeCode) -> str:
        attribute = plate.schema.GetPlateVisibilityAttr()
        value = attribute.Get(time)
        if value in _VISIBILITIES:
            return str(value)
        expected = f"{attribute.GetName()} of {plate.prim.GetPath()} must be one of {', '.join(_VISIBILITIES)}"
        self._log.add("bad_back_plate", attribute.GetPath(), f"{expected}, got {format_value(value)}: solo is used")
        return "solo"

    def _update(
        self, plate: Plate, from_camera: DoubleArray, place: DoubleArray, prim_id: int, time: Usd.TimeCode
    ) -> _Drawn:
        """Images, surface and place of a plate at a time, the same objects where nothing changes.

        Args:
            plate: the plate.
            from_camera: ``(4, 4)`` world from camera space in scene units.
            place: ``(4, 4)`` camera space from the plate's own.
            prim_id: number of its camera.
            time: USD time code.
        """
        images = PlateImages(self._images, plate, time, self._log)
        pictures, depths, known = images.pictures(), images.depths(self._depths), self._drawn.get(plate.key)
        square = plate.surface(prim_id, *_SQUARE) if known is None else known.square
        relief = None if depths is None else (depths, place)
        if relief is None:
            geometry = square
        elif known is None or not _same_relief(known.depths, relief):
            geometry = plate.surface(prim_id, *make_relief(*relief))
        else:
            geometry = known.batch.geometry
        pose = from_camera if relief is not None else from_camera @ place
        if known is None:
            material, role = pictures.material(plate.at), self._roles[plate.prim]
            batch = Batch(geometry, material, pose[None], culls_backs=self._culls_backs, camera_role=role)
            return _Drawn(square, relief, pictures, batch)
        batch = known.batch
        if known.pictures != pictures:
            batch = replace(batch, material=pictures.material(plate.at))
        if batch.geometry is not geometry or not np.array_equal(batch.poses[0], pose):
            batch = replace(batch, geometry=geometry, poses=pose[None])
        return _Drawn(square, relief, pictures, batch)


def _same_relief(one: tuple[DoubleArray, DoubleArray] | None, other: tuple[DoubleArray, DoubleArray]) -> bool:
    return one is not None and all(map(partial(np.array_equal, equal_nan=True), one, other))
