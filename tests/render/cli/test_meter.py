"""`pullfocus meter`: what is said, and that its keys expose the shot as the meter does."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path

import pytest
from pxr import Sdf

from render.film import Grade
from render.frame import FrameRenderer, FrameSettings
from render.optics.photometry.exposure import MIDDLE_GREY
from render.pictures.picture import make_picture
from render.shot import Shot
from tests.render.kits.cli_shots import SQUARE, Command, write_shot

CAMERA = "/World/main_cam"
AUTO = """
    def Camera "main_cam" (prepend apiSchemas = ["FilmAPI", "LensAPI", "FocusPointAPI:middle"])
    {
        float focalLength = 0.5
        float horizontalAperture = 0.36
        float verticalAperture = 0.24
        float focusDistance = 5
        float fStop = 2
        float exposure = 1.5
        float exposure:time = 0.02
        float exposure:iso = 400
        float exposure:fStop = 2.8
        float2 clippingRange = (0.1, 100)
        double lens:neutralDensity = 0.3
        uniform token film:metering:mode = "MODE"
        rel focusPoint:middle:target = </World/Square>
        double3 xformOp:translate = (0, 0, 5)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def DomeLight "sky"
    {
        float inputs:intensity.timeSamples = { 1: 1, 6: 1, 7: 8 }
    }
"""
PICTURE = FrameSettings(24, 16, engine="pinhole", rays=1, supersample=1, layers=1)


def shot_file(folder: Path, mode: str = "average") -> Path:
    return write_shot(folder / "shot.usda", AUTO.replace("MODE", mode), SQUARE)


def scales(renderer: FrameRenderer, shot: Shot, times: tuple[float, ...]) -> list[float]:
    return [make_picture(renderer, shot, CAMERA, t, PICTURE, Grade()).camera.exposure_scale for t in times]


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


@pytest.mark.gl
def test_what_it_says(command: Command, tmp_path: Path) -> None:
    ended = command("meter", shot_file(tmp_path, "manual"))
    assert ended.status == 0, ended.err
    assert "1/50 s, f/2.8 (exposure:fStop), ISO 400, +1.5 stops: EV 6.61" in ended.out
    assert "ND 0.3, 1 stops" in ended.out
    assert "center" in ended.out


def test_inspect_says_how_a_camera_is_exposed(command: Command, tmp_path: Path) -> None:
    shot = shot_file(tmp_path)
    assert "exposed 1/50 s, f/2.8 (exposure:fStop), ISO 400, +1.5 stops: EV 6.61" in command("inspect", shot).out
    (read,) = json.loads(command("inspect", shot, "--json").out)["exposures"]
    assert (read["camera"], read["exposure"]["iso"], read["lens"]["tStop"]) == (CAMERA, 400, 2)
    shot.write_text(shot.read_text().replace("exposure:iso = 400", "exposure:iso = 0"))
    assert "exposure:iso of camera /World/main_cam must be a positive number, got 0" in command("inspect", shot).out


@pytest.mark.gl
def test_what_it_says_to_programs_fits_together(command: Command, tmp_path: Path) -> None:
    ended = command("meter", shot_file(tmp_path), "--frames", "1,12", "--point", "middle", "--json")
    assert ended.status == 0, ended.err
    readings = json.loads(ended.out)["frames"]
    assert [one["time"] for one in readings] == [1, 12]
    assert readings[0]["place"] == pytest.approx([0.5, 0.5])
    for one in readings:
        assert one["mode"] == "spot"
        assert one["stops"] == pytest.approx(math.log2(one["luminanceNits"] / one["exposure"]["greyNits"]))
        assert one["ev100"] == pytest.approx(math.log2(one["luminanceNits"] * 8))
        lux = math.pi * one["luminanceNits"] * 10**-0.3 / (4 * 2.8**2)
        assert one["luxOnFilm"] == pytest.approx(lux, rel=1e-5)
    assert readings[1]["luminanceNits"] == pytest.approx(8 * readings[0]["luminanceNits"], rel=1e-4)


@pytest.mark.gl
@pytest.mark.parametrize("baked", [False, True])
def test_its_keys_expose_the_shot_as_the_meter_does_in_every_tool(
    renderer: FrameRenderer, command: Command, tmp_path: Path, baked: bool
) -> None:
    shot, layer = shot_file(tmp_path), tmp_path / "keys.usda"
    metered = scales(renderer, Shot.open(shot), (1.0, 6.0, 12.0))
    assert metered[0] > 1.5 * metered[2]
    ended = command("meter", shot, "--key", layer, *(["--baked"] if baked else []))
    assert ended.status == 0, ended.err
    keyed = Shot.open(shot, edits=layer)
    assert scales(renderer, keyed, (1.0, 6.0, 12.0)) == pytest.approx(metered, rel=0.005)
    assert not keyed.exposure.meter_cache  # it is exposed by hand now
    exposure = keyed.stage.GetPrimAtPath(CAMERA).GetAttribute("exposure")
    assert exposure.HasSpline() != baked
    between = [exposure.Get(6 + n / 10) for n in range(11)]
    assert all(a >= b for a, b in pairwise(between))


@pytest.mark.gl
def test_held_it_is_one_number_for_all_frames(command: Command, tmp_path: Path) -> None:
    shot, layer = shot_file(tmp_path), tmp_path / "keys.usda"
    assert command("meter", shot, "--key", layer, "--hold", "--mode", "center").status == 0
    written = Sdf.Layer.FindOrOpen(str(layer))
    spec = written.GetAttributeAtPath(f"{CAMERA}.exposure")
    assert not spec.HasInfo("timeSamples")
    assert not spec.HasInfo("spline")
    one = spec.default
    assert command("meter", shot, "--key", tmp_path / "one.usda", "--frames", 7, "--mode", "center").status == 0
    of_one = Sdf.Layer.FindOrOpen(str(tmp_path / "one.usda"))
    single = of_one.GetAttributeAtPath(f"{CAMERA}.exposure").default
    ended = command("meter", shot, "--frames", "1:12", "--mode", "center", "--json")
    readings = json.loads(ended.out)["frames"]
    expected = [frame["compensationStops"] for frame in readings]
    assert one == pytest.approx(sum(expected) / 12, abs=1e-4)
    assert single == pytest.approx(expected[6], abs=1e-6)


@pytest.mark.gl
def test_metered_once_more_over_its_own_keys_it_says_the_same(command: Command, tmp_path: Path) -> None:
    shot, layer, again = shot_file(tmp_path), tmp_path / "keys.usda", tmp_path / "again.usda"
    assert command("meter", shot, "--key", layer).status == 0
    assert command("meter", shot, "--edits", layer, "--mode", "average", "--key", again).status == 0
    for time in (1, 6.5, 12):
        shots = [Shot.open(shot, edits=edits) for edits in (layer, again)]
        first, second = (keyed.stage.GetPrimAtPath(CAMERA).GetAttribute("exposure").Get(time) for keyed in shots)
        assert first == pytest.approx(second, abs=0.01)


@pytest.mark.gl
def test_the_meter_s_grey_is_grey_in_the_picture(renderer: FrameRenderer, command: Command, tmp_path: Path) -> None:
    shot, layer = shot_file(tmp_path), tmp_path / "keys.usda"
    assert command("meter", shot, "--point", "middle", "--smoothing", 0.1, "--key", layer).status == 0
    picture = make_picture(renderer, Shot.open(shot, edits=layer), CAMERA, 1, PICTURE, Grade())
    light = picture.frame.color[8, 12, :3] @ [0.27222872, 0.67408177, 0.05368952] * picture.camera.exposure_scale
    assert light == pytest.approx(MIDDLE_GREY, rel=0.02)


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        (["--hold"], "--hold is for --key"),
        (["--baked"], "--baked is for --key"),
        (["--mode", "average", "--point", "middle"], "--point and --spot are for --mode spot, got average"),
        (["--spot", "3,2"], "--spot takes a place in the picture such as 0.5,0.5, got '3,2'"),
        (["--spot", "left"], "--spot takes a place in the picture such as 0.5,0.5, got 'left'"),
        (["--camera", "/World/none"], "there is no camera at /World/none"),
        (["--key", "SHOT"], "the shot itself is made of"),
        (["--key", "k.usdc"], "--key writes a layer as text, a .usda or .usd file, got k.usdc"),
        (["--key", "k.png"], "got k.png"),
        (["--compensation", "nan"], "--compensation takes stops from -100 to 100, got nan"),
        (["--smoothing", "0"], "--smoothing takes seconds from 0.001 to 3600, got 0"),
        (["--key", "no_folder/k.usda"], "the folder no_folder does not exist"),
    ],
)
def test_wrong_arguments_are_reported_in_one_line(
    command: Command, tmp_path: Path, typed: list[str], words: str
) -> None:
    shot = shot_file(tmp_path)
    ended = command("meter", shot, *(str(shot) if word == "SHOT" else word for word in typed))
    assert ended.status in (1, 2)
    assert words in ended.err
    assert "fault of the program" not in ended.err


@pytest.mark.gl
def test_a_lens_without_light_is_metered_but_exposes_nothing(command: Command, tmp_path: Path) -> None:
    closed = AUTO.replace("MODE", "average").replace("lens:neutralDensity = 0.3", "lens:transmittance = 0")
    shot = write_shot(tmp_path / "closed.usda", closed, SQUARE)
    ended = command("meter", shot, "--json")
    assert ended.status == 0
    (frame,) = json.loads(ended.out)["frames"]
    assert frame["luminanceNits"] > 0
    assert (frame["stops"], frame["compensationStops"], frame["luxOnFilm"]) == (None, None, 0)
    assert "inf" not in command("meter", shot).out.splitlines()[-1]
    keyed = command("meter", shot, "--key", tmp_path / "keys.usda")
    assert (keyed.status, "nothing to meter" in keyed.err) == (1, True)


@pytest.mark.gl
def test_a_black_shot_and_an_unknown_point_are_reported(command: Command, tmp_path: Path) -> None:
    black = write_shot(tmp_path / "black.usda", AUTO.replace("MODE", "spot").replace("1: 1, 6: 1, 7: 8", "1: 0"))
    ended = command("meter", black, "--mode", "average", "--key", tmp_path / "keys.usda")
    assert ended.status == 1
    assert "nothing to meter: every frame is black where the meter looks" in ended.err
    assert not (tmp_path / "keys.usda").exists()
    assert (
        "no focus point to meter is named 'midle': did you mean 'middle'?"
        in command("meter", black, "--point", "midle").err
    )
