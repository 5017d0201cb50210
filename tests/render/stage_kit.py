"""Small stages, made in memory, for the tests of the stage reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pxr import Sdf, Usd, UsdGeom, Vt

from render.scene import Batch, Scene
from render.stage import StageReader

ASSETS = Path(__file__).parents[2].parent / "shared" / "assets"
needs_assets = pytest.mark.skipif(not ASSETS.is_dir(), reason="the shared assets are not here")

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


def read(stage: Usd.Stage, time: float = 0.0) -> Scene:
    """The scene of a stage."""
    return StageReader(stage).read(time)


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
