"""The splines that the page's curves are compared with are those of the usd-core that is installed."""

from __future__ import annotations

import json

import pytest

from tests.usd_schemas.spline_cases import FILE, make_cases


@pytest.mark.parametrize(("kept", "made"), list(zip(json.loads(FILE.read_text()), make_cases(), strict=True)))
def test_the_page_is_compared_with_what_usd_says(kept: dict, made: dict) -> None:
    assert kept["name"] == made["name"]
    assert kept["keys"] == made["keys"]
    assert kept["values"] == [pytest.approx(pair, abs=1e-9) for pair in made["values"]]
