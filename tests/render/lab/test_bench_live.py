"""`pullfocus bench live` measures what it says, and holds it to its goals."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from render.lab.bench.live_plan import DRAGS, FIRST_MS
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, write_shot

pytestmark = pytest.mark.gl


def test_every_drag_is_measured_and_rests_on_the_picture_of_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "live.json"
    monkeypatch.setattr(
        "render.lab.bench.live.write_demo", lambda folder: write_shot(folder / "a.usda", SQUARE, CAMERA)
    )

    ended = Command(capsys)("bench", "live", "--quick", "--json", file)

    assert ended.status == 0
    found = json.loads(file.read_text())
    assert (found["width"], found["height"]) == (96, 54)
    assert [row["name"] for row in found["rows"]] == list(DRAGS)
    for row in found["rows"]:
        assert row["name"] in ended.out
        assert row["equal"]
        assert 0 < row["first_ms"] <= row["first_p95_ms"]
        assert row["rest_first_ms"] <= row["rest_final_ms"]
        assert 0 <= row["read_share"] < 1
    goals = found["goals"]
    firsts = [row["first_ms"] for row in found["rows"] if row["name"] in FIRST_MS]
    assert [goal["got"] for goal in goals[:-1]] == [*firsts, max(row["look_p95_ms"] for row in found["rows"])]
    assert goals[-1]["holds"]
    assert ended.out.count("pass") + ended.out.count("FAIL") == len(goals)
