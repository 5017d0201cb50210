"""The page's table of settings: current, and with a slider for each number that REST has a range for the page of."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import pytest

from service.http.page_settings import allowed_numbers, page_settings
from usd_schemas.settings.setting import Resource
from usd_schemas.settings.tables import rest_settings

TABLE = Path(__file__).parents[3] / "web" / "src" / "model" / "settings.gen.ts"


def test_the_page_is_built_with_the_declared_settings():
    """Written anew by `make schema`."""
    assert TABLE.read_text(encoding="utf-8") == page_settings()


@pytest.mark.parametrize("resource", get_args(Resource))
def test_what_a_slider_gives_makes_a_picture(resource):
    for item in rest_settings(resource):
        if item.slider is None:
            continue
        for number in (item.slider.least, item.slider.most):
            assert item.accepted.holds(number), item.name
            assert item.sent.least <= number <= item.sent.most, item.name
            assert number > item.sent.least or not item.sent.above, item.name


@pytest.mark.parametrize("resource", get_args(Resource))
def test_the_page_takes_no_number_that_makes_no_picture(resource):
    for item in rest_settings(resource):
        if item.slider is None:
            continue
        allowed = allowed_numbers(item)
        for number in (allowed["least"], allowed["most"]):
            assert item.accepted.holds(number) or (number == allowed["least"] and allowed["above"]), item.name
