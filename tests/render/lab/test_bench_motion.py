"""`pullfocus bench motion` measures what it says, and holds it to its goals."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from pxr import Gf, UsdGeom

from render.lab.bench.motion_plan import FRAME
from tests.render.kits.cli_shots import Command
from tests.render.kits.moving_shots import write_posts_shot

pytestmark = pytest.mark.gl


def write_room(folder: Path) -> Path:
    """A room in place of the demo shot, through which the camera trucks."""
    stage = write_posts_shot(folder / "room.usda")
    track = UsdGeom.Camera.Get(stage, "/cam").AddTranslateOp()
    for time, x in ((FRAME, -0.1), (FRAME + 1, 0.1)):
        track.Set(Gf.Vec3d(x, 0, 0), time)
    stage.Save()
    return folder / "room.usda"


def test_motion_is_measured_both_ways(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("render.lab.bench.motion.write_demo", write_room)
    file = tmp_path / "motion.json"

    ended = Command(capsys)("bench", "motion", "--quick", "--json", file)

    assert ended.status == 0
    found = json.loads(file.read_text())
    assert (found["width"], found["height"]) == (128, 72)
    rows = {(row["way"], row["moments"]): row for row in found["rows"]}
    assert list(rows) == [("still", 1), ("velocities", 4), ("moments", 4)]
    still, fast, exact = rows.values()
    assert still["ratio"] == 1
    assert fast["ratio"] in [pytest.approx(fast[clock] / still[clock]) for clock in ("cpu_ms", "ms")]
    assert exact["psnr_db"] is None
    ratio, alike = found["goals"]
    assert (ratio["got"], alike["got"]) == (fast["ratio"], fast["psnr_db"])
    assert alike["got"] > still["psnr_db"] + 3
    assert ended.out.count("pass") + ended.out.count("FAIL") == 2
