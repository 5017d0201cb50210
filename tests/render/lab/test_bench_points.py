"""`pullfocus bench points` measures patterns against those of before."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.render.kits.cli_shots import Command


def test_patterns_are_measured(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "points.json"

    ended = Command(capsys)("bench", "points", "--quick", "--json", file)

    assert ended.status == 0
    found = json.loads(file.read_text())
    rows = {row["name"]: row for row in found["rows"]}
    assert all(name in ended.out for name in rows)
    assert rows["R2 x Halton, shifted"]["mean_db"] == 0
    assert rows["random"]["mean_db"] > 2
    assert rows["product"]["mean_db"] < -0.5
    for row in rows.values():
        assert len(row["edges_db"]) == len(found["rays"])
        assert row["mean_db"] == pytest.approx(sum(row["blurs_db"]) / 3)
