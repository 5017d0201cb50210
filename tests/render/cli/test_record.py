"""`pullfocus record` writes the frames that were asked for, and says what it does."""

from __future__ import annotations

import ctypes
import json
import os
import pty
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest
from numpy.typing import NDArray

from render.cli.main import main
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot

WIDTH, HEIGHT = 48, 32


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A red square, 5 m before the camera."""
    return write_shot(tmp_path / "shot.usda", SQUARE, CAMERA)


def read(path: Path, part: int = 0) -> NDArray[np.float32]:
    """The pixels of one part of a picture, ``(height, width, channels)``."""
    return np.asarray(OpenImageIO.ImageBuf(str(path), part, 0).get_pixels(OpenImageIO.FLOAT))


def part_names(path: Path) -> list[str]:
    """Names of the parts of an EXR."""
    picture = OpenImageIO.ImageInput.open(str(path))
    names = []
    while picture.seek_subimage(len(names), 0):
        names.append(picture.spec().getattribute("name"))
    return names


@pytest.mark.parametrize("ending", [".png", ".jpg", ".jpeg", ".exr", ".PNG"])
def test_the_ending_decides_the_format(ending: str, pullfocus: Command, shot: Path) -> None:
    out = shot.parent / f"frame{ending}"
    ended = pullfocus("record", shot, out, *small())
    assert (ended.status, ended.out) == (0, "")
    picture = read(out)
    assert picture.shape[:2] == (HEIGHT, WIDTH)
    red, green = picture[HEIGHT // 2, WIDTH // 2, :2]
    assert red > 1.3 * green


def test_each_frame_gets_its_file_and_json_lists_them(pullfocus: Command, shot: Path) -> None:
    ended = pullfocus("record", shot, shot.parent / "f.###.png", "--frames", "1,4:8x2", "--json", *small())
    result = json.loads(ended.out)
    files = [shot.parent / f"f.{number:03}.png" for number in (1, 4, 6, 8)]
    assert [Path(frame["file"]) for frame in result["frames"]] == files
    assert [frame["time"] for frame in result["frames"]] == [1, 4, 6, 8]
    assert all(file.is_file() for file in files)
    assert (result["camera"], result["settings"]["width"], result["settings"]["height"]) == (
        "/World/main_cam",
        WIDTH,
        HEIGHT,
    )


@pytest.mark.parametrize(("options", "moments"), [((), 1), (("--motion-by", "moments"), 16)])
def test_who_says_how_motion_is_looked_at_wants_motion(
    options: tuple[str, ...], moments: int, pullfocus: Command, shot: Path
) -> None:
    ended = pullfocus("record", shot, shot.parent / "f.png", "--json", *small("--engine", "pinhole"), *options)
    assert json.loads(ended.out)["settings"]["motion"] == moments


def test_without_frames_the_first_one_is_recorded(pullfocus: Command, shot: Path) -> None:
    ended = pullfocus("record", shot, shot.parent / "f.##.png", *small())
    assert ended.status == 0
    assert [file.name for file in shot.parent.glob("f.*.png")] == ["f.01.png"]


def test_the_same_command_gives_the_same_bytes(pullfocus: Command, shot: Path) -> None:
    files = [shot.parent / "one.png", shot.parent / "two.png"]
    for file in files:
        assert pullfocus("record", shot, file, "--seed", 7, *small()).status == 0
    assert files[0].read_bytes() == files[1].read_bytes()


def test_an_exr_holds_the_requested_parts(pullfocus: Command, shot: Path) -> None:
    out = shot.parent / "frame.exr"
    assert pullfocus("record", shot, out, "--aov", "color,depth,prim_id", *small()).status == 0
    assert part_names(out) == ["rgba", "depth", "prim_id"]
    assert read(out, 1)[HEIGHT // 2, WIDTH // 2, 0] == pytest.approx(5, rel=1e-4)


def test_unlit_shading_shows_the_base_colour(pullfocus: Command, shot: Path) -> None:
    out = shot.parent / "frame.exr"
    assert pullfocus("record", shot, out, "--shading", "unlit", "--engine", "pinhole", *small()).status == 0
    # The square's displayColor, from linear Rec. 709 to ACEScg (matrix of ACES TB-2014-004 and Rec. 709 primaries).
    acescg = np.array([[0.6131, 0.3395, 0.0474], [0.0702, 0.9164, 0.0134], [0.0206, 0.1096, 0.8698]]) @ [0.8, 0.2, 0.1]
    assert read(out)[HEIGHT // 2, WIDTH // 2] == pytest.approx([*acescg, 1], rel=0.01)


@pytest.mark.parametrize("engine", ["lens", "accumulation", "pinhole"])
def test_every_engine_of_today_makes_the_picture(engine: str, pullfocus: Command, shot: Path) -> None:
    out = shot.parent / "frame.png"
    assert pullfocus("record", shot, out, "--engine", engine, *small()).status == 0
    picture = read(out)
    assert picture[HEIGHT // 2, WIDTH // 2, 0] > picture[0, 0, 0]


def test_the_chosen_camera_is_reported_unless_named(pullfocus: Command, shot: Path) -> None:
    out = shot.parent / "frame.png"
    assert "/World/main_cam" in pullfocus("record", shot, out, *small()).err.splitlines()[0]
    assert not pullfocus("record", shot, out, "--camera", "/World/main_cam", *small()).err.startswith("camera")


def test_a_stage_without_a_camera_is_framed(pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "no_camera.usda", SQUARE)
    out = tmp_path / "frame.png"
    ended = pullfocus("record", shot, out, *small())
    assert ended.status == 0
    assert ended.err.startswith("camera: none of the stage (")
    picture = read(out)
    assert picture[picture.shape[0] // 2, WIDTH // 2, 0] > picture[0, 0, 0]


def test_a_mask_leaves_out_all_else(pullfocus: Command, tmp_path: Path) -> None:
    behind = SQUARE.replace("Square", "Wall").replace("0)", "-1)")
    shot = write_shot(tmp_path / "two.usda", SQUARE, behind, CAMERA)
    out = tmp_path / "frame.exr"
    depths = {}
    for mask in ("/World/Square", "/World/Wall", "/World/Square,/World/Wall"):
        assert pullfocus("record", shot, out, "--mask", mask, "--aov", "color,depth", *small()).status == 0
        depths[mask] = float(read(out, 1)[HEIGHT // 2, WIDTH // 2, 0])
    assert depths["/World/Square"] == pytest.approx(5, rel=1e-4)
    assert depths["/World/Wall"] == pytest.approx(6, rel=1e-4)
    assert depths["/World/Square,/World/Wall"] == pytest.approx(5, rel=1e-4)


def test_purposes_choose_what_is_drawn(pullfocus: Command, tmp_path: Path) -> None:
    proxy = SQUARE.replace("int[] faceVertexCounts", 'uniform token purpose = "proxy"\n        int[] faceVertexCounts')
    shot = write_shot(tmp_path / "proxy.usda", proxy, CAMERA)
    out = tmp_path / "frame.exr"
    coverage = {}
    for purposes in ("render", "proxy", "render,proxy"):
        assert pullfocus("record", shot, out, "--purposes", purposes, *small()).status == 0
        coverage[purposes] = float(read(out)[HEIGHT // 2, WIDTH // 2, 3])
    assert coverage == pytest.approx({"render": 0, "proxy": 1, "render,proxy": 1}, abs=1e-3)


def test_edits_are_put_over_the_shot(pullfocus: Command, shot: Path) -> None:
    edits = shot.parent / "edits.usda"
    edits.write_text(
        '#usda 1.0\n(\n    timeCodesPerSecond = 24\n)\nover "World"\n{\n    over "main_cam"\n    {\n'
        "        double3 xformOp:translate = (0, 0, 8)\n    }\n}\n"
    )
    out = shot.parent / "frame.exr"
    assert pullfocus("record", shot, out, "--edits", edits, "--aov", "color,depth", *small()).status == 0
    assert read(out, 1)[HEIGHT // 2, WIDTH // 2, 0] == pytest.approx(8, rel=1e-4)


def test_what_is_not_honoured_is_warned_of_once(pullfocus: Command, tmp_path: Path) -> None:
    hair = '\n    def BasisCurves "Hair" {}\n'
    shot = write_shot(tmp_path / "hair.usda", SQUARE, hair, CAMERA)
    ended = pullfocus("record", shot, tmp_path / "f.#.png", "--frames", "1:3", *small())
    assert ended.status == 0
    assert len([line for line in ended.err.splitlines() if line.startswith("warning:") and "/World/Hair" in line]) == 1


def test_away_from_a_terminal_each_frame_is_a_line(pullfocus: Command, shot: Path) -> None:
    ended = pullfocus("record", shot, shot.parent / "f.#.png", "--frames", "1:2", *small())
    lines = [line for line in ended.err.splitlines() if "f." in line]
    assert [line.split(" ")[0] for line in lines] == ["1/2", "2/2"]
    assert "\x1b" not in ended.err


def _start(shot: Path, stderr: int, *arguments: object) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "render.cli", "record", shot, shot.parent / "f.####.png", *arguments]
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "100"}

    def listen_to_control_c() -> None:
        """A test run in the background of a shell hands down that Ctrl-C is ignored."""
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    return subprocess.Popen(
        [str(word) for word in command], stderr=stderr, env=environment, preexec_fn=listen_to_control_c
    )


def test_on_a_terminal_a_bar_shows_how_far_it_is(shot: Path) -> None:
    ours, theirs = pty.openpty()
    process = _start(shot, theirs, "--frames", "1:3", *small())
    os.close(theirs)
    shown = b""
    try:
        while chunk := os.read(ours, 65536):
            shown += chunk
    except OSError:  # how Linux says that the other end of a terminal was closed
        pass
    os.close(ours)
    assert process.wait(60) == 0
    assert b"\x1b[" in shown
    assert b"/3" in shown
    assert b"1/3 f.0001.png" not in shown


def test_control_c_leaves_only_whole_files(shot: Path) -> None:
    process = _start(shot, subprocess.PIPE, "--frames", "1:9999", *small())
    assert process.stderr is not None
    messages = [process.stderr.readline() for _ in range(3)]  # the camera, and two frames
    process.send_signal(signal.SIGINT)
    messages += process.stderr.readlines()
    process.stderr.close()
    assert process.wait(60) == 130
    assert b"Traceback" not in b"".join(messages)
    assert messages[-1].startswith(b"pullfocus: stopped")
    frames = sorted(shot.parent.glob("f.*.png"))
    assert 2 <= len(frames) < 9999
    assert all(read(frame).shape[:2] == (HEIGHT, WIDTH) for frame in frames)
    assert sorted(shot.parent.iterdir()) == [*frames, shot]


def test_control_c_within_a_call_of_opengl_stops_too(
    shot: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """PyOpenGL converts arguments in callbacks of ctypes, which turns an interrupt there into its own error."""

    def interrupt(*_: object) -> None:
        raise ctypes.ArgumentError("argument 4: KeyboardInterrupt: ")

    monkeypatch.setattr("render.cli.commands.parse_command", interrupt)
    assert main(["record", str(shot), str(shot.parent / "f.png")]) == 130
    assert capsys.readouterr().err.startswith("pullfocus: stopped")


def test_a_lost_focus_point_is_warned_of_once(pullfocus: Command, tmp_path: Path) -> None:
    lost = CAMERA.replace(
        'Camera "main_cam"', 'Camera "main_cam" (prepend apiSchemas = ["FocusAPI", "FocusPointAPI:eye"])'
    ).replace("{", '{\n        uniform token focus:mode = "points"\n        rel focusPoint:eye:target = </World/Gone>')
    path = write_shot(tmp_path / "lost.usda", SQUARE, lost)
    ended = pullfocus("record", path, tmp_path / "f.#.png", "--frames", "1:3", *small())
    warnings = [line for line in ended.err.splitlines() if line.startswith("warning:")]
    assert ended.status == 0
    assert len(warnings) == 1
    for words in ("focus point eye", "/World/Gone", "the camera's own focus distance is kept"):
        assert words in warnings[0]


def test_focus_below_the_lenss_mark_is_drawn_and_warned_of_once(pullfocus: Command, tmp_path: Path) -> None:
    """The mark counts from the film: 5 m before the entrance pupil are 5.05 m before the film of a thin 50 mm lens."""
    for marked_mm, warnings in ((5040.0, 0), (5080.0, 1)):
        camera = CAMERA.replace('"main_cam"', '"main_cam" (prepend apiSchemas = ["LensAPI"])')
        camera = camera.replace("{", f"{{\n        double lens:closeFocus = {marked_mm}", 1)
        path = write_shot(tmp_path / f"near{marked_mm:g}.usda", SQUARE, camera)
        ended = pullfocus("record", path, tmp_path / "f.#.png", "--frames", "1:3", *small())
        assert ended.status == 0
        messages = [line for line in ended.err.splitlines() if line.startswith("warning:")]
        assert len(messages) == warnings
        assert all("nearer than the 5.08 m before the film that its lens is marked for" in line for line in messages)


def test_several_wavelengths_make_fringes_and_one_alone_none(pullfocus: Command, tmp_path: Path) -> None:
    white = write_shot(tmp_path / "white.usda", SQUARE.replace("0.8, 0.2, 0.1", "1, 1, 1"), CAMERA)
    fringes = []
    for count in (1, 3, 9):
        out = tmp_path / f"{count}.exr"
        lens = ("--lens", "singlet_50", "--shading", "unlit", "--wavelengths", count)
        assert pullfocus("record", white, out, *small(*lens)).status == 0
        fringes.append(float(np.ptp(read(out)[..., :3], axis=-1).max()))
    one, three, nine = fringes
    assert one < 2e-3
    assert min(three, nine) > 0.01
    assert abs(three - nine) > 2e-3
