"""Stages of each kind of geometry, material and light, for the page of all kinds and its tests."""

from __future__ import annotations

from pathlib import Path

from pxr import Usd, UsdGeom, UsdLux

from tests.render.kits.kinds.geometry import GEOMETRY
from tests.render.kits.kinds.lights import LIGHTS
from tests.render.kits.kinds.materials import MATERIALS
from tests.render.kits.kinds.parts import Author
from tests.render.kits.stages import add_mesh

__all__ = ["GEOMETRY", "LIGHTS", "MATERIALS", "Author", "kind_stage"]


def kind_stage(file: Path, author: Author, *, booth: bool = False) -> Usd.Stage:
    """Stage with one kind ``/world/kind``, and a camera ``/camera`` that sees it.

    Args:
        file: layer to write; textures come beside it.
        author: authors the kind.
        booth: whether it brings a light of its own; else a sky and a sun light it, on a floor.
    """
    stage = Usd.Stage.CreateNew(str(file))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, "Y")
    UsdGeom.Xform.Define(stage, "/world")
    author(stage, "/world/kind", file.parent)
    camera = UsdGeom.Camera.Define(stage, "/camera")
    camera.CreateFocalLengthAttr(0.5)  # tenths of a metre
    camera.CreateHorizontalApertureAttr(0.36)
    camera.CreateVerticalApertureAttr(0.27)
    camera.CreateFStopAttr(1.4)
    camera.CreateFocusDistanceAttr(4.9)
    camera.CreateClippingRangeAttr((0.1, 100))
    camera.AddTranslateOp().Set((0, 2.2, 5.0))
    camera.AddRotateXYZOp().Set((-16, 0, 0))
    if not booth:
        floor = add_mesh(stage, "/floor", [(-20, 0, 10), (20, 0, 10), (20, 0, -20), (-20, 0, -20)])
        floor.CreateDisplayColorAttr([(0.35, 0.35, 0.37)])
        UsdLux.DomeLight.Define(stage, "/sky").CreateIntensityAttr(0.5)
        sun = UsdLux.DistantLight.Define(stage, "/sun")
        sun.CreateIntensityAttr(2.0)
        sun.CreateNormalizeAttr(True)
        sun.CreateAngleAttr(4.0)
        UsdGeom.Xformable(sun).AddRotateXYZOp().Set((-50, -30, 0))
    stage.Save()
    return stage
