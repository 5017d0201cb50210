"""Whatever is authored survives .usda, .usdc and .usdz, and export to plain Cameras."""

from __future__ import annotations

import tempfile
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pxr import Sdf, Usd, UsdGeom, UsdUtils

from usd_schemas import (
    ApertureData,
    Asset,
    FilmData,
    FocusData,
    FocusPoint,
    LensCamera,
    LensData,
    SchemaError,
    TiltShiftData,
    define_camera,
    define_lens_camera,
)
from usd_schemas.export import export_portable, portable_layer
from usd_schemas.registration import SINGLE_APPLY

VIEWS = {
    "lens": LensData,
    "aperture": ApertureData,
    "tilt_shift": TiltShiftData,
    "film": FilmData,
    "focus": FocusData,
}
NUMBERS = st.floats(-1e6, 1e6)
TEXTS = st.text(st.characters(codec="utf-8", exclude_characters="\0", exclude_categories=["Cs", "Cc"]), max_size=12)


def values_for(prim: Usd.Prim, name: str, fallback: Any) -> st.SearchStrategy[Any]:
    """Any value that the schema allows for a property."""
    attribute = prim.GetAttribute(name)
    kind = str(attribute.GetTypeName())
    tokens = attribute.GetMetadata("allowedTokens")
    hard = attribute.GetHardLimits()
    least, most = hard.GetMinimum(), hard.GetMaximum()
    if tokens:
        return st.sampled_from(list(tokens))
    if kind in ("double", "float"):
        return st.floats(least, most, allow_nan=False, allow_infinity=False, width=32 if kind == "float" else 64)
    if kind == "int":
        return st.integers(-(2**31) if least is None else least, 2**31 - 1 if most is None else most)
    scalar = {
        "bool": st.booleans(),
        "string": TEXTS,
        "asset": st.sampled_from([Asset(), Asset("./iris.png"), Asset("look/shot.cdl")]),
        "int2": st.tuples(st.integers(-9, 9), st.integers(-9, 9)),
        "float2": st.tuples(*[st.floats(-9, 9, width=32)] * 2),
        "double2": st.tuples(NUMBERS, NUMBERS),
        "double3": st.tuples(NUMBERS, NUMBERS, NUMBERS),
        "color3d": st.tuples(NUMBERS, NUMBERS, NUMBERS),
        "double": NUMBERS,
    }[str(attribute.GetTypeName().scalarType)]
    return st.lists(scalar, max_size=4).map(tuple) if attribute.GetTypeName().isArray else scalar


def filled(prim: Usd.Prim, kind: type[Any], prefix: str = "", **given_fields: Any) -> st.SearchStrategy[Any]:
    """A dataclass whose every field has any allowed value."""
    strategies: dict[str, st.SearchStrategy[Any]] = {name: st.just(value) for name, value in given_fields.items()}
    for item in fields(kind):
        if "group" in item.metadata:
            strategies[item.name] = filled(prim, item.metadata["group"])
        elif "usd" in item.metadata:
            strategies[item.name] = values_for(prim, prefix + item.metadata["usd"], item.default)
    return st.builds(kind, **strategies)


def reopened(stage: Usd.Stage, suffix: str, folder: Path) -> Usd.Stage:
    """Write the stage's root layer in a format, and open what was written."""
    path = folder / f"shot{suffix}"
    if suffix == ".usdz":
        inner = folder / "inner.usdc"
        assert stage.GetRootLayer().Export(str(inner))
        assert UsdUtils.CreateNewUsdzPackage(str(inner), str(path))
    else:
        assert stage.GetRootLayer().Export(str(path))
    return Usd.Stage.Open(str(path))


# One example draws some two hundred values, so that many outgrow Hypothesis' buffer and are discarded. How many depends on the
# modules that are loaded, whose constants it draws too; the checks of generation would pass or fail with the selection of tests.
@settings(
    max_examples=12,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much],
)
@given(data=st.data(), suffix=st.sampled_from([".usda", ".usdc"]))
def test_any_allowed_value_of_every_property_survives(data: st.DataObject, suffix: str) -> None:
    stage = Usd.Stage.CreateInMemory()
    camera = define_camera(stage, "/cam")
    said = {}
    for view, kind in VIEWS.items():
        said[view] = data.draw(filled(camera.prim, kind), label=view)
        getattr(camera, view).author(said[view])
    point = camera.add_focus_point("hero", FocusPoint("hero", ("/a",)))
    hero = data.draw(filled(camera.prim, FocusPoint, "focusPoint:hero:", name="hero", target=("/a/b",)), label="hero")
    point.author(hero)
    with tempfile.TemporaryDirectory() as folder:
        again = reopened(stage, suffix, Path(folder))
        back = LensCamera(again.GetPrimAtPath("/cam"))
        assert {view: getattr(back, view).read() for view in VIEWS} == said
        assert back.focus_point("hero").read() == hero


@pytest.fixture
def shot(tmp_path: Path) -> Usd.Stage:
    """A LensCamera with a mask, keys of every kind and a second one in a variant."""
    (tmp_path / "iris.png").write_bytes(b"not a real picture, but a file")
    stage = Usd.Stage.CreateNew(str(tmp_path / "shot.usda"))
    UsdGeom.Xform.Define(stage, "/shot/subject")
    camera = define_lens_camera(stage, "/shot/cam")
    camera.aperture.author(ApertureData(blades=7, mask=Asset("./iris.png")))
    point = camera.add_focus_point("hero", FocusPoint("hero", ("/shot/subject",)))
    for time, interpolation in ((1, "linear"), (10, "held"), (20, "auto"), (30, "bezier")):
        point.set_key("weight", time, time / 30, interpolation)  # type: ignore[arg-type]
    point.set_key("enabled", 5, False)
    point.set_key("offset", 5, (1.0, 2.0, 3.0))
    variants = stage.GetPrimAtPath("/shot").GetVariantSets().AddVariantSet("rig")
    variants.AddVariant("b_cam")
    variants.SetVariantSelection("b_cam")
    with variants.GetVariantEditContext():
        define_lens_camera(stage, "/shot/b_cam")
    stage.Save()
    return stage


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
def test_keys_survive_each_format(shot: Usd.Stage, suffix: str, tmp_path: Path) -> None:
    stage = reopened(shot, suffix, tmp_path)
    again = LensCamera(stage.GetPrimAtPath("/shot/cam"))
    before, after = LensCamera(shot.GetPrimAtPath("/shot/cam")).focus_point("hero"), again.focus_point("hero")
    for attribute in ("weight", "enabled", "offset"):
        assert after.keys(attribute) == before.keys(attribute) != []
    for time in range(35):
        assert after.read(time) == before.read(time)


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usd", ".usdz"])
@pytest.mark.parametrize("of_layer", [False, True])
def test_export_makes_cameras_that_say_the_same(shot: Usd.Stage, suffix: str, of_layer: bool, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    source = shot.GetRootLayer() if of_layer else shot
    untouched = shot.GetRootLayer().ExportToString()
    path = export_portable(source, tmp_path / "out" / f"portable{suffix}")
    stage = Usd.Stage.Open(str(path))
    was, now = LensCamera(shot.GetPrimAtPath("/shot/cam")), LensCamera(stage.GetPrimAtPath("/shot/cam"))
    assert now.prim.GetTypeName() == stage.GetPrimAtPath("/shot/b_cam").GetTypeName() == "Camera"
    assert now.prim.GetAppliedSchemas() == [*SINGLE_APPLY, "FocusPointAPI:hero"]
    for view in VIEWS:
        assert getattr(now, view).read() == replace(
            getattr(was, view).read(), **({"mask": now.aperture.read().mask} if view == "aperture" else {})
        )
    assert now.aperture.read().mask.resolved, "the mask is found from where the export stands"
    assert [now.focus_point("hero").read(t) for t in range(35)] == [was.focus_point("hero").read(t) for t in range(35)]
    assert shot.GetRootLayer().ExportToString() == untouched
    assert [entry.name for entry in path.parent.iterdir()] == [path.name], "nothing half written is left"


def test_an_exported_file_names_its_files_from_where_it_stands(shot: Usd.Stage, tmp_path: Path) -> None:
    text = export_portable(shot, tmp_path / "portable.usda").read_text()
    assert "@./iris.png@" in text
    assert str(tmp_path) not in text


def test_an_exported_camera_authors_fallbacks_for_other_readers(shot: Usd.Stage) -> None:
    layer = portable_layer(shot)
    camera = layer.GetPrimAtPath("/shot/cam")
    assert camera.attributes["lens:model"].default == "thin"
    assert camera.attributes["film:curve:gamma"].default == (0.6, 0.6, 0.6)
    assert "LensCamera" not in layer.ExportToString()


def test_a_lens_camera_from_a_reference_is_found_in_a_stage(tmp_path: Path) -> None:
    rig = Usd.Stage.CreateInMemory()
    define_lens_camera(rig, "/rig/cam").lens.author(LensData(squeeze=1.8))
    stage = Usd.Stage.CreateInMemory()
    prim = stage.DefinePrim("/shot")
    prim.GetReferences().AddReference(rig.GetRootLayer().identifier, "/rig")
    again = Usd.Stage.Open(str(export_portable(stage, tmp_path / "shot.usda")))
    assert again.GetPrimAtPath("/shot/cam").GetTypeName() == "Camera"
    assert LensCamera(again.GetPrimAtPath("/shot/cam")).lens.read().squeeze == 1.8


def test_explicit_schema_lists_stay_explicit(tmp_path: Path) -> None:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(
        '#usda 1.0\ndef LensCamera "cam" (\n    apiSchemas = ["FocusPointAPI:hero", "LensAPI"]\n)\n{\n}\n'
    )
    portable = portable_layer(layer)
    schemas = portable.GetPrimAtPath("/cam").GetInfo("apiSchemas")
    assert schemas.explicitItems == [*SINGLE_APPLY, "FocusPointAPI:hero"]


@pytest.mark.parametrize("name", ["shot.abc", "shot", "nowhere/shot.usda"])
def test_export_to_where_it_cannot_go_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(SchemaError, match=r"must end in \.usda|is not there"):
        export_portable(Usd.Stage.CreateInMemory(), tmp_path / name)
    assert list(tmp_path.iterdir()) == []
