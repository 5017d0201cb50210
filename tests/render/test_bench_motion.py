"""`pullfocus bench motion` measures what it says, and holds it to its goals."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli_shots import Command

pytestmark = pytest.mark.gl


def test_motion_is_measured_both_ways(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "motion.json"

    ended = Command(capsys)("bench", "motion", "--quick", "--json", file)

    assert ended.status == 0
    found = json.loads(file.read_text())
    assert (found["width"], found["height"]) == (128, 72)
    rows = {(row["way"], row["moments"]): row for row in found["rows"]}
    assert list(rows) == [("still", 1), ("velocities", 4), ("moments", 4)]
    still, fast, exact = rows.values()
    assert still["ratio"] == 1
    assert fast["ratio"] == pytest.approx(fast["cpu_ms"] / still["cpu_ms"])
    assert exact["psnr_db"] is None
    ratio, alike = found["goals"]
    assert (ratio["got"], alike["got"]) == (fast["ratio"], fast["psnr_db"])
    assert alike["got"] > 20
    assert ended.out.count("pass") + ended.out.count("FAIL") == 2


def test_a_picture_without_size_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    ended = Command(capsys)("bench", "motion", "--width", "0")

    assert ended.status == 2
    assert len(ended.err.splitlines()) == 1
