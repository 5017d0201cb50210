"""Products of a RenderSettings prim, as a stage authors them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from pxr import Gf, Sdf, Usd, UsdRender

from render.errors import SettingsError
from render.model.framing import WHOLE, Window
from render.stage.findings import FindingLog
from render.stage.own_settings import own_fields, read_own_settings
from render.stage.render_products import Product, Var, read_products
from render.stage.render_settings import RenderSettings
from tests.render.kits.stages import new_stage

T = Sdf.ValueTypeNames


def settings_with(*names: str) -> tuple[Usd.Stage, UsdRender.Settings, list[UsdRender.Product]]:
    """A stage with settings /R/s of 40 by 20 pixels, and products of these names."""
    stage = new_stage()
    settings = UsdRender.Settings.Define(stage, "/R/s")
    settings.CreateResolutionAttr(Gf.Vec2i(40, 20))
    settings.CreateCameraRel().SetTargets(["/cam"])
    products = [UsdRender.Product.Define(stage, f"/R/{name}") for name in names]
    settings.CreateProductsRel().SetTargets([product.GetPath() for product in products])
    return stage, settings, products


def read(settings: UsdRender.Settings) -> tuple[list[Product], dict[str, str]]:
    """Products, and the findings by their codes."""
    log = FindingLog()
    return read_products(RenderSettings(settings), log), {found.code: found.message for found in log.as_list()}


def test_a_product_takes_what_it_lacks_from_the_settings() -> None:
    stage, settings, (_, own) = settings_with("plain", "own")
    settings.CreateDisableMotionBlurAttr(True)
    own.CreateCameraRel().SetTargets(["/other"])
    own.CreateResolutionAttr(Gf.Vec2i(10, 10))
    own.CreateDisableMotionBlurAttr(False)
    own.CreateDisableDepthOfFieldAttr(True)
    own.CreateAspectRatioConformPolicyAttr("cropAperture")
    own.CreateProductNameAttr("shots/own.####.png")
    plain_read, own_read = read(settings)[0]
    assert (plain_read.camera_path, plain_read.width, plain_read.height) == ("/cam", 40, 20)
    assert (plain_read.file, plain_read.has_motion, plain_read.vars) == ("plain.exr", False, ())
    assert plain_read.framing == WHOLE.__class__(conform="expandAperture")
    assert (own_read.camera_path, own_read.width, own_read.height) == ("/other", 10, 10)
    assert (own_read.file, own_read.has_motion) == ("shots/own.####.png", True)
    assert own_read.framing.is_sharp
    assert own_read.framing.conform == "cropAperture"
    assert stage.GetPrimAtPath(own_read.path)


@pytest.mark.parametrize(
    ("ndc", "left", "top", "size"),
    [
        ((0.25, 0.25, 0.75, 0.5), 10, 10, (20, 5)),
        ((-0.1, 0, 1, 1.25), -4, -5, (44, 25)),
        ((0.0, 0.0, 0.0124, 1), 0, 0, None),  # left of the first pixel's centre
        ((0.0, 0.0, 0.0126, 1), 0, 0, (1, 20)),
    ],
)
def test_a_window_holds_the_pixels_whose_centres_it_holds(
    ndc: tuple[float, float, float, float], left: int, top: int, size: tuple[int, int] | None
) -> None:
    _, settings, (product,) = settings_with("p")
    product.CreateDataWindowNDCAttr(Gf.Vec4f(*ndc))
    if size is None:
        with pytest.raises(SettingsError, match="dataWindowNDC of product /R/p must be a window"):
            read(settings)
        return
    ((found,), _) = read(settings)
    assert found.framing.window == Window(left, top, 40, 20)
    assert (found.width, found.height) == size


def test_vars_are_ordered_and_those_that_cannot_be_are_left_out() -> None:
    stage, settings, (product,) = settings_with("p")
    wanted = [
        ("beauty", "Ci", "raw", "color3h", Var("beauty", "color", "half", 3)),
        ("ids", "primId", "raw", "int", Var("ids", "primId", "uint", 1)),
        ("uv", "st", "primvar", "float2", Var("uv", "primvars:st", "float", 2)),
        ("where", "Peye", "intrinsic", "point3f", Var("where", "Peye", "float", 3)),
        ("Neye", "", "raw", "normal3f", Var("Neye", "Neye", "float", 3)),
        ("bounce", "C<RD>L", "lpe", "color3f", None),
        ("mattes", "cryptoObject", "raw", "color3f", Var("cryptoObject", "cryptoObject", None, None)),
        ("again", "cryptoObject", "raw", "color3f", None),
        ("odd", "nonsense", "raw", "color3f", None),
    ]
    for name, source, kind, data_type, _ in wanted:
        var = UsdRender.Var.Define(stage, f"/R/{name}")
        var.CreateSourceNameAttr(source)
        var.CreateSourceTypeAttr(kind)
        var.CreateDataTypeAttr(data_type)
    product.CreateOrderedVarsRel().SetTargets([*(f"/R/{name}" for name, *_ in wanted), "/R/nowhere", "/R/p"])
    (found,), findings = read(settings)
    assert found.vars == tuple(var for *_, var in wanted if var)
    assert findings.keys() == {"light_path", "unknown_var", "no_var", "duplicate_var"}


def test_our_own_settings_are_those_of_settings_and_product() -> None:
    _, settings, (product,) = settings_with("p")
    prim = settings.GetPrim()
    prim.CreateAttribute("pullfocus:rays", T.Int).Set(64)
    prim.CreateAttribute("pullfocus:motionBy", T.Token).Set("velocities")
    prim.CreateAttribute("pullfocus:noise", T.Double).Set(0.01)
    prim.CreateAttribute("pullfocus:adaptive", T.Bool).Set(False)
    prim.CreateAttribute("pullfocus:ray", T.Int).Set(1)
    prim.CreateAttribute("pullfocus:layers", T.String).Set("four")
    prim.CreateAttribute("pullfocus:seed", T.Int).Set(-1)
    prim.CreateAttribute("pullfocus:connections", T.Bool).Block()
    product.GetPrim().CreateAttribute("pullfocus:rays", T.Int).Set(16)
    product.GetPrim().CreateAttribute("pullfocus:supersample", T.Int).Set(2)
    (found,), findings = read(settings)
    assert found.own == {"rays": 16, "motion_by": "velocities", "adaptive": False, "supersample": 2.0}
    assert "rays" in findings["unknown_setting"]
    assert "/R/s.pullfocus:seed is not used: seed must be from 0" in findings["bad_setting"]
    assert read_own_settings(prim, FindingLog())["noise"] == 0.01


def test_products_that_are_none_are_named_and_the_rest_is_rendered() -> None:
    stage, settings, (first, other) = settings_with("first", "other")
    other.CreateProductTypeAttr("hologram")
    settings.GetProductsRel().AddTarget("/R/nowhere")
    products, findings = read(settings)
    assert [product.path for product in products] == ["/R/first"]
    assert findings.keys() == {"product_type", "no_product"}
    assert "its productType is hologram, not raster or deepRaster" in findings["product_type"]
    stage.RemovePrim(first.GetPath())
    with pytest.raises(SettingsError, match="/R/s has no products to render"):
        read(settings)


def test_a_deep_product_has_one_colour_in_an_exr() -> None:
    stage, settings, (deep,) = settings_with("deep")
    deep.CreateProductTypeAttr("deepRaster")
    for name in ("color", "depth", "Ci"):
        UsdRender.Var.Define(stage, f"/R/{name}").CreateSourceNameAttr(name)
    deep.CreateOrderedVarsRel().SetTargets(["/R/depth", "/R/color", "/R/Ci"])
    (found,), findings = read(settings)
    assert (found.is_deep, found.file, [var.name for var in found.vars]) == (True, "deep.exr", ["color"])
    assert "var /R/Ci is left out: the deepRaster product /R/deep has one colour" in findings["deep_var"]
    deep.CreateProductNameAttr("deep.png")
    with pytest.raises(SettingsError, match="must be the name of an EXR, which a deepRaster product is"):
        read(settings)


@pytest.mark.parametrize(
    ("name", "kind", "value", "message"),
    [
        ("resolution", T.Int2, Gf.Vec2i(0, 20), "picture width must be from 1"),
        ("resolution", T.Int2, Gf.Vec2i(2**30, 20), "picture width must be from 1"),
        ("resolution", T.Float2, Gf.Vec2f(4, 4), "resolution of product /R/p must be two whole numbers"),
        ("pixelAspectRatio", T.Float, 0.0, "pixelAspectRatio of product /R/p must be a positive number"),
        ("pixelAspectRatio", T.Float, 1e30, "pixelAspectRatio of product /R/p must be a positive number up to 1e.06"),
        ("pixelAspectRatio", T.String, "wide", "pixelAspectRatio of product /R/p must be a number"),
        ("dataWindowNDC", T.Float4, Gf.Vec4f(0, 0, float("nan"), 1), "must be four finite numbers"),
        ("dataWindowNDC", T.Float4, Gf.Vec4f(0, 0, 1e9, 1), "must be four finite numbers"),
        ("dataWindowNDC", T.Float4, Gf.Vec4f(0, 0, 9999, 1), "picture width must be from 1"),
        ("disableMotionBlur", T.String, "yes", "disableMotionBlur of product /R/p must be true or false"),
    ],
)
def test_values_that_make_no_picture_are_one_clear_error(
    name: str, kind: Sdf.ValueTypeName, value: object, message: str
) -> None:
    _, settings, (product,) = settings_with("p")
    spec = Sdf.AttributeSpec(product.GetPrim().GetStage().GetRootLayer().GetPrimAtPath("/R/p"), name, kind)
    spec.default = value
    with pytest.raises(SettingsError, match=message):
        read(settings)


def test_the_guide_has_all_of_our_own_settings() -> None:
    guide = (Path(__file__).parents[3] / "docs/guide/products.md").read_text()
    assert set(re.findall(r"^\| `pullfocus:(\w+)` \|", guide, re.MULTILINE)) == set(own_fields())
