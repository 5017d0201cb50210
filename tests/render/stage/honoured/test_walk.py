"""The walk over a stage: what counts as authored, groups, prototypes, shader inputs and schemas that USD does not know."""

from __future__ import annotations

import pytest
from pxr import Sdf, Usd, UsdGeom, UsdShade, Vt

from render.stage import find_not_honoured
from tests.render.kits.stages import T, add_mesh, instancer, new_stage


def _messages(stage: Usd.Stage) -> list[str]:
    return [finding.message for finding in find_not_honoured(stage)]


def scale_blur(prim: UsdGeom.Mesh, value: float | None = 0.5) -> Usd.Attribute:
    """Author a property that is not honoured."""
    attribute = UsdGeom.MotionAPI.Apply(prim.GetPrim()).CreateMotionBlurScaleAttr()
    if value is not None:
        attribute.Set(value)
    return attribute


def test_prims_with_the_same_property_make_one_finding() -> None:
    stage = new_stage()
    for number in range(1200):
        scale_blur(add_mesh(stage, f"/m{number}"))
    (finding,) = find_not_honoured(stage)
    assert (finding.code, finding.path, finding.count) == ("not_honoured", "/m0.motion:blurScale", 1200)
    assert finding.message.startswith("motion:blurScale of /m0 and 1,199 other prims is not honoured: ")


@pytest.mark.parametrize("value", [None, 1.0, "samples"])
def test_what_says_nothing_is_not_named(value: object) -> None:
    stage = new_stage()
    attribute = scale_blur(add_mesh(stage, "/m"), None)
    if value == "samples":
        attribute.Set(0.5, 5)
        assert _messages(stage) == [
            "motion:blurScale of /m is not honoured: motion is blurred as long as the shutter is open"
        ]
        attribute.Clear()
    elif value is None:
        attribute.Block()
    else:
        attribute.Set(value)
    assert _messages(stage) == []


def test_a_value_of_another_type_is_named() -> None:
    stage = new_stage()
    UsdGeom.MotionAPI.Apply(add_mesh(stage, "/m").GetPrim())
    spec = Sdf.AttributeSpec(stage.GetRootLayer().GetPrimAtPath("/m"), "motion:blurScale", T.Token)
    spec.default = "much"
    assert len(_messages(stage)) == 1


def test_a_prototype_counts_once_under_its_first_instance() -> None:
    stage = new_stage()
    scale_blur(add_mesh(stage, "/class/leaf/mesh"))
    stage.GetPrimAtPath("/class").SetSpecifier(Sdf.SpecifierClass)
    for tree in ("/class/tree/a", "/class/tree/b"):
        prim = stage.DefinePrim(tree)
        prim.GetReferences().AddInternalReference("/class/leaf")
        prim.SetInstanceable(True)
    for tree in ("/one", "/two", "/three"):
        prim = stage.DefinePrim(tree)
        prim.GetReferences().AddInternalReference("/class/tree")
        prim.SetInstanceable(True)
    (finding,) = find_not_honoured(stage)
    assert finding.count == 1
    assert stage.GetPrimAtPath(finding.path.partition(".")[0]).IsInstanceProxy()


def test_prototypes_of_an_instancer_that_are_overs_count() -> None:
    stage = new_stage()
    scale_blur(add_mesh(stage, "/pi/protos/ball"))
    stage.GetPrimAtPath("/pi/protos").SetSpecifier(Sdf.SpecifierOver)
    instancer(stage, "/pi", ["/pi/protos/ball"], [0, 0])
    assert [finding.path for finding in find_not_honoured(stage)] == ["/pi/protos/ball.motion:blurScale"]


def test_inactive_prims_and_properties_of_no_schema_do_not_count() -> None:
    stage = new_stage()
    prim = add_mesh(stage, "/m").GetPrim()
    prim.CreateAttribute("studio:version", T.Int).Set(3)
    prim.CreateAttribute("primvars:mask", T.Float).Set(1.0)
    inactive = add_mesh(stage, "/n")
    scale_blur(inactive)
    inactive.GetPrim().SetActive(False)
    assert _messages(stage) == []


def test_types_and_schemas_that_usd_does_not_know_are_named() -> None:
    stage = new_stage()
    UsdGeom.Xform.Define(stage, "/a").GetPrim().AddAppliedSchema("StudioAPI")
    stage.DefinePrim("/b", "StudioPrim")
    stage.DefinePrim("/c", "StudioPrim")
    assert {(finding.code, finding.message) for finding in find_not_honoured(stage)} == {
        ("unknown_schema", "schema StudioAPI of /a is not known"),
        ("unknown_schema", "type StudioPrim of /b and 1 other prim is not known"),
    }


def test_an_unknown_type_with_a_known_fallback_is_that_type() -> None:
    stage = new_stage()
    stage.SetMetadata("fallbackPrimTypes", {"StudioMesh": Vt.TokenArray(["Mesh"])})
    stage = Usd.Stage.Open(stage.GetRootLayer())
    prim = stage.DefinePrim("/m", "StudioMesh")
    scale_blur(UsdGeom.Mesh(prim))
    assert [finding.path for finding in find_not_honoured(stage)] == ["/m.motion:blurScale"]


@pytest.mark.parametrize(
    ("node", "name", "kind", "value", "named"),
    [
        ("UsdPreviewSurface", "opacityMode", T.Token, "presence", False),
        ("UsdPreviewSurface", "displacement", T.Float, 0.5, False),
        ("UsdPreviewSurface", "roughness", T.Float, 0.1, False),
        ("UsdPrimvarReader_float2", "fallback", T.Float2, (1, 1), False),
        ("UsdPrimvarReader_float3", "fallback", T.Float3, (1, 1, 1), False),
    ],
)
def test_shader_inputs_that_are_not_honoured_are_named(
    node: str, name: str, kind: Sdf.ValueTypeName, value: object, named: bool
) -> None:
    stage = new_stage()
    shader = UsdShade.Shader.Define(stage, "/s")
    shader.CreateIdAttr(node)
    shader.CreateInput(name, kind).Set(value)
    assert [finding.path for finding in find_not_honoured(stage)] == ([f"/s.inputs:{name}"] if named else [])


def test_the_displacement_of_a_preview_surface_is_its_input() -> None:
    stage = new_stage()
    material = UsdShade.Material.Define(stage, "/m")
    shader = UsdShade.Shader.Define(stage, "/m/s")
    shader.CreateIdAttr("UsdPreviewSurface")
    material.CreateDisplacementOutput().ConnectToSource(shader.CreateOutput("displacement", T.Token))
    assert _messages(stage) == []
    shader.GetIdAttr().Set("ND_displacement_float")
    assert _messages(stage) == ["outputs:displacement of /m is not honoured: that of UsdPreviewSurface alone is"]
