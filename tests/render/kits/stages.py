"""Small stages, made in memory, for the tests of the stage reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from numpy.typing import NDArray
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, Vt

from render.model.scene import Batch, Scene
from render.stage import StageReader
from render.stage.options import StageOptions

ASSETS = Path(__file__).parents[3].parent / "shared" / "assets"
needs_assets = pytest.mark.skipif(not ASSETS.is_dir(), reason="the shared assets are not here")

T = Sdf.ValueTypeNames

QUAD_POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]


def new_stage(metres_per_unit: float = 1.0, up: str = "Y") -> Usd.Stage:
    """An empty stage in memory."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, metres_per_unit)
    UsdGeom.SetStageUpAxis(stage, up)
    return stage


def add_mesh(
    stage: Usd.Stage,
    path: str,
    points: object = QUAD_POINTS,
    counts: object = (4,),
    corners: object = (0, 1, 2, 3),
    scheme: str = "none",
) -> UsdGeom.Mesh:
    """A mesh; by default a unit square in the XY plane that faces +Z."""
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.array(points, np.float32)))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.array(counts, np.int32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.array(corners, np.int32)))
    mesh.CreateSubdivisionSchemeAttr(scheme)
    return mesh


def set_primvar(
    prim: Usd.Prim, name: str, kind: Sdf.ValueTypeName, interpolation: str, value: object
) -> UsdGeom.Primvar:
    """Author a primvar."""
    primvar = UsdGeom.PrimvarsAPI(prim).CreatePrimvar(name, kind, interpolation)
    primvar.Set(value)
    return primvar


def read(stage: Usd.Stage, time: float = 0.0, *, cull_backfaces: bool = False) -> Scene:
    """The scene of a stage."""
    return StageReader(stage, StageOptions(cull_backfaces=cull_backfaces)).read(time)


def only_batch(scene: Scene) -> Batch:
    """The scene's one batch."""
    assert len(scene.batches) == 1
    return scene.batches[0]


def world_points(batch: Batch, instance: int = 0) -> NDArray[np.float64]:
    """``(n, 3)`` vertices of one instance in the world."""
    pose = batch.poses[instance]
    return batch.geometry.positions.astype(np.float64) @ pose[:3, :3].T + pose[:3, 3]


def facing(batch: Batch) -> NDArray[np.float64]:
    """``(m, 3)`` unit directions that the triangles face by their winding, in the first instance's world."""
    corners = world_points(batch)[batch.geometry.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def codes(reader: StageReader) -> set[str]:
    """The codes of a reader's findings."""
    return {finding.code for finding in reader.findings}


def add_material(stage: Usd.Stage, path: str, **inputs: object) -> UsdShade.Shader:
    """A UsdPreviewSurface material with constant inputs; returns its surface shader."""
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, f"{path}/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    for name, value in inputs.items():
        kind = T.Float if isinstance(value, float) else T.Int if isinstance(value, int) else T.Color3f
        shader.CreateInput(name, kind).Set(value)
    material.CreateSurfaceOutput().ConnectToSource(shader.CreateOutput("surface", T.Token))
    return shader


def bind(prim: Usd.Prim, path: str, **options: object) -> None:
    """Bind a material to a prim."""
    material = UsdShade.Material(prim.GetStage().GetPrimAtPath(path))
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(material, **options)


def add_texture(stage: Usd.Stage, path: str, file: str, varname: str = "st") -> UsdShade.Shader:
    """A UsdUVTexture that reads a primvar."""
    reader = UsdShade.Shader.Define(stage, f"{path}_reader")
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", T.String).Set(varname)
    texture = UsdShade.Shader.Define(stage, path)
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", T.Asset).Set(file)
    texture.CreateInput("st", T.Float2).ConnectToSource(reader.CreateOutput("result", T.Float2))
    return texture


def add_textured_material(stage: Usd.Stage, prim: Usd.Prim, file: str) -> UsdShade.Shader:
    """Bind a material with a diffuse texture; returns the texture."""
    shader = add_material(stage, "/looks/textured")
    texture = add_texture(stage, "/looks/textured/diffuse", file)
    shader.CreateInput("diffuseColor", T.Color3f).ConnectToSource(texture.CreateOutput("rgb", T.Float3))
    bind(prim, "/looks/textured")
    return texture


def write_picture(path: Path, pixels: np.ndarray) -> str:
    """Write a picture file of the array's own type."""
    output = oiio.ImageOutput.create(str(path))
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], str(pixels.dtype))
    spec.attribute("oiio:UnassociatedAlpha", 1)
    assert output.open(str(path), spec)
    assert output.write_image(pixels)
    output.close()
    return str(path)


def dense_grid(stage: Usd.Stage, path: str, n: int = 80) -> UsdGeom.Mesh:
    """A mesh of 2 n² triangles: enough for instancing to pay."""
    x, y = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
    points = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3) / n
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    corners = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).ravel()
    return add_mesh(stage, path, points, [4] * n * n, corners)


def two_instances(stage: Usd.Stage) -> None:
    dense_grid(stage, "/_proto/geo/grid")
    stage.GetPrimAtPath("/_proto").SetSpecifier(Sdf.SpecifierClass)
    for number in range(2):
        prim = UsdGeom.Xform.Define(stage, f"/i{number}")
        prim.GetPrim().GetReferences().AddInternalReference("/_proto")
        prim.GetPrim().SetInstanceable(True)
        prim.AddTranslateOp().Set(Gf.Vec3d(10 * number, 0, 0))


def instancer(stage: Usd.Stage, path: str, prototypes: list[str], indices: list[int]) -> UsdGeom.PointInstancer:
    instances = UsdGeom.PointInstancer.Define(stage, path)
    instances.CreatePrototypesRel().SetTargets([Sdf.Path(p) for p in prototypes])
    instances.CreateProtoIndicesAttr(indices)
    instances.CreatePositionsAttr([Gf.Vec3f(10 * i, 0, 0) for i in range(len(indices))])
    return instances
