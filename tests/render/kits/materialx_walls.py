"""A wall that wears a material by MaterialX, and its picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade

from render import colour
from render.frame import FrameRenderer
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.scene import Material
from render.stage import StageReader
from tests.render.kits.stages import add_material, add_mesh, bind, set_primvar

CORNERS = ((-2, -2, -4), (2, -2, -4), (2, 2, -4), (-2, 2, -4))
CAMERA = Camera(np.eye(4), 36, 36, 36)
"""Camera whose picture the wall fills."""


def glowing(nodes: str, link: str) -> str:
    """Document whose material glows in what a node gives.

    Args:
        nodes: elements of its graph.
        link: attributes of the emission's input.
    """
    surface = f'<surface_unlit name="S" type="surfaceshader"><input name="emission_color" type="color3" {link}/></surface_unlit>'
    return document(surface, nodes)


def document(surface: str, nodes: str = "", version: str = "1.39") -> str:
    """Document with one material, of a surface S."""
    material = '<surfacematerial name="M" type="material"><input name="surfaceshader" nodename="S"/></surfacematerial>'
    return f'<materialx version="{version}" colorspace="lin_rec709">{nodes}{surface}{material}</materialx>'


def wall(folder: Path, text: str, *, metres_per_unit: float = 1.0, up: str = "Y") -> Usd.Stage:
    """Stage with a wall ``/wall``, that fills the picture, in the material of a document."""
    (folder / "m.mtlx").write_text(text)
    layer = Sdf.Layer.CreateNew(str(folder / "shot.usda"))
    stage = Usd.Stage.Open(layer)
    UsdGeom.SetStageMetersPerUnit(stage, metres_per_unit)
    UsdGeom.SetStageUpAxis(stage, up)
    points = np.array(CORNERS, float) / metres_per_unit
    mesh = add_mesh(
        stage, "/wall", points if up == "Y" else np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)
    )
    set_primvar(mesh.GetPrim(), "st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex", [(0, 0), (1, 0), (1, 1), (0, 1)])
    stage.DefinePrim("/Looks").GetReferences().AddReference("./m.mtlx", "/MaterialX")
    binding = UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim())
    binding.GetPrim().CreateRelationship("material:binding").SetTargets(["/Looks/Materials/M"])
    return stage


def material_of(reader: StageReader, time: float = 0.0) -> Material:
    """Material of the only batch."""
    return reader.read(time).batches[0].material


def picture(
    renderer: FrameRenderer, stage: Usd.Stage, side_px: int = 16, time: float = 0.0, shading: str = "lit"
) -> FloatArray:
    """``(side_px, side_px, 4)`` light of the wall, linear Rec. 709, and coverage."""
    settings = FrameSettings(side_px, side_px, rays=1, supersample=1, engine="pinhole", shading=shading)
    frame = renderer.render(StageReader(stage).read(time), CAMERA, settings)
    return colour.from_working(frame.color, "lin_rec709")


def add_light(stage: Usd.Stage) -> None:
    """Sun and sky."""
    sun = UsdLux.DistantLight.Define(stage, "/sun")
    sun.CreateIntensityAttr(3.0)
    UsdGeom.Xformable(sun).AddRotateXYZOp().Set((-10.0, 5.0, 0.0))
    UsdLux.DomeLight.Define(stage, "/sky").CreateIntensityAttr(0.5)


def add_lamp(stage: Usd.Stage) -> None:
    """Wall of radiance 2 behind all else."""
    look = {"diffuseColor": Gf.Vec3f(0, 0, 0), "emissiveColor": Gf.Vec3f(2, 2, 2), "ior": 1.0, "roughness": 1.0}
    add_material(stage, "/lamp", **look)
    lamp = UsdGeom.Mesh.Define(stage, "/lamp_wall")
    lamp.CreatePointsAttr([(-9, -9, -6), (9, -9, -6), (9, 9, -6), (-9, 9, -6)])
    lamp.CreateFaceVertexCountsAttr([4])
    lamp.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    bind(lamp.GetPrim(), "/lamp")
