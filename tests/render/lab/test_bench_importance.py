"""`pullfocus bench importance` measures Fearing's experiments, holds them to his speed-ups, and draws what a cutoff costs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from render.lab.bench.importance.scene import CUTOFF_EXPERIMENT, EXPERIMENTS, STAR_MM, StillLife
from tests.render.kits.cli_shots import Command

pytestmark = pytest.mark.gl

LOOK = {experiment.name: experiment for experiment in EXPERIMENTS}


def test_the_experiments_are_measured(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, plot = tmp_path / "importance.json", tmp_path / "plot.png"

    ended = Command(capsys)("bench", "importance", "--quick", "--json", file, "--plot", plot)

    assert ended.status == 0
    found = json.loads(file.read_text())
    assert {"device", "experiments", "cutoff"} <= set(found)
    rows = found["experiments"]
    assert [(row["name"], row["size"], row["frames"]) for row in rows] == [(name, 64, 5) for name in LOOK]
    for row in rows:
        assert {"linear_s", "importance_s", "none_s", "speedup", "speedup_without_first"} <= set(row)
        assert min(row["linear_s"], row["importance_s"], row["none_s"]) > 0
        assert row["most_apart"] <= 1e-4
        assert 0 < row["changed"] < 1
    assert [cut["m"] for cut in found["cutoff"]] == [25, 100]
    some, whole = found["cutoff"]
    assert some["psnr_db"] > 15
    assert whole["psnr_db"] is None
    sizes = found["sizes"]
    assert [(row["name"], row["star_radius_mm"]) for row in sizes] == [
        (name, radius_mm) for radius_mm in (2.5, 5.0) for name in ("sideways", "away")
    ]
    small, large = (row for row in sizes if row["name"] == "sideways")
    assert 0 < small["changed"] < large["changed"]
    assert small["star_share"] == pytest.approx(2 * 2.5 * 8 / 7 / STAR_MM)
    assert "a star moves sideways, in focus: 22.1 times, met at" in ended.out
    assert len(found["goals"]) == 3  # the first two experiments are held to nothing at one size
    assert found["goals"][-1]["holds"]
    assert ended.out.count("pass") + ended.out.count("FAIL") == len(found["goals"])
    assert np.asarray(Image.open(plot)).std() > 5


def test_a_star_moves_in_a_still_life() -> None:
    """In focus it is sharp; where something nearer stands it is not seen; and all but it stays as it was."""
    scene = StillLife(96)
    before, after = (scene.frame(LOOK["sideways"], t) for t in (0.3, 0.5))
    changed = (before.light != after.light).any(axis=-1)
    assert 0.005 < changed.mean() < 0.2
    assert (before.radii == after.radii)[~changed].all()
    middle = 48 + int(96 * (-2 * 2 / STAR_MM) / 2), 48
    assert after.radii[middle] == pytest.approx(0, abs=1e-4)
    assert after.light[middle][2] < 0.2 * after.light[middle][0]
    assert before.radii.min() < -1
    assert before.radii.max() > 1


def test_the_focus_is_pulled_from_the_knot_to_the_computer_and_back() -> None:
    scene = StillLife(64)
    first, last = (scene.frame(LOOK["pull"], t) for t in (0.0, 1.0))
    assert (first.light == last.light).all()
    computer = 36, 22
    assert abs(last.radii[computer]) < 1e-4
    assert first.radii[computer] < -0.5
    assert (scene.frame(CUTOFF_EXPERIMENT, 0.0).radii == last.radii).all()
