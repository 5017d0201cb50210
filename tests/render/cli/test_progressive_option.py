"""`pullfocus record --progressive`: pictures over pictures, and the last one is record's own."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, write_shot

pytestmark = pytest.mark.gl
SMALL = ("--imageWidth", "64", "--rays", "8")


@pytest.mark.parametrize("ending", ["png", "jpg"])
def test_the_last_picture_is_that_of_record(tmp_path: Path, capsys: pytest.CaptureFixture[str], ending: str) -> None:
    stage = write_shot(tmp_path / "a.usda", SQUARE, CAMERA)
    plain, better = tmp_path / f"plain.{ending}", tmp_path / f"better.{ending}"
    assert Command(capsys)("record", stage, plain, *SMALL).status == 0

    ended = Command(capsys)("record", stage, better, *SMALL, "--progressive", "--json")

    assert ended.status == 0
    assert better.read_bytes() == plain.read_bytes()
    (frame,) = json.loads(ended.out)["frames"]
    stages = [picture["stage"] for picture in frame["pictures"]]
    assert (stages[0], stages[-1]) == ("preview", "final")
    times = [picture["totalMs"] for picture in frame["pictures"]]
    assert times == sorted(times)
    assert "preview of 43 x" in ended.err


def test_every_picture_on_the_way_is_a_whole_file_of_the_same_size(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    import OpenImageIO

    stage, file = write_shot(tmp_path / "a.usda", SQUARE, CAMERA), tmp_path / "a.png"
    seen: list[tuple[int, int]] = []
    monkeypatch.setattr(
        "render.cli.recording.progressive.print_message",
        lambda _: seen.append(
            (OpenImageIO.ImageBuf(str(file)).spec().width, OpenImageIO.ImageBuf(str(file)).spec().height)
        ),
    )
    ended = Command(capsys)("record", stage, file, "--imageWidth", "600", "--rays", "4", "--progressive")
    assert ended.status == 0
    assert len(seen) >= 1
    assert {width for width, _ in seen} == {600}


@pytest.mark.parametrize(
    ("out", "more", "told"),
    [
        ("a.exr", (), "--progressive is for pictures to look at"),
        ("a.png", ("--long-exposure", "1:3"), "leave out --long-exposure"),
        ("a.png", ("--contact-sheet", "stop=2,4"), "leave out --contact-sheet"),
    ],
)
def test_conflicting_options_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], out: str, more: tuple[str, ...], told: str
) -> None:
    stage = write_shot(tmp_path / "a.usda", SQUARE, CAMERA)
    ended = Command(capsys)("record", stage, tmp_path / out, *more, "--progressive")
    assert ended.status == 2
    assert told in ended.err
    assert not (tmp_path / out).exists()


@pytest.mark.parametrize("was_there", [True, False])
def test_a_preview_is_not_left_in_place_of_the_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, was_there: bool
) -> None:
    """Stopped half way, the file is what it was."""
    stage, file = write_shot(tmp_path / "a.usda", SQUARE, CAMERA), tmp_path / "a.png"
    if was_there:
        assert Command(capsys)("record", stage, file, *SMALL).status == 0
    before = file.read_bytes() if was_there else None

    def stop(_: str) -> None:
        assert file.read_bytes() != before, "a preview is there"
        raise KeyboardInterrupt

    monkeypatch.setattr("render.cli.recording.progressive.print_message", stop)
    assert Command(capsys)("record", stage, file, *SMALL, "--engine", "flag", "--progressive").status != 0
    assert (file.read_bytes() if file.exists() else None) == before
