"""Bad input ends a command with one clear sentence and the right exit status, and leaves nothing behind."""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pxr import Usd

from render.errors import InputError, one_line
from render.stage.findings import Finding
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, Ended, small, write_shot

DONE, FAILED, WRONG_ARGUMENTS = 0, 1, 2


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture
def good(tmp_path: Path) -> Path:
    """A shot that nothing is wrong with."""
    return write_shot(tmp_path / "good.usda", SQUARE, CAMERA)


def assert_one_sentence(ended: Ended, status: int, *words: str) -> None:
    """It failed with that status, and the last line says why in these words."""
    assert ended.status == status, ended.err
    assert ended.out == ""
    assert "Traceback" not in ended.err
    *before, last = ended.err.splitlines()
    assert last.startswith("pullfocus")
    assert not any(line.startswith("pullfocus") for line in before)
    assert "fault of the program" not in last
    for word in words:
        assert word in last


def _not_usd(folder: Path) -> Path:
    path = folder / "holiday.usda"
    path.write_bytes(b"\xff\xd8\xff\xe0 a photograph")
    return path


def _truncated_crate(folder: Path) -> Path:
    whole = folder / "whole.usdc"
    assert Usd.Stage.Open(str(write_shot(folder / "text.usda", SQUARE, CAMERA))).Export(str(whole))
    path = folder / "truncated.usdc"
    path.write_bytes(whole.read_bytes()[: whole.stat().st_size * 2 // 3])
    return path


def _no_file(folder: Path) -> Path:
    return folder / "nowhere.usda"


def _folder(folder: Path) -> Path:
    return folder


BAD_STAGES: list[tuple[Callable[[Path], Path], str]] = [
    (_not_usd, "holiday.usda"),
    (_truncated_crate, "truncated.usdc"),
    (_no_file, "nowhere.usda"),
    (_folder, "not a file"),
]


@pytest.mark.parametrize("command", ["record", "inspect", "focus-curve"])
@pytest.mark.parametrize(("make", "word"), BAD_STAGES, ids=[make.__name__.strip("_") for make, _ in BAD_STAGES])
def test_what_is_no_stage_is_named(
    make: Callable[[Path], Path], word: str, command: str, pullfocus: Command, tmp_path: Path
) -> None:
    stage = make(tmp_path)
    out = tmp_path / "frame.png"
    ended = pullfocus(command, stage, *([out] if command == "record" else []))
    assert_one_sentence(ended, FAILED, word)
    assert not out.exists()


def test_a_missing_reference_is_warned_of_and_the_rest_is_drawn(pullfocus: Command, tmp_path: Path) -> None:
    chair = '\n    def "Chair" (references = @./furniture/chair.usda@) {}\n'
    ended = pullfocus("record", write_shot(tmp_path / "a.usda", SQUARE, chair, CAMERA), tmp_path / "f.png", *small())
    assert ended.status == DONE
    assert "warning: furniture/chair.usda is missing: prim /World/Chair refers to it" in ended.err
    assert (tmp_path / "f.png").is_file()


@pytest.mark.parametrize("options", [(), ("--camera", "/World/main_cam")])
@pytest.mark.parametrize("command", ["record", "focus-curve"])
def test_a_stage_whose_only_sublayer_is_missing(
    command: str, options: tuple[str, ...], pullfocus: Command, tmp_path: Path
) -> None:
    path, out = tmp_path / "layered.usda", tmp_path / "frame.png"
    path.write_text("#usda 1.0\n(\n    subLayers = [@./set_dressing.usda@]\n)\n")
    ended = pullfocus(command, path, *([out] if command == "record" else []), *options)
    assert_one_sentence(ended, FAILED, options[-1] if options else "set_dressing.usda is missing")
    assert "warning: set_dressing.usda is missing: layer layered.usda refers to it" in ended.err
    assert not out.exists()


def test_inspect_lists_missing_files(pullfocus: Command, tmp_path: Path) -> None:
    path = tmp_path / "layered.usda"
    path.write_text("#usda 1.0\n(\n    subLayers = [@./set_dressing.usda@]\n)\n")
    ended = pullfocus("inspect", path)
    assert ended.status == DONE
    assert "set_dressing.usda is missing: layer layered.usda" in ended.out


@pytest.mark.parametrize("command", ["record", "focus-curve"])
@pytest.mark.parametrize("path", ["/World/Square", "/World/no_such", "no_such", "not a path", "/", ""])
def test_a_camera_path_that_is_no_camera_is_named(path: str, command: str, pullfocus: Command, good: Path) -> None:
    out = good.parent / "frame.png"
    ended = pullfocus(command, good, *([out] if command == "record" else []), "--camera", path)
    assert_one_sentence(ended, FAILED, path)
    assert not out.exists()


@pytest.mark.parametrize(
    ("attribute", "word"),
    [
        ("float focalLength = -0.5", "focal"),
        ("float focalLength = 0", "focal"),
        ("float horizontalAperture = 0", "Aperture"),
        ("float verticalAperture = -0.24", "Aperture"),
        ("float fStop = -2", "f"),
        ("float focusDistance = nan", "focus"),
        ("float2 clippingRange = (10, 1)", "clipping"),
        ("double3 xformOp:translate = (nan, 0, 5)", "main_cam"),
        ("double3 xformOp:scale = (0, 0, 0)", "main_cam"),
    ],
)
def test_impossible_numbers_of_a_camera_are_named(
    attribute: str, word: str, pullfocus: Command, tmp_path: Path
) -> None:
    name = attribute.split(" = ")[0]
    lines = [line for line in CAMERA.splitlines() if name not in line]
    if "scale" in attribute:
        lines = [line.replace('["xformOp:translate"]', '["xformOp:translate", "xformOp:scale"]') for line in lines]
    lines.insert(-1, f"        {attribute}")
    shot = write_shot(tmp_path / "bad_camera.usda", SQUARE, "\n".join(lines) + "\n")
    out = tmp_path / "frame.png"
    assert_one_sentence(pullfocus("record", shot, out, *small()), FAILED, word)
    assert not out.exists()


def test_geometry_that_stands_nowhere_is_left_out_and_named(pullfocus: Command, tmp_path: Path) -> None:
    nowhere = SQUARE.replace("Square", "Nowhere").replace(
        "color3f[]",
        "matrix4d xformOp:transform = ((nan, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))\n"
        '        uniform token[] xformOpOrder = ["xformOp:transform"]\n        color3f[]',
    )
    shot = write_shot(tmp_path / "nan.usda", SQUARE, nowhere, CAMERA)
    ended = pullfocus("record", shot, tmp_path / "frame.png", *small())
    assert "Traceback" not in ended.err
    assert "/World/Nowhere" in ended.err
    assert ended.status in (0, FAILED)


def test_an_empty_stage_has_nothing_to_frame(pullfocus: Command, tmp_path: Path) -> None:
    shot = tmp_path / "empty.usda"
    shot.write_text("#usda 1.0\n")
    assert_one_sentence(pullfocus("record", shot, tmp_path / "frame.png"), FAILED, "empty.usda")
    assert_one_sentence(pullfocus("focus-curve", shot), FAILED, "empty.usda", "camera")
    assert pullfocus("inspect", shot).status == 0


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--imageWidth", "0"], "0"),
        (["--imageWidth", "-5"], "-5"),
        (["--imageWidth", "1000000"], "1000000"),
        (["--imageWidth", "wide"], "wide"),
        (["--frames", "1:1000000000"], "100,000"),
        (["--frames", ""], "frames"),
        (["--frames", "9:1x2"], "9:1x2"),
        (["--frames", "1:3"], "####"),
        (["--rays", "0"], "rays"),
        (["--layers", "99"], "layers"),
        (["--supersample", "0.5"], "supersample"),
        (["--wavelengths", "0"], "wavelengths must be from 1 to 64, got 0"),
        (["--wavelengths", "65"], "wavelengths must be from 1 to 64, got 65"),
        (["--seed", "-1"], "seed"),
        (["--engine", "magic"], "magic"),
        (["--shading", "toon"], "toon"),
        (["--purposes", "secret"], "secret"),
        (["--complexity", "utmost"], "utmost"),
        (["--aov", "depth"], "EXR"),
        (["--lens", "planar"], "did you mean planar_50"),
        (["--lens", ""], "the library has double_gauss_50"),
        (["--film", "porta"], "porta"),
        (["--no-such-option"], "--no-such-option"),
    ],
    ids=" ".join,
)
def test_wrong_arguments_are_reported_before_rendering(
    options: list[str], word: str, pullfocus: Command, good: Path
) -> None:
    out = good.parent / "frame.png"
    assert_one_sentence(pullfocus("record", good, out, *options), WRONG_ARGUMENTS, word)
    assert not out.exists()


@pytest.mark.parametrize("name", ["frame.avi", "frame.tga", "frame"])
def test_an_ending_that_is_no_picture_format_is_refused(name: str, pullfocus: Command, good: Path) -> None:
    assert_one_sentence(pullfocus("record", good, good.parent / name), WRONG_ARGUMENTS, name)


def test_an_unknown_part_of_an_exr_is_refused(pullfocus: Command, good: Path) -> None:
    ended = pullfocus("record", good, good.parent / "frame.exr", "--aov", "color,smell")
    assert_one_sentence(ended, WRONG_ARGUMENTS, "smell")


@pytest.mark.parametrize(
    "arguments", [[], ["develop"], ["record"], ["inspect"], ["focus-curve", "--format", "pdf", "x"]]
)
def test_an_incomplete_command_says_where_help_is(arguments: list[str], pullfocus: Command) -> None:
    assert_one_sentence(pullfocus(*arguments), WRONG_ARGUMENTS, "--help")


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--gaps", "hold"), "--gaps is for --import"),
        (("--first-frame", "1"), "--first-frame is for --import"),
        (("--import", "curve.csv", "--frames", "1"), "--frames is not for --import"),
        (("--import", "curve.csv", "--lens", "planar_50"), "--lens is not for --import"),
        (("--import", "curve.csv", "--format", "json", "--baked"), "--baked"),
    ],
)
def test_options_of_an_import_and_of_solving_are_kept_apart(
    options: tuple[str, ...], told: str, pullfocus: Command, good: Path
) -> None:
    assert_one_sentence(pullfocus("focus-curve", good, *options), WRONG_ARGUMENTS, told)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (None, "No such file"),
        ("frame,focus_distance_m\n1,2\n2,x\n3,2\n", "row 3 cannot be used"),
        ("frame,focus_distance_m\n1,2\n2,2\n5,2\n", "frames 3 to 4"),
        ("frame,focus_distance\n1,2\n", "focus_distance_m"),
    ],
)
def test_a_curve_that_cannot_be_imported_is_reported(
    content: str | None, told: str, pullfocus: Command, good: Path
) -> None:
    source, out = good.parent / "curve.csv", good.parent / "pulled.usda"
    if content is not None:
        source.write_text(content)
    assert_one_sentence(pullfocus("focus-curve", good, "--import", source, "--out", out), FAILED, told)
    assert not out.exists()


def test_baked_needs_a_layer_to_bake_into(pullfocus: Command, good: Path) -> None:
    assert_one_sentence(pullfocus("focus-curve", good, "--format", "csv", "--baked"), WRONG_ARGUMENTS, "--baked")


def test_a_missing_folder_is_reported_before_rendering(pullfocus: Command, good: Path) -> None:
    out = good.parent / "no_such" / "frame.png"
    assert_one_sentence(pullfocus("record", good, out), FAILED, "no_such", "does not exist")


def test_a_folder_at_the_files_path_is_reported_before_rendering(
    pullfocus: Command, good: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (good.parent / "frame.0002.png").mkdir()
    monkeypatch.setattr("render.frame.FrameRenderer", lambda: pytest.fail("it began to render"))
    ended = pullfocus("record", good, good.parent / "frame.####.png", "--frames", "1:3")
    assert_one_sentence(ended, FAILED, "frame.0002.png: it is a folder, expected a file")


def test_a_layer_of_edits_that_is_none_is_named(pullfocus: Command, good: Path) -> None:
    edits = good.parent / "edits.usda"
    ended = pullfocus("record", good, good.parent / "frame.png", "--edits", edits)
    assert_one_sentence(ended, FAILED, "edits.usda")


@pytest.mark.parametrize("ending", [".exr", ".png"])
def test_a_full_disk_is_reported_and_leaves_no_half_file(ending: str, good: Path) -> None:
    def no_file_over_a_few_bytes() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (256, 256))

    out = good.parent / "out"
    out.mkdir()
    command = [sys.executable, "-m", "render.cli", "record", good, out / f"frame{ending}", *small()]
    ended = subprocess.run(
        [str(part) for part in command],
        capture_output=True,
        text=True,
        preexec_fn=no_file_over_a_few_bytes,
        check=False,
    )
    assert_one_sentence(Ended(ended.returncode, ended.stdout, ended.stderr), FAILED, "full")
    assert list(out.iterdir()) == []


def test_a_full_disk_behind_standard_output_is_reported(good: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    with Path("/dev/full").open("w") as full:
        ended = subprocess.run(
            [sys.executable, "-m", "render.cli", "inspect", str(good)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert_one_sentence(Ended(ended.returncode, "", ended.stderr), FAILED, "standard output")


def test_a_shot_of_several_cameras_asks_for_one_to_be_named(pullfocus: Command, tmp_path: Path) -> None:
    two = write_shot(tmp_path / "two.usda", SQUARE, *(CAMERA.replace("main_cam", name) for name in ("left", "right")))
    ended = pullfocus("focus-curve", two)
    assert_one_sentence(ended, FAILED, "has 2 cameras", "--camera", "/World/left, /World/right")


@pytest.mark.parametrize(
    ("mask", "words"),
    [
        ("World/Square", "absolute prim paths, got World/Square"),
        ("/World/Square /a%b", "absolute prim paths, got /a%b"),
        ("/World/Square.points", "absolute prim paths, got /World/Square.points"),
        ("", "absolute prim paths, got none"),
        ("/World/Sqare", "does not hold: /World/Sqare"),
    ],
)
def test_a_mask_that_names_no_prim_is_refused(mask: str, words: str, pullfocus: Command, good: Path) -> None:
    ended = pullfocus("record", good, good.parent / "out.png", "--mask", mask, *small())
    assert_one_sentence(ended, WRONG_ARGUMENTS, "--mask", words)


@pytest.mark.parametrize(
    "options",
    [["--engine", "magic"], ["--rays", "0"], ["--shading", "toon"], ["--imageWidth", "0"], ["--mask", "Square"]],
    ids=" ".join,
)
def test_wrong_arguments_are_reported_before_a_bad_stage(
    options: list[str], pullfocus: Command, tmp_path: Path
) -> None:
    ended = pullfocus("record", _not_usd(tmp_path), tmp_path / "out.png", *options)
    assert ended.status == WRONG_ARGUMENTS
    assert "holiday.usda" not in ended.err


def test_settings_are_checked_without_loading_opengl() -> None:
    script = "import sys, render.cli.record; sys.exit('OpenGL' in sys.modules or 'moderngl' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


def test_a_demo_where_a_file_lies_says_so(pullfocus: Command, good: Path) -> None:
    assert_one_sentence(pullfocus("demo", good), FAILED, f"{good} is to be a directory", "is a file")
    assert good.read_text().startswith("#usda")


@pytest.mark.parametrize(
    "arguments",
    [
        ("record", "no\nshot.usda", "frame.png"),
        ("record", "{good}", "no\nfolder/frame.png"),
        ("record", "{good}", "frame.png", "--camera", "/no\ncamera"),
        ("record", "{good}", "frame.png", "--lens", "no\nlens.zmx"),
        ("record", "{good}", "frame.png", "--no\nsuch-option"),
        ("inspect", "no\nshot.usda"),
        ("lenses", "show", "no\nlens.zmx"),
        ("lenses", "show", "{folder}/two\nlines.dat"),
        ("lenses", "show", "thin_50", "--out", "no\nfolder/lens.png"),
        ("bench", "lens", "--json", "no\nfolder/bench.json"),
    ],
)
def test_a_name_with_a_line_break_does_not_break_the_message(
    arguments: tuple[str, ...], pullfocus: Command, good: Path
) -> None:
    (good.parent / "two\nlines.dat").write_text("50 5 -1.5 20\n-50 0 1 20\n")
    typed = [word.format(good=good, folder=good.parent) for word in arguments]
    ended = pullfocus(*typed)
    assert ended.status in (FAILED, WRONG_ARGUMENTS)
    assert_one_sentence(ended, ended.status, r"\n")
    assert len(ended.err.splitlines()) == 1


def test_what_a_lens_is_called_stays_on_its_line(pullfocus: Command, tmp_path: Path) -> None:
    file = tmp_path / "two\nlines.dat"
    file.write_text("50 5 1.5 20\n-50 0 1 20\n")
    ended = pullfocus("lenses", "show", file)
    assert ended.status == DONE
    assert ended.out.splitlines()[0].strip() == r"two\nlines"


@given(st.text())
def test_any_words_stay_on_one_line(text: str) -> None:
    line = one_line(text)
    assert len(line.splitlines()) <= 1
    line.encode()  # which halves of pairs could not be
    assert one_line(line) == line
    assert Finding("code", "/path", text).message == InputError(text).detail == line


@pytest.mark.parametrize("name", ["Objektiv für Nähe", "ロケ\u3000地", "a\u00a0b", r"c:\new", "Ω × 2"])
def test_words_of_any_script_are_left_as_they_are(name: str) -> None:
    assert one_line(name) == name
