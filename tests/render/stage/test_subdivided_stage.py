"""Subdivision surfaces of stages: how finely they are refined, what stays when the camera moves, and what clicks on them find."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdShade

from render.model.scene import Scene
from render.stage import StageReader
from render.stage.anchors.anchors import AnchorReader
from render.stage.assembly import subdivision_levels
from render.stage.geometry import surface
from render.stage.options import StageOptions
from tests.render.kits.stages import T, add_mesh, new_stage, only_batch, set_primvar, world_points
from usd_schemas import FocusPoint

CUBE_POINTS = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
CUBE_CORNERS = [0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6]


def add_cube(stage: Usd.Stage, path: str = "/cube", scheme: str = "catmullClark") -> UsdGeom.Mesh:
    return add_mesh(stage, path, CUBE_POINTS, [4] * 6, CUBE_CORNERS, scheme=scheme)


def add_camera(stage: Usd.Stage, keys: dict[float, float]) -> UsdGeom.Camera:
    """A camera on the z axis, at distances by time."""
    camera = UsdGeom.Camera.Define(stage, "/camera")
    move = camera.AddTranslateOp()
    for time, distance in keys.items():
        move.Set(Gf.Vec3d(0, 0, distance), time)
    return camera


def count_triangles(scene: Scene) -> int:
    return sum(len(batch.geometry.triangles) * len(batch.poses) for batch in scene.batches)


@pytest.mark.parametrize(("complexity", "triangles"), [("low", 12), ("medium", 48), ("high", 192), ("veryhigh", 768)])
def test_each_complexity_has_its_steps(complexity: str, triangles: int) -> None:
    stage = new_stage()
    add_cube(stage)
    add_cube(stage, "/plain", "none")
    assert count_triangles(StageReader(stage, StageOptions(complexity=complexity)).read(0)) == triangles + 12


@pytest.mark.parametrize("complexity", ["low", "medium", "auto"])
def test_a_creased_cube_looks_like_a_cube(complexity: str) -> None:
    stage = new_stage()
    mesh = add_cube(stage)
    rings = np.array(CUBE_CORNERS).reshape(-1, 4)
    mesh.CreateCreaseIndicesAttr(np.column_stack([rings, rings[:, 0]]).ravel().tolist())
    mesh.CreateCreaseLengthsAttr([5] * 6)
    mesh.CreateCreaseSharpnessesAttr([10.0] * 6)
    geometry = only_batch(StageReader(stage, StageOptions(complexity=complexity)).read(0)).geometry
    corners = geometry.positions[geometry.triangles].astype(np.float64)
    facets = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facets /= np.linalg.norm(facets, axis=1, keepdims=True)
    np.testing.assert_allclose(geometry.normals[geometry.triangles], np.repeat(facets[:, None], 3, axis=1), atol=1e-5)


def test_automatic_levels_follow_the_size_on_screen() -> None:
    stage = new_stage()
    add_cube(stage)
    n = 9
    flat = np.stack([*np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), np.full((n, n), -2)], -1).reshape(-1, 3)
    first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    corners = np.stack([first, first + n, first + n + 1, first + 1], 1).ravel()
    add_mesh(stage, "/floor", flat, [4] * (n - 1) ** 2, corners, scheme="catmullClark")
    add_camera(stage, {1: 10.0, 2: 100.0, 3: 1e5})
    reader = StageReader(stage)
    counts = [count_triangles(reader.read(time, "/camera")) - 2 * (n - 1) ** 2 for time in (1.0, 2.0, 3.0)]
    assert counts[0] > counts[1] > counts[2] == 12
    assert all(count in {12 * 4**level for level in range(6)} for count in counts)
    fresh = StageReader(stage).read(1.0, "/camera")
    again = reader.read(1.0, "/camera")
    for one, other in zip(fresh.batches, again.batches, strict=True):
        np.testing.assert_array_equal(one.geometry.positions, other.geometry.positions)
    assert count_triangles(reader.read(1.0)) > 0  # without a camera


def test_edges_are_within_a_quarter_of_a_pixel() -> None:
    """The middles of the edges of a ball, whose radius is that of the limit surface, by their distance from it."""
    stage = new_stage()
    add_cube(stage)
    camera = add_camera(stage, {1: 20.0})
    geometry = only_batch(StageReader(stage).read(1.0, "/camera")).geometry
    finer = only_batch(StageReader(stage, StageOptions(complexity="veryhigh")).read(1.0)).geometry
    assert len(geometry.triangles) > len(finer.triangles)
    corners = geometry.positions[geometry.triangles].astype(np.float64)
    edges = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    radius = np.linalg.norm(geometry.positions, axis=1).max()
    px_m = (
        subdivision_levels.SCREEN_PX * camera.GetFocalLengthAttr().Get() / camera.GetHorizontalApertureAttr().Get() / 19
    )
    assert px_m * edges.max() ** 2 / (8 * radius) < 0.5  # sagitta; the surface is up to twice as bent as the ball


def test_an_edit_of_the_camera_counts_where_it_matters() -> None:
    stage = new_stage()
    add_cube(stage)
    camera = add_camera(stage, {1: 1e5})
    reader = StageReader(stage)
    assert count_triangles(reader.read(1.0, "/camera")) == 12
    camera.GetPrim().GetAttribute("xformOp:translate").Set(Gf.Vec3d(0, 0, 5), 1)
    assert count_triangles(reader.read(1.0, "/camera")) > 12


def test_instances_are_refined_for_the_nearest() -> None:
    stage = new_stage()
    instancer = UsdGeom.PointInstancer.Define(stage, "/many")
    add_cube(stage, "/many/cube")
    instancer.CreatePrototypesRel().SetTargets(["/many/cube"])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([(0, 0, 0), (0, 0, -1e6)])
    add_camera(stage, {1: 10.0})
    near = count_triangles(StageReader(stage).read(1.0, "/camera"))
    instancer.GetPositionsAttr().Set([(0, 0, -1e6), (0, 0, -1e6)])
    assert near > count_triangles(StageReader(stage).read(1.0, "/camera")) == 24


def test_subsets_and_moving_points_stay_with_their_faces() -> None:
    stage = new_stage()
    mesh = add_cube(stage)
    mesh.GetPointsAttr().Set(np.array(CUBE_POINTS, np.float32) * 2, 5)
    mesh.GetPointsAttr().Set(np.array(CUBE_POINTS, np.float32), 1)
    looks = [UsdShade.Material.Define(stage, f"/look{number}") for number in range(2)]
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(looks[0])
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "side", "face", [3], "materialBind")
    UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(looks[1])
    reader = StageReader(stage, StageOptions(complexity="medium"))
    scenes = [reader.read(time) for time in (1.0, 5.0)]
    faces = {frozenset(batch.geometry.face_ids.tolist()) for batch in scenes[0].batches}
    assert frozenset().union(*faces) == frozenset(range(6))
    sizes = [max(np.abs(world_points(batch)).max() for batch in scene.batches) for scene in scenes]
    assert sizes[1] == pytest.approx(2 * sizes[0])


def test_a_place_that_is_clicked_is_where_the_point_is() -> None:
    """Places on the triangles that are drawn, as fans of the control mesh's faces, and where focus points there are."""
    stage = new_stage()
    mesh = add_cube(stage)
    mesh.CreateCreaseIndicesAttr([0, 1])
    mesh.CreateCreaseLengthsAttr([2])
    mesh.CreateCreaseSharpnessesAttr([1.5])
    mesh.CreateOrientationAttr("leftHanded")
    set_primvar(mesh.GetPrim(), "displayColor", T.Color3fArray, "uniform", [(0.1 * i, 0, 0) for i in range(6)])
    geometry = only_batch(StageReader(stage, StageOptions(complexity="veryhigh")).read(0)).geometry
    random = np.random.default_rng(7)
    triangles, weights = random.integers(0, len(geometry.triangles), 30), random.dirichlet([1, 1, 1], 30)
    fans, shares = geometry.fan_points(triangles, weights)
    anchors = AnchorReader(stage, StageOptions(complexity="veryhigh"))
    for triangle, own, fan, share in zip(triangles, weights, fans, shares, strict=True):
        drawn = own @ geometry.positions[geometry.triangles[triangle]]
        face = int(geometry.face_ids[triangle])
        focus = FocusPoint(
            name="p", target=("/cube",), face=face, fan_triangle=int(fan), barycentric=(share[0], share[1], share[2])
        )
        np.testing.assert_allclose(anchors.position(focus, 0), drawn, atol=2e-5)


def test_bad_creases_leave_the_control_mesh() -> None:
    stage = new_stage()
    mesh = add_cube(stage)
    mesh.CreateCreaseIndicesAttr([0, 99])
    mesh.CreateCreaseLengthsAttr([2])
    mesh.CreateCreaseSharpnessesAttr([1.0])
    reader = StageReader(stage, StageOptions(complexity="high"))
    assert count_triangles(reader.read(0)) == 12
    assert any(finding.code == "subdivision" and "/cube" in finding.message for finding in reader.findings)


def test_too_many_triangles_are_refined_less(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subdivision_levels, "fitting_level", lambda corners, level: min(level, 2))
    stage = new_stage()
    add_cube(stage)
    reader = StageReader(stage, StageOptions(complexity="veryhigh"))
    assert count_triangles(reader.read(0)) == 192
    (finding,) = reader.findings
    assert (
        finding.message
        == "/cube is refined in 2 steps, not 3: it would have 768 triangles, and up to 2,000,000 are drawn"
    )


def test_all_surfaces_together_have_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subdivision_levels, "MOST_IN_ALL_AUTO", 500)
    stage = new_stage()
    for number in range(4):
        add_cube(stage, f"/cube{number}")
    add_camera(stage, {1: 10.0})
    reader = StageReader(stage)
    assert count_triangles(reader.read(1.0, "/camera")) == 4 * 48
    assert [finding.code for finding in reader.findings] == ["subdivision"]


def test_faces_that_change_over_time_are_refined_too() -> None:
    """A mesh that is empty at first, as of a simulation, and one with more faces later than its level was chosen for."""
    stage = new_stage()
    mesh = add_cube(stage)
    counts, corners = mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
    for attribute in (counts, corners):
        attribute.Clear()
        attribute.Set([], 1)
    counts.Set([4] * 6, 2)
    corners.Set(CUBE_CORNERS, 2)
    reader = StageReader(stage, StageOptions(complexity="medium"))
    assert [count_triangles(reader.read(time)) for time in (1.0, 2.0)] == [0, 48]


def test_a_level_too_fine_for_later_faces_is_lowered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(surface, "fitting_level", lambda corners, level: min(level, 1))
    stage = new_stage()
    add_cube(stage)
    assert count_triangles(StageReader(stage, StageOptions(complexity="high")).read(0)) == 48
