"""A focus point sticks to its face, whatever moves, bends or multiplies it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

from render.errors import NotFoundError
from render.frame import FrameRenderer
from render.model.camera import Camera
from render.model.scene import Batch, Scene
from render.stage import AnchorReader, StageOptions, StageReader, anchor_position, default_camera, open_stage
from tests.render.kits.skinned import bent_strip
from tests.render.kits.stages import (
    ASSETS,
    QUAD_POINTS,
    add_mesh,
    dense_grid,
    instancer,
    needs_assets,
    new_stage,
    read,
    two_instances,
    world_points,
)
from usd_schemas import FocusPoint


def point(target: str | tuple[str, ...], **values: object) -> FocusPoint:
    values = {"barycentric": (0.2, 0.3, 0.5), "face": 0, **values}
    return FocusPoint(name="p", target=(target,) if isinstance(target, str) else target, **values)


def drawn_at(batch: Batch, instance: int, triangle: int, weights: tuple[float, float, float]) -> np.ndarray:
    """Where the renderer draws a place on a triangle, given in the fan's order."""
    corners = batch.geometry.triangles[triangle]
    if batch.geometry.swapped is not None and batch.geometry.swapped[triangle]:
        corners = corners[[0, 2, 1]]
    return np.asarray(weights) @ world_points(batch, instance)[corners]


def assert_everywhere(stage: Usd.Stage, time: float) -> None:
    """All over every instance, the anchor is where the renderer draws that triangle."""
    scene = StageReader(stage).read(time)
    anchors = AnchorReader(stage)
    count = 0
    for batch in scene.batches:
        for instance in range(len(batch.poses)):
            triangles = len(batch.geometry.triangles)
            for triangle in range(0, triangles, 1 + triangles // 100):
                p = point(target_of(scene, batch, instance, triangle), **face_of(batch, instance, triangle))
                np.testing.assert_allclose(
                    anchors.position(p, time), drawn_at(batch, instance, triangle, p.barycentric), atol=1e-4
                )
                count += 1
    assert count


def target_of(scene: Scene, batch: Batch, instance: int, triangle: int) -> tuple[str, ...]:
    own = scene.prim_paths[batch.geometry.prim_ids[triangle]]
    if batch.instance_prim_ids is None:
        return (own,)
    picked = scene.prim_paths[batch.instance_prim_ids[instance]]
    return (picked, own) if batch.instance_numbers is not None else (picked,)


def face_of(batch: Batch, instance: int, triangle: int) -> dict[str, object]:
    return {
        "face": int(batch.geometry.face_ids[triangle]),
        "fan_triangle": int(batch.geometry.fan_ids[triangle]),
        "instance": -1 if batch.instance_numbers is None else int(batch.instance_numbers[instance]),
    }


def test_on_a_plain_mesh_in_centimetres_z_up() -> None:
    stage = new_stage(0.01, "Z")
    mesh = add_mesh(stage, "/m")
    mesh.AddTranslateOp().Set(Gf.Vec3d(100, 200, 300))
    mesh.AddScaleOp().Set(Gf.Vec3f(100, 100, 100))
    # The second triangle of the fan is corners 0, 2, 3: (0, 0), (1, 1), (0, 1).
    found = anchor_position(stage, point("/m", fan_triangle=1), 0)
    np.testing.assert_allclose(found, [1 + 0.3, 3, -2 - 0.8], atol=1e-6)


def test_with_an_offset_in_the_targets_own_space() -> None:
    stage = new_stage()
    add_mesh(stage, "/m").AddRotateYOp().Set(90.0)
    found = anchor_position(stage, point("/m", barycentric=(1.0, 0.0, 0.0), offset=(0.0, 0.0, 2.0)), 0)
    np.testing.assert_allclose(found, [2, 0, 0], atol=1e-6)


def test_on_things_that_move_and_bend() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/group/m")
    mover = UsdGeom.Xform.Define(stage, "/group").AddTranslateOp()
    mover.Set(Gf.Vec3d(0, 0, 0), 0)
    mover.Set(Gf.Vec3d(10, 0, 0), 10)
    mesh.GetPointsAttr().Set([Gf.Vec3f(*p) for p in QUAD_POINTS], 0)
    mesh.GetPointsAttr().Set([Gf.Vec3f(p[0], p[1], 8) for p in QUAD_POINTS], 10)
    p = point("/group/m", barycentric=(1.0, 0.0, 0.0))
    np.testing.assert_allclose(anchor_position(stage, p, 5), [5, 0, 4], atol=1e-6)


@pytest.mark.parametrize("kind", ["Sphere", "Cube", "Cylinder", "Cone", "Capsule", "Plane"])
def test_on_implicit_shapes(kind: str) -> None:
    stage = new_stage(0.1, "Z")
    prim = stage.DefinePrim("/shape", kind)
    UsdGeom.Xformable(prim).AddRotateXYZOp().Set(Gf.Vec3f(10, 20, 30))
    assert_everywhere(stage, 0)


def test_on_native_instances_that_move_and_mirror() -> None:
    stage = new_stage()
    two_instances(stage)
    UsdGeom.Xformable(stage.GetPrimAtPath("/i1")).GetOrderedXformOps()[0].Set(Gf.Vec3d(3, 4, 5), 10)
    UsdGeom.Xformable(stage.GetPrimAtPath("/i0")).AddScaleOp().Set(Gf.Vec3f(-1, 2, 1))
    assert_everywhere(stage, 10)


def test_on_left_handed_and_instanced_meshes() -> None:
    stage = new_stage(0.5)
    dense_grid(stage, "/dots/geo/grid", 9).CreateOrientationAttr("leftHanded")
    dots = instancer(stage, "/dots", ["/dots/geo"], [0, 0, 0])
    dots.CreateIdsAttr([5, 6, 7])
    dots.CreateInvisibleIdsAttr([6])
    dots.GetPositionsAttr().Set([Gf.Vec3f(i, 0, 0) for i in range(3)], 0)
    dots.GetPositionsAttr().Set([Gf.Vec3f(i, 9, 0) for i in range(3)], 10)
    assert_everywhere(stage, 5)


def test_on_nested_instancers() -> None:
    stage = new_stage()
    add_mesh(stage, "/outer/inner/a")
    instancer(stage, "/outer/inner", ["/outer/inner/a"], [0, 0, 0]).AddTranslateOp().Set(Gf.Vec3d(0, 7, 0))
    instancer(stage, "/outer", ["/outer/inner"], [0, 0])
    assert_everywhere(stage, 0)


def test_an_instance_is_followed_by_its_id_as_others_come_and_go() -> None:
    stage = new_stage()
    add_mesh(stage, "/dots/a")
    dots = instancer(stage, "/dots", ["/dots/a"], [])
    for time, ids in ((1, [4, 8]), (2, [8, 9]), (3, [9])):
        dots.GetProtoIndicesAttr().Set([0] * len(ids), time)
        dots.CreateIdsAttr().Set(ids, time)
        dots.GetPositionsAttr().Set([Gf.Vec3f(10 * number, time, 0) for number in ids], time)
    p = point(("/dots", "/dots/a"), barycentric=(1.0, 0.0, 0.0), instance=8)
    found = AnchorReader(stage).read_anchors([[p]] * 3, [1.0, 2.0, 3.0])
    np.testing.assert_allclose(found.positions_m[:2, 0], [[80, 1, 0], [80, 2, 0]])
    assert "instance 8 of /dots, which does not exist at time 3" in found.problems[2]["p"]
    for time in (1, 2, 3):
        assert_everywhere(stage, time)


def test_an_instance_that_is_invisible_keeps_its_place() -> None:
    stage = new_stage()
    add_mesh(stage, "/dots/a")
    dots = instancer(stage, "/dots", ["/dots/a"], [0, 0])
    dots.CreateInvisibleIdsAttr([1])
    p = point(("/dots", "/dots/a"), barycentric=(1.0, 0.0, 0.0), instance=1)
    np.testing.assert_allclose(anchor_position(stage, p, 0), [10, 0, 0])


@pytest.mark.parametrize("ids", [[5, 5, 6], [5, 6], [-1, 0, 1], [0, 1, 2**40]])
def test_ids_that_repeat_are_reported_and_indices_are_used(ids: list[int]) -> None:
    stage = new_stage()
    add_mesh(stage, "/dots/a")
    instancer(stage, "/dots", ["/dots/a"], [0, 0, 0]).CreateIdsAttr(ids)
    reader = StageReader(stage)
    assert [b.instance_numbers.tolist() for b in reader.read(0).batches if b.instance_numbers is not None] == [
        [0, 1, 2]
    ]
    assert "bad_ids" in {finding.code for finding in reader.findings}
    p = point(("/dots", "/dots/a"), barycentric=(1.0, 0.0, 0.0), instance=2)
    np.testing.assert_allclose(anchor_position(stage, p, 0), [20, 0, 0])


def test_a_target_without_a_surface_or_a_face_is_its_origin() -> None:
    stage = new_stage()
    UsdGeom.Xform.Define(stage, "/locator").AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
    add_mesh(stage, "/locator/m")
    np.testing.assert_allclose(anchor_position(stage, point("/locator"), 0), [1, 2, 3])
    np.testing.assert_allclose(anchor_position(stage, point("/locator/m", face=-1), 0), [1, 2, 3])


@pytest.mark.parametrize(
    ("target", "values", "says"),
    [
        ("/gone", {}, "/gone"),
        ((), {}, "nothing"),
        ("/m", {"face": 3}, "face 3"),
        ("/m", {"face": -2}, "face -2"),
        ("/m", {"fan_triangle": 2}, "triangle 2"),
        (("/dots", "/dots/a"), {"instance": 9}, "instance 9"),
        (("/m", "/dots/a"), {"instance": 0}, "instance 0"),
    ],
)
def test_what_is_not_there_is_named(target: str | tuple[str, ...], values: dict, says: str) -> None:
    stage = new_stage()
    add_mesh(stage, "/m")
    add_mesh(stage, "/dots/a")
    instancer(stage, "/dots", ["/dots/a"], [0])
    with pytest.raises(NotFoundError, match=says):
        anchor_position(stage, point(target, **values), 0)


@needs_assets
def test_on_a_skinned_mesh_the_point_goes_with_the_skin() -> None:
    stage = open_stage(ASSETS / "ElephantWithMonochord" / "SoC-ElephantWithMonochord.usdc")
    assert_everywhere(stage, 75)


CHESS_MASK = ["/ChessSet/Black/Pawns", "/ChessSet/White/Pawns", "/ChessSet/White/KnightL"]


@needs_assets
@pytest.mark.gl
@pytest.mark.parametrize(
    ("name", "mask", "complexity", "share"),
    [
        ("Teapot/Teapot.usd", None, "low", 1e-6),
        ("Teapot/Teapot.usd", None, "auto", 1e-4),
        ("OpenChessSet/chess_set.usda", CHESS_MASK, "low", 1e-6),
        ("OpenChessSet/chess_set.usda", CHESS_MASK, "auto", 1e-4),
        ("ElephantWithMonochord/SoC-ElephantWithMonochord.usdc", None, "auto", 1e-6),
    ],
)
def test_a_click_finds_the_place_that_the_anchor_finds_again(
    renderer: FrameRenderer, name: str, mask: list[str] | None, complexity: str, share: float
) -> None:
    """Click on real assets, make a focus point of what was hit, and ask where it is: within a share of the distance. A refined
    surface is drawn with flat triangles, within a quarter of a pixel of the limit surface, on which the point is.
    """
    stage = open_stage(ASSETS / name)
    options = StageOptions(mask=mask, complexity=complexity)
    scene = StageReader(stage, options, max_texture=64).read(stage.GetStartTimeCode())
    camera = default_camera(stage, aspect=1.0).framing
    assert isinstance(camera, Camera)
    hits = 0
    for x, y in np.random.default_rng(5).uniform((40, 80), (160, 120), (72, 2)):
        pick = renderer.pick(scene, camera, 200, 200, float(x), float(y))
        if pick is None:
            continue
        target = (pick.prim_path,) if pick.prototype_path is None else (pick.prim_path, pick.prototype_path)
        place = {"face": pick.face, "fan_triangle": pick.fan_triangle, "instance": pick.instance}
        p = point(target, barycentric=pick.barycentric, **place)
        found = AnchorReader(stage, StageOptions(complexity=complexity)).position(p, stage.GetStartTimeCode())
        np.testing.assert_allclose(found, pick.position_m, atol=share * camera.focus_distance_m)
        hits += 1
    assert hits >= 3


def everything() -> tuple[Usd.Stage, list[FocusPoint]]:
    """A stage with a strip that a skeleton bends, a mesh whose points and faces move, a ball that grows, and moving dots."""
    stage = bent_strip()
    mesh = add_mesh(stage, "/group/m")
    mover = UsdGeom.Xform.Define(stage, "/group").AddTranslateOp()
    mover.Set(Gf.Vec3d(0, 0, 0), 0)
    mover.Set(Gf.Vec3d(10, 0, 0), 10)
    mesh.GetPointsAttr().Set([Gf.Vec3f(*p) for p in QUAD_POINTS], 0)
    mesh.GetPointsAttr().Set([Gf.Vec3f(p[0], p[1], 8) for p in QUAD_POINTS], 10)
    mesh.GetFaceVertexIndicesAttr().Set([0, 1, 2, 3], 0)
    mesh.GetFaceVertexIndicesAttr().Set([1, 2, 3, 0], 5)
    UsdGeom.Sphere.Define(stage, "/ball").CreateRadiusAttr().Set(1, 0)
    UsdGeom.Sphere(stage.GetPrimAtPath("/ball")).GetRadiusAttr().Set(3, 10)
    add_mesh(stage, "/dots/a")
    dots = instancer(stage, "/dots", ["/dots/a"], [0, 0])
    dots.GetPositionsAttr().Set([Gf.Vec3f(i, 0, 0) for i in range(2)], 0)
    dots.GetPositionsAttr().Set([Gf.Vec3f(i, 9, 0) for i in range(2)], 10)
    points = [
        point("/rig/strip", face=1),
        point("/rig/strip", face=0, offset=(0.0, 1.0, 0.0)),
        point("/group/m", fan_triangle=1),
        point("/ball", face=70),
        point(("/dots", "/dots/a"), instance=1),
        point("/rig"),
    ]
    return stage, [replace(p, name=f"p{number}") for number, p in enumerate(points)]


def test_many_times_at_once_are_as_each_time_alone() -> None:
    stage, points = everything()
    times = [0.0, 2.5, 5.0, 7.5, 10.0]
    expected = [[anchor_position(stage, p, time) for p in points] for time in times]
    found = AnchorReader(stage).positions(points, times)
    np.testing.assert_array_equal(found, expected)
    moves = np.ptp(found, axis=0).max(axis=1) > 0.1
    assert moves.tolist() == [True, False, True, True, True, False]
    assert AnchorReader(stage).positions([], times).shape == (5, 0, 3)
    assert AnchorReader(stage).positions(points, []).shape == (0, 6, 3)


def test_points_without_a_position_are_reported_and_leave_the_others() -> None:
    stage, points = everything()
    counts = UsdGeom.Mesh(stage.GetPrimAtPath("/group/m")).GetFaceVertexCountsAttr()
    counts.Set([4], 0)
    counts.Set([3], 5)
    gone = [point("/gone"), point("/ball", face=10**6), point(("/dots", "/dots/a"), instance=7)]
    asked = [*points, *(replace(p, name=f"gone{number}") for number, p in enumerate(gone))]
    found = AnchorReader(stage).read_anchors([asked, asked], [0.0, 5.0])
    np.testing.assert_array_equal(found.positions_m[0, :6], AnchorReader(stage).positions(points, [0.0])[0])
    assert np.isnan(found.positions_m[0]).all(axis=1).tolist() == [False] * 6 + [True] * 3
    assert set(found.problems[0]) == {"gone0", "gone1", "gone2"}
    assert set(found.problems[1]) == {"gone0", "gone1", "gone2", "p2"}
    assert "/gone" in found.problems[0]["gone0"]
    assert "face 1000000" in found.problems[0]["gone1"]
    assert "instance 7" in found.problems[0]["gone2"]
    assert found.problems[1]["p2"] == (
        "focus point p2 is on /group/m, but faceVertexCounts add up to 3 corners, but there are 4 indices"
    )


def test_a_focus_point_whose_face_is_keyed_goes_from_face_to_face() -> None:
    stage, _ = everything()
    at = [point("/rig/strip", face=0), point("/rig/strip", face=1)]
    found = AnchorReader(stage).read_anchors([[at[0]], [at[1]]], [0.0, 0.0]).positions_m
    np.testing.assert_array_equal(found[:, 0], [anchor_position(stage, p, 0.0) for p in at])
    assert found[1, 0, 0] - found[0, 0, 0] == pytest.approx(1)


def test_points_and_faces_that_cannot_be_used_are_reported() -> None:
    stage = new_stage()
    add_mesh(stage, "/few", points=QUAD_POINTS[:3])
    add_mesh(stage, "/nan", points=[(0, 0, 0), (1, 0, 0), (np.nan, 1, 0), (0, 1, 0)])
    empty = add_mesh(stage, "/empty")
    empty.GetPointsAttr().Set([])
    found = AnchorReader(stage).read_anchors(
        [[replace(point(f"/{name}", fan_triangle=1), name=name) for name in ("few", "nan", "empty")]], [0.0]
    )
    assert np.isnan(found.positions_m).all()
    problems = found.problems[0]
    assert "there are 3" in problems["few"]
    assert "not finite" in problems["nan"]
    assert "no points" in problems["empty"]


def test_the_scene_is_unchanged_by_asking() -> None:
    stage = new_stage()
    add_mesh(stage, "/m")
    before = read(stage).triangle_count
    anchor_position(stage, point("/m"), 0)
    assert read(stage).triangle_count == before
