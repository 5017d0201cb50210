"""Meshes become triangles that face outside, with the right normals, whatever way they were authored."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pxr import Gf, Sdf, UsdGeom

from render.stage import StageReader
from render.stage.options import StageOptions
from tests.render.kits.stages import (
    QUAD_POINTS,
    add_mesh,
    add_textured_material,
    codes,
    facing,
    new_stage,
    only_batch,
    read,
    set_primvar,
    world_points,
    write_picture,
)

CUBE_POINTS = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
CUBE_CORNERS = [0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6]


def test_a_polygon_becomes_the_fan_of_its_corners() -> None:
    stage = new_stage()
    angle = np.linspace(0, 2 * np.pi, 7, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    add_mesh(stage, "/ngon", ring, [7], range(7))
    geometry = only_batch(read(stage)).geometry
    corners = geometry.positions[geometry.triangles]
    assert geometry.fan_ids.tolist() == [0, 1, 2, 3, 4]
    assert geometry.face_ids.tolist() == [0] * 5
    for number, triangle in enumerate(corners):
        np.testing.assert_allclose(triangle, ring[[0, number + 1, number + 2]], atol=1e-6)


@given(sides=st.lists(st.integers(0, 7), min_size=1, max_size=8))
@settings(max_examples=40)
def test_faces_keep_their_numbers_and_areas(sides: list[int]) -> None:
    if sum(max(n - 2, 0) for n in sides) == 0:
        sides = [*sides, 3]
    points, corners = [], []
    for face, n in enumerate(sides):
        angle = np.arange(n) * (2 * np.pi / max(n, 1))
        corners += [len(points) + i for i in range(n)]
        points += [(np.cos(a) + 3 * face, np.sin(a), 0) for a in angle]
    stage = new_stage()
    add_mesh(stage, "/m", points, sides, corners)
    geometry = only_batch(read(stage)).geometry
    a, b, c = (geometry.positions[geometry.triangles[:, i]].astype(float) for i in range(3))
    area = np.bincount(geometry.face_ids, np.cross(b - a, c - a)[:, 2] / 2, len(sides))
    expected = [n / 2 * np.sin(2 * np.pi / n) if n > 2 else 0 for n in sides]
    np.testing.assert_allclose(area, expected, atol=1e-5)


@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("orientation", ["rightHanded", "leftHanded"])
def test_triangles_and_normals_face_outside(orientation: str, mirror: bool) -> None:
    stage = new_stage()
    corners = np.array(CUBE_CORNERS).reshape(6, 4)
    if orientation == "leftHanded":
        corners = corners[:, ::-1]
    mesh = add_mesh(stage, "/cube", CUBE_POINTS, [4] * 6, corners.ravel())
    mesh.CreateOrientationAttr(orientation)
    mesh.AddScaleOp().Set(Gf.Vec3f(-2 if mirror else 2, 1, 1))
    batch = only_batch(read(stage))
    centres = world_points(batch)[batch.geometry.triangles].mean(axis=1)
    assert (np.sum(facing(batch) * centres, axis=1) > 0).all()
    normals = batch.geometry.normals[batch.geometry.triangles].mean(axis=1)
    np.testing.assert_allclose(normals, facing(batch), atol=1e-5)


@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("orientation", ["rightHanded", "leftHanded"])
def test_swapped_says_which_triangles_are_not_in_fan_order(orientation: str, mirror: bool) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/quad")
    mesh.CreateOrientationAttr(orientation)
    mesh.AddScaleOp().Set(Gf.Vec3f(-1 if mirror else 1, 1, 1))
    geometry = only_batch(read(stage)).geometry
    swapped = np.zeros(2, bool) if geometry.swapped is None else geometry.swapped
    assert (swapped == ((orientation == "leftHanded") != mirror)).all()
    corners = geometry.positions[geometry.triangles]
    corners[swapped] = corners[swapped][:, [0, 2, 1]]
    sign = np.array([-1 if mirror else 1, 1, 1])
    np.testing.assert_allclose(corners, np.array(QUAD_POINTS)[[[0, 1, 2], [0, 2, 3]]] * sign, atol=1e-6)


def test_holes_are_not_drawn() -> None:
    stage = new_stage()
    add_mesh(stage, "/cube", CUBE_POINTS, [4] * 6, CUBE_CORNERS).CreateHoleIndicesAttr([1, 4])
    assert set(only_batch(read(stage)).geometry.face_ids.tolist()) == {0, 2, 3, 5}


def test_a_subdivision_cage_has_smooth_and_a_plain_mesh_flat_normals() -> None:
    for scheme, vertices in (("catmullClark", 8), ("none", 24)):
        stage = new_stage()
        add_mesh(stage, "/cube", CUBE_POINTS, [4] * 6, CUBE_CORNERS, scheme=scheme)
        geometry = only_batch(StageReader(stage, StageOptions(complexity="low")).read(0)).geometry
        assert len(geometry.positions) == vertices
        alignment = np.sum(geometry.normals * geometry.positions / np.sqrt(3), axis=1)
        np.testing.assert_allclose(alignment, 1 if scheme == "catmullClark" else 1 / np.sqrt(3), atol=1e-5)


def test_authored_normals_are_used_and_the_primvar_wins() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/quad")
    mesh.CreateNormalsAttr([(0, 1, 0)])
    mesh.SetNormalsInterpolation("constant")
    np.testing.assert_allclose(only_batch(read(stage)).geometry.normals, [[0, 1, 0]] * 4)
    primvar = set_primvar(
        mesh.GetPrim(), "normals", Sdf.ValueTypeNames.Normal3fArray, "faceVarying", [(1, 0, 0), (0, 0, 2)]
    )
    primvar.SetIndices([0, 1, 1, 0])
    np.testing.assert_allclose(
        only_batch(read(stage)).geometry.normals[[0, 1, 2, 3]], [[1, 0, 0], [0, 0, 1], [0, 0, 1], [1, 0, 0]]
    )


def test_normals_stand_upright_on_a_squashed_surface() -> None:
    """A plane's normal under a non-uniform scale stays perpendicular to the plane, which a naive transform breaks."""
    stage = new_stage()
    mesh = add_mesh(stage, "/slope", [(0, 0, 0), (1, 0, 1), (1, 1, 1), (0, 1, 0)])
    mesh.CreateNormalsAttr([(-1, 0, 1)])
    mesh.SetNormalsInterpolation("constant")
    mesh.AddScaleOp().Set(Gf.Vec3f(3, 1, 1))
    batch = only_batch(read(stage))
    np.testing.assert_allclose(np.abs(batch.geometry.normals[0]), np.abs(facing(batch)[0]), atol=1e-6)


def test_corners_with_the_same_values_share_a_vertex(tmp_path: Path) -> None:
    """A grid with face-varying coordinates that are continuous needs no more vertices than it has points."""
    n = 16
    stage = new_stage()
    x, y = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
    points = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    corners = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).ravel()
    mesh = add_mesh(stage, "/grid", points, [4] * n * n, corners, scheme="catmullClark")
    values = [Gf.Vec2f(*map(float, points[c, :2] / n)) for c in corners]
    set_primvar(mesh.GetPrim(), "st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying", values)
    file = write_picture(tmp_path / "one.png", np.full((1, 1, 3), 128, np.uint8))
    add_textured_material(stage, mesh.GetPrim(), file)
    geometry = only_batch(read(stage)).geometry
    assert geometry.uvs is not None
    assert len(geometry.positions) == (n + 1) ** 2
    np.testing.assert_allclose(geometry.uvs, geometry.positions[:, :2] / n, atol=1e-6)


def test_a_z_up_stage_in_centimetres_comes_out_y_up_in_metres() -> None:
    stage = new_stage(0.01, "Z")
    add_mesh(stage, "/flag").AddTranslateOp().Set(Gf.Vec3d(100, 200, 300))
    points = world_points(only_batch(read(stage)))
    np.testing.assert_allclose(points[0], [1, 3, -2], atol=1e-6)
    np.testing.assert_allclose(points[2], [1.01, 3, -2.01], atol=1e-6)


@pytest.mark.parametrize(
    ("points", "counts", "corners", "says"),
    [
        (QUAD_POINTS, [4], [0, 1, 2, 9], "0 to 9"),
        (QUAD_POINTS, [4], [0, 1, 2], "3 indices"),
        (QUAD_POINTS, [-4], [0, 1, 2, 3], "negative"),
        ([(0, 0, 0), (1, 0, np.nan), (1, 1, 0)], [3], [0, 1, 2], "point 1 is not finite"),
        ([], [3], [0, 1, 2], "no points"),
    ],
)
def test_a_broken_mesh_is_left_out_and_named(points: list, counts: list, corners: list, says: str) -> None:
    stage = new_stage()
    add_mesh(stage, "/broken", points, counts, corners)
    add_mesh(stage, "/good")
    reader = StageReader(stage)
    scene = reader.read(0)
    assert scene.prim_paths == ("/good",)
    finding = next(f for f in reader.findings if f.path == "/broken")
    assert finding.code == "bad_geometry"
    assert says in finding.message
    assert "/broken" in finding.message


def test_a_mesh_of_lines_is_reported() -> None:
    stage = new_stage()
    add_mesh(stage, "/lines", QUAD_POINTS, [2, 2], [0, 1, 2, 3])
    reader = StageReader(stage)
    assert reader.read(0).batches == ()
    assert codes(reader) == {"no_faces"}


def test_a_concave_face_is_reported_unless_fanned_from_its_reflex() -> None:
    arrow = [(0, 0, 0), (2, 1, 0), (0, 2, 0), (0.5, 1, 0)]
    for first, found in ((0, {"concave_faces"}), (3, set())):
        stage = new_stage()
        add_mesh(stage, "/arrow", arrow, [4], [(first + i) % 4 for i in range(4)])
        reader = StageReader(stage)
        reader.read(0)
        assert codes(reader) == found


def test_static_surfaces_with_one_material_are_one_draw() -> None:
    stage = new_stage()
    for i in range(20):
        add_mesh(stage, f"/m{i}").AddTranslateOp().Set(Gf.Vec3d(i, 0, 0))
    UsdGeom.Mesh(stage.GetPrimAtPath("/m7")).CreateDoubleSidedAttr(True)
    scene = read(stage)
    assert sorted(len(batch.geometry.triangles) for batch in scene.batches) == [2, 38]
    assert {batch.double_sided for batch in scene.batches} == {False, True}
    big = max(scene.batches, key=lambda batch: len(batch.geometry.triangles))
    for triangle, prim_id in zip(big.geometry.triangles, big.geometry.prim_ids, strict=True):
        number = int(scene.prim_paths[prim_id].removeprefix("/m"))
        assert number <= big.geometry.positions[triangle, 0].min() < number + 1
