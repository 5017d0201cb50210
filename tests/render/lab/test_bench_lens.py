"""The lens bench: what it finds has the shape that programs read, its numbers hang together, and it needs no USD. Never times."""

from __future__ import annotations

import argparse
import errno
import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from render.lab.bench.clock import Repeats, Spent, median_spent
from render.lab.bench.goals import judged
from render.lab.bench.lens import measure
from render.lab.bench.lenses import ABBE, bench_lenses
from render.lab.bench.plan import PICTURE, SWEPT, Plan, add_arguments, asked_plan, quick_plan
from render.lab.bench.results import (
    Goal,
    LayersRow,
    LensBench,
    ReferenceTimes,
    SceneRow,
    SurfacesRow,
    Sweeps,
    Times,
    as_json,
)
from render.lab.bench.text import report
from render.lab.reference.bench_scenes import SCENES
from render.lab.reference.scenes import posts_before_wall
from render.optics.prescription.completion import completed
from render.optics.prescription.paraxial import first_order
from tests.render.kits.cli_shots import Command
from usd_schemas import library_lens

SCENE_KEYS = {
    *("name", "triangles", "peel_ms", "nbuffer_ms", "trace_ms", "total_ms"),
    *("reference_ms", "ratio", "psnr_db", "ssim", "layers", "layers_mb"),
}


@pytest.fixture(scope="module")
def found() -> LensBench:
    plan = replace(
        quick_plan(),
        picture=replace(PICTURE, width=80, height=60, rays=16),
        rays=(4, 16),
        layers=(1, 4),
        f_stops=(1.4, 8.0),
    )
    said: list[str] = []
    bench = measure({"posts": posts_before_wall}, plan, said.append)
    assert any("posts" in line for line in said)
    return bench


@pytest.mark.gl
def test_json_has_the_shape_that_programs_read(found: LensBench) -> None:
    table: dict[str, Any] = json.loads(as_json(found))
    assert table["device"]
    (scene,) = table["scenes"]
    assert set(scene) >= SCENE_KEYS
    assert scene["name"] == "posts"
    assert scene["triangles"] == posts_before_wall()[0].triangle_count
    assert [row["rays"] for row in table["sweeps"]["rays"]] == [4, 16]
    assert [row["layers"] for row in table["sweeps"]["layers"]] == [1, 4]
    assert [row["f_stop"] for row in table["sweeps"]["aperture"]] == [1.4, 8.0]
    assert [(row["surfaces"], row["disperses"]) for row in table["sweeps"]["surfaces"]] == [
        (0, False),
        (13, False),
        (13, True),
    ]
    assert table["goals"] == []  # they are set for larger pictures


@pytest.mark.gl
def test_numbers_hang_together(found: LensBench) -> None:
    sweeps = found.sweeps
    for row in (*found.scenes, *sweeps.rays, *sweeps.layers, *sweeps.aperture, *sweeps.surfaces):
        for times in (row, row.cpu):
            assert times.total_ms == pytest.approx(times.peel_ms + times.nbuffer_ms + times.trace_ms)
            assert min(times.peel_ms, times.nbuffer_ms, times.trace_ms) > 0
    (scene,) = found.scenes
    assert scene.ratio == pytest.approx(scene.reference_ms / scene.total_ms)
    assert scene.psnr_db > 25  # of posts thinner than the few pixels that there are
    assert 0.8 < scene.ssim <= 1
    assert 2 <= scene.layers <= 4  # no more can hold anything, where the picture is so small
    few, many = sweeps.layers
    assert (few.peeled, many.peeled) == (1, scene.layers)
    assert many.psnr_db > few.psnr_db
    quarter, whole = sweeps.rays
    assert whole.reference_ms == pytest.approx(4 * quarter.reference_ms)
    wide, narrow = sweeps.aperture
    assert wide.blur_px == pytest.approx(narrow.blur_px * 8 / 1.4)


@pytest.mark.gl
def test_four_layers_fit_the_memory_that_they_may_take(found: LensBench) -> None:
    radiance_w_depth_mb = 1024 * 768 * (4 * 8 + 16 + 8 + 4) / 1e6  # four of RGBA16F, packed w, background, depth
    assert radiance_w_depth_mb < found.layers_mb_1024x768 < 64


@pytest.mark.gl
def test_report_names_what_was_measured(found: LensBench) -> None:
    text = report(found)
    for word in (found.device, "80x60", "posts", "PSNR", "reference", "f/1.4", "wide", "apart"):
        assert word in text


def test_median_is_taken_of_each_clock() -> None:
    runs = [Spent(1, 30), Spent(3, 10), Spent(2, 20)]
    assert median_spent(runs) == Spent(2, 20)


def test_slow_pictures_are_measured_less_often() -> None:
    repeats = Repeats(3, 9, enough_ms=2000)
    assert repeats.more(2, 60_000)
    assert not repeats.more(3, 60_000)
    assert repeats.more(8, 80)
    assert not repeats.more(9, 90)


def test_lenses_are_those_of_the_library() -> None:
    lenses = {(lens.name, lens.disperses): lens for lens in bench_lenses()}
    assert [lens.surfaces for lens in bench_lenses()] == [0, 2, 7, 13, 2, 7, 13]
    for name, entry, focal_mm in (("telephoto", "telephoto_250", 249.6), ("wide", "wide_22", 22.02)):
        prescription = lenses[name, False].lens.prescription
        assert prescription is not None
        assert tuple(s.radius_mm for s in prescription.surfaces) == tuple(library_lens(entry).lens.prescription.radius)
        assert first_order(completed(prescription)).focal_length_mm == pytest.approx(focal_mm, rel=1e-3)
        dispersing = lenses[name, True].lens.prescription
        assert dispersing is not None
        assert {s.glass.abbe for s in dispersing.surfaces if s.glass.index > 1} == {ABBE}


def hall(psnr_db: float = 44.0) -> SceneRow:
    faster = ReferenceTimes(1, 1, 2, 4, reference_ms=24, ratio=6)
    return SceneRow(
        **vars(faster), name="hall", triangles=1, psnr_db=psnr_db, ssim=0.996, layers=4, layers_mb=9, cpu=faster
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
    verdicts = {goal.goal: goal for goal in judged(bench)}
    assert [goal.holds for goal in verdicts.values()] == [True, False, True, False, True, True]
    share = next(goal for name, goal in verdicts.items() if "second four" in name)
    assert share.got == pytest.approx(1 / 3)
    on_gpu = judged(replace(bench, software=False))
    assert on_gpu[0] == Goal("hall: times faster than the reference, at least", 15.0, 6, False)
    assert "FAIL  hall: PSNR in dB, at least 45: 44" in report(replace(bench, goals=judged(bench)))


@pytest.mark.parametrize("psnr_db", [float("inf"), float("nan")])
def test_what_is_no_number_is_null_and_the_rest_is_kept(
    psnr_db: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Pictures that are equal have an infinite PSNR: no reason to lose what took minutes to measure."""
    found = LensBench("a device", True, 80, 60, 16, 2, [hall(psnr_db)], Sweeps("hall", [], [], [], []), 60.6)
    monkeypatch.setattr("render.lab.bench.lens.measure", lambda *_: found)
    (tmp_path / "bench.json").write_text("old")
    ended = Command(capsys)("bench", "lens", "--json", tmp_path / "bench.json")
    assert ended.status == 0
    assert "hall" in ended.out
    assert [path.name for path in tmp_path.iterdir()] == ["bench.json"]
    scene = json.loads((tmp_path / "bench.json").read_text())["scenes"][0]
    assert (scene["psnr_db"], scene["ssim"], scene["cpu"]["ratio"]) == (None, 0.996, 6)


def test_json_that_cannot_be_written_keeps_the_old_file_and_tables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    found = LensBench("a device", True, 80, 60, 16, 2, [hall()], Sweeps("hall", [], [], [], []), 60.6)
    monkeypatch.setattr("render.lab.bench.lens.measure", lambda *_: found)
    monkeypatch.setattr(os, "fsync", full)
    (tmp_path / "bench.json").write_text("old")
    ended = Command(capsys)("bench", "lens", "--json", tmp_path / "bench.json")
    assert ended.status == 1
    assert "the disk is full" in ended.err
    assert "hall" in ended.out
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]


def test_whole_plan_is_what_the_goals_are_set_for() -> None:
    assert (PICTURE.width, PICTURE.height, PICTURE.rays, PICTURE.layers) == (800, 600, 100, 4)
    assert Plan().picture == PICTURE
    assert SWEPT in SCENES
    assert {4, 8} <= set(Plan().layers)


def _arguments(*typed: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    return parser.parse_args(typed)


def test_arguments_change_the_plan() -> None:
    plan = asked_plan(_arguments("--supersample", "3", "--rays", "64"))
    assert plan.picture == replace(PICTURE, supersample=3, rays=64)
    assert asked_plan(_arguments("--quick", "--rays", "9")).picture.rays == 9
    assert asked_plan(_arguments("--quick")).picture.width < PICTURE.width


@pytest.mark.parametrize(
    ("typed", "status", "said"),
    [
        (("lens", "--rays", "0"), 2, "rays must be from 1 to"),
        (("lens", "--supersample", "9"), 2, "supersample must be from 1 to 4, got 9"),
        (("lens", "--scene", "atlantis"), 2, "'atlantis' (choose from"),
        (
            ("lens", "--json", "no such folder/bench.json"),
            1,
            "cannot write no such folder/bench.json: the folder no such folder does not exist",
        ),
        (("lens", "--json", "."), 1, "cannot write .: it is a folder, expected a file"),
        (("lens", "--json", "/dev/null"), 1, "cannot write /dev/null: it is a device or a pipe, expected a file"),
        (("lens", "--rays"), 2, "--rays"),
        ((), 2, "BENCH"),
        (("coffee",), 2, "coffee"),
    ],
)
def test_bad_arguments_are_told_in_one_sentence(
    typed: tuple[str, ...], status: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    ended = Command(capsys)("bench", *typed)
    assert ended.status == status
    assert said in ended.err.splitlines()[-1]
    assert len(ended.err.splitlines()) == 1
    assert ended.out == ""


@pytest.mark.gl
def test_json_takes_the_place_of_the_tables(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("render.lab.bench.lens.SCENES", {"posts": posts_before_wall})
    ended = Command(capsys)("bench", "lens", "--quick", "--rays", "4", "--json", "-")
    assert ended.status == 0
    table = json.loads(ended.out)
    assert [scene["name"] for scene in table["scenes"]] == ["posts"]
    assert (table["rays"], table["width"]) == (4, quick_plan().picture.width)
