"""`pullfocus bench start` measures what it says: a process of `record`, by stage, until its first pixel and its end."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from render.lab.bench.start import recorder
from render.lab.bench.start.plan import FIRST_PIXEL_S, StartPlan
from render.lab.bench.start.run import STAGES, _pictures
from tests.render.kits.cli_shots import Command

pytestmark = pytest.mark.gl


def test_stages_add_up_to_the_first_pixel_and_to_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "start.json"
    monkeypatch.setattr("render.lab.bench.start.run.CACHES", ())  # those of the user, so that no shader is compiled

    ended = Command(capsys)("bench", "start", "--quick", "--json", file)

    assert ended.status == 0
    found = json.loads(file.read_text())
    (row,) = found["rows"]
    assert (row["shot"], row["width"]) == ("small", 64)
    assert row["missing"] == []
    (warm,) = row["warm"]
    assert sum(warm["before_s"].values()) == pytest.approx(warm["first_pixel_s"], abs=0.01)
    assert sum(warm["after_s"].values()) == pytest.approx(warm["done_s"] - warm["first_pixel_s"], abs=0.05)
    assert set(warm["before_s"]) | set(warm["after_s"]) <= set(STAGES)
    assert min(warm["before_s"][stage] for stage in ("imports", "stage", "upload", "lens table", "peel", "trace")) > 0
    (goal,) = found["goals"]
    assert goal["holds"] == (warm["first_pixel_s"] <= FIRST_PIXEL_S)
    assert ended.out.count("pass") + ended.out.count("FAIL") == 1


def test_the_small_shot_is_drawn_at_each_width() -> None:
    assert _pictures(StartPlan()) == [("small", 64), ("small", 160), ("small", 320), ("demo", 320)]
    assert _pictures(StartPlan(("demo",), (96,))) == [("demo", 96)]


def test_time_is_charged_to_the_innermost_stage(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr(recorder, "perf_counter", lambda: now)
    monkeypatch.setattr(recorder, "_BEGAN", now)
    stopwatch = recorder.Stopwatch()
    for seconds, step in ((1, lambda: stopwatch.enter("peel")), (2, lambda: stopwatch.enter("shaders"))):
        now += seconds
        step()
    now += 4
    stopwatch.leave()
    now += 8
    stopwatch.note_first_pixel()
    now += 16
    stopwatch.leave()
    assert stopwatch.before == {"other": 1, "peel": 10, "shaders": 4}
    assert stopwatch.after == {"peel": 16}
    assert stopwatch.first_pixel == 115
