"""`pullfocus bench live` measures what it says, and holds it to its goals."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from render.errors import GraphicsError
from render.frame import FrameRenderer
from render.lab.bench.live import DragRow, LiveBench, compare, measure_before, report
from render.lab.bench.live_plan import DRAGS, FIRST_MS
from render.model.focus_map import FocusMap
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
        assert row["first_psnr_db"] is None or row["first_psnr_db"] > 15
    goals = found["goals"]
    firsts = [row["first_ms"] for row in found["rows"] if row["name"] in FIRST_MS]
    assert [goal["got"] for goal in goals[:-1]] == [*firsts, max(row["look_p95_ms"] for row in found["rows"])]
    assert goals[-1]["holds"]
    assert ended.out.count("pass") + ended.out.count("FAIL") == len(goals)


def test_focus_maps_are_measured_with_the_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        "render.lab.bench.live.write_demo", lambda folder: write_shot(folder / "a.usda", SQUARE, CAMERA)
    )
    maps: list[FocusMap] = []
    measure = FrameRenderer.map_focus

    def kept(*arguments: Any, **named: Any) -> FocusMap:
        maps.append(measure(*arguments, **named))
        return maps[-1]

    monkeypatch.setattr(FrameRenderer, "map_focus", kept)
    file = tmp_path / "live.json"
    ended = Command(capsys)("bench", "live", "--quick", "--focus-maps", "--json", file)
    assert ended.status == 0
    assert "with its focus map" in ended.out
    assert json.loads(file.read_text())["focus_maps"]
    assert len(maps) > 2 * len(DRAGS)
    assert Command(capsys)("bench", "live", "--quick", "--focus-maps", "--before", ".").status == 2


def test_drags_are_held_to_those_of_another_checkout() -> None:
    row = DragRow("focus", 3, 80, 90, 0.1, 48, 8, 70, 900, 5, 10, 20, equal=True, first_psnr_db=30)
    slow, fast, alike = (
        replace(row, first_ms=240, first_psnr_db=28),
        replace(row, first_ms=79, first_psnr_db=32.5),
        replace(row, first_psnr_db=None),
    )
    assert [(goal.got, goal.holds) for goal in compare([slow], [row])] == [(3.0, False), (-2.0, False)]
    assert [goal.holds for goal in compare([fast], [row])] == [True, True]
    assert [goal.got for goal in compare([alike], [row])] == [1.0]
    printed = report(LiveBench("a device", 96, 54, 8, [alike], [], [row])).splitlines()
    assert [line.split()[-1] for line in printed if line.startswith("focus")] == ["equal", "30.0"]


def test_a_checkout_that_cannot_draw_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "render").mkdir()
    (tmp_path / "render" / "__init__.py").touch()
    with pytest.raises(GraphicsError, match=r"the drags with .* failed with status 1"):
        measure_before(tmp_path, [])
