"""One declaration for a setting: REST, the command line, the page and the renderer have no setting or range of their own."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import get_args

import pytest

from render.cli import record
from render.cli.options.settings import add_settings
from render.film.balance import GREATEST_K, LEAST_K
from render.optics.photometry.exposure import MAX_COMPENSATION_STOPS
from service.http.page_settings import RESOURCES
from service.models.cameras import CameraEdit
from service.models.exposure import ExposureSettings, ExposureSettingsEdit
from service.models.film_settings import FilmSettings, FilmSettingsEdit
from service.models.focus import Anchor, FocusPoint, FocusPointCreate, FocusPointEdit, KeyedAttribute
from service.models.solving import FocusSettings, FocusSettingsEdit
from usd_schemas.settings.tables import LENS_SETTINGS, POINT_SETTINGS, SETTINGS, rest_settings

PANELS = Path(__file__).parents[3] / "web" / "src" / "view" / "panels"
NO_SETTINGS = {"camera", "time", "keys", "etag", "gateMm"}
MODELS = {
    "exposure": (ExposureSettings, ExposureSettingsEdit),
    "film": (FilmSettings, FilmSettingsEdit),
    "focus": (FocusSettings, FocusSettingsEdit),
}


def fields(model):
    return {info.alias: info for info in model.model_fields.values() if info.alias not in NO_SETTINGS}


@pytest.mark.parametrize("resource", RESOURCES)
def test_rest_has_the_declared_settings_and_no_others(resource):
    read, edit = map(fields, MODELS[resource])
    declared = {item.camel_name: item for item in rest_settings(resource)}
    assert read.keys() == declared.keys()
    assert edit.keys() == {name for name, item in declared.items() if not item.read_only}
    assert {name: info.description for name, info in read.items()} == {n: item.doc for n, item in declared.items()}


def limits(model, name):
    """The bounds of a field's numbers, as the OpenAPI document states them."""
    schema = model.model_json_schema()["properties"][model.model_fields[name].alias]
    schema = schema["anyOf"][0] if "anyOf" in schema else schema
    schema = schema["prefixItems"][0] if "prefixItems" in schema else schema
    return schema.get("minimum", schema.get("exclusiveMinimum")), schema.get("maximum")


def test_rest_has_the_settings_of_a_focus_point_and_no_others():
    declared = {item.field_name: item for item in rest_settings("focusPoint")}
    assert set(POINT_SETTINGS) - {item.name for item in declared.values()} == {"topology"}
    placed = ["position_m", "depth_m", "screen", "visible_in_frame", "state", "share"]
    sharpness = ["coc_mm", "focus_distance_m", "sharp"]
    computed = [*placed, *sharpness, "problem"]
    assert list(FocusPoint.model_fields) == ["name", *declared, *computed, "keys", "etag"]
    assert FocusPointCreate.model_fields.keys() - {"name"} == declared.keys()
    assert list(FocusPointEdit.model_fields) == list(declared)
    for model in (Anchor, FocusPoint, FocusPointCreate, FocusPointEdit):
        for name in model.model_fields.keys() & declared.keys():
            assert model.model_fields[name].description == declared[name].rest_doc, (model, name)


def test_numbers_of_a_point_have_declared_bounds_and_defaults():
    for item in rest_settings("focusPoint"):
        assert item.relationship or FocusPointCreate.model_fields[item.field_name].default == item.default, item.name
        if item.type in (float, int) or item.name in ("offset", "barycentric"):
            assert limits(FocusPointEdit, item.field_name) == (item.sent.least, item.sent.most), item.name
            least = (
                -1 if item.name == "fan_triangle" else item.sent.least
            )  # -1 is refused by the schema, with its own message
            assert limits(FocusPointCreate, item.field_name) == (least, item.sent.most), item.name


def test_the_keyed_attributes_of_a_focus_point_are_the_declared_ones():
    assert set(get_args(KeyedAttribute)) == {item.usd for item in rest_settings("focusPoint") if item.rest_keyable}


def test_the_numbers_of_the_lens_have_the_declared_bounds():
    assert LENS_SETTINGS.keys() <= CameraEdit.model_fields.keys()
    for name, item in LENS_SETTINGS.items():
        assert limits(CameraEdit, name) == (item.sent.least, item.sent.most), name
        assert item.settable.most >= item.sent.most, name
        assert item.settable.least == item.sent.least, name


def test_each_python_name_is_one_setting_with_one_rest_name():
    names = [item.camel_name for item in SETTINGS.values()]
    assert len(set(names)) == len(names)
    assert len({item.usd for item in SETTINGS.values()}) == len(names)
    assert all(re.fullmatch(r"[a-z][A-Za-z]*", name) for name in names)


def test_defaults_and_sliders_lie_within_what_rest_takes():
    for item in (SETTINGS | POINT_SETTINGS).values():
        if item.rest in (*RESOURCES, "focusPoint") and item.type is float:
            assert item.sent.least <= item.default <= item.sent.most, item.name
            assert item.accepted.holds(item.default), item.name
            if item.slider:
                assert item.sent.least <= item.slider.least < item.slider.most <= item.sent.most, item.name


def test_the_command_line_has_the_declared_options_and_ranges():
    alone = argparse.ArgumentParser()
    add_settings(alone.add_argument_group("settings"))
    declared = {item.option.flag for item in SETTINGS.values() if item.option}
    assert {flag for action in alone._actions for flag in action.option_strings} - {"-h", "--help"} == declared
    command = argparse.ArgumentParser()
    record.add_arguments(command)
    assert declared <= {flag for action in command._actions for flag in action.option_strings}


def test_panels_of_settings_write_no_range():
    of_points = ("FocusPoints", "PointSettings")
    of_cameras = ("LensPanel", "FilmPanel", "ExposurePanel", "GlassPanel", "LightMeter", "FocusSettings", "FocusAmount")
    for name in of_points + of_cameras:
        text = (PANELS / f"{name}.tsx").read_text(encoding="utf-8")
        assert not re.search(r"\b(linear|log|focus)Scale\(", text), name


def test_formulas_hold_as_far_as_declared():
    """Optics is numpy alone and knows its domain itself; the declaration must say the same."""
    bounds = SETTINGS["compensation_stops"].sent
    assert (bounds.least, bounds.most) == (-MAX_COMPENSATION_STOPS, MAX_COMPENSATION_STOPS)
    slider, balance = SETTINGS["white_balance_k"].slider, SETTINGS["white_balance_k"].sent
    assert LEAST_K <= slider.least < slider.most <= GREATEST_K == balance.most


def test_scales_of_the_page_take_every_range_from_the_declarations():
    text = (PANELS.parents[1] / "model" / "scale.ts").read_text(encoding="utf-8")
    assert not re.search(r"Scale\(\s*[\d.]", text)
