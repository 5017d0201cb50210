"""`pullfocus bodies`: the library as a table, and the numbers of one body."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.render.kits.cli_shots import Command
from usd_schemas import library_bodies


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


def shown(pullfocus: Command, *arguments: object) -> dict[str, Any]:
    """Return the JSON entry of a body."""
    ended = pullfocus("bodies", "show", *arguments, "--json")
    assert ended.status == 0, ended.err
    report: dict[str, Any] = json.loads(ended.out)
    return report


def test_the_library_is_a_table_with_a_line_for_each_body(pullfocus: Command) -> None:
    ended = pullfocus("bodies")
    assert ended.status == 0
    for body in library_bodies():
        [line] = [line for line in ended.out.splitlines() if line.split()[:1] == [body.name]]
        assert body.description in line
        assert f"{body.gate_mm[0]:g} × {body.gate_mm[1]:g}" in line
    listed = json.loads(pullfocus("bodies", "--json").out)["bodies"]
    assert [body["name"] for body in listed] == [body.name for body in library_bodies()]
    assert len(listed) >= 15


def test_the_numbers_of_a_body_are_reported_with_their_units(pullfocus: Command) -> None:
    output = pullfocus("bodies", "show", "alexa_35", "--lens-mm", "35").out
    for words in (
        "27.99 × 19.22 mm, diagonal 33.95 mm",
        "4608 × 3164, 6.07 µm apart",
        "1.46:1",
        "1.27 corner to corner, 1.29 from side to side",
        "43.6°",
        "45 mm",
        "27.99 × 11.71",
        "4608 × 1928",
    ):
        assert words in output
    assert "25 mm" not in output  # one lens was asked for


def test_an_anamorphic_gate_is_shown_as_wide_as_it_looks(pullfocus: Command) -> None:
    assert "2x: shown as wide as 44 mm" in pullfocus("bodies", "show", "anamorphic_35").out
    report = shown(pullfocus, "anamorphic_35", "--lens-mm", 50)
    assert (report["gateMm"], report["squeeze"], report["resolution"]) == ([22, 18.59], 2, None)
    assert report["aspect"] == pytest.approx(2.367, abs=1e-3)
    [view] = report["fieldsOfView"]
    assert view["horizontalDeg"] == pytest.approx(47.5, abs=0.05)
    assert view["fullFrameMm"] == pytest.approx(50 * report["cropFactor"])
    [scope] = [guide for guide in report["framingGuides"] if guide["name"] == "2.39:1"]
    assert scope["gateMm"] == pytest.approx([22, 44 / 2.39])
    assert scope["shareOfGate"] == pytest.approx([1, 0.990], abs=1e-3)


def test_json_may_be_requested_before_or_after_the_action(pullfocus: Command) -> None:
    assert json.loads(pullfocus("bodies", "--json", "show", "super16").out) == shown(pullfocus, "super16")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ("super35",),
            "no camera body named 'super35' in the library: did you mean super35_4perf or super35_3perf or super",
        ),
        (("super16", "--lens-mm", "0"), "focal length must be a positive number of mm, got 0"),
        (("super16", "--lens-mm", "nan"), "focal length must be a positive number of mm, got nan"),
    ],
)
def test_what_cannot_be_shown_is_refused_by_one_sentence(
    arguments: tuple[str, ...], words: str, pullfocus: Command
) -> None:
    ended = pullfocus("bodies", "show", *arguments)
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert words in ended.err
