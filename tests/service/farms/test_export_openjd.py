"""`pullfocus export-openjd`: options are checked before they reach a farm, and the farm's picture is that of `record`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path

import pytest

from render.cli.main import main
from tests.render.kits.cli_shots import CAMERA, SQUARE, write_shot

ROOT = Path(__file__).parents[3]
SMALL = ("--imageWidth", "64", "--rays", "4", "--supersample", "1", "--layers", "1")
CDL = """<ColorCorrection id="warm"><SOPNode><Slope>1.2 1 0.8</Slope><Offset>0 0 0</Offset><Power>1 1 1</Power></SOPNode>
</ColorCorrection>"""
SETTINGS = """
    def RenderSettings "Settings" {{
        int2 resolution = (96, 64)
        rel camera = </World/main_cam>
        {}
    }}
"""
needs_openjd = pytest.mark.skipif(find_spec("openjd") is None, reason="openjd-cli is not installed")


@pytest.fixture
def shot(tmp_path):
    return write_shot(tmp_path / "shot.usda", SQUARE, CAMERA)


def export(shot, *arguments, template=None):
    """The template that the command writes, and its exit status."""
    file = template or shot.parent / "job.template.json"
    status = main(["export-openjd", str(shot), str(file), *map(str, arguments)])
    return json.loads(file.read_text()) if status == 0 else None, status


def options(template):
    return template["steps"][0]["script"]["actions"]["onRun"]["args"][3:]


def frames(template):
    return template["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0]["range"]


def defaults(template):
    return {each["name"]: each.get("default") for each in template["parameterDefinitions"]}


def openjd(*arguments):
    """Call `openjd`, whose tasks find the `pullfocus` of this checkout."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "openjd", *map(str, arguments)]
    return subprocess.run(command, env=environment, capture_output=True, text=True)


def test_the_command_is_found_by_its_entry_point():
    values = {entry.name: entry.value for entry in entry_points(group="pullfocus.commands")}
    assert values["export-openjd"] == "service.farms.command:export_openjd"


@pytest.mark.gl
@needs_openjd
def test_a_task_draws_the_picture_that_record_draws(tmp_path):
    folder = tmp_path / 'it\'s a "shot" {x} $HOME é'
    folder.mkdir()
    shot = write_shot(folder / "shot 1;.usda", SQUARE, CAMERA)
    given = ("--frames", "3:5", "--stop", "1.4", *SMALL)
    _, status = export(shot, folder / "new folder" / "p i c.####.exr", *given)
    assert status == 0
    checked = openjd("check", folder / "job.template.json")
    assert checked.returncode == 0, checked.stdout
    ran = openjd("run", folder / "job.template.json", "--step", "Render", "--task-param", "Frame=4")
    assert ran.returncode == 0, ran.stdout
    assert main(["record", str(shot), str(tmp_path / "own.####.exr"), "--frames", "4", *given[2:]]) == 0
    assert os.listdir(folder / "new folder") == ["p i c.0004.exr"]
    assert (folder / "new folder" / "p i c.0004.exr").read_bytes() == (tmp_path / "own.0004.exr").read_bytes()


@needs_openjd
def test_a_template_elsewhere_says_what_to_give(shot, tmp_path, capsys):
    apart = tmp_path / "apart"
    apart.mkdir()
    template, _ = export(shot, tmp_path / "a b.####.png", template=apart / "job.json")
    assert {name for name, value in defaults(template).items() if value is None} == {
        "Shot",
        "ShotFolder",
        "OutputFolder",
    }
    said = capsys.readouterr().err.splitlines()[-1]
    assert f"-p Shot={shot} -p ShotFolder={tmp_path} -p OutputFolder={tmp_path}" in said
    assert openjd("check", apart / "job.json").returncode == 0


def test_without_options_all_frames_of_the_shot(shot):
    template, _ = export(shot)
    assert frames(template) == "1-12"
    assert defaults(template) == {
        "Shot": "shot.usda",
        "ShotFolder": ".",
        "OutputFolder": "renders",
        "ImageName": "shot.####.exr",
        "Width": 960,
        "Rays": 100,
    }
    assert options(template) == [
        "--imageWidth={{Param.Width}}",
        "--rays={{Param.Rays}}",
        "--frames={{Task.Param.Frame}}",
    ]


def test_frames_of_usdrecord_become_a_range(shot):
    template, _ = export(shot, "--frames", "9:1x-2,20,-3:-1")
    assert frames(template) == "-3--1,1-9:2,20"


def test_options_are_passed_on_each_in_one_word(shot):
    typed = (
        "-cam",
        "main_cam",
        "--look=",
        "--cdl",
        "1,1,1,-0.1,0,0,1,1,1",
        "--compensation",
        "-1.5",
        "--flare",
        "--unloaded",
        "--disableDomeLightVisibility",
    )
    template, status = export(shot, "renders/a.####.png", *typed, "--supersam", "2", "--stop", "2.8", "--noise", "0.01")
    assert status == 0
    assert options(template)[:-2] == [
        "--unloaded",
        "--camera=main_cam",
        "--disableDomeLightVisibility",
        "--noise=0.01",
        "--supersample=2.0",
        "--stop=2.8",
        "--compensation=-1.5",
        "--look=",
        "--cdl=1,1,1,-0.1,0,0,1,1,1",
        "--flare=1.0",
    ]
    assert "Rays" not in defaults(template)  # the noise takes their place


def test_files_that_options_name_are_parameters(shot, tmp_path):
    (tmp_path / "a.cc").write_text(CDL)
    for name in ("edits.usda", "session.usda"):
        (tmp_path / name).write_text("#usda 1.0\n")
    named = ("--edits", "edits.usda", "--sessionLayer", "session.usda", "--cdl", "a.cc#warm")
    words = [str(tmp_path / word) if "." in word else word for word in named]
    template, status = export(shot, "a.####.png", *words)
    assert status == 0
    expected = {"--edits={{Param.EditLayer}}", "--sessionLayer={{Param.SessionLayer}}", "--cdl={{Param.CdlFile}}#warm"}
    assert expected <= set(options(template))
    found = {
        name: value for name, value in defaults(template).items() if name in ("EditLayer", "SessionLayer", "CdlFile")
    }
    assert found == {"EditLayer": "edits.usda", "SessionLayer": "session.usda", "CdlFile": "a.cc"}


def test_a_lens_of_the_library_is_a_name(shot):
    template, status = export(shot, "a.####.png", "--lens", "double_gauss_50")
    assert status == 0
    assert "--lens=double_gauss_50" in options(template)


def test_settings_of_the_stage_stay_the_stages(tmp_path):
    shot = write_shot(tmp_path / "shot.usda", SQUARE, CAMERA, SETTINGS.format("int pullfocus:rays = 7"))
    template, status = export(shot, "--renderSettingsPrimPath", "/World/Settings")
    assert status == 0
    assert defaults(template)["Rays"] == 7
    assert "Width" not in defaults(template)  # the resolution has it


def test_products_are_written_below_a_folder(tmp_path, capsys):
    product = """rel products = [</World/P>]
    }
    def RenderProduct "P" {
        token productName = "%s"
    """
    shot = write_shot(tmp_path / "shot.usda", SQUARE, CAMERA, SETTINGS.format(product % "beauty.####.exr"))
    chosen = ("--products", "--renderSettingsPrimPath", "/World/Settings")
    template, status = export(shot, *chosen)
    assert status == 0
    assert template["steps"][0]["script"]["actions"]["onRun"]["args"][2] == "{{Param.OutputFolder}}"
    assert defaults(template).keys() == {"Shot", "ShotFolder", "OutputFolder"}
    write_shot(shot, SQUARE, CAMERA, SETTINGS.format(product % "beauty.exr"))
    assert export(shot, *chosen)[1] == 2
    assert "beauty.exr" in capsys.readouterr().err.splitlines()[-1]


@pytest.mark.parametrize(
    ("typed", "word"),
    [
        (["a.mp4"], "movie"),
        (["a.####.tga"], "tga"),
        (["a.exr"], "a.exr"),
        (["####/a.####.exr"], "folder"),
        (["%V/a.####.exr", "--stereo"], "folder"),
        (["a.####.exr", "--frames", "1:2x0.5"], "1.5"),
        (["a.####.exr", "--frames", "5:"], "frames"),
        (["a.####.exr", "--defaultTime"], "--defaultTime"),
        (["a.####.exr", "--long-exposure", "1:2"], "--long-exposure"),
        (["a.####.png", "--contact-sheet", "stop=1,2"], "--contact-sheet"),
        (["a.####.exr", "--traceToFile", "t.json"], "--traceToFile"),
        (["a.####.exr", "--rays", "0"], "rays"),
        (["a.####.exr", "--film", "kodachromatic"], "kodachromatic"),
        (["a.####.exr", "--renderer", "a{{b"], "no escape"),
        (["a.####.exr", "--camera", "/World/Square"], "Square"),
        (["a.####.exr", "--mask", "/Nobody"], "/Nobody"),
        (["a.####.png", "--ocio-config", "none.ocio"], "none.ocio"),
        (["a.####.exr", "--task-timeout", "0"], "--task-timeout"),
        (["a\n.####.exr"], "control character"),
        (["a.####.exr", "--nonsense"], "--nonsense"),
    ],
    ids=str,
)
def test_what_no_farm_can_do_is_refused_in_one_line(shot, capsys, typed, word):
    try:
        status = export(shot, *typed)[1]
    except SystemExit as stopped:  # the parser itself
        status = stopped.code
    assert status in (1, 2)
    said = capsys.readouterr().err.splitlines()
    assert word in said[-1]
    assert sum(line.startswith("pullfocus") for line in said) == 1
    assert not (shot.parent / "job.template.json").exists()


def test_braces_are_taken_in_names_of_pictures_alone(tmp_path, capsys):
    shot = write_shot(tmp_path / "a{{b.usda", SQUARE, CAMERA)
    assert export(shot, "a.####.exr")[1] == 2
    assert "{{" in capsys.readouterr().err.splitlines()[-1]
    template, status = export(write_shot(tmp_path / "ab.usda", SQUARE, CAMERA), tmp_path / "a{{b.####.exr")
    assert status == 0
    assert defaults(template)["ImageName"] == "a{{b.####.exr"


def test_a_template_ends_with_json(shot, capsys):
    assert export(shot, template=shot)[1] == 2
    assert "a template is a .json file" in capsys.readouterr().err
    assert export(shot, template=shot.parent / "none" / "job.json")[1] == 1
