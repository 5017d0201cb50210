"""`pullfocus bench service` runs a service of its own, counts what its viewers get, and judges it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from service.bench.results import DelayRow, ViewersFound, goals_of, spread_of
from tests.render.kits.cli_shots import Command


def test_a_viewer_without_a_picture_misses_the_goal():
    none = spread_of([])
    starved = ViewersFound(2, 0, [], [0, 5], None, 1, none, none, none)
    unfair = ViewersFound(2, 0, [], [1, 5], 5.0, 0, none, none, none)
    row = DelayRow("edit", none, none, none, 1.5, 2.5, [])
    assert [goal.holds for goal in goals_of(starved, unfair, 300, [row])] == [
        *(True, False),
        *(True, True, False),
        *(True, True, False, True),
    ]


def test_the_spread_of_times_has_the_95th_percentile():
    spread = spread_of([float(i) for i in range(1, 101)])
    assert (spread.count, spread.median_s, spread.p95_s, spread.most_s) == (100, 50.5, 95.0, 100.0)


@pytest.mark.gl
def test_three_viewers_drag_for_two_seconds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "load.json"
    ended = Command(capsys)(
        "bench",
        "service",
        "--viewers",
        "3",
        "--seconds",
        "2",
        "--phase",
        "2",
        "--width",
        "64",
        "--first",
        "--json",
        file,
    )
    assert ended.status == 0, ended.err
    found = json.loads(file.read_text())
    for together in (found["at_start"], found["running"]):
        assert together["viewers"] == len(together["pictures"]) == 3
        assert together["refusals"] == []
    assert found["rays_refused"] > found["rays_admitted"] > 0
    assert len(found["delays"]) == 5
    assert all(row["failures"] == [] and row["alone"]["count"] > 0 for row in found["delays"])
    assert ended.out.count("pass") + ended.out.count("FAIL") == len(found["goals"]) >= 6
