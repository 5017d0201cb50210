"""One declaration for a setting: REST, the command line, the page and the renderer have no setting or range of their own."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

import pytest

from render.cli import record
from render.cli.options.settings import add_settings
from render.film.balance import GREATEST_K, LEAST_K
from render.optics.photometry.exposure import MAX_COMPENSATION_STOPS
from service.http.page_settings import RESOURCES
from service.models.exposure import ExposureSettings, ExposureSettingsEdit
from service.models.film_settings import FilmSettings, FilmSettingsEdit
from service.models.solving import FocusSettings, FocusSettingsEdit
from usd_schemas.settings.tables import SETTINGS, rest_settings

PANELS = Path(__file__).parents[2] / "web" / "src" / "view" / "panels"
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


def test_each_python_name_is_one_setting_with_one_rest_name():
    names = [item.camel_name for item in SETTINGS.values()]
    assert len(set(names)) == len(names)
    assert len({item.usd for item in SETTINGS.values()}) == len(names)
    assert all(re.fullmatch(r"[a-z][A-Za-z]*", name) for name in names)


def test_defaults_and_sliders_lie_within_what_rest_takes():
    for item in SETTINGS.values():
        if item.rest in RESOURCES and item.type is float:
            assert item.sent.least <= item.default <= item.sent.most, item.name
            assert item.accepted.holds(item.default), item.name
            if item.slider:
                assert item.sent.least <= item.slider.least < item.slider.most <= item.sent.most, item.name


def test_the_command_line_has_the_declared_options_and_ranges():
    alone = argparse.ArgumentParser()
    add_settings(alone.add_argument_group("settings"))
    declared = {item.option.flag for item in SETTINGS.values() if item.option}
    assert {flag for action in alone._actions for flag in action.option_strings} - {"-h", "--help"} == declared
    commands = argparse.ArgumentParser().add_subparsers()
    record.add_parser(commands)
    assert declared <= {flag for action in commands.choices["record"]._actions for flag in action.option_strings}


def test_panels_of_film_exposure_and_focus_write_no_range():
    for name in ("FilmPanel", "ExposurePanel", "GlassPanel", "LightMeter", "FocusSettings", "FocusAmount"):
        text = (PANELS / f"{name}.tsx").read_text(encoding="utf-8")
        assert not re.search(r"\b(linear|log|focus)Scale\(", text), name


def test_formulas_hold_as_far_as_declared():
    """Optics is numpy alone and knows its domain itself; the declaration must say the same."""
    bounds = SETTINGS["compensation_stops"].sent
    assert (bounds.least, bounds.most) == (-MAX_COMPENSATION_STOPS, MAX_COMPENSATION_STOPS)
    slider, balance = SETTINGS["white_balance_k"].slider, SETTINGS["white_balance_k"].sent
    assert LEAST_K <= slider.least < slider.most <= GREATEST_K == balance.most
