"""`pullfocus inspect` and `pullfocus focus-curve` tell what is in a shot, for people and for programs."""

from __future__ import annotations

import csv
import io
import json
import re
from pathlib import Path

import pytest
from pxr import Sdf, Usd

from render.cli.console import print_findings
from render.stage import Finding
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, write_shot

HAIR = '\n    def BasisCurves "Hair" {}\n'
BROKEN_CAMERA = CAMERA.replace("main_cam", "broken").replace("focalLength = 0.5", "focalLength = -0.5")


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A shot with a camera that works, one that does not, and something that is not honoured."""
    return write_shot(tmp_path / "shot.usda", SQUARE, HAIR, BROKEN_CAMERA, CAMERA)


def test_json_has_all_that_was_found(pullfocus: Command, shot: Path) -> None:
    ended = pullfocus("inspect", shot, "--json")
    inspection = json.loads(ended.out)
    assert ended.status == 0
    assert (
        inspection["frameRange"]["start"],
        inspection["frameRange"]["end"],
        inspection["frameRange"]["framesPerSecond"],
    ) == (
        1,
        12,
        24,
    )
    assert (inspection["upAxis"], inspection["metersPerUnit"]) == ("Y", 1)
    assert inspection["cameras"] == ["/World/broken", "/World/main_cam"]
    assert inspection["defaultCamera"]["path"] == "/World/main_cam"
    assert (inspection["primCount"], inspection["triangleCount"], inspection["lightCount"]) == (1, 2, 0)
    [lens] = inspection["readouts"]
    assert (lens["camera"], lens["focalLengthMm"], lens["fStop"]) == ("/World/main_cam", 50, 2)
    assert lens["focusDistanceM"] == 5
    assert {note["path"] for note in inspection["notes"]} == {"/World/Hair", "/World/broken"}


def _keys(value: object, path: str = "") -> set[str]:
    """Paths of all keys, as the reference writes them."""
    if isinstance(value, list):
        return {path} | set().union(*(_keys(each, f"{path}[]") for each in value)) if path else set()
    if not isinstance(value, dict):
        return {path}
    return set().union(*(_keys(each, f"{path}.{name}".lstrip(".")) for name, each in value.items()))


def test_payloads_are_left_out_where_that_is_asked_for(pullfocus: Command, tmp_path: Path) -> None:
    (tmp_path / "asset.usda").write_text('#usda 1.0\n(\n    defaultPrim = "A"\n)\ndef Sphere "A" {}\n')
    loads = '\n    def "Lamp" (payload = @./asset.usda@) {}\n'
    shot = write_shot(tmp_path / "shot.usda", SQUARE, loads, CAMERA)
    loaded, unloaded = (json.loads(pullfocus("inspect", shot, "--json", *more).out) for more in ((), ("--unloaded",)))
    assert loaded["primCount"] == unloaded["primCount"] + 1
    assert [note["code"] for note in unloaded["notes"]] == ["unloaded_payloads"]
    assert loaded["notes"] == []


def test_every_key_is_in_the_reference(pullfocus: Command, tmp_path: Path) -> None:
    odd = CAMERA.replace("main_cam", "odd").replace(
        '"odd"\n    {',
        '"odd" (\n        prepend apiSchemas = ["ApertureAPI"]\n    )\n    {\n        int aperture:blades = 2',
    )
    eyes = [
        CAMERA.replace("main_cam", role).replace(
            "float fStop", f'uniform token stereoRole = "{role}"\n        float fStop'
        )
        for role in ("left", "right")
    ]
    plated = CAMERA.replace('"main_cam"', '"main_cam" (\n        prepend apiSchemas = ["BackPlateAPI:sky"]\n    )')
    shot = write_shot(tmp_path / "shot.usda", SQUARE, HAIR, odd, plated, *eyes)
    inspection = json.loads(pullfocus("inspect", shot, "--json").out)
    assert (inspection["format"], inspection["version"]) == ("pullfocus.inspection", 1)
    written = {key for key in _keys(inspection) if not key.endswith("]")}
    page = (Path(__file__).parents[3] / "docs/reference/inspection.md").read_text(encoding="utf-8")
    documented = set(re.findall(r"^\| `([^`]+)` \|", page, re.MULTILINE))
    lists = {key for key in written if any(other.startswith(f"{key}[]") for other in written)}
    assert written - lists == documented - lists
    assert lists <= documented | {"exposures[].equivalents"}


def test_people_read_the_same(pullfocus: Command, shot: Path) -> None:
    ended = pullfocus("inspect", shot)
    assert ended.status == 0
    for words in (
        "1 to 12, 24 a second",
        "/World/main_cam  50 mm  f/2",
        "/World/broken  cannot be used",
        "/World/Hair",
    ):
        assert words in ended.out


def test_what_the_validators_find_is_listed(pullfocus: Command, tmp_path: Path) -> None:
    camera = CAMERA.replace(
        'def Camera "main_cam"\n    {',
        'def Camera "main_cam" (\n        prepend apiSchemas = ["ApertureAPI"]\n    )\n    {\n        int aperture:blades = 2',
    )
    inspection = json.loads(pullfocus("inspect", write_shot(tmp_path / "iris.usda", SQUARE, camera), "--json").out)
    [problem] = inspection["validation"]
    assert problem["path"].startswith("/World/main_cam")
    assert "blades" in problem["message"]


def test_warnings_are_few_and_of_every_kind(capsys: pytest.CaptureFixture[str]) -> None:
    many = [Finding("curves", f"/c{number}", f"/c{number} is not drawn") for number in range(30)]
    print_findings([*many, Finding("texture", "/t", "texture t is missing")], "shot.usda")
    lines = capsys.readouterr().err.splitlines()
    assert lines[:2] == ["warning: /c0 is not drawn", "warning: texture t is missing"]
    assert len(lines) == 9
    assert lines[-1] == "warning: and 23 more, see: pullfocus inspect shot.usda"


def test_a_curve_has_every_frame_of_the_shot(pullfocus: Command, shot: Path) -> None:
    curve = json.loads(pullfocus("focus-curve", shot).out)
    assert [sample["timeCode"] for sample in curve["samples"]] == list(range(1, 13))
    assert {sample["focusDistanceM"] for sample in curve["samples"]} == {5}


def test_a_curve_of_some_frames_runs_forward(pullfocus: Command, shot: Path) -> None:
    text = pullfocus("focus-curve", shot, "--format", "csv", "--frames", "9,1:5x2").out
    assert [float(row["time_code"]) for row in csv.DictReader(io.StringIO(text))] == [1, 3, 5, 9]


def test_limits_by_the_image_distance_are_closer(pullfocus: Command, shot: Path) -> None:
    """The circle is larger by v / f = 5 / (5 - 0.05), so that the limits are as much nearer in inverse depth."""
    reaches = []
    for options in ([], ["--circle-distance", "imageDistance"]):
        [sample] = json.loads(pullfocus("focus-curve", shot, "--frames", "1", *options).out)["samples"]
        reaches.append(1 / sample["nearM"] - 1 / 5)
    assert reaches[0] / reaches[1] == pytest.approx(5 / 4.95, rel=1e-6)
    misplaced = pullfocus("focus-curve", shot, "--import", shot, "--circle-distance", "imageDistance")
    assert (misplaced.status, misplaced.err.count("\n")) == (2, 1)


def test_opentrackio_curves_have_the_lenss_distortion(pullfocus: Command, shot: Path) -> None:
    """It is that of the lens alone at the same focus (OpenLensIO 1.0.1, section 4.1), and other formats have none."""
    distagon = ("--frames", "1,2", "--lens", "distagon_35", "--format")
    first, second = json.loads(pullfocus("focus-curve", shot, *distagon, "opentrackio").out)
    assert first["lens"]["distortion"] == second["lens"]["distortion"]
    [entry] = first["lens"]["distortion"]
    assert entry["model"] == "Brown-Conrady D-U"
    alone = pullfocus("lenses", "opentrackio", "distagon_35", "--f-stop", 2, "--focus", 5)
    expected = json.loads(alone.out)["lens"]["distortion"][0]["radial"]
    assert entry["radial"] == pytest.approx(expected, rel=0.02)
    assert "distortion" not in pullfocus("focus-curve", shot, *distagon, "json").out
    [thin] = json.loads(pullfocus("focus-curve", shot, "--frames", "1", "--format", "opentrackio").out)
    assert "distortion" not in thin["lens"]


@pytest.mark.parametrize("baked", [False, True])
def test_a_curve_as_a_layer_focuses_the_shot(baked: bool, pullfocus: Command, shot: Path) -> None:
    out = shot.parent / "focus.usda"
    ended = pullfocus("focus-curve", shot, "--format", "usda", "--out", out, *(["--baked"] if baked else []))
    assert (ended.status, ended.out) == (0, "")
    above = Sdf.Layer.CreateAnonymous()
    above.subLayerPaths = [str(out), str(shot)]
    stage = Usd.Stage.Open(above)
    focus = stage.GetAttributeAtPath("/World/main_cam.focusDistance")
    assert (focus.GetNumTimeSamples() > 0, focus.HasSpline()) == (baked, not baked)
    assert focus.Get(6) == pytest.approx(5)


def test_help_lists_every_command(pullfocus: Command) -> None:
    ended = pullfocus("--help")
    assert ended.status == 0
    for command in ("record", "inspect", "focus-curve", "demo", "serve"):
        assert command in ended.out


@pytest.mark.parametrize("command", ["record", "inspect", "focus-curve", "demo", "serve"])
def test_each_command_has_its_own_help(command: str, pullfocus: Command) -> None:
    ended = pullfocus(command, "--help")
    assert ended.status == 0
    assert f"pullfocus {command}" in ended.out


def test_an_orthographic_camera_has_no_focal_length(pullfocus: Command, tmp_path: Path) -> None:
    parallel = CAMERA.replace("focalLength = 0.5", 'focalLength = 0.5\n        token projection = "orthographic"')
    assert "main_cam  orthographic  " in pullfocus("inspect", write_shot(tmp_path / "shot.usda", SQUARE, parallel)).out
