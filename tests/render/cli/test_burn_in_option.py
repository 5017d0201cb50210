"""`pullfocus record --burn-in`: facts in the corners of graded pictures and movies, and not in light."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO
import pytest

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


def pixels(file: Path) -> np.ndarray:
    return OpenImageIO.ImageBuf(str(file)).get_pixels(OpenImageIO.UINT8).astype(int)


def test_facts_are_burnt_into_stills_and_movies(
    pullfocus: Command, shot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    moving: list[np.ndarray] = []
    add = MovieWriter.add

    def spy(self: MovieWriter, picture: Any, description: MovieDescription) -> None:
        moving.append(picture)
        add(self, picture, description)

    monkeypatch.setattr(MovieWriter, "add", spy)
    options = ("--frames", "2:3", *small())
    assert pullfocus("record", shot, shot.parent / "plain.#.png", *options).status == 0
    burnt = ("--burn-in", "frame", *options)
    assert pullfocus("record", shot, shot.parent / "burnt.#.png", *burnt).status == 0
    assert pullfocus("record", shot, shot.parent / "burnt.mp4", *burnt).status == 0

    plain, stills = ([pixels(shot.parent / f"{name}.{frame}.png") for frame in (2, 3)] for name in ("plain", "burnt"))
    np.testing.assert_array_equal(moving, stills)
    for before, after in zip(plain, stills, strict=True):
        rows = np.argwhere((before != after).any(axis=-1))[:, 0]
        assert (rows.min(), rows.max() < 32) == (32 - 15, True)  # one line at the bottom


@pytest.mark.parametrize(
    ("out", "facts", "message"),
    [
        ("a.exr", "frame", "an EXR file has the same facts in its header"),
        ("a.png", "", "--burn-in takes facts such as frame,timecode,lens, or all"),
        ("a.png", "frmae", "there is no burn-in named 'frmae'"),
        ("a.png", "revision", "--burn-in knows no revision of a file"),
    ],
)
def test_facts_that_cannot_be_burnt_in(out: str, facts: str, message: str, pullfocus: Command, shot: Path) -> None:
    ended = pullfocus("record", shot, shot.parent / out, "--burn-in", facts, *small())
    assert ended.status != 0
    assert message in " ".join(ended.err.split())
    assert not (shot.parent / out).exists()
