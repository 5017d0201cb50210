"""List of the back plates of a stage's cameras, for inspection."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from render.stage.camera.plate_places import PlateError, plate_names, read_plate_place
from render.stage.opening import read_quietly
from usd_schemas.units import metres_from_units


@dataclass(frozen=True)
class BackPlate:
    """A back plate of a camera.

    Attributes:
        camera: prim path.
        name: name of the plate.
        image: file as it is authored, or an empty string.
        visibility: ``solo``, ``all`` or ``mute``, as it is authored.
        depth_m: depth of its centre in front of the camera; None where it cannot be placed.
    """

    camera: str
    name: str
    image: str
    visibility: str
    depth_m: float | None


def list_plates(stage: Usd.Stage, cameras: Sequence[str], time: float) -> list[BackPlate]:
    """Back plates at a time.

    Args:
        stage: the stage.
        cameras: prim paths of its cameras.
        time: USD time code.
    """
    with read_quietly(stage):
        prims = [stage.GetPrimAtPath(path) for path in cameras]
        return [_read(prim, name, Usd.TimeCode(time)) for prim in prims for name in plate_names(prim)]


def _read(prim: Usd.Prim, name: str, time: Usd.TimeCode) -> BackPlate:
    plate = UsdGeom.BackPlateAPI(prim, name)
    image, visibility = plate.GetImageAttr().Get(time), plate.GetPlateVisibilityAttr().Get(time)
    try:
        depth = -float(read_plate_place(UsdGeom.Camera(prim), name, time)[2, 3])
    except PlateError:
        depth = np.nan
    depth_m = metres_from_units(depth, prim.GetStage()) if np.isfinite(depth) else None
    return BackPlate(str(prim.GetPath()), name, str(getattr(image, "path", "")), str(visibility), depth_m)
