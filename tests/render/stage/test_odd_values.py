"""Values that a file may hold and no renderer can use: they are named, and the rest of the stage is drawn."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import pytest
from pxr import Sdf, Usd, UsdGeom, UsdLux, UsdRender

from render.errors import CameraError, StageError
from render.stage import StageReader, limits, list_cameras, open_stage, read_camera
from tests.render.kits.stages import T, add_mesh, codes, instancer, new_stage, only_batch, read, world_points
from usd_schemas import LensCamera, SchemaError
from usd_schemas.validation import validate


def _override(prim: Usd.Prim, name: str, kind: Sdf.ValueTypeName, value: object) -> None:
    """Author a property with a type that is not its schema's, as a file may."""
    spec = Sdf.AttributeSpec(prim.GetStage().GetRootLayer().GetPrimAtPath(prim.GetPath()), name, kind)
    spec.default = value


def _drawn(stage: Usd.Stage) -> tuple[set[str], dict[str, str]]:
    """The prims that are drawn, and the findings by path; numpy's warnings are errors."""
    reader = StageReader(stage)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = reader.read(0.0)
    shown = {scene.prim_paths[i] for batch in scene.batches for i in set(batch.geometry.prim_ids.tolist())}
    return shown, {finding.path: finding.message for finding in reader.findings}


@pytest.mark.parametrize(
    ("name", "kind", "value"),
    [
        ("focalLength", T.String, "fifty"),
        ("fStop", T.Float2, (1, 2)),
        ("focusDistance", T.TokenArray, ["a"]),
        ("clippingRange", T.Float, 1.0),
        ("clippingRange", T.String, "x"),
        ("shutter:open", T.String, "x"),
        ("exposure:iso", T.String, "x"),
    ],
)
def test_a_camera_property_of_another_type_is_named(name: str, kind: Sdf.ValueTypeName, value: object) -> None:
    stage = new_stage()
    camera = UsdGeom.Camera.Define(stage, "/cam")
    _override(camera.GetPrim(), name, kind, value)
    with pytest.raises(CameraError, match=f"{name} of camera /cam must be"):
        read_camera(stage, "/cam", 0.0)


def test_an_infinite_focus_distance_is_focus_at_infinity() -> None:
    stage = new_stage()
    UsdGeom.Camera.Define(stage, "/cam").CreateFocusDistanceAttr(math.inf)
    assert read_camera(stage, "/cam", 0.0).focus_distance_m == 0.0


def test_a_conform_policy_that_is_none_is_named_with_its_prim() -> None:
    stage = new_stage()
    UsdGeom.Camera.Define(stage, "/cam")
    UsdRender.Settings.Define(stage, "/R").CreateAspectRatioConformPolicyAttr("bogus")
    stage.SetMetadata("renderSettingsPrimPath", "/R")
    with pytest.raises(StageError, match=r"of /R must be one of .*, got bogus"):
        read_camera(stage, "/cam", 0.0)


@pytest.mark.parametrize(
    ("name", "kind", "value"),
    [
        ("points", T.String, "x"),
        ("points", T.Float, 1.0),
        ("points", T.Matrix4d, None),
        ("faceVertexCounts", T.String, "x"),
        ("faceVertexCounts", T.Float, math.inf),
        ("faceVertexCounts", T.Asset, Sdf.AssetPath("x.png")),
        ("faceVertexIndices", T.Int, -1),
        ("holeIndices", T.Float, -1.0),
    ],
)
def test_a_mesh_with_values_of_another_type_is_a_finding(name: str, kind: Sdf.ValueTypeName, value: object) -> None:
    stage = new_stage()
    add_mesh(stage, "/good")
    bad = add_mesh(stage, "/bad").GetPrim()
    bad.RemoveProperty(name)
    _override(bad, name, kind, kind.defaultValue if value is None else value)
    shown, findings = _drawn(stage)
    assert shown == {"/good"}
    assert findings["/bad"].startswith("/bad is not drawn: ")


@pytest.mark.parametrize(
    ("shape", "name", "kind", "value"),
    [
        (UsdGeom.Cylinder, "axis", T.Token, "W"),
        (UsdGeom.Sphere, "radius", T.String, "x"),
        (UsdGeom.Sphere, "radius", T.TokenArray, ["a", "b"]),
        (UsdGeom.Sphere, "radius", T.Double, 1e300),
        (UsdGeom.Cylinder, "height", T.Float, math.inf),
    ],
)
def test_an_implicit_shape_that_cannot_be_read_is_a_finding(
    shape: type, name: str, kind: Sdf.ValueTypeName, value: object
) -> None:
    stage = new_stage()
    add_mesh(stage, "/good")
    _override(shape.Define(stage, "/bad").GetPrim(), name, kind, value)
    shown, findings = _drawn(stage)
    assert shown == {"/good"}
    assert name in findings["/bad"]


@pytest.mark.parametrize(
    ("name", "kind", "value"),
    [
        ("inputs:exposure", T.Float, 2000.0),
        ("inputs:radius", T.Double, 1e300),
        ("inputs:intensity", T.String, "x"),
        ("inputs:intensity", T.Float, 1e30),
        ("inputs:intensity", T.Double, 1e300),
        ("inputs:color", T.Float, math.nan),
        ("inputs:color", T.Asset, Sdf.AssetPath("x.png")),
    ],
)
def test_a_light_that_cannot_be_read_is_off_and_the_others_shine(
    name: str, kind: Sdf.ValueTypeName, value: object
) -> None:
    stage = new_stage()
    UsdLux.SphereLight.Define(stage, "/good")
    _override(UsdLux.SphereLight.Define(stage, "/bad").GetPrim(), name, kind, value)
    assert [light.path for light in read(stage).lights] == ["/good"]
    assert _drawn(stage)[1]["/bad"].startswith("light /bad is off: ")


@pytest.mark.parametrize("name", ["target", "part"])
def test_a_focus_point_whose_target_is_an_attribute_is_named(name: str) -> None:
    stage = new_stage()
    prim = UsdGeom.Camera.Define(stage, "/cam").GetPrim()
    prim.AddAppliedSchema("FocusAPI")
    prim.AddAppliedSchema("FocusPointAPI:p")
    _override(prim, f"focusPoint:p:{name}", T.String, "x")
    with pytest.raises(SchemaError, match=rf"/cam\.focusPoint:p:{name} must be a relationship"):
        LensCamera(prim).focus_point("p").read()
    assert [p.path for p in validate(stage) if "must be a relationship" in p.message] == [f"/cam.focusPoint:p:{name}"]


def _tower(stage: Usd.Stage, levels: int, width: int) -> None:
    """Instances of instances: each level instances the one below it ``width`` times."""
    for level in range(levels):
        root = stage.CreateClassPrim(f"/_level{level}")
        if not level:
            UsdGeom.Cube.Define(stage, f"{root.GetPath()}/cube")
            continue
        for number in range(width):
            child = UsdGeom.Xform.Define(stage, f"{root.GetPath()}/i{number}").GetPrim()
            child.GetReferences().AddInternalReference(f"/_level{level - 1}")
            child.SetInstanceable(True)
    top = UsdGeom.Xform.Define(stage, "/top").GetPrim()
    top.GetReferences().AddInternalReference(f"/_level{levels - 1}")


def test_instances_that_multiply_beyond_all_time_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MAX_INSTANCED_PRIMS", 1000)
    stage = new_stage()
    _tower(stage, 9, 12)
    UsdGeom.Camera.Define(stage, "/cam")
    assert list_cameras(stage) == ["/cam"]
    add_mesh(stage, "/zzz")
    shown, findings = _drawn(stage)
    assert "/zzz" in shown
    assert findings["/"].startswith("the stage has more than 1,000 prims in instances")


def test_cameras_in_nested_instances_are_listed() -> None:
    stage = new_stage()
    _tower(stage, 3, 2)
    UsdGeom.Camera.Define(stage, "/_level0/cam")
    assert list_cameras(stage) == [f"/top/i{one}/i{two}/cam" for one in range(2) for two in range(2)]


def test_nested_instancers_beyond_all_memory_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MAX_PLACES", 8)
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/outer/inner/ball")
    instancer(stage, "/outer/inner", ["/outer/inner/ball"], [0] * 3)
    instancer(stage, "/outer", ["/outer/inner"], [0] * 3)
    add_mesh(stage, "/good")
    shown, findings = _drawn(stage)
    assert shown == {"/good"}
    assert findings["/outer/inner"].startswith("instancer /outer/inner has 9 instances")


@pytest.mark.parametrize(
    ("field", "value"), [("timeCodesPerSecond", "0"), ("startTimeCode", "nan"), ("endTimeCode", "inf")]
)
def test_rates_and_ranges_that_no_shot_can_have_are_refused(tmp_path: Path, field: str, value: str) -> None:
    file = tmp_path / "odd.usda"
    file.write_text(f"#usda 1.0\n(\n    {field} = {value}\n)\n")
    with pytest.raises(StageError, match=f"{field} of .* must be a"):
        open_stage(file)


def test_instances_of_no_prototype_are_named_and_the_others_drawn() -> None:
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/pi/ball").AddTranslateOp().Set((0, 5, 0))
    instancer(stage, "/pi", ["/pi/ball"], [0, 7, -1])
    reader = StageReader(stage)
    batch = only_batch(reader.read(0.0))
    assert batch.poses[:, :3, 3].tolist() == [[0, 5, 0]]
    assert "2 of 3 instances of /pi are not drawn" in reader.findings[0].message


def test_an_instancer_whose_arrays_differ_in_length_is_named() -> None:
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/pi/ball")
    bad = instancer(stage, "/pi", ["/pi/ball"], [0, 0])
    bad.CreateScalesAttr([(1, 1, 1)])
    shown, findings = _drawn(stage)
    assert shown == {"/pi/ball"}
    assert findings["/pi"] == "the scales of /pi are not used: there are 1 for 2 instances"
    bad.GetPositionsAttr().Set([(0, 0, 0)])
    shown, findings = _drawn(stage)
    assert shown == {"/pi/ball"}
    assert findings["/pi"] == "instancer /pi has 2 protoIndices and 1 positions: the instances that have both are drawn"


@pytest.mark.parametrize(
    ("kind", "value"), [(T.String, "x"), (T.FloatArray, [math.nan]), (T.Matrix4d, T.Matrix4d.defaultValue)]
)
def test_an_instancer_with_values_of_another_type_is_named(kind: Sdf.ValueTypeName, value: object) -> None:
    stage = new_stage()
    add_mesh(stage, "/good")
    UsdGeom.Sphere.Define(stage, "/pi/ball")
    bad = instancer(stage, "/pi", ["/pi/ball"], [0]).GetPrim()
    bad.RemoveProperty("protoIndices")
    _override(bad, "protoIndices", kind, value)
    shown, findings = _drawn(stage)
    assert shown == {"/good"}
    assert "instancer /pi is not drawn" in findings["/pi"]


def test_points_out_of_range_are_a_finding_and_no_warning() -> None:
    stage = new_stage()
    add_mesh(stage, "/good")
    add_mesh(stage, "/bad", [(0, 0, 0), (1e30, 0, 0), (1e30, 1e30, 0), (0, 1e30, 0)])
    shown, findings = _drawn(stage)
    assert shown == {"/good"}
    assert "out of range" in findings["/bad"]


def test_a_place_out_of_range_is_a_finding_and_no_warning() -> None:
    stage = new_stage()
    add_mesh(stage, "/good")
    add_mesh(stage, "/bad").AddTranslateOp().Set((1e200, 0, 0))
    shown, findings = _drawn(stage)
    assert shown == {"/good"}
    assert "out of range" in findings["/bad"]


def test_geometry_too_far_for_single_precision_is_drawn_and_named() -> None:
    stage = new_stage()
    add_mesh(stage, "/near").AddTranslateOp().Set((9e5, 0, 0))
    add_mesh(stage, "/far").AddTranslateOp().Set((4e6, 0, 0))
    shown, findings = _drawn(stage)
    assert shown == {"/near", "/far"}
    assert findings == {"/far": "/far reaches 4e+06 m from the origin: its vertices are placed to 0.25 m"}


@pytest.mark.parametrize("value", [3, "full", Sdf.AssetPath("full"), True])
def test_purposes_of_bindings_of_another_type_are_a_finding(value: object) -> None:
    stage = new_stage()
    add_mesh(stage, "/m")
    settings = UsdRender.Settings.Define(stage, "/R").GetPrim()
    kinds = {int: T.Int, str: T.String, Sdf.AssetPath: T.Asset, bool: T.Bool}
    _override(settings, "materialBindingPurposes", kinds[type(value)], value)
    stage.SetMetadata("renderSettingsPrimPath", "/R")
    shown, findings = _drawn(stage)
    assert shown == {"/m"}
    assert findings["/R"].startswith("materialBindingPurposes of /R must be a list of tokens, got ")


@pytest.mark.parametrize(
    ("name", "kind", "value"),
    [
        ("scales", T.StringArray, ["x", "y", "z"]),
        ("velocities", T.IntArray, [1, 2, 3]),
        ("orientations", T.TokenArray, ["x"]),
    ],
)
def test_a_short_instancer_with_a_list_of_another_type_is_drawn(
    name: str, kind: Sdf.ValueTypeName, value: object
) -> None:
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/pi/ball")
    bad = instancer(stage, "/pi", ["/pi/ball"], [0, 0])
    bad.GetPositionsAttr().Set([(0, 0, 0)])
    _override(bad.GetPrim(), name, kind, value)
    shown, _ = _drawn(stage)
    assert shown == {"/pi/ball"}


def test_positions_of_another_type_are_named() -> None:
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/pi/ball")
    bad = instancer(stage, "/pi", ["/pi/ball"], [0, 0])
    bad.GetPrim().RemoveProperty("positions")
    _override(bad.GetPrim(), "positions", T.String, "here")
    shown, findings = _drawn(stage)
    assert not shown
    assert "positions must be a list of points" in findings["/pi"]


@pytest.mark.parametrize("ids", [[7], [7, 8]])
def test_invisible_ids_of_a_short_list_hide_their_own_alone(ids: list[int]) -> None:
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/pi/ball")
    dots = instancer(stage, "/pi", ["/pi/ball"], [0, 0, 0])
    dots.CreateIdsAttr(ids)
    dots.CreateInvisibleIdsAttr([7])
    batch = only_batch(StageReader(stage).read(0))
    assert batch.poses[:, 0, 3].tolist() == [10, 20]


def test_procedurals_are_named() -> None:
    stage = new_stage()
    stage.DefinePrim("/grass", "GenerativeProcedural")
    _, findings = _drawn(stage)
    assert findings == {
        "/grass": "/grass is not drawn: GenerativeProcedural prims are not honoured",
    }


@pytest.mark.parametrize("axis", ["X", "rubbish", ""])
def test_an_up_axis_that_is_not_y_is_z(axis: str) -> None:
    stage, z_up = new_stage(), new_stage(up="Z")
    stage.GetPseudoRoot().SetMetadata("upAxis", axis)
    for one in (stage, z_up):
        add_mesh(one, "/m")
    reader = StageReader(stage)
    assert world_points(only_batch(reader.read(0))) == pytest.approx(world_points(only_batch(read(z_up))))
    assert codes(reader) == {"up_axis"}
