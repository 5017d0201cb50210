"""`pullfocus record` graded as the user says, in place of what the shot says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from render.film import Cdl, Grade, GradeChoice, list_displays
from render.model.arrays import FloatArray
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot
from tests.render.kits.colours import OWN_CONFIG
from usd_schemas.settings import Asset, GradeData

GAMUT = "ACES 1.3 Reference Gamut Compression"
CDL_FILE = """<ColorCorrectionCollection xmlns="urn:ASC:CDL:v1.01">
  <ColorCorrection id="day"><SOPNode><Slope>2 1 1</Slope><Offset>0 0 0</Offset><Power>1 1 1</Power></SOPNode></ColorCorrection>
  <ColorCorrection id="night"><SOPNode><Slope>.5 .5 1.1</Slope><Offset>0 0 0</Offset><Power>1 1 1</Power></SOPNode>
  </ColorCorrection>
</ColorCorrectionCollection>
"""


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A shot with a correction of its own, and a view."""
    says = 'double3 film:cdl:slope = (0.9, 0.9, 0.9)\n        string film:ocio:view = "Un-tone-mapped"\n    }\n'
    said = CAMERA.rstrip().removesuffix("}") + "    " + says
    said = said.replace('Camera "main_cam"', 'Camera "main_cam" (apiSchemas = ["FilmAPI"])')
    return write_shot(tmp_path / "shot.usda", SQUARE, said)


def middle(path: Path) -> FloatArray:
    """The middle of a picture, ``(3,)`` from 0 to 1."""
    pixels: FloatArray = OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT)
    colour: FloatArray = pixels[pixels.shape[0] // 2, pixels.shape[1] // 2, :3]
    return colour


@pytest.mark.gl
def test_a_picture_is_graded_as_requested(pullfocus: Command, shot: Path) -> None:
    folder = shot.parent
    (folder / "grades.ccc").write_text(CDL_FILE)
    asked: dict[str, tuple[str, ...]] = {
        "own": (),
        "neutral": ("--cdl", "1,1,1,0,0,0,1,1,1"),
        "grey": ("--cdl", "1 1 1  0 0 0  1 1 1  0"),
        "night": ("--cdl", f"{folder / 'grades.ccc'}#night"),
        "p3": ("--display", "Display P3 - Display"),
        "toned": ("--view", "ACES 2.0 - SDR 100 nits (Rec.709)"),
    }
    seen = {}
    for name, options in asked.items():
        ended = pullfocus("record", shot, folder / f"{name}.png", *small("--shading", "unlit"), *options)
        assert ended.status == 0, ended.err
        seen[name] = middle(folder / f"{name}.png")

    assert (seen["neutral"] > 1.1 * seen["own"]).all(), "the shot's own correction no longer holds"
    assert np.ptp(seen["grey"]) < 0.01
    assert seen["night"][2] > seen["own"][2]
    assert np.abs(seen["p3"] - seen["own"]).max() > 0.02
    assert np.abs(seen["toned"] - seen["own"]).max() > 0.02


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--display", "Display P4 - Display"), ("unknown display", "did you mean 'Display P3 - Display'")),
        (("--view", "ACES 2.0 SDR"), ("unknown view", "did you mean 'ACES 2.0 - SDR")),
        (("--look", f"-{GAMUT[:-3]}"), ("unknown look", f"did you mean '{GAMUT}'")),
        (("--cdl", "1,1,1,0,0,0,1,1"), ("--cdl takes a file, or 9 numbers", "got 8")),
        (("--cdl", "1,1,1,0,0,0,1,1,-1"), ("power must be three numbers above 0",)),
        (("--cdl", "1,1,1,0,0,0,1,1,nan"), ("power must be",)),
        (("--ocio-config", "ocio://cg-config-latests"), ("did you mean 'ocio://cg-config-latest'",)),
        (("--film", "vision3_500t_5218"), ("no film stock", "vision3_500t_5219")),
        (("--film", "kodak"), ("no film stock named 'kodak' in the library: did you mean kodachrome_64",)),
        (("--cdl", "-1,1,1"), ("--cdl takes a file, or 9 numbers", "got 3")),
        (("--cdl", ""), ("--cdl is empty",)),
        (("--ocio-config", ""), ("--ocio-config is empty",)),
        (("--ocio-config", "/"), ("the OpenColorIO configuration /: it is a folder",)),
        (("--look", ","), ("--look takes names of looks, or '' for none, got ','",)),
    ],
)
def test_words_that_mean_nothing_are_wrong_arguments(
    options: tuple[str, ...], words: tuple[str, ...], pullfocus: Command, shot: Path
) -> None:
    ended = pullfocus("record", shot, shot.parent / "frame.png", *small(), *options)

    assert ended.status == 2
    assert all(word in ended.err.splitlines()[-1] for word in words), ended.err
    assert not (shot.parent / "frame.png").exists()


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ("gone.cdl", ("there is no CDL file", "gone.cdl")),
        ("grades.ccc#nigth", ("no correction 'nigth'", "did you mean 'night'")),
        ("damaged.cdl", ("damaged.cdl is damaged",)),
        (".", (". is a folder, expected a CDL file",)),
    ],
)
def test_cdl_files_that_are_none_are_named(
    typed: str, words: tuple[str, ...], pullfocus: Command, shot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(shot.parent)
    Path("grades.ccc").write_text(CDL_FILE)
    Path("damaged.cdl").write_text("<ColorDecisionList><nothing")

    ended = pullfocus("record", shot, "frame.png", *small(), "--cdl", typed)

    assert ended.status == 1
    assert all(word in ended.err.splitlines()[-1] for word in words), ended.err


def test_a_broken_configuration_is_reported_in_one_sentence(pullfocus: Command, shot: Path) -> None:
    broken = shot.parent / "broken.ocio"
    broken.write_text("ocio_profile_version: 2\nroles: [not, a, map]\n")

    ended = pullfocus("record", shot, shot.parent / "frame.png", *small(), "--ocio-config", broken)

    assert ended.status == 2
    assert f"cannot read the OpenColorIO configuration {broken}" in ended.err.splitlines()[-1]
    assert "Traceback" not in ended.err


@pytest.mark.gl
def test_an_exr_says_once_that_it_is_not_graded(pullfocus: Command, shot: Path) -> None:
    graded = ("--film", "velvia_50", "--cdl", "1,1,1,0,0,0,1,1,1")
    ended = pullfocus(
        "record", shot, shot.parent / "f.##.exr", "--frames", "1:2", *small("--engine", "pinhole"), *graded
    )
    assert ended.status == 0, ended.err
    assert ended.err.count("warning") == 1
    assert "an EXR file stays scene-linear: --film, --cdl are not applied" in ended.err
    assert "scene-linear" not in pullfocus("record", shot, shot.parent / "f.png", *small(), *graded).err


@pytest.mark.gl
@pytest.mark.parametrize("film", ["vision3_500t_5219", "velvia_50"])
def test_a_print_is_shown_by_another_configuration(film: str, pullfocus: Command, shot: Path) -> None:
    own = shot.parent / "studio.ocio"
    own.write_text(OWN_CONFIG)
    seen = {}
    for name, options in {"ours": ("--view", "Un-tone-mapped"), "theirs": ("--ocio-config", own)}.items():
        ended = pullfocus(
            "record", shot, shot.parent / f"{name}.png", *small("--film", film, "--cdl", "1,1,1,0,0,0,1,1,1"), *options
        )
        assert ended.status == 0, ended.err
        seen[name] = middle(shot.parent / f"{name}.png")

    linear = (
        (seen["ours"] + 0.055) / 1.055
    ) ** 2.4  # IEC 61966-2-1; the studio's monitor is linear, of the same primaries
    np.testing.assert_allclose(seen["theirs"], linear, atol=1.5 / 255)
    assert np.ptp(linear) > 0.05


def test_unset_options_are_the_shots_own() -> None:
    display = "Display P3 - Display"
    shared = next(view for view in list_displays()[display] if view in list_displays()["sRGB - Display"])
    said = GradeData(display="sRGB - Display", view=shared, look=GAMUT, cdl_saturation=0.5)

    assert Grade.from_film_data(said, choice=GradeChoice(display=display)) == Grade(
        None, display, shared, GAMUT, Cdl(saturation=0.5)
    )
    assert Grade.from_film_data(said, choice=GradeChoice(look="", cdl=Cdl())) == Grade(None, "sRGB - Display", shared)


def test_a_view_missing_on_the_display_becomes_its_default() -> None:
    said = GradeData(display="Rec.2100-PQ - Display", view="ACES 2.0 - HDR 1000 nits (Rec.2020)")

    assert Grade.from_film_data(said, choice=GradeChoice(display="sRGB - Display")).view is None


def test_another_configuration_has_other_words(tmp_path: Path) -> None:
    own = tmp_path / "shot.ocio"
    own.write_text("never read")
    said = GradeData(
        ocio_config=Asset(str(own), str(own)), display="Monitor", view="Plain", look="Show", cdl_saturation=0.5
    )

    assert Grade.from_film_data(said, choice=GradeChoice(config="ocio://default")) == Grade(
        "ocio://default", cdl=Cdl(saturation=0.5)
    )
