"""ASC colour decisions, from numbers and from files."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from render.errors import InputError, SettingsError
from render.film import Cdl, read_cdl

ONE = """<?xml version="1.0" encoding="UTF-8"?>
<ColorCorrection id="sh010_v2">
  <SOPNode><Slope>1.1 1.0 0.9</Slope><Offset>0.01 0 -0.02</Offset><Power>1 1.05 1.1</Power></SOPNode>
  <SatNode><Saturation>0.85</Saturation></SatNode>
</ColorCorrection>
"""
PLAIN = """
<ColorCorrection id="{}">
  <SOPNode><Slope>{} 1 1</Slope><Offset>0 0 0</Offset><Power>1 1 1</Power></SOPNode>
</ColorCorrection>
"""
COLLECTION = (
    '<ColorCorrectionCollection xmlns="urn:ASC:CDL:v1.2">'
    + PLAIN.format("sh010", 1.1)
    + PLAIN.format("sh020", 1.2)
    + PLAIN.format("sh030", 1.3)
    + "</ColorCorrectionCollection>"
)
DECISIONS = (
    '<ColorDecisionList xmlns="urn:ASC:CDL:v1.2">'
    + "".join(f"<ColorDecision>{PLAIN.format(name, slope)}</ColorDecision>" for name, slope in (("a", 2), ("b", 3)))
    + "</ColorDecisionList>"
)


def written(folder: Path, name: str, text: str) -> Path:
    file = folder / name
    file.write_text(text)
    return file


def test_a_single_correction(tmp_path: Path) -> None:
    assert read_cdl(written(tmp_path, "shot.cc", ONE)) == Cdl(
        (1.1, 1.0, 0.9), (0.01, 0.0, -0.02), (1.0, 1.05, 1.1), 0.85
    )


@pytest.mark.parametrize(("correction", "slope"), [("", 1.1), ("sh010", 1.1), ("sh030", 1.3), ("1", 1.2)])
def test_a_correction_of_a_collection_by_id_or_number(correction: str, slope: float, tmp_path: Path) -> None:
    assert read_cdl(written(tmp_path, "show.ccc", COLLECTION), correction).slope == (slope, 1.0, 1.0)


@pytest.mark.parametrize(("correction", "slope"), [("", 2.0), ("b", 3.0)])
def test_a_decision_of_a_list(correction: str, slope: float, tmp_path: Path) -> None:
    assert read_cdl(written(tmp_path, "show.cdl", DECISIONS), correction).slope == (slope, 1.0, 1.0)


def test_a_file_that_was_edited_is_read_again(tmp_path: Path) -> None:
    file = written(tmp_path, "shot.cc", ONE)
    assert read_cdl(file).saturation == 0.85

    file.write_text(ONE.replace("0.85", "0.5"))

    assert read_cdl(file).saturation == 0.5


@pytest.mark.parametrize(
    ("correction", "expected"),
    [
        ("sh20", "did you mean 'sh020' or "),
        ("night", "expected one of 'sh010', 'sh020', 'sh030'"),
        ("7", "expected one of 'sh010', 'sh020', 'sh030'"),
    ],
)
def test_an_unknown_correction_is_reported_with_the_near_ones(correction: str, expected: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_cdl(written(tmp_path, "show.ccc", COLLECTION), correction)

    assert f"show.ccc has no correction '{correction}': {expected}" in str(caught.value)
    assert caught.value.code == "unknown_correction"


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("a.cc", "", "Does not appear to contain a valid ASC CDL"),
        ("a.ccc", "<ColorCorr", "Missing CDL tag"),
        ("a.cc", ONE.replace("1.1 1.0 0.9", "1.1 1.0"), "SOPNode: 3 values required"),
        ("a.cc", ONE.replace("1 1.05 1.1", "1 0 1"), "Invalid 'power' 0 should be greater than 0"),
        ("a.cc", ONE.replace("1.1 1.0 0.9", "-1 1.0 0.9"), "Invalid 'slope' -1 should be greater than 0"),
        ("a.ccc", '<ColorCorrectionCollection xmlns="urn:ASC:CDL:v1.2"/>', ""),
    ],
)
def test_a_damaged_file_is_one_clear_sentence(name: str, text: str, reason: str, tmp_path: Path) -> None:
    file = written(tmp_path, name, text)

    with pytest.raises(InputError) as caught:
        read_cdl(file)

    message = str(caught.value)
    assert message.startswith(f"CDL file {file} ")
    assert reason in message
    assert "\n" not in message
    assert caught.value.code == "bad_cdl"


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no CDL file .*none\.cc"):
        read_cdl(tmp_path / "none.cc")


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ({"slope": (-0.1, 1, 1)}, "the CDL's slope must be three numbers from 0 up, got -0.1, 1, 1"),
        ({"offset": (0, math.nan, 0)}, "the CDL's offset must be three finite numbers, got 0, nan, 0"),
        ({"power": (1, 1, 0)}, "the CDL's power must be three numbers above 0, got 1, 1, 0"),
        ({"power": (1, 1)}, "the CDL's power must be three numbers above 0, got 1, 1"),
        ({"saturation": -1.0}, "the CDL's saturation must be a number from 0 up, got -1"),
        ({"saturation": math.inf}, "the CDL's saturation must be a number from 0 up, got inf"),
    ],
)
def test_impossible_numbers_are_refused(numbers: dict[str, Any], message: str) -> None:
    with pytest.raises(SettingsError, match="CDL") as caught:
        Cdl(**numbers)

    assert str(caught.value) == message


def test_a_decision_that_decides_nothing_is_neutral() -> None:
    assert Cdl().is_neutral
    assert not Cdl(power=(1, 1, 1.001)).is_neutral
