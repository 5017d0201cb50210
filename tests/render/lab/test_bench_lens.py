"""`pullfocus bench lens` measures what its JSON says, and its goals say what holds. No test asserts a time."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from render.lab.bench.clock import Spent, StageClock
from render.lab.bench.goals import judge
from render.lab.bench.plan import quick_plan
from render.lab.bench.results import (
    Goal,
    LayersRow,
    LensBench,
    ReferenceTimes,
    SceneRow,
    SurfacesRow,
    Sweeps,
    Times,
    times,
)
from render.lab.bench.rig import Traced
from render.lab.bench.text import report
from render.lab.reference.scenes import posts_before_wall
from render.trace.lens import STAGES
from tests.render.kits.cli_shots import Command


@pytest.mark.gl
def test_the_lens_engine_is_measured(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("render.lab.bench.lens.SCENES", {"posts": posts_before_wall})

    ended = Command(capsys)("bench", "lens", "--quick", "--rays", "16", "--json", "-")

    assert ended.status == 0
    results = json.loads(ended.out)
    assert (results["rays"], results["width"]) == (16, quick_plan().picture.width)
    sweeps = results["sweeps"]
    assert [(row["surfaces"], row["disperses"]) for row in sweeps["surfaces"]] == [(0, False), (13, False), (13, True)]
    for row in (*results["scenes"], *(row for sweep in ("rays", "layers", "aperture") for row in sweeps[sweep])):
        for cost in (row, row["cpu"]):
            assert cost["total_ms"] == pytest.approx(cost["peel_ms"] + cost["nbuffer_ms"] + cost["trace_ms"])
            assert min(cost["peel_ms"], cost["nbuffer_ms"], cost["trace_ms"]) > 0
    (scene,) = results["scenes"]
    assert scene["triangles"] == posts_before_wall()[0].triangle_count
    assert scene["ratio"] == pytest.approx(scene["reference_ms"] / scene["total_ms"])
    assert scene["ratios"] == sorted(scene["ratios"])
    assert scene["ratio"] in scene["ratios"]
    assert len(scene["ratios"]) == len(scene["cpu_ratios"]) == quick_plan().runs
    assert 0 <= scene["spared"] < 1
    assert scene["psnr_db"] > 25  # of posts thinner than the few pixels that there are
    few, many = sweeps["rays"]
    assert many["reference_ms"] == pytest.approx(many["rays"] / few["rays"] * few["reference_ms"])
    wide, narrow = sweeps["aperture"]
    assert wide["blur_px"] == pytest.approx(narrow["blur_px"] * narrow["f_stop"] / wide["f_stop"])
    radiance_w_depth_mb = 1024 * 768 * (4 * 8 + 16 + 8 + 4) / 1e6  # four of RGBA16F, packed w, background, depth
    assert radiance_w_depth_mb < results["layers_mb_1024x768"] < 64
    assert results["goals"] == []  # they are set for larger pictures


def hall(psnr_db: float = 44.0) -> SceneRow:
    faster = ReferenceTimes(1, 1, 2, 4, reference_ms=36, ratio=9)
    return SceneRow(
        **vars(faster),
        name="hall",
        triangles=1,
        psnr_db=psnr_db,
        ssim=0.996,
        layers=4,
        layers_mb=9,
        spared=0.5,
        cpu=faster,
        ratios=[8.0, 9.0, 9.5],
        cpu_ratios=[6.0, 6.1, 6.2],
    )


def test_goals_say_what_holds() -> None:
    times, scene = Times(1, 1, 2, 4), hall()
    layers = [
        LayersRow(1, 1, trace_ms, 2 + trace_ms, layers=count, peeled=count, psnr_db=45, ssim=1, cpu=times)
        for count, trace_ms in ((4, 60.0), (8, 90.0))
    ]
    lens = SurfacesRow(
        **vars(times),
        lens="wide",
        surfaces=13,
        disperses=False,
        f_stop=2.8,
        table_ms=1,
        thin_trace_ms=1.25,
        trace_over_thin=1.6,
        cpu=times,
        cpu_trace_over_thin=1.6,
    )
    apart = replace(lens, disperses=True, trace_over_thin=4.8)
    bench = LensBench("llvmpipe", True, 800, 600, 100, 2, [scene], Sweeps("hall", [], layers, [], [lens, apart]), 60.6)
    verdicts = {goal.goal: goal for goal in judge(bench)}
    assert [goal.holds for goal in verdicts.values()] == [True, False, True, False, True, True]
    share = next(goal for name, goal in verdicts.items() if "second four" in name)
    assert share.got == pytest.approx(1 / 3)
    on_gpu = judge(replace(bench, software=False))
    assert on_gpu[0] == Goal("hall: times faster than the reference, at least", 15.0, 9, False)
    assert "FAIL  hall: PSNR in dB, at least 47: 44" in report(replace(bench, goals=judge(bench)))
    assert "hall: 3 runs had ratios of 8.0 to 9.5, 17% apart (6.0 to 6.2, 3% apart)" in report(bench)


@pytest.mark.parametrize("psnr_db", [float("inf"), float("nan")])
def test_a_number_that_is_not_finite_is_null_in_json(
    psnr_db: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Equal pictures have an infinite PSNR; the rest of the results is kept."""
    results = LensBench("a device", True, 80, 60, 16, 2, [hall(psnr_db)], Sweeps("hall", [], [], [], []), 60.6)
    monkeypatch.setattr("render.lab.bench.lens.measure", lambda *_: results)
    ended = Command(capsys)("bench", "lens", "--json", tmp_path / "bench.json")
    assert ended.status == 0
    assert "hall" in ended.out
    scene = json.loads((tmp_path / "bench.json").read_text())["scenes"][0]
    assert (scene["psnr_db"], scene["ssim"], scene["cpu"]["ratio"]) == (None, 0.996, 9)


def test_all_stages_of_a_picture_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the total, and each time that a stage comes, as in tiles; by a clock that goes on by 10 ms with each reading."""
    spent = {stage: Spent(10.0**i, 2 * 10.0**i) for i, stage in enumerate(STAGES)}
    wall, cpu = times(Traced(np.zeros((1, 1, 4), np.float32), spent, Spent(), 4, 0))
    assert (wall.total_ms, cpu.total_ms) == (11_111, 22_222)
    moments = itertools.count(step=10.0)
    monkeypatch.setattr("render.lab.bench.clock._now", lambda: Spent(next(moments)))
    clock = StageClock(lambda: None)
    for stage in ("peel", "trace", "peel", "trace", "peel"):
        clock(stage)
    assert clock.spent["peel"].wall_ms == 30
    assert clock.spent["trace"].wall_ms == 20
