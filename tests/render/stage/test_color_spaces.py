"""Colours are converted from the space that their attribute, prim, ancestor or file names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from pxr import Gf, Usd, UsdGeom, UsdLux, UsdShade

from render import colour
from render.model.arrays import FloatArray
from render.stage import StageReader, find_not_honoured
from render.stage.color_spaces import RgbSpace, from_chromaticities
from tests.render.kits.stages import (
    T,
    add_material,
    add_mesh,
    add_textured_material,
    bind,
    codes,
    instancer,
    new_stage,
    only_batch,
    read,
    set_primvar,
    write_picture,
)

AP1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
RGB = (0.8, 0.3, 0.1)
REC709 = Gf.ColorSpace(Gf.ColorSpaceNames.LinearRec709)


def expected(space: Gf.ColorSpace, rgb: tuple[float, ...] = RGB) -> tuple[float, ...]:
    """A colour in the working space, by USD's own conversion to linear Rec. 709."""
    linear = REC709.Convert(space, Gf.Vec3f(*rgb)).GetRGB()
    return colour.rgb_to_working((linear[0], linear[1], linear[2]))


def painted(stage: Usd.Stage) -> Usd.Attribute:
    """The diffuse colour of a square's material, at /looks/a."""
    shader = add_material(stage, "/looks/a", diffuseColor=Gf.Vec3f(*RGB))
    bind(add_mesh(stage, "/m").GetPrim(), "/looks/a")
    return shader.GetInput("diffuseColor").GetAttr()


def define(prim: Usd.Prim, name: str = "studio") -> Gf.ColorSpace:
    """Define a colour space with a transfer function on a prim."""
    numbers = [Gf.Vec2f(*pair) for pair in ((0.7, 0.3), (0.2, 0.7), (0.15, 0.05), (0.3127, 0.329))]
    definition = Usd.ColorSpaceDefinitionAPI.Apply(prim, name)
    definition.CreateNameAttr(name)
    definition.CreateColorSpaceAttrsWithChroma(*numbers, 2.0, 0.055)
    return Gf.ColorSpace(name, *numbers, 2.0, 0.055)


def name_space(prim: Usd.Prim, name: str) -> None:
    Usd.ColorSpaceAPI.Apply(prim).CreateColorSpaceNameAttr(name)


@pytest.mark.parametrize("name", ["srgb_ap1_scene", "g22_adobergb_scene", "lin_ap0_scene", "g18_rec709_scene"])
def test_a_space_by_its_numbers_converts_as_gf_does(name: str) -> None:
    space = Gf.ColorSpace(name)
    values = np.random.default_rng(2).random((20, 4), np.float32)
    got = RgbSpace.of(space).linearise(values)
    wanted = [REC709.Convert(space, Gf.Vec3f(*row[:3].tolist())).GetRGB() for row in values]
    np.testing.assert_allclose(got[:, :3], wanted, atol=1e-5)
    assert (got[:, 3] == values[:, 3]).all()


def test_an_attributes_own_space_counts_first() -> None:
    stage = new_stage()
    attribute = painted(stage)
    name_space(stage.GetPrimAtPath("/looks"), "lin_ap0_scene")
    attribute.SetColorSpace("srgb_rec709_scene")
    np.testing.assert_allclose(
        only_batch(read(stage)).material.base_color, expected(Gf.ColorSpace("srgb_rec709_scene")), atol=1e-4
    )


def test_the_nearest_prim_above_names_the_space() -> None:
    stage = new_stage()
    painted(stage)
    name_space(stage.GetPrimAtPath("/looks"), "lin_ap0_scene")
    name_space(stage.GetPrimAtPath("/looks/a"), "lin_rec2020_scene")
    got = only_batch(read(stage)).material.base_color
    np.testing.assert_allclose(got, expected(Gf.ColorSpace("lin_rec2020_scene")), atol=1e-4)
    assert find_not_honoured(stage) == []


def test_a_defined_space_is_used_below_its_definition() -> None:
    stage = new_stage()
    painted(stage)
    space = define(stage.GetPrimAtPath("/looks"))
    name_space(stage.GetPrimAtPath("/looks/a"), "studio")
    np.testing.assert_allclose(only_batch(read(stage)).material.base_color, expected(space), atol=1e-5)
    assert find_not_honoured(stage) == []


def test_a_space_of_the_interface_counts() -> None:
    """The colour is authored on the material, whose own attribute names its space."""
    stage = new_stage()
    painted(stage)
    interface = UsdShade.Material(stage.GetPrimAtPath("/looks/a")).CreateInput("tint", T.Color3f)
    interface.Set(Gf.Vec3f(*RGB))
    interface.GetAttr().SetColorSpace("lin_ap1_scene")
    UsdShade.Shader(stage.GetPrimAtPath("/looks/a/surface")).GetInput("diffuseColor").ConnectToSource(interface)
    got = only_batch(read(stage)).material.base_color
    np.testing.assert_allclose(got, expected(Gf.ColorSpace("lin_ap1_scene")), atol=1e-4)


def test_a_space_that_is_not_known_is_named() -> None:
    stage = new_stage()
    painted(stage).SetColorSpace("no_such_space")
    reader = StageReader(stage)
    np.testing.assert_allclose(only_batch(reader.read(0)).material.base_color, colour.rgb_to_working(RGB), rtol=1e-5)
    (finding,) = reader.findings
    assert finding.code == "unknown_color_space"
    assert "no_such_space" in finding.message


@pytest.mark.parametrize("name", ["raw", "data", "unknown", "identity", "lin_rec709_scene"])
def test_unmanaged_colours_are_linear_rec_709(name: str) -> None:
    stage = new_stage()
    painted(stage).SetColorSpace(name)
    np.testing.assert_allclose(only_batch(read(stage)).material.base_color, colour.rgb_to_working(RGB), rtol=1e-5)


def test_display_colours_have_a_space() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/world/m").GetPrim()
    set_primvar(mesh, "displayColor", T.Color3fArray, "constant", [RGB])
    name_space(stage.GetPrimAtPath("/world"), "lin_ap1_scene")
    colors = only_batch(read(stage)).geometry.colors
    assert colors is not None
    np.testing.assert_allclose(colors[0, :3], expected(Gf.ColorSpace("lin_ap1_scene")), atol=1e-4)


def test_colours_of_instancers_have_a_space() -> None:
    stage = new_stage()
    add_mesh(stage, "/i/proto")
    prim = instancer(stage, "/i", ["/i/proto"], [0, 0]).GetPrim()
    set_primvar(prim, "displayColor", T.Color3fArray, "vertex", [RGB, (0, 0, 1)])
    prim.GetAttribute("primvars:displayColor").SetColorSpace("lin_ap1_scene")
    colors = only_batch(read(stage)).instance_colors
    assert colors is not None
    np.testing.assert_allclose(colors[0, :3], expected(Gf.ColorSpace("lin_ap1_scene")), atol=1e-4)


def test_a_lights_colour_has_a_space() -> None:
    stage = new_stage()
    light = UsdLux.DistantLight.Define(stage, "/sun")
    light.CreateColorAttr(Gf.Vec3f(*RGB))
    light.CreateIntensityAttr(2.0)
    light.CreateNormalizeAttr(True)
    light.GetColorAttr().SetColorSpace("lin_ap1_scene")
    UsdGeom.Xform.Define(stage, "/w")
    (sun,) = read(stage).lights
    np.testing.assert_allclose(sun.radiance, 2 * np.array(expected(Gf.ColorSpace("lin_ap1_scene"))), atol=1e-4)


def _exr(**attributes: object) -> Callable[[Path], str]:
    def write(folder: Path) -> str:
        output = oiio.ImageOutput.create(str(folder / "t.exr"))
        assert output is not None
        spec = oiio.ImageSpec(1, 1, 3, "float")
        for name, value in attributes.items():
            kind = (oiio.TypeDesc("float[8]"),) if isinstance(value, tuple) else ()
            spec.attribute(name, *kind, value)
        assert output.open(str(folder / "t.exr"), spec)
        assert output.write_image(np.array([[RGB]], np.float32))
        output.close()
        return str(folder / "t.exr")

    return write


def texel(stage: Usd.Stage) -> FloatArray:
    return only_batch(read(stage)).material.lookups["base_color"].image.pixels[0, 0, :3].astype(np.float32)


@pytest.mark.parametrize(
    ("write", "space"),
    [
        (_exr(chromaticities=AP1), Gf.ColorSpace("lin_ap1_scene")),
        (_exr(colorInteropID="lin_ap1_scene"), Gf.ColorSpace("lin_ap1_scene")),
        (_exr(colorInteropID="srgb_rec709_scene"), Gf.ColorSpace("srgb_rec709_scene")),
        (_exr(colorInteropID="no_such_space"), REC709),
        (_exr(), REC709),
    ],
)
def test_a_files_own_space_counts_for_its_colours(
    tmp_path: Path, write: Callable[[Path], str], space: Gf.ColorSpace
) -> None:
    stage = new_stage()
    texture = add_textured_material(stage, add_mesh(stage, "/m").GetPrim(), write(tmp_path))
    np.testing.assert_allclose(texel(stage), expected(space), rtol=3e-3, atol=1e-3)
    texture.CreateInput("sourceColorSpace", T.Token).Set("raw")
    np.testing.assert_allclose(texel(stage), expected(REC709), rtol=3e-3)


def test_a_texture_may_be_of_a_defined_space(tmp_path: Path) -> None:
    stage = new_stage()
    file = write_picture(tmp_path / "t.exr", np.array([[RGB]], np.float32))
    texture = add_textured_material(stage, add_mesh(stage, "/m").GetPrim(), file)
    space = define(stage.GetPrimAtPath("/looks"))
    texture.GetInput("file").GetAttr().SetColorSpace("studio")
    np.testing.assert_allclose(texel(stage), expected(space), rtol=3e-3, atol=1e-3)


def test_chromaticities_that_span_no_colours_are_none() -> None:
    assert from_chromaticities("flat", (0.3, 0.3) * 4) is None
    assert from_chromaticities("odd", (*AP1[:7], float("nan"))) is None
    assert from_chromaticities("ap1", AP1) is not None


def test_a_stage_without_spaces_has_no_findings() -> None:
    stage = new_stage()
    painted(stage)
    reader = StageReader(stage)
    reader.read(0)
    assert codes(reader) == set()
