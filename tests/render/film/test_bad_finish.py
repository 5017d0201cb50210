"""Film, grade and shutter that make no sense are one clear sentence: from `record`, and without a picture from `inspect`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot

NEGATIVE = 'token film:process = "negative"'
STOCK = 'string film:stock = "5219"'
CHANNELS = ("red", "green", "blue")
CURVES = 'token film:curve:source = "knots"'
BACKWARDS = "double2[] film:curve:red = [(-1, 0.1), (0, 1), (1, 0.5)]"
RISING = "double2[] film:curve:{} = [(-1, 0.1), (0, 1), (1, 1.5)]"

BAD: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "stock": ((NEGATIVE, 'string film:stock = "vision3_500t_5218"'), ("vision3_500t_5218", "vision3_500t_5219")),
    "print": (
        (NEGATIVE, 'string film:stock = "5219"', 'string film:printStock = "vision_2384"'),
        ("vision_2384", "vision_2383"),
    ),
    "process": (('token film:process = "polaroid"',), ("polaroid", "reversal")),
    "curve that runs backwards": (
        (NEGATIVE, CURVES, BACKWARDS, RISING.format("green"), RISING.format("blue")),
        ("curve:red", "rise or fall throughout"),
    ),
    "positive for a negative": (
        (NEGATIVE, CURVES, *(f"double2[] film:curve:{c} = [(-1, 2), (1, 0.1)]" for c in ("red", "green", "blue"))),
        ("run backwards for film process negative", "density falls with exposure"),
    ),
    "exposures out of order": (
        (NEGATIVE, CURVES, "double2[] film:curve:green = [(0, 0.1), (-1, 1)]"),
        ("film:curve", "increase"),
    ),
    "display": (('string film:ocio:display = "sRGB - Dsiplay"',), ("unknown display", "'sRGB - Display'")),
    "view": (('string film:ocio:view = "ACES 2.0 SDR"',), ("unknown view", "'ACES 2.0 - SDR")),
    "look": (('string film:ocio:look = "Night"',), ("unknown look 'Night'", "Gamut Compression")),
    "configuration that is broken": (
        ("asset film:ocio:config = @./broken.ocio@",),
        ("cannot read the OpenColorIO configuration", "broken.ocio", "needs to be a map"),
    ),
    "configuration that is gone": (("asset film:ocio:config = @./gone.ocio@",), ("gone.ocio, which is not there",)),
    "CDL": (("double3 film:cdl:power = (1, 1, 0)",), ("power must be three numbers above 0, got 1, 1, 0",)),
    "CDL file": (("asset film:cdl:file = @./gone.cdl@",), ("gone.cdl, which is not there",)),
    "light": (("double film:whiteBalance = 100",), ("1000 to 40000 kelvin", "got 100")),
    "push": ((NEGATIVE, 'string film:stock = "5219"', "double film:push = 9"), ("5", "got 9")),
    "sensor": (('token film:process = "digital"', "double film:sensor:fullWell = -1"), ("full", "-1")),
    "shutter of no kind": (('token film:shutter:type = "rollng"',), ("film:shutter:type", "rollng", "rolling")),
    "direction of no kind": (('token film:shutter:direction = "in"',), ("film:shutter:direction", "'in'", "left")),
    "stop of no kind": (('token film:exposure:stop = "both"',), ("film:exposure:stop", "'both'", "iris")),
    "source of no curve": (('token film:curve:source = "drawn"',), ("film:curve:source", "'drawn'", "parametric")),
    "process by its number": (("int film:process = 3",), ("film:process", "must be of type token, got int")),
    "knots that are numbers": (
        ('token film:process = "monochrome"', CURVES, "double[] film:curve:green = [1, 2, 3]"),
        ("film:curve:green", "must be of type double2[], got double[]"),
    ),
    "lens of no kind": (('token lens:model = "magic"',), ("lens:model", "'magic'", "heightField")),
    "clip": (
        ('token film:process = "digital"', "double film:sensor:clip = 5000"),
        ("film:sensor:clip must be from 0 to 40 stops, got 5000",),
    ),
    "read noise": (
        ('token film:process = "digital"', "double film:sensor:readNoise = 1e30"),
        ("film:sensor:readNoise must be from 0 to 1e+06 electrons, got 1e+30",),
    ),
    "speed below nothing": ((NEGATIVE, STOCK, "double film:speed = -100"), ("film:speed", "-100")),
    "speed that is no number": ((NEGATIVE, STOCK, "double film:speed = nan"), ("film:speed", "nan")),
    "speed beyond all": (
        (NEGATIVE, STOCK, "double film:speed = 1e300"),
        ("film:speed must be from 0.01 to 1e+07 ISO",),
    ),
    "speed that is next to nothing": (
        (NEGATIVE, STOCK, "double film:speed = 1e-300"),
        ("film:speed must be from 0.01 to 1e+07 ISO, or 0 for", "got 1e-300"),
    ),
    "middle grey far away": (
        (NEGATIVE, CURVES, *(RISING.format(c) for c in CHANNELS), "double film:curve:middleGray = 50"),
        ("film:curve:middleGray must be from -30 to 30 of log10 exposure, got 50",),
    ),
    "middle grey that is no number": (
        (NEGATIVE, CURVES, *(RISING.format(c) for c in CHANNELS), "double film:curve:middleGray = nan"),
        ("film:curve:middleGray", "nan"),
    ),
    "knots beyond all": (
        ('token film:process = "monochrome"', CURVES, "double2[] film:curve:green = [(-1e300, 0), (1e300, 1e300)]"),
        ("the green curve of film:curve needs log10 exposures from -30 to 30", "got (-1e+300, 0)"),
    ),
    "grain beyond all": (
        (NEGATIVE, STOCK, "double film:grain:amount = 1e30"),
        ("film:grain:amount must be from 0 to 100, got 1e+30",),
    ),
    "granularity that is no number": (
        (NEGATIVE, STOCK, "double film:grain:amount = 1", "double3 film:grain:rms = (nan, 5, 5)"),
        ("film:grain:rms", "nan"),
    ),
    "granularity below nothing": (
        (NEGATIVE, STOCK, "double film:grain:amount = 1", "double3 film:grain:rms = (-5, 5, 5)"),
        ("film:grain:rms must be from 0 to 1000 thousandths of density each, got -5, 5, 5",),
    ),
    "shutter that lets nothing through": (("double[] film:shutter:efficiency = [0, 0]",), ("efficiency of a shutter",)),
    "shutter that closes before it opens": (
        ("double shutter:open = 0.5", "double shutter:close = 0.25"),
        ("shutter", "open", "0.5", "0.25"),
    ),
}


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture(params=BAD)
def bad(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, tuple[str, ...]]:
    """A shot whose camera says something that makes no sense, and what must be said of it."""
    (tmp_path / "broken.ocio").write_text("ocio_profile_version: 2\nroles: [not, a, map]\n")
    says, words = BAD[request.param]
    camera = (
        CAMERA.replace('"main_cam"', '"main_cam" (prepend apiSchemas = ["FilmAPI", "LensAPI"])')
        .rstrip()
        .removesuffix("}")
    )
    lines = "".join(f"        {line}\n" for line in says)
    return write_shot(tmp_path / "shot.usda", SQUARE, f"{camera}{lines}    }}\n"), words


def test_record_ends_with_one_sentence(pullfocus: Command, bad: tuple[Path, tuple[str, ...]]) -> None:
    shot, words = bad
    out = shot.parent / "frame.png"

    ended = pullfocus("record", shot, out, *small())

    said = ended.err.splitlines()
    assert ended.status == 1, ended.err
    assert said[-1].startswith("pullfocus: ")
    assert sum(line.startswith("pullfocus") for line in said) == 1
    assert "fault of the program" not in said[-1]
    for word in words:
        assert word.removeprefix("curve:") in said[-1]
    assert not out.exists()


def test_inspect_finds_it_without_a_picture(pullfocus: Command, bad: tuple[Path, tuple[str, ...]]) -> None:
    shot, words = bad

    found = json.loads(pullfocus("inspect", shot, "--json").out)

    about = [finding["message"] for finding in (*found["notes"], *found["validation"])]
    assert len(about) == 1, "one clear sentence, and not two of the same"
    assert all(word in about[0] for word in words)


def test_a_key_that_makes_no_sense_is_found_where_it_stands(pullfocus: Command, tmp_path: Path) -> None:
    camera = (
        CAMERA.replace('"main_cam"', '"main_cam" (prepend apiSchemas = ["FilmAPI", "LensAPI"])')
        .rstrip()
        .removesuffix("}")
    )
    says = "double3 film:cdl:power.timeSamples = {1: (1, 1, 1), 9: (1, 0, 1), 12: (0, 0, 0)}\n    }\n"

    found = json.loads(pullfocus("inspect", write_shot(tmp_path / "a.usda", SQUARE, camera + says), "--json").out)

    [note] = found["notes"]
    assert "power must be three numbers above 0, got 1, 0, 1 (at time code 9)" in note["message"]


def test_a_finish_that_can_be_made_is_no_finding(pullfocus: Command, tmp_path: Path) -> None:
    camera = (
        CAMERA.replace('"main_cam"', '"main_cam" (prepend apiSchemas = ["FilmAPI", "LensAPI"])')
        .rstrip()
        .removesuffix("}")
    )
    says = 'token film:process = "negative"\n        string film:stock = "5219"\n    }\n'

    found = json.loads(pullfocus("inspect", write_shot(tmp_path / "a.usda", SQUARE, camera + says), "--json").out)

    assert (found["notes"], found["validation"]) == ([], [])
