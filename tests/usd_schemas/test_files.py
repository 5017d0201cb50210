"""The schema's files: current, fully documented, and the same as what the Python view says."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from pxr import Sdf, Usd

from usd_schemas import (
    PLUGIN_FOLDER,
    ApertureData,
    Asset,
    FilmData,
    FocusData,
    FocusPoint,
    LensData,
    TiltShiftData,
    define_camera,
    generate,
)
from usd_schemas.binding import property_names, read
from usd_schemas.schema_source import schema_source

SCHEMAS = {
    "LensAPI": LensData,
    "ApertureAPI": ApertureData,
    "TiltShiftAPI": TiltShiftData,
    "FilmAPI": FilmData,
    "FocusAPI": FocusData,
}
INSTANCE = "focusPoint:__INSTANCE_NAME__:"


def definition(schema: str) -> Usd.PrimDefinition:
    return Usd.SchemaRegistry().FindAppliedAPIPrimDefinition(schema)


EVERY_PROPERTY = [
    (schema, name) for schema in (*SCHEMAS, "FocusPointAPI") for name in definition(schema).GetPropertyNames()
]


def test_generated_files_are_what_the_source_gives() -> None:
    assert generate.stale_files() == []


def test_a_changed_declaration_makes_the_generated_files_stale(tmp_path: Path) -> None:
    for name in ("schema.usda", *generate.GENERATED):
        shutil.copy(PLUGIN_FOLDER / name, tmp_path)
    changed = schema_source().replace("int aperture:blades = 0", "int aperture:blades = 7")
    assert generate.stale_files(tmp_path, changed) == ["schema.usda", "generatedSchema.usda"]


def test_a_broken_source_is_refused_with_its_place() -> None:
    with pytest.raises(RuntimeError, match="usdGenSchema could not read"):
        generate.generate('#usda 1.0\nclass "Broken" (\n')


@pytest.mark.parametrize(("schema", "name"), EVERY_PROPERTY)
def test_each_property_has_documentation_unit_and_display_group(schema: str, name: str) -> None:
    says = definition(schema).GetPropertyMetadata
    doc = says(name, "documentation")
    assert doc.splitlines()[-1].startswith("Unit: ")
    assert len(doc.split("Unit:")[0]) > 20
    assert says(name, "displayGroup")
    assert says(name, "displayName")


@pytest.mark.parametrize(("schema", "name"), EVERY_PROPERTY)
def test_each_number_has_limits_and_each_token_its_choices(schema: str, name: str) -> None:
    attribute = definition(schema).GetAttributeDefinition(name)
    if not attribute:
        return
    fallback, kind = attribute.GetFallbackValue(), str(attribute.GetTypeName())
    if kind == "token":
        assert fallback in definition(schema).GetPropertyMetadata(name, "allowedTokens")
    if kind in ("int", "float", "double"):
        limits = definition(schema).GetPropertyMetadata(name, "limits")
        hard, soft = limits.get("hard", {}), limits.get("soft", {})
        assert soft or hard
        least, most = hard.get("minimum", float("-inf")), hard.get("maximum", float("inf"))
        assert least <= fallback <= most
        assert least <= soft.get("minimum", least) <= soft.get("maximum", most) <= most


@pytest.mark.parametrize(("schema", "kind"), SCHEMAS.items())
def test_the_view_knows_every_property_and_its_fallback(schema: str, kind: type[Any]) -> None:
    names = set(definition(schema).GetPropertyNames())
    assert set(property_names(kind)) == names
    stage = Usd.Stage.CreateInMemory()
    assert read(kind, define_camera(stage, "/cam").prim) == kind()


def test_the_focus_point_view_knows_every_property_and_its_fallback() -> None:
    names = {name.removeprefix(INSTANCE) for name in definition("FocusPointAPI").GetPropertyNames()}
    assert set(property_names(FocusPoint)) == names - {"target", "part"}
    stage = Usd.Stage.CreateInMemory()
    prim = define_camera(stage, "/cam").prim
    prim.ApplyAPI("FocusPointAPI", "a")
    assert read(FocusPoint, prim, prefix="focusPoint:a:", name="a") == FocusPoint("a")


def test_files_and_their_fallbacks_are_assets() -> None:
    attribute = definition("ApertureAPI").GetAttributeDefinition("aperture:mask")
    assert attribute.GetTypeName() == Sdf.ValueTypeNames.Asset
    assert ApertureData().mask == Asset("")


def test_lens_camera_is_a_camera_with_the_five_schemas() -> None:
    lens_camera = Usd.SchemaRegistry().FindConcretePrimDefinition("LensCamera")
    assert lens_camera.GetAppliedAPISchemas() == list(SCHEMAS)
    assert {"focalLength", "focusDistance", "fStop", "shutter:open"} <= set(lens_camera.GetPropertyNames())


def test_hydra_names_have_hydra_types() -> None:
    lens = definition("LensAPI")
    for name in ("lensDistortion:k1", "splitDiopter:focusDistance1", "splitDiopter:width2", "lensDistortion:ior"):
        assert lens.GetAttributeDefinition(name).GetTypeName() == Sdf.ValueTypeNames.Float
