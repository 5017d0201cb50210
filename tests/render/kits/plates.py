"""Cameras with back plates, and what they show."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from pxr import Gf, Usd, UsdGeom

from render.frame import FrameRenderer
from render.model.arrays import DoubleArray, FloatArray
from render.model.frame_settings import FrameSettings
from render.optics.view import PinholeView
from render.stage import StageReader, read_camera
from tests.render.kits.stages import new_stage, only_batch, world_points

WIDTH, HEIGHT = 160, 90
FOCUS = 5.0


def write_image(path: Path, pixels: object) -> str:
    """Write an image of any number of channels; float32 values are linear."""
    values = np.asarray(pixels, np.float32)
    values = np.tile(values, (4, 4, 1)) if values.ndim == 1 else values
    out = oiio.ImageOutput.create(str(path))
    out.open(str(path), oiio.ImageSpec(values.shape[1], values.shape[0], values.shape[2], "float"))
    out.write_image(values)
    out.close()
    return str(path)


def plated(image: str = "", unit: float = 1.0, up: str = "Y", **tweaks: object) -> Usd.Stage:
    """A camera ``/cam`` at the origin that sees 36 by 20.25 mm through 50 mm, focused at 5 units, with a plate ``sky``."""
    stage = new_stage(unit, up)
    camera = UsdGeom.Camera.Define(stage, "/cam")
    tenths = 0.01 / unit  # of a unit, for a millimetre
    camera.CreateFocalLengthAttr(50 * tenths)
    camera.CreateHorizontalApertureAttr(36 * tenths)
    camera.CreateVerticalApertureAttr(20.25 * tenths)
    camera.CreateFocusDistanceAttr(FOCUS)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.01, 1e6))
    add_plate(stage, image, **tweaks)
    return stage


def add_plate(stage: Usd.Stage, image: str, camera: str = "/cam", name: str = "sky", **tweaks: object) -> None:
    """A plate; ``tweaks`` are its other properties, with ``_`` for ``:``."""
    plate = UsdGeom.BackPlateAPI.Apply(stage.GetPrimAtPath(camera), name)
    plate.CreateImageAttr(image)
    for key, value in tweaks.items():
        stage.GetPrimAtPath(camera).GetAttribute(f"backPlate:{name}:{key.replace('_', ':')}").Set(value)


def picture(
    renderer: FrameRenderer, stage: Usd.Stage, camera: str = "/cam", time: float = 0, **settings: object
) -> FloatArray:
    """Radiance and coverage."""
    chosen = {"engine": "pinhole", "rays": 1, "supersample": 1, "adaptive": False, **settings}
    view = read_camera(stage, camera, time, aspect=WIDTH / HEIGHT)
    return renderer.render(StageReader(stage).read(time), view, FrameSettings(WIDTH, HEIGHT, **chosen)).color


def corners_in_picture(stage: Usd.Stage) -> tuple[DoubleArray, DoubleArray]:
    """Places of a plate's corners in pixels, and their depths in metres."""
    view = PinholeView.from_camera(read_camera(stage, "/cam", 0), WIDTH, HEIGHT)
    places, depths = view.project(world_points(only_batch(StageReader(stage).read(0))))
    return np.asarray(places), np.asarray(depths)
