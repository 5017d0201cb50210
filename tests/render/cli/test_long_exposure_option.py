"""`pullfocus record --long-exposure`: one picture over many frames, as a file that says so."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from render.pictures.long_exposure import LongExposure
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A red square that stands still, 5 m before the camera."""
    return write_shot(tmp_path / "shot.usda", SQUARE, CAMERA)


def middle(path: Path) -> np.ndarray:
    pixels = np.asarray(OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT))
    return pixels[pixels.shape[0] // 2, pixels.shape[1] // 2, :3]


def test_what_stands_still_is_as_bright_as_in_one_frame(pullfocus: Command, shot: Path) -> None:
    one, long, open_twice = (shot.parent / f"{name}.exr" for name in ("one", "long", "twice"))
    assert pullfocus("record", shot, one, *small()).status == 0
    ended = pullfocus("record", shot, long, "--long-exposure", "1:5", "--json", *small())
    assert ended.status == 0
    (said,) = json.loads(ended.out)["frames"]
    assert said["longExposure"] == {"openFrames": 4, "openSeconds": 4 / 24, "intervals": 4, "ndStops": 2}
    np.testing.assert_allclose(middle(long), middle(one), rtol=1e-3)
    assert pullfocus("record", shot, open_twice, "--long-exposure", "1:3,5:7", "--nd", "1", *small()).status == 0
    np.testing.assert_allclose(middle(open_twice), 2 * middle(one), rtol=1e-3)
    spec = OpenImageIO.ImageBuf(str(long)).spec()
    assert spec.getattribute("pullfocus:longExposureSeconds") == pytest.approx(4 / 24)


def test_control_c_closes_the_shutter_and_keeps_what_is_there(
    pullfocus: Command, shot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, whole = shot.parent / "stopped.png", shot.parent / "whole.png"
    expose = LongExposure.expose

    def stopped_in_the_third(self: LongExposure, begin: float, end: float, *rest: object) -> None:
        if begin == 3:
            raise KeyboardInterrupt
        expose(self, begin, end, *rest)  # type: ignore[arg-type]

    assert pullfocus("record", shot, whole, "--long-exposure", "1:3", *small()).status == 0
    monkeypatch.setattr(LongExposure, "expose", stopped_in_the_third)
    ended = pullfocus("record", shot, out, "--long-exposure", "1:99", *small())
    assert ended.status == 130
    assert "holds 0.08333 s (2 frames) of the exposure" in ended.err
    assert out.read_bytes()[-2000:] == whole.read_bytes()[-2000:]
    monkeypatch.setattr(LongExposure, "expose", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
    nothing = shot.parent / "nothing.png"
    assert pullfocus("record", shot, nothing, "--long-exposure", "1:99", *small()).status == 130
    assert not nothing.exists()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--long-exposure", "9:3"), "a shutter cannot close before it opens: it opens at 9 and closes at 3"),
        (("--long-exposure", "9"), "expected when the shutter opens and closes, such as 1:241"),
        (("--long-exposure", "1:3", "--frames", "1:3"), "leave out --frames"),
        (("--long-exposure", "1:3", "--nd", "dark"), "--nd takes a number of stops from 0 to 40 or auto, got 'dark'"),
        (("--long-exposure", "1:3", "--nd", "-2000"), "from 0 to 40 or auto, got '-2000'"),
        (("--long-exposure", "1:3", "--nd", "1e9"), "from 0 to 40 or auto, got '1e9'"),
        (("--nd", "3"), "needs --long-exposure"),
    ],
)
def test_senseless_arguments_are_reported_in_one_line(
    pullfocus: Command, shot: Path, arguments: tuple[str, ...], told: str
) -> None:
    ended = pullfocus("record", shot, shot.parent / "f.png", *arguments, *small())
    assert ended.status == 2
    assert told in ended.err
    assert len(ended.err.strip().splitlines()) == 1
    assert not (shot.parent / "f.png").exists()


def test_a_long_exposure_has_no_depth(pullfocus: Command, shot: Path) -> None:
    ended = pullfocus("record", shot, shot.parent / "f.exr", "--long-exposure", "1:3", "--aov", "color,depth", *small())
    assert ended.status == 2
    assert "a long exposure has colour alone" in ended.err


def test_a_shutter_that_closes_before_it_opens_is_refused_here_too(pullfocus: Command, shot: Path) -> None:
    backwards = CAMERA.replace(
        "float fStop", "double shutter:open = 0.5\n        double shutter:close = -0.5\n        float fStop"
    )
    write_shot(shot, SQUARE, backwards)
    ended = pullfocus("record", shot, shot.parent / "f.png", "--long-exposure", "1:3", *small())
    assert ended.status == 1
    assert "camera /World/main_cam: a shutter cannot close before it opens: shutter:open is 0.5" in ended.err
    assert not (shot.parent / "f.png").exists()
