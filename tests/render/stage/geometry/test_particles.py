"""Points are drawn as balls of their widths, in number by how many there are."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render import colour
from render.stage import StageReader
from tests.render.kits.stages import T, codes, new_stage, only_batch, read, set_primvar, world_points


def dots(stage: Usd.Stage, places: object, widths: object = (0.5,)) -> UsdGeom.Points:
    """Points on a stage."""
    prim = UsdGeom.Points.Define(stage, "/dots")
    prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.asarray(places, np.float32)))
    prim.CreateWidthsAttr(Vt.FloatArray.FromNumpy(np.asarray(widths, np.float32)))
    return prim


@pytest.mark.parametrize("count", [1, 1_001, 20_001, 100_001])
def test_an_outline_has_the_area_of_the_circle_in_the_mean(count: int):
    """The mean area of a convex body's outlines is a quarter of its surface (Cauchy)."""
    stage = new_stage()
    dots(stage, np.zeros((count, 3)))
    batch = only_batch(read(stage))
    faces = len(batch.geometry.triangles) // count
    corners = world_points(batch)[batch.geometry.triangles[:faces]]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(cross, axis=1).sum() / 8 == pytest.approx(np.pi * 0.25**2, rel=1e-5)
    assert (np.sum(cross * corners[:, 0], axis=1) > 0).all()  # outward
    assert faces == {1: 512, 1_001: 128, 20_001: 32, 100_001: 8}[count]


def test_each_point_has_its_place_width_and_colour():
    stage = new_stage()
    prim = dots(stage, [(0, 0, 0), (3, 0, 0), (6, 0, 0)], [0.5, 1.0, 2.0]).GetPrim()
    coded = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    set_primvar(prim, "displayColor", T.Color3fArray, "vertex", [Gf.Vec3f(*one) for one in coded])
    batch = only_batch(read(stage))
    points = world_points(batch)
    nearest = np.argmin(np.abs(points[:, :1] - np.array([0.0, 3.0, 6.0])), axis=1)
    for number, width in enumerate((0.5, 1.0, 2.0)):
        assert np.ptp(points[nearest == number], axis=0) == pytest.approx([width] * 3, rel=0.01)
    assert batch.geometry.colors is not None
    shown = colour.to_working(np.array(coded, np.float32))
    np.testing.assert_allclose(batch.geometry.colors[:, :3], shown[nearest], atol=1e-6)


def test_points_without_widths_have_one_unit_and_are_named():
    stage = new_stage()
    dots(stage, [(0, 0, 0)], ())
    reader = StageReader(stage)
    assert np.ptp(world_points(only_batch(reader.read(0.0))), axis=0) == pytest.approx([1.0] * 3, rel=0.01)
    assert codes(reader) == {"no_widths"}


@pytest.mark.parametrize(
    ("places", "widths"),
    [
        ([(0, 0, np.nan)], [1]),
        ([(0, 0, 1e20)], [1]),
        (np.zeros((0, 3)), [1]),
        (np.zeros((3, 3)), [1, 2]),
        (np.zeros((3, 3)), [1, np.nan, 2]),
        (np.zeros((1_000_001, 3)), [1]),
    ],
)
def test_points_that_cannot_be_drawn_are_named(places: object, widths: list):
    stage = new_stage()
    dots(stage, places, widths)
    reader = StageReader(stage)
    assert not reader.read(0.0).batches
    assert codes(reader) == {"bad_geometry"}


TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]


@pytest.mark.parametrize("orientation", ["rightHanded", "leftHanded"])
@pytest.mark.parametrize("has_faces", [True, False])
def test_tetrahedra_are_drawn_by_their_surface(orientation: str, has_faces: bool):
    stage = new_stage()
    mesh = UsdGeom.TetMesh.Define(stage, "/tet")
    mesh.CreatePointsAttr([Gf.Vec3f(*point) for point in TETRAHEDRON])
    mesh.CreateOrientationAttr(orientation)
    right = orientation == "rightHanded"
    tets = [(0, 1, 2, 3), (1, 4, 2, 3)]
    mesh.CreateTetVertexIndicesAttr([Gf.Vec4i(*(t if right else (t[1], t[0], *t[2:]))) for t in tets])
    if has_faces:
        faces = UsdGeom.TetMesh.ComputeSurfaceFaces(mesh, Usd.TimeCode.Default())
        mesh.CreateSurfaceFaceVertexIndicesAttr(faces)
    batch = only_batch(read(stage))
    corners = world_points(batch)[batch.geometry.triangles]
    assert len(corners) == 6
    volume = np.sum(np.cross(corners[:, 0], corners[:, 1]) * corners[:, 2]) / 6
    assert volume == pytest.approx(1 / 6 + 1 / 3, rel=1e-6)


@pytest.mark.parametrize("indices", [[(0, 1, 2, 9)], [(0, 1, 2, -1)], []])
def test_tetrahedra_that_contradict_themselves_are_named(indices: list):
    stage = new_stage()
    mesh = UsdGeom.TetMesh.Define(stage, "/tet")
    mesh.CreatePointsAttr([Gf.Vec3f(*point) for point in TETRAHEDRON])
    mesh.CreateTetVertexIndicesAttr([Gf.Vec4i(*one) for one in indices])
    reader = StageReader(stage)
    assert not reader.read(0.0).batches
    assert codes(reader) <= {"bad_geometry", "no_faces"}
    assert codes(reader)
