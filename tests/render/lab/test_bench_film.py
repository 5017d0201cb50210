"""`pullfocus bench film` measures what it says, and holds it to its goals."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from render.lab.bench.film_plan import FINISHINGS
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, write_shot

pytestmark = pytest.mark.gl


def test_film_is_measured_beside_the_frame(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "film.json"
    monkeypatch.setattr(
        "render.lab.bench.film.write_demo", lambda folder: write_shot(folder / "a.usda", SQUARE, CAMERA)
    )

    ended = Command(capsys)("bench", "film", "--quick", "--json", file)

    assert ended.status == 0
    found = json.loads(file.read_text())
    assert (found["width"], found["height"]) == (160, 90)
    assert [row["name"] for row in found["rows"]] == [way.name for way in FINISHINGS]
    for row in found["rows"]:
        assert row["name"] in ended.out
        assert row["share"] == pytest.approx(row["live_ms"] / found["frame_ms"])
        assert 0 < row["apart"] < 1, "the device agrees with the processor"
    share, apart = found["goals"]
    assert share["got"] == max(row["share"] for row in found["rows"])
    assert apart["holds"]
    assert ended.out.count("pass") + ended.out.count("FAIL") == 2
