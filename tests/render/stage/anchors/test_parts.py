"""A focus point that follows a part is at its place in the part's bounds, in closed form, whatever moves or changes them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from pxr import Gf, Sdf, Usd, UsdGeom

from render.errors import NotFoundError, StageError
from render.stage import AnchorReader, anchor_position
from tests.render.kits.skinned import bent_strip
from tests.render.kits.stages import QUAD_POINTS, add_mesh, instancer, new_stage, two_instances
from usd_schemas import FocusPoint

PLACE = (0.25, 0.75, 0.5)


def subject(part: str, place: tuple[float, float, float] = PLACE, **values: object) -> FocusPoint:
    return FocusPoint("p", **{"target": ("/gone",), "face": 7, "part": part, "bounds_point": place, **values})


def box(stage: Usd.Stage, path: str, least: tuple[float, ...], most: tuple[float, ...]) -> UsdGeom.Mesh:
    """A mesh of two points."""
    return add_mesh(stage, path, [least, most], [2], [0, 1])


def places(stage: Usd.Stage, point: FocusPoint, *times: float) -> NDArray[np.float64]:
    found = AnchorReader(stage).read_anchors([[point]] * len(times), times)
    assert found.problems == ({},) * len(times)
    for time, position in zip(times, found.positions_m[:, 0], strict=True):
        np.testing.assert_allclose(anchor_position(stage, point, time), position, atol=1e-12)
    return found.positions_m[:, 0]


def test_in_a_group_that_moves_turns_and_grows_z_up() -> None:
    stage = new_stage(0.01, "Z")
    group = UsdGeom.Xform.Define(stage, "/group")
    move, turn, grow = group.AddTranslateOp(), group.AddRotateZOp(), group.AddScaleOp()
    for time in (0, 10):
        move.Set(Gf.Vec3d(100 * time, 0, 50), time)
        turn.Set(9.0 * time, time)
        grow.Set(Gf.Vec3f(1 + time / 10), time)
    box(stage, "/group/a", (0, 0, 0), (100, 200, 400))
    box(stage, "/group/b", (-100, 0, 0), (0, 100, 0)).AddTranslateOp().Set(Gf.Vec3d(0, -200, 0))
    for time, position in zip((0, 5, 10), places(stage, subject("/group"), 0, 5, 10), strict=True):
        # bounds from (-100, -200, 0) to (100, 200, 400): the place is (-50, 100, 200)
        angle, scale = np.radians(9 * time), 1 + time / 10
        x = scale * (-50 * np.cos(angle) - 100 * np.sin(angle)) + 100 * time
        y = scale * (-50 * np.sin(angle) + 100 * np.cos(angle))
        np.testing.assert_allclose(position, [x / 100, (scale * 200 + 50) / 100, -y / 100], atol=1e-6)


def test_bounds_follow_extents_and_points_and_what_moves_inside() -> None:
    stage = new_stage()
    authored = box(stage, "/group/authored", (0, 0, 0), (1, 1, 1))
    authored.CreateExtentAttr().Set([(0, 0, 0), (2, 2, 2)], 0)
    authored.GetExtentAttr().Set([(0, 0, 0), (4, 2, 2)], 10)
    still = subject("/group/authored", (1, 1, 1))
    np.testing.assert_allclose(places(stage, still, 0, 5, 10), [[2, 2, 2], [3, 2, 2], [4, 2, 2]])
    grows = UsdGeom.Sphere.Define(stage, "/group/ball")
    grows.CreateRadiusAttr().Set(1, 0)
    grows.GetRadiusAttr().Set(3, 10)
    np.testing.assert_allclose(places(stage, subject("/group/ball", (1, 0, 0.5)), 0, 10), [[1, -1, 0], [3, -3, 0]])
    goes = box(stage, "/group/goes", (0, 0, 0), (1, 1, 1)).AddTranslateOp()
    goes.Set(Gf.Vec3d(0, 0, 0), 0)
    goes.Set(Gf.Vec3d(0, 9, 0), 10)
    np.testing.assert_allclose(places(stage, subject("/group", (1, 1, 0)), 0, 10), [[2, 2, -1], [4, 10, -3]])


def test_bounds_never_jump_while_shapes_turn() -> None:
    stage = new_stage()
    for name, size in (("a", (4, 1, 1)), ("b", (1, 4, 1))):
        turn = box(stage, f"/group/{name}", (0, 0, 0), size).AddRotateXYZOp()
        turn.Set(Gf.Vec3f(0, 0, 0), 0)
        turn.Set(Gf.Vec3f(90, 70, 180), 100)
    steps = np.diff(places(stage, subject("/group", (1, 1, 1)), *np.linspace(0, 100, 401)), axis=0)
    assert np.linalg.norm(steps, axis=1).max() < 0.1


def test_a_skinned_part_is_as_its_skeleton_bends_it() -> None:
    stage = bent_strip()
    # at rest from (0, 0, -1) to (2, 0, 0); bent, its right half stands up to (1, 1, 0); the rig is at z = 50
    for part in ("/rig/strip", "/rig"):
        found = places(stage, subject(part, (1, 1, 1)), 0, 10)
        np.testing.assert_allclose(found, [[2, 0, 50], [1, 1, 50]], atol=1e-6)


def test_an_instance_proxy_is_a_part() -> None:
    stage = new_stage()
    two_instances(stage)
    UsdGeom.Xformable(stage.GetPrimAtPath("/i1")).GetOrderedXformOps()[0].Set(Gf.Vec3d(3, 4, 5))
    proxies = [
        prim for prim in Usd.PrimRange(stage.GetPrimAtPath("/i1"), Usd.TraverseInstanceProxies()) if prim.IsA("Mesh")
    ]
    assert proxies[0].IsInstanceProxy()
    least = places(stage, subject(str(proxies[0].GetPath()), (0, 0, 0)), 0)
    np.testing.assert_allclose(least, places(stage, subject("/i1", (0, 0, 0)), 0))
    np.testing.assert_allclose(least[0], [3, 4, 5])


def test_a_part_of_a_prototype_is_that_of_the_points_instance() -> None:
    stage = new_stage()
    add_mesh(stage, "/dots/a/m").AddTranslateOp().Set(Gf.Vec3d(0, 7, 0))
    dots = instancer(stage, "/dots", ["/dots/a"], [0, 0, 0])
    dots.GetPositionsAttr().Set([Gf.Vec3f(i, 0, 0) for i in range(3)])
    target = {"target": ("/dots", "/dots/a/m"), "instance": 2}
    np.testing.assert_allclose(places(stage, subject("/dots/a", (0.5, 0.5, 0), **target), 0), [[2.5, 7.5, 0]])
    np.testing.assert_allclose(places(stage, subject("/dots", (0.5, 0.5, 0), **target), 0), [[1.5, 7.5, 0]])


def test_only_what_is_visible_and_drawn_has_bounds() -> None:
    stage = new_stage()
    box(stage, "/group/a", (0, 0, 0), (1, 1, 1))
    UsdGeom.Imageable(box(stage, "/group/hidden", (0, 0, 0), (5, 5, 5))).MakeInvisible()
    box(stage, "/group/guide", (0, 0, 0), (7, 7, 7)).CreatePurposeAttr("guide")
    off = box(stage, "/group/off", (0, 0, 0), (6, 6, 6))
    off.CreateVisibilityAttr().Set("invisible", 1)  # one sample holds at all times
    blinks = UsdGeom.Xform.Define(stage, "/group/blinks")
    box(stage, "/group/blinks/b", (0, 0, 0), (3, 3, 3))
    blinks.CreateVisibilityAttr().Set("invisible", 0)
    blinks.GetVisibilityAttr().Set("inherited", 5)
    most = subject("/group", (1, 1, 1))
    np.testing.assert_allclose(places(stage, most, 0, 5), [[1, 1, 1], [3, 3, 3]])
    UsdGeom.Imageable(stage.GetPrimAtPath("/group")).MakeInvisible()
    np.testing.assert_allclose(places(stage, most, 0, 5), [[1, 1, 1], [3, 3, 3]], err_msg="as a hidden surface does")


def test_with_an_offset_in_the_parts_own_space() -> None:
    stage = new_stage()
    add_mesh(stage, "/group/m")
    UsdGeom.Xform.Define(stage, "/group").AddRotateYOp().Set(90.0)
    found = places(stage, subject("/group", (0, 0, 0), offset=(0.0, 0.0, 2.0)), 0)
    np.testing.assert_allclose(found, [[2, 0, 0]], atol=1e-6)


@pytest.mark.parametrize(
    ("part", "says"),
    [
        ("/gone", "follows the bounds of /gone, which is not there"),
        ("/off", "/off, which is deactivated"),
        ("/look", "/look, which has none at time 3"),
        ("/empty", "/empty, which has none at time 3: there is nothing to be seen of it"),
        ("/cam", "/cam, which has none at time 3"),
    ],
)
def test_a_part_without_bounds_is_named(part: str, says: str) -> None:
    stage = new_stage()
    UsdGeom.Xform.Define(stage, "/empty")
    UsdGeom.Camera.Define(stage, "/cam")
    stage.DefinePrim("/look", "Material")
    add_mesh(stage, "/off").GetPrim().SetActive(False)
    add_mesh(stage, "/m")
    with pytest.raises(NotFoundError, match=says):
        anchor_position(stage, subject(part), 3)
    other = replace(subject("/m", (0, 0, 0)), name="q")
    found = AnchorReader(stage).read_anchors([[subject(part), other]], [3.0])
    assert says in found.problems[0]["p"]
    np.testing.assert_allclose(found.positions_m[0], [[np.nan] * 3, [0, 0, 0]])


def test_a_place_in_bounds_is_where_the_position_is() -> None:
    stage = new_stage(0.01, "Z")
    group = UsdGeom.Xform.Define(stage, "/group")
    group.AddRotateXYZOp().Set(Gf.Vec3f(10, 20, 30))
    box(stage, "/group/a", (0, 0, 0), (100, 200, 400))
    anchors, point = AnchorReader(stage), subject("/group", offset=(1.0, 2.0, 3.0))
    for place in ((0.1, 0.2, 0.3), (-0.5, 1.5, 0.0)):
        position = anchors.position(replace(point, bounds_point=place), 0)
        np.testing.assert_allclose(anchors.place_in_bounds(point, position, 0), place, atol=1e-9)


def test_flat_bounds_have_their_middle_as_the_place() -> None:
    stage = new_stage()
    add_mesh(stage, "/m", [(x, y, 5) for x, y, _ in QUAD_POINTS])
    found = AnchorReader(stage).place_in_bounds(subject("/m"), np.array([0.25, 1.0, 5.0]), 0)
    np.testing.assert_allclose(found, [0.25, 1.0, 0.5])
    UsdGeom.Xformable(stage.GetPrimAtPath("/m")).AddScaleOp().Set(Gf.Vec3f(1, 0, 1))
    with pytest.raises(StageError, match="cannot follow the bounds of /m, whose transform is flat at time 0"):
        AnchorReader(stage).place_in_bounds(subject("/m"), np.zeros(3), 0)


def test_shapes_without_usable_bounds_count_for_nothing() -> None:
    stage = new_stage()
    box(stage, "/group/a", (0, 0, 0), (1, 1, 1))
    box(stage, "/group/bad", (0, 0, 0), (1, 1, 1)).CreateExtentAttr([(0, 0, 0), (np.nan, 9, 9)])
    box(stage, "/group/turned", (0, 0, 0), (1, 1, 1)).CreateExtentAttr([(9, 9, 9), (0, 0, 0)])
    box(stage, "/group/endless", (0, 0, 0), (1, 1, 1)).CreateExtentAttr([(-np.inf,) * 3, (np.inf,) * 3])
    box(stage, "/group/lost", (0, 0, 0), (8, 8, 8)).AddTranslateOp().Set(Gf.Vec3d(np.nan, 0, 0))
    UsdGeom.Mesh.Define(stage, "/group/none")
    word = box(stage, "/group/word", (0, 0, 0), (1, 1, 1)).GetPrim()
    Sdf.AttributeSpec(word.GetPrimStack()[0], "extent", Sdf.ValueTypeNames.String).default = "large"
    np.testing.assert_allclose(places(stage, subject("/group", (1, 1, 1)), 0), [[1, 1, 1]])


def test_a_part_of_too_many_shapes_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("render.stage.anchors.part_bounds.MOST_SHAPES", 1)
    stage = new_stage()
    box(stage, "/group/a", (0, 0, 0), (1, 1, 1))
    np.testing.assert_allclose(places(stage, subject("/group", (1, 1, 1)), 0), [[1, 1, 1]])
    box(stage, "/group/b", (0, 0, 0), (1, 1, 1))
    (problem,) = AnchorReader(stage).read_anchors([[subject("/group")]], [0]).problems
    assert "/group has more than 1 shapes, too many to follow" in problem["p"]


def test_a_part_of_an_outer_instancer_is_refused() -> None:
    stage = new_stage()
    box(stage, "/L/m", (0, 0, 0), (1, 1, 1))
    UsdGeom.Xform.Define(stage, "/P")
    for path, prototype in (("/P/In", "/L"), ("/O", "/P")):
        found = UsdGeom.PointInstancer.Define(stage, path)
        found.CreatePrototypesRel().SetTargets([prototype])
        found.CreateProtoIndicesAttr([0, 0])
        found.CreatePositionsAttr([(0, 0, 0), (10, 0, 0)])
    point = subject("/P", target=("/O", "/L/m"), face=0, instance=1)
    (problem,) = AnchorReader(stage).read_anchors([[point]], [0]).problems
    assert "cannot follow the bounds of /P, which holds the instancer" in problem["p"]
    near = replace(point, part="/L", bounds_point=(0, 0, 0))
    np.testing.assert_allclose(places(stage, near, 0), [[10, 0, 0]])
