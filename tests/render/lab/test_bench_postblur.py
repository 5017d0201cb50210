"""`pullfocus bench postblur` measures FLAG and the naive gather as the blur grows, and engines against references."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from render.engines import engine_names
from render.lab.bench.clock import Spent
from render.lab.bench.postblur.plan import QUICK
from render.lab.bench.postblur.speed import crossover, exponent, fit_growth
from render.postblur.flag import BAND_BYTES
from tests.render.kits.cli_shots import Command

RADII = (3.0, 7.0, 13.0, 27.0, 81.0)


def test_growth_is_that_of_the_radius() -> None:
    assert exponent(RADII, [0.2 * r**2 for r in RADII]) == pytest.approx(2)
    assert exponent(RADII, [9 + 3 * r for r in RADII]) == pytest.approx(1)
    assert exponent(RADII, [40 + 0.1 * r**1.5 for r in RADII]) == pytest.approx(1.5)


def test_the_crossover_lies_where_both_take_as_long() -> None:
    fast, slow = [10 * r for r in RADII], [r**2 for r in RADII]
    assert crossover(RADII, fast, slow) == pytest.approx(10)
    assert crossover(RADII, fast, [2 * one for one in fast]) == 3
    assert crossover(RADII, slow, fast) is None


def test_times_are_judged_by_the_requested_clock() -> None:
    spent = [(Spent(radius, 50.0), Spent(radius**2, 25.0)) for radius in QUICK.radii]
    wall, processor = (fit_growth(QUICK, spent, by_processor=by) for by in (False, True))
    assert wall.ahead == pytest.approx(QUICK.radii)
    assert wall.flag_exponent == pytest.approx(1)
    assert processor.ahead == pytest.approx([0.5] * len(QUICK.radii))
    assert processor.crossover_px is None


@pytest.mark.gl
def test_everything_is_measured_drawn_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, plot = tmp_path / "blurs.json", tmp_path / "blurs.svg"

    ended = Command(capsys)("bench", "postblur", "--quick", "--json", file, "--plot", plot)

    assert ended.status == 0
    found = json.loads(file.read_text())
    assert found["radii"] == list(QUICK.radii)
    assert len(found["flag_ms"]) == len(found["naive_ms"]) == len(found["memory_mb"]) == len(QUICK.radii)
    assert found["memory_mb"] == sorted(found["memory_mb"])
    assert found["bound_mb"] == pytest.approx(BAND_BYTES / 1e6)
    assert found["flag_exponent"] == found["even"]["flag_exponent"]
    if "llvmpipe" in found["device"]:  # on a GPU, starting the work takes longer than these few pixels
        assert found["mixed"]["naive_exponent"] > 1
    assert "<svg" in plot.read_text()
    rows = {(row["scene"], row["engine"]): row for row in found["quality"]}
    assert {engine for _, engine in rows} == set(engine_names())
    for scene in ("spheres", "posts"):
        flag, gather, sharp = (rows[scene, engine] for engine in ("flag", "gather", "pinhole"))
        assert flag["lens_psnr_db"] > sharp["lens_psnr_db"] + 3
        assert flag["lens_psnr_db"] == pytest.approx(gather["lens_psnr_db"], abs=0.1)
        assert rows[scene, "lens"]["lens_psnr_db"] is None
    assert ended.out.count("pass") + ended.out.count("FAIL") == len(found["goals"])
