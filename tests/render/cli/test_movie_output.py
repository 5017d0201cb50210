"""`pullfocus record SHOT OUT.mp4`: the pictures of the PNGs, in one file."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
import OpenImageIO
import pytest

from render.cli.main import main
from render.output.movie import MovieDescription, MovieWriter
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot

pytestmark = pytest.mark.gl


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A red square, 5 m before the camera; frames 1 to 12 at 24 in a second."""
    return write_shot(tmp_path / "shot.usda", SQUARE, CAMERA)


@pytest.mark.parametrize("ending", ["mp4", "mov", "webm"])
def test_a_movie_holds_the_frames_asked_for(ending: str, pullfocus: Command, shot: Path) -> None:
    out = shot.parent / f"rack.{ending}"
    ended = pullfocus("record", shot, out, "--frames", "1:9x2", "--json", *small())

    assert ended.status == 0
    assert [(frame["time"], frame["file"]) for frame in json.loads(ended.out)["frames"]] == [
        (time, str(out)) for time in (1, 3, 5, 7, 9)
    ]
    with av.open(str(out)) as movie:
        stream = movie.streams.video[0]
        frames = list(movie.decode(stream))
        assert (len(frames), stream.width, stream.height, stream.average_rate) == (5, 48, 32, Fraction(12))
    red, green, _ = frames[0].to_ndarray(format="rgb24")[16, 24].astype(int)
    assert red > 1.3 * green
    assert sorted(file.name for file in shot.parent.iterdir()) == [out.name, shot.name]


def test_a_movie_encodes_the_pixels_of_the_pngs(
    pullfocus: Command, shot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    encoded: list[np.ndarray] = []
    add = MovieWriter.add

    def spy(self: MovieWriter, picture: Any, description: MovieDescription) -> None:
        encoded.append(picture)
        add(self, picture, description)

    monkeypatch.setattr(MovieWriter, "add", spy)
    options = ("--frames", "2:3", "--guides", "1:1", "--film", "velvia_50", *small())
    assert pullfocus("record", shot, shot.parent / "a.mp4", *options).status == 0
    assert pullfocus("record", shot, shot.parent / "a.#.png", *options).status == 0

    stills = [
        OpenImageIO.ImageBuf(str(shot.parent / f"a.{frame}.png")).get_pixels(OpenImageIO.UINT8) for frame in (2, 3)
    ]
    np.testing.assert_array_equal(encoded, stills)
    with av.open(str(shot.parent / "a.mp4")) as movie:
        assert movie.metadata["title"] == "shot.usda /World/main_cam"
        assert movie.streams.video[0].metadata["timecode"] == "00:00:00:02"


def test_without_frames_a_movie_is_of_the_whole_shot(pullfocus: Command, shot: Path) -> None:
    assert pullfocus("record", shot, shot.parent / "a.mp4", *small("--engine", "pinhole")).status == 0
    with av.open(str(shot.parent / "a.mp4")) as movie:
        assert len(list(movie.decode(video=0))) == 12


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("a.avi", (), "unknown movie format of '"),
        ("a.##.mp4", ("--frames", "1:2"), "a movie is one file for all frames: leave out the # in"),
        ("a.mov", ("--aov", "color,depth"), "a movie holds graded pictures of one camera: leave out --aov"),
        ("a.mp4", ("--progressive",), "leave out --progressive"),
        ("a.mp4", ("--stereo",), "leave out --stereo"),
        ("a.mp4", ("--long-exposure", "1:3"), "leave out --long-exposure"),
        ("a.mp4", ("--contact-sheet", "stop=2,4"), "leave out --contact-sheet"),
    ],
)
def test_what_no_movie_holds_is_refused_at_once(
    name: str, options: tuple[str, ...], words: str, pullfocus: Command, shot: Path
) -> None:
    ended = pullfocus("record", shot, shot.parent / name, *options)
    assert ended.status == 2
    assert words in ended.err
    assert list(shot.parent.iterdir()) == [shot]


def test_ctrl_c_leaves_no_movie(shot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = shot.parent / "a.mp4"
    add = MovieWriter.add

    def stop_at_second(self: MovieWriter, picture: Any, description: MovieDescription) -> None:
        add(self, picture, description)
        if description.title and len(added) == 1:
            raise KeyboardInterrupt
        added.append(picture)

    added: list[Any] = []
    monkeypatch.setattr(MovieWriter, "add", stop_at_second)
    assert main([str(word) for word in ("record", shot, out, "--frames", "1:3", *small())]) == 130
    assert len(added) == 1
    assert list(shot.parent.iterdir()) == [shot]
