"""Levels of detail (UsdLod): of each root the one level is drawn that an override, a heuristic or the default names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLod, UsdLux

from render.frame import FrameRenderer, FrameSettings
from render.model.scene import Scene
from render.pictures.picture import make_picture
from render.shot import Shot
from render.stage import StageReader, find_not_honoured
from tests.render.kits.stages import add_mesh, new_stage


def house(count: int = 4, path: str = "/house", unit: float = 1.0) -> Usd.Stage:
    """A root of levels ``l0``, ``l1`` and so on, without heuristics, at the origin, and a camera ``/cam`` that looks at it."""
    stage = new_stage(unit)
    add_root(stage, path, count)
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, 5))
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.01, 1e6))
    return stage


def add_root(stage: Usd.Stage, path: str, count: int) -> UsdLod.RootAPI:
    UsdGeom.Xform.Define(stage, path)
    for level in range(count):
        add_mesh(stage, f"{path}/l{level}")
    return UsdLod.RootAPI.Apply(stage.GetPrimAtPath(path))


def add_distances(
    stage: Usd.Stage, root: str, thresholds: Sequence[float], **attributes: object
) -> UsdLod.DistanceHeuristic:
    heuristic = UsdLod.DistanceHeuristic.Define(stage, f"/by_distance{len(stage.GetRootLayer().rootPrims)}")
    heuristic.CreateLodDomainAttr("imaging")
    heuristic.CreateThresholdsAttr(thresholds)
    for name, value in attributes.items():
        heuristic.GetPrim().GetAttribute(name).Set(value)
    UsdLod.RootAPI(stage.GetPrimAtPath(root)).CreateLodHeuristicsRel().AddTarget(heuristic.GetPath())
    return heuristic


def add_sizes(stage: Usd.Stage, root: str) -> UsdLod.ScreenSizeHeuristic:
    heuristic = UsdLod.ScreenSizeHeuristic.Define(stage, "/by_size")
    heuristic.CreateLodDomainAttr("imaging")
    heuristic.CreateThresholdsAttr([0.25, 0.1, 0.025])
    heuristic.CreateExtentAttr([(-1, -1, 0), (1, 1, 0)])
    UsdLod.RootAPI(stage.GetPrimAtPath(root)).CreateLodHeuristicsRel().SetTargets([heuristic.GetPath()])
    return heuristic


def move_camera(stage: Usd.Stage, *place: float) -> None:
    UsdGeom.XformCommonAPI(stage.GetPrimAtPath("/cam")).SetTranslate(Gf.Vec3d(*place))


def drawn(scene: Scene) -> list[str]:
    """Paths of the drawn prims, each as often as it is drawn, without their common root."""
    found = []
    for batch in scene.batches:
        ids = batch.instance_prim_ids
        if ids is None:
            ids = np.array([*dict.fromkeys(batch.geometry.prim_ids.tolist())])
        found += [scene.prim_paths[number] for number in ids]
    return sorted(found)


def shown(stage: Usd.Stage, camera: str = "/cam", time: float = 0) -> list[str]:
    return [path.rpartition("/")[2] for path in drawn(StageReader(stage).read(time, camera))]


@pytest.mark.parametrize(
    ("distance", "level"), [(5, 0), (9.9, 0), (10, 1), (49, 1), (50, 2), (99, 2), (100, 3), (1e4, 3)]
)
@pytest.mark.parametrize("unit", [1.0, 0.01])
def test_distances_in_scene_units_choose_the_level(distance: float, level: int, unit: float) -> None:
    stage = house(unit=unit)
    add_distances(stage, "/house", [10, 50, 100])
    move_camera(stage, 0, 0, distance)
    assert shown(stage) == [f"l{level}"]


def test_a_centre_and_a_volume_are_in_the_space_of_the_root() -> None:
    stage = house(2)
    UsdGeom.XformCommonAPI(stage.GetPrimAtPath("/house")).SetScale(Gf.Vec3f(2, 2, 2))
    heuristic = add_distances(stage, "/house", [10], center=Gf.Vec3f(0, 0, -3))
    move_camera(stage, 0, 0, 3)
    assert shown(stage) == ["l0"]
    move_camera(stage, 0, 0, 5)
    assert shown(stage) == ["l1"]
    box = UsdGeom.Cube.Define(stage, "/box")
    box.CreateExtentAttr([(-1, -1, -1), (1, 1, 1)])
    box.CreateVisibilityAttr("invisible")
    heuristic.CreateBoundingVolumeRel().SetTargets([box.GetPath()])
    move_camera(stage, 0, 0, 11.9)
    assert shown(stage) == ["l0"]
    move_camera(stage, 0, 0, 12.1)
    assert shown(stage) == ["l1"]


@pytest.mark.parametrize(("distance", "level"), [(11, 0), (14.9, 0), (15.1, 1), (25, 1)])
def test_of_two_levels_that_blend_the_nearer_is_drawn(distance: float, level: int) -> None:
    stage = house(2)
    add_distances(stage, "/house", [10], blendThresholds=[20.0])
    move_camera(stage, 0, 0, distance)
    assert shown(stage) == [f"l{level}"]


@pytest.mark.parametrize("method", ["projectedSphere", "projectedExtent"])
@pytest.mark.parametrize(("size", "level"), [(0.3, 0), (0.2, 1), (0.05, 2), (0.01, 3)])
def test_the_share_of_the_picture_chooses_the_level(method: str, size: float, level: int) -> None:
    stage = house()
    add_sizes(stage, "/house").CreateProjectionMethodAttr(method)
    camera = UsdGeom.Camera(stage.GetPrimAtPath("/cam"))
    gate = camera.GetHorizontalApertureAttr().Get() * camera.GetVerticalApertureAttr().Get()
    area = 2 * math.pi if method == "projectedSphere" else 4.0  # of the ball around the square, or of the square itself
    move_camera(stage, 0, 0, camera.GetFocalLengthAttr().Get() * math.sqrt(area / (gate * size)))
    assert shown(stage) == [f"l{level}"]


def test_without_a_camera_or_a_heuristic_the_default_is_drawn() -> None:
    stage = house()
    root = UsdLod.RootAPI(stage.GetPrimAtPath("/house"))
    assert shown(stage) == ["l0"]
    root.CreateLodDefaultIndexAttr(2)
    assert shown(stage) == ["l2"]
    add_distances(stage, "/house", [10])
    assert shown(stage) == ["l0"]
    assert shown(stage, camera="") == ["l2"]


@pytest.mark.parametrize(
    ("mode", "index", "expected"),
    [
        ("noOverride", 3, ["l1"]),
        ("indexedLOD", 3, ["l3"]),
        ("indexedLOD", 1.6, ["l2"]),
        ("indexedLOD", -7, ["l0"]),
        ("indexedLOD", 99, ["l3"]),
        ("indexedLOD", math.nan, ["l1"]),
        ("noLOD", 0, []),
        ("allLOD", 0, ["l0", "l1", "l2", "l3"]),
        ("rubbish", 0, ["l1"]),
    ],
)
def test_overrides_come_first(mode: str, index: float, expected: list[str]) -> None:
    stage = house(path="/town/house")
    add_distances(stage, "/town/house", [1])
    override = UsdLod.OverrideAPI.Apply(stage.GetPrimAtPath("/town"))
    override.CreateLodOverrideModeAttr(mode)
    override.CreateLodOverrideIndexAttr(index)
    assert shown(stage) == expected


def test_roots_within_levels_are_obeyed_together() -> None:
    stage = house(2)
    add_root(stage, "/house/l0/door", 2)
    add_distances(stage, "/house", [10])
    add_distances(stage, "/house/l0/door", [6])
    seen = []
    for distance in (5, 7, 20):
        move_camera(stage, 0, 0, distance)
        seen.append(drawn(StageReader(stage).read(0, "/cam")))
    assert seen == [["/house/l0", "/house/l0/door/l0"], ["/house/l0", "/house/l0/door/l1"], ["/house/l1"]]


def test_native_instances_have_levels_of_their_own() -> None:
    stage = house(2, path="/class/tree")
    add_distances(stage, "/class/tree", [10])
    stage.GetPrimAtPath("/class").SetSpecifier(Sdf.SpecifierClass)
    for name, depth in (("near", 0), ("far", -40), ("farther", -60)):
        tree = UsdGeom.Xform.Define(stage, f"/{name}")
        tree.GetPrim().GetReferences().AddInternalReference("/class")
        tree.GetPrim().SetInstanceable(True)
        UsdGeom.XformCommonAPI(tree).SetTranslate(Gf.Vec3d(0, 0, depth))
    assert drawn(StageReader(stage).read(0, "/cam")) == ["/far/tree/l1", "/farther/tree/l1", "/near/tree/l0"]


def test_instances_of_an_instancer_have_levels_of_their_own() -> None:
    stage = house(2, path="/many/prototypes/tree")
    add_distances(stage, "/many/prototypes/tree", [10, 50])
    many = UsdGeom.PointInstancer.Define(stage, "/many")
    many.CreatePrototypesRel().SetTargets(["/many/prototypes/tree"])
    many.CreateProtoIndicesAttr([0, 0, 0])
    many.CreatePositionsAttr([Gf.Vec3f(0, 0, z) for z in (0, -20, 2)])
    colors = UsdGeom.PrimvarsAPI(many).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, "vertex")
    colors.Set([(1, 0, 0), (0, 1, 0), (0, 0, 1)])
    scene = StageReader(stage).read(0, "/cam")
    found = {scene.prim_paths[batch.geometry.prim_ids[0]]: batch for batch in scene.batches}
    near, far = found["/many/prototypes/tree/l0"], found["/many/prototypes/tree/l1"]
    assert near.instance_numbers is not None
    assert far.instance_numbers is not None
    assert (near.instance_numbers.tolist(), far.instance_numbers.tolist()) == ([0, 2], [1])
    assert near.poses[:, 2, 3].tolist() == [0, 2]
    assert near.instance_colors is not None
    assert near.instance_colors[:, :3].argmax(axis=1).tolist() == [0, 2]


def test_lights_of_other_levels_are_off() -> None:
    stage = house(2)
    for level in range(2):
        UsdLux.SphereLight.Define(stage, f"/house/l{level}/lamp")
    add_distances(stage, "/house", [10])
    reader = StageReader(stage)
    assert [light.path for light in reader.read(0, "/cam").lights] == ["/house/l0/lamp"]
    move_camera(stage, 0, 0, 20)
    assert [light.path for light in reader.read(0, "/cam").lights] == ["/house/l1/lamp"]


UNUSABLE: dict[str, tuple[str | None, dict[str, object], str]] = {
    "no prim": (None, {}, "is missing"),
    "another type": ("Xform", {}, "is Xform"),
    "no domain": ("LODDistanceHeuristic", {"thresholds": [1.0]}, "there is none"),
    "falling distances": (
        "LODDistanceHeuristic",
        {"lod:domain": "imaging", "thresholds": [3.0, 1.0]},
        "ascending order",
    ),
    "no number": ("LODDistanceHeuristic", {"lod:domain": "imaging", "thresholds": [math.nan]}, "finite numbers"),
    "rising sizes": ("LODScreenSizeHeuristic", {"lod:domain": "imaging", "thresholds": [0.1, 0.3]}, "descending order"),
    "unknown": (
        "LODScreenSizeHeuristic",
        {"lod:domain": "imaging", "projectionMethod": "guess"},
        "projectionMethod 'guess'",
    ),
    "extent not a number": (
        "LODScreenSizeHeuristic",
        {"lod:domain": "imaging", "extent": [(math.nan, 0, 0), (1, 1, 1)]},
        "must be finite numbers",
    ),
    "center not a number": (
        "LODDistanceHeuristic",
        {"lod:domain": "imaging", "thresholds": [1.0], "center": (math.nan, 0, 0)},
        "center must be finite numbers",
    ),
    "no extent": ("LODScreenSizeHeuristic", {"lod:domain": "imaging", "extent": []}, "must be two corners"),
}


@pytest.mark.parametrize("case", UNUSABLE)
def test_a_heuristic_that_cannot_be_used_is_named(case: str) -> None:
    kind, attributes, fault = UNUSABLE[case]
    stage = house()
    root = UsdLod.RootAPI(stage.GetPrimAtPath("/house"))
    root.CreateLodHeuristicsRel().SetTargets(["/heuristic"])
    root.CreateLodDefaultIndexAttr(1)
    if kind is not None:
        prim = stage.DefinePrim("/heuristic", kind)
        for name, value in attributes.items():
            prim.GetAttribute(name).Set(value)
    reader = StageReader(stage)
    assert [path[-2:] for path in drawn(reader.read(0, "/cam"))] == ["l1"]
    (finding,) = reader.findings
    assert (finding.code, finding.path) == ("level_of_detail", "/heuristic")
    assert fault in finding.message


def test_an_extent_of_another_type_is_named() -> None:
    stage = house()
    add_sizes(stage, "/house").GetPrim().RemoveProperty("extent")
    prim = stage.GetRootLayer().GetPrimAtPath("/by_size")
    Sdf.AttributeSpec(prim, "extent", Sdf.ValueTypeNames.String).default = "x"
    reader = StageReader(stage)
    reader.read(0, "/cam")
    assert "its extent must be two corners" in reader.findings[0].message


@pytest.mark.parametrize(
    ("blends", "volume"), [([20.0], None), ([20.0, math.nan], None), ([], "/nowhere"), ([], "/house")]
)
def test_what_a_heuristic_passes_over_is_named(blends: list[float], volume: str | None) -> None:
    stage = house()
    heuristic = add_distances(stage, "/house", [4, 50], blendThresholds=blends)
    heuristic.CreateBoundingVolumeRel().SetTargets([volume] if volume else [])
    reader = StageReader(stage)
    assert len(drawn(reader.read(0, "/cam"))) == 1
    (finding,) = reader.findings
    assert (finding.code, finding.path) == ("level_of_detail", str(heuristic.GetPath()))
    assert (f"got {volume}" if volume else "blendThresholds must be 2 finite numbers") in finding.message


@pytest.mark.parametrize("focal_length", [0.0, -1.0, math.nan])
def test_a_camera_without_focal_length_shows_the_default(focal_length: float) -> None:
    stage = house()
    add_sizes(stage, "/house")
    UsdLod.RootAPI(stage.GetPrimAtPath("/house")).CreateLodDefaultIndexAttr(3)
    UsdGeom.Camera(stage.GetPrimAtPath("/cam")).CreateFocalLengthAttr(focal_length)
    reader = StageReader(stage)
    assert [path[-2:] for path in drawn(reader.read(0, "/cam"))] == ["l3"]
    assert "is not used for /cam: the focalLength of the camera must be" in reader.findings[0].message


def test_heuristics_of_other_domains_are_passed_over() -> None:
    stage = house()
    add_distances(stage, "/house", [1, 2]).GetLodDomainAttr().Set("audio")
    add_distances(stage, "/house", [1])
    reader = StageReader(stage)
    assert [path[-2:] for path in drawn(reader.read(0, "/cam"))] == ["l1"]
    assert reader.findings == []
    assert find_not_honoured(stage) == []


def test_a_default_that_there_is_not_is_named() -> None:
    stage = house()
    UsdLod.RootAPI(stage.GetPrimAtPath("/house")).CreateLodDefaultIndexAttr(9)
    reader = StageReader(stage)
    assert [path[-2:] for path in drawn(reader.read(0))] == ["l3"]
    assert "lod:default:index of /house must be from 0 to 3, got 9" in reader.findings[0].message


def test_levels_follow_the_camera_and_are_else_the_same_objects() -> None:
    stage = house(2)
    add_mesh(stage, "/ground")
    add_distances(stage, "/house", [10])
    place = UsdGeom.Xformable(stage.GetPrimAtPath("/cam")).GetOrderedXformOps()[0]
    for time, distance in ((1, 5.0), (2, 6.0), (3, 30.0)):
        place.Set(Gf.Vec3d(0, 0, distance), time)
    reader = StageReader(stage)
    scenes = [reader.read(time, "/cam") for time in (1, 2, 3)]
    assert [drawn(scene) for scene in scenes] == [["/ground", "/house/l0"]] * 2 + [["/ground", "/house/l1"]]
    assert scenes[1].batches == scenes[0].batches
    last = reader.read(3, "/cam")
    assert last is scenes[2]
    UsdGeom.Camera.Define(stage, "/close")
    close = reader.read(3, "/close")
    assert drawn(close) == ["/ground", "/house/l0"]
    place.Set(Gf.Vec3d(0, 0, 7), 3)
    assert drawn(reader.read(3, "/cam")) == ["/ground", "/house/l0"]


def test_an_edit_that_changes_no_level_keeps_the_scene() -> None:
    stage = house(2)
    add_distances(stage, "/house", [10])
    camera = UsdGeom.Camera(stage.GetPrimAtPath("/cam"))
    reader = StageReader(stage)
    first, count = reader.read(0, "/cam"), reader.changes
    for distance in (3.0, 4.0):
        camera.CreateFocusDistanceAttr(distance)
        assert reader.read(0, "/cam") is first
    assert reader.changes == count
    move_camera(stage, 0, 0, 6)
    assert reader.read(0, "/cam") is first
    move_camera(stage, 0, 0, 20)
    assert drawn(reader.read(0, "/cam")) == ["/house/l1"]
    assert reader.changes > count


@pytest.mark.gl
def test_a_picture_shows_the_level_for_its_camera(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = house(2)
    add_distances(stage, "/house", [10])
    for level, color in enumerate([(1, 0, 0), (0, 0, 1)]):
        UsdGeom.Gprim(stage.GetPrimAtPath(f"/house/l{level}")).CreateDisplayColorAttr([color])
    for name, distance in (("near", 3), ("far", 12)):
        camera = UsdGeom.Camera.Define(stage, f"/{name}")
        camera.AddTranslateOp().Set(Gf.Vec3d(0.5, 0.5, distance))
        camera.CreateClippingRangeAttr(Gf.Vec2f(0.01, 100))
        camera.CreateShutterOpenAttr(-0.25)
        camera.CreateShutterCloseAttr(0.25)
    stage.Export(f"{tmp_path}/shot.usda")
    shot = Shot.open(f"{tmp_path}/shot.usda")
    for motion_by, motion in (("moments", 1), ("moments", 2), ("velocities", 2)):
        settings = FrameSettings(48, 36, rays=4, supersample=1, shading="unlit", motion=motion, motion_by=motion_by)
        near, far = (
            make_picture(renderer, shot, f"/{name}", 0, settings).frame.color[18, 24] for name in ("near", "far")
        )
        assert near[0] > 4 * near[2]
        assert far[2] > 4 * far[0]
