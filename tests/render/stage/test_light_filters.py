"""RenderMan's light filters, as stages name them and their parameters."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdLux

from render.model.light_filters import Barn, LightFilter, Ramp, Window
from render.model.scene import Light
from render.stage import StageReader, find_not_honoured
from tests.render.kits.stages import codes, new_stage, write_picture

Types = Sdf.ValueTypeNames


def filtered_stage(kind: str, **values: object) -> Usd.Stage:
    """A lamp with a filter two units in front of it; ``__`` stands for a colon in names."""
    stage = new_stage()
    light = UsdLux.SphereLight.Define(stage, "/rig/lamp")
    prim = stage.DefinePrim("/rig/filter", kind)
    UsdGeom.Xform.Define(stage, "/rig").AddTranslateOp().Set((0, 0, 5))
    prim.CreateAttribute("xformOp:translate", Types.Double3).Set((0, 0, -2))
    prim.CreateAttribute("xformOpOrder", Types.TokenArray).Set(["xformOp:translate"])
    UsdLux.LightAPI(light.GetPrim()).CreateFiltersRel().AddTarget("/rig/filter")
    for name, value in values.items():
        write(prim, name.replace("__", ":"), value)
    return stage


def write(prim: Usd.Prim, name: str, value: object) -> None:
    kinds = {bool: Types.Bool, int: Types.Int, float: Types.Float, str: Types.Token, list: Types.FloatArray}
    kind = Types.Color3fArray if isinstance(value, list) and isinstance(value[0], tuple) else kinds[type(value)]
    prim.CreateAttribute(name, kind).Set(value)


def read_light(stage: Usd.Stage) -> tuple[Light, set[str]]:
    """The light, and the codes of what was found."""
    reader = StageReader(stage)
    return reader.read(0).lights[0], codes(reader) | {finding.code for finding in find_not_honoured(stage)}


def only_filter(stage: Usd.Stage) -> LightFilter:
    light, found = read_light(stage)
    assert found == set()
    (one,) = light.filters
    return one


def test_intensity_is_multiplied() -> None:
    plain = read_light(filtered_stage("PxrIntMultLightFilter"))[0]
    light, found = read_light(
        filtered_stage("PxrIntMultLightFilter", inputs__intensity=3.0, inputs__exposure=1.0, inputs__specular=0.5)
    )
    assert (light.diffuse, light.specular) == (6.0, 3.5)
    assert light.radiance == plain.radiance
    assert found == set()
    inverted = filtered_stage("PxrIntMultLightFilter", inputs__intensity=2.0, inputs__invert=1)
    assert read_light(inverted)[0].diffuse == 0.5


@pytest.mark.parametrize(("density", "diffuse", "specular"), [(0.0, 1.0, 1.0), (0.25, 1.5, 1.25), (7.0, 3.0, 2.0)])
def test_density_is_a_share_of_the_multiplier(density: float, diffuse: float, specular: float) -> None:
    values = {"inputs__intensity": 3.0, "inputs__specular": 0.5, "inputs__density": density}
    light, found = read_light(filtered_stage("PxrIntMultLightFilter", **values))
    assert (light.diffuse, light.specular, found) == (diffuse, specular, set())


def test_saturation_keeps_the_luminance() -> None:
    stage = filtered_stage("PxrIntMultLightFilter", color__saturation=0.0)
    UsdLux.LightAPI(stage.GetPrimAtPath("/rig/lamp")).CreateColorAttr((0.0, 1.0, 0.0))
    UsdLux.LightAPI(stage.GetPrimAtPath("/rig/lamp")).CreateIntensityAttr(10.0)
    assert read_light(stage)[0].radiance == pytest.approx([7.152] * 3, rel=1e-3)


def test_a_dome_is_multiplied_too() -> None:
    stage = filtered_stage("PxrIntMultLightFilter", inputs__intensity=3.0)
    dome = UsdLux.DomeLight.Define(stage, "/sky")
    dome.GetFiltersRel().AddTarget("/rig/filter")
    reader = StageReader(stage)
    read = reader.read(0).dome
    assert read is not None
    assert (read.diffuse, read.specular) == (3.0, 3.0)
    assert read.radiance == pytest.approx((1, 1, 1))
    write(stage.GetPrimAtPath("/rig/filter"), "inputs:saturation", 0.5)
    reader.read(0)
    assert codes(reader) == {"unsupported_filter"}


def test_barn_doors_stand_where_their_prim_does() -> None:
    one = only_filter(filtered_stage("PxrBarnLightFilter", inputs__width=2.0, inputs__radius=0.0))
    np.testing.assert_allclose(one.pose[:3, 3], np.array([0, 0, 3]) * np.linalg.norm(one.pose[:3, 0]))
    assert one.shape == Barn(Window((1.0, 1.0, 0.5, 0.5)))
    assert (one.density, one.strength, one.inverted) == (1.0, 1.0, False)


@pytest.mark.parametrize(
    "names",
    [
        (
            "barnMode",
            "edgeThickness",
            "edge__left",
            "refine__right",
            "scale__height",
            "analytic__apex",
            "preBarnEffect",
        ),
        (
            *("inputs__barnMode", "inputs__edge", "inputs__leftEdge", "inputs__right", "inputs__scaleHeight"),
            *("inputs__apex", "inputs__preBarn"),
        ),
    ],
)
def test_barn_doors_have_two_sets_of_names(names: tuple[str, ...]) -> None:
    """Those of OpenUSD's schemas, and those of the shader. A side is half of width, offset and radius, all scaled."""
    values = ("analytic", 0.4, 0.5, 1.0, 2.0, 3.0, "cone")
    one = only_filter(filtered_stage("PxrBarnLightFilter", **dict(zip(names, values, strict=True))))
    assert isinstance(one.shape, Barn)
    assert (one.shape.before, one.shape.source) == ("cone", (0.0, 0.0, 3.0, 1.0))
    assert one.shape.window.sides == (0.75, 1.25, 1.5, 1.5)
    assert one.shape.window.radii == (0.25, 0.5)
    assert one.shape.window.edges == pytest.approx((0.1, 0.2, 0.4, 0.4))


def test_barn_doors_may_follow_the_light() -> None:
    values = {"inputs__barnMode": 1, "inputs__useLightDirection": 1, "inputs__preBarn": 2}
    shape = only_filter(filtered_stage("PxrBarnLightFilter", **values, inputs__apex=4.0)).shape
    assert isinstance(shape, Barn)
    assert (shape.before, shape.source) == ("none", (0.0, 0.0, 4.0, 1.0))
    shape = only_filter(filtered_stage("PxrBarnLightFilter", **values, inputs__directional=1)).shape
    assert isinstance(shape, Barn)
    assert shape.source == (0.0, 0.0, 1.0, 0.0)


def test_ramps() -> None:
    values = {"inputs__falloff_Knots": [0.0, 0.5, 1.0], "inputs__falloff_Floats": [1.0, 0.25, 0.0]}
    one = only_filter(filtered_stage("PxrRampLightFilter", **values, inputs__rampType=1, inputs__beginDist=2.0))
    assert isinstance(one.shape, Ramp)
    assert (one.shape.mode, one.shape.begin, one.shape.end) == ("linear", 2.0, 10.0)
    at = np.linspace(0, 1, len(one.shape.colors))
    np.testing.assert_allclose(one.shape.colors[:, 0], np.interp(at, [0, 0.5, 1], [1, 0.25, 0]), atol=1e-6)
    colors = {"colorRamp_Knots": [0.0, 0.5], "colorRamp_Colors": [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]}
    shape = only_filter(filtered_stage("PxrRampLightFilter", **colors, colorRamp_Interpolation="constant")).shape
    assert isinstance(shape, Ramp)
    np.testing.assert_array_equal(shape.colors[[0, -1]], [[1, 0, 0], [0, 1, 0]])


def test_a_filter_may_be_named_by_its_shader() -> None:
    stage = filtered_stage("LightFilter", ri__lightFilter__shaderId="PxrBarnLightFilter", inputs__density=0.5)
    one = only_filter(stage)
    assert one.density == 0.5
    assert one.pose[2, 3] == pytest.approx(3 * np.linalg.norm(one.pose[:3, 0]))


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("LightFilter", {}),
        ("PxrRodLightFilter", {}),
        ("PxrRampLightFilter", {}),
        ("PxrRampLightFilter", {"falloff_Floats": [1.0, 0.0], "falloff_Knots": [0.0]}),
        ("PxrRampLightFilter", {"falloff_Floats": [1.0], "falloff_Knots": [0.0], "falloff_Interpolation": "bspline"}),
        ("PxrBarnLightFilter", {"inputs__width": -5.0}),
        ("PxrBarnLightFilter", {"inputs__width": float("nan")}),
        ("PxrBarnLightFilter", {"inputs__width": "wide"}),
        ("PxrBarnLightFilter", {"inputs__barnMode": 7}),
        ("PxrBarnLightFilter", {"inputs__barnMode": 1, "inputs__shearX": 0.5}),
        ("PxrIntMultLightFilter", {"inputs__intensity": [1.0, 2.0]}),
    ],
)
def test_what_cannot_be_honoured_is_named(kind: str, values: dict[str, object]) -> None:
    light, found = read_light(filtered_stage(kind, **values))
    assert (light.filters, light.diffuse, found) == ((), 1.0, {"unsupported_filter"})


@pytest.mark.parametrize("kind", ["LightFilter", "PxrBarnLightFilter"])
def test_an_invisible_filter_is_off(kind: str) -> None:
    stage = filtered_stage(kind, visibility="invisible", lightFilter__shaderId="PxrBarnLightFilter")
    light, found = read_light(stage)
    assert (light.filters, found) == ((), set())


@pytest.mark.parametrize(("scale", "count"), [(1e-4, 1), (0.0, 0)])
def test_filters_may_be_small_but_not_flat(scale: float, count: int) -> None:
    stage = filtered_stage("PxrBarnLightFilter")
    prim = stage.GetPrimAtPath("/rig/filter")
    prim.CreateAttribute("xformOp:scale", Types.Float3).Set((scale, scale, scale))
    prim.GetAttribute("xformOpOrder").Set(["xformOp:translate", "xformOp:scale"])
    light, found = read_light(stage)
    assert len(light.filters) == count
    assert found == (set() if count else {"unsupported_filter"})


def test_settings_without_effect_are_named() -> None:
    stage = filtered_stage("PxrBarnLightFilter", inputs__saturation=0.5)
    stage.GetPrimAtPath("/rig/filter").CreateRelationship("collection:filterLink:excludes").AddTarget("/rig")
    UsdLux.LightAPI(stage.GetPrimAtPath("/rig/lamp")).GetFiltersRel().AddTarget("/gone")
    light, found = read_light(stage)
    assert len(light.filters) == 1
    assert found == {"filter_setting", "filter_link", "missing_target"}


STRONG = {"inputs__intensity": 1e9, "inputs__exposure": 30.0, "inputs__diffuse": 1e9}


@pytest.mark.parametrize("kind", ["PxrIntMultLightFilter", "PxrBarnLightFilter", "PxrRampLightFilter"])
def test_a_filter_that_is_too_strong_is_left_out(kind: str) -> None:
    light, found = read_light(filtered_stage(kind, **STRONG, falloff_Floats=[1.0], falloff_Knots=[0.0]))
    assert (light.filters, light.diffuse) == ((), 1.0)
    assert "unsupported_filter" in found


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("PxrIntMultLightFilter", {"inputs__intensity": 9e8}),
        ("PxrBarnLightFilter", {"inputs__intensity": 9e8}),
        ("PxrBarnLightFilter", {"inputs__diffuse": -9e8}),
        ("PxrRampLightFilter", {"falloff_Floats": [9e8], "falloff_Knots": [0.0], "inputs__invert": 1}),
    ],
)
@pytest.mark.parametrize("lamp", ["SphereLight", "DomeLight"])
def test_a_light_that_filters_make_too_strong_is_off(kind: str, values: dict[str, object], lamp: str) -> None:
    stage = filtered_stage(kind, **values)
    stage.GetPrimAtPath("/rig/lamp").SetTypeName(lamp)
    for number in range(3):
        path = f"/rig/filter_{number}"
        Sdf.CopySpec(stage.GetRootLayer(), "/rig/filter", stage.GetRootLayer(), path)
        UsdLux.LightAPI(stage.GetPrimAtPath("/rig/lamp")).GetFiltersRel().AddTarget(path)
    reader = StageReader(stage)
    scene = reader.read(0)
    is_placed = kind != "PxrIntMultLightFilter"
    if lamp == "DomeLight":
        assert scene.dome is not None
        assert scene.dome.diffuse == (1.0 if is_placed else 0.0)
        assert codes(reader) == {"unsupported_filter" if is_placed else "bad_light"}
    else:
        assert (scene.lights, codes(reader)) == ((), {"bad_light"})


def test_strong_filters_within_range_are_kept() -> None:
    stage = filtered_stage("PxrBarnLightFilter", inputs__intensity=1e8, inputs__diffuse=2.0)
    assert only_filter(stage).strength == 1e8


def test_saturation_of_a_textured_light_is_a_finding(tmp_path: Path) -> None:
    file = write_picture(tmp_path / "gel.exr", np.ones((2, 2, 3), np.float32))
    stage = filtered_stage("PxrIntMultLightFilter", color__saturation=0.5)
    lamp = stage.GetPrimAtPath("/rig/lamp")
    lamp.SetTypeName("RectLight")
    UsdLux.RectLight(lamp).CreateTextureFileAttr(file)
    assert read_light(stage)[1] == {"unsupported_filter"}
    stage.GetPrimAtPath("/rig/filter").GetAttribute("color:saturation").Set(1.0)
    assert read_light(stage)[1] == set()


@pytest.mark.parametrize(("expression", "found"), [("/set//", {"filter_link"}), ("", set())])
def test_a_filter_link_by_an_expression_is_a_finding(expression: str, found: set[str]) -> None:
    stage = filtered_stage("PxrBarnLightFilter")
    attribute = stage.GetPrimAtPath("/rig/filter").CreateAttribute(
        "collection:filterLink:membershipExpression", Types.PathExpression
    )
    attribute.Set(Sdf.PathExpression(expression))
    assert read_light(stage)[1] == found
