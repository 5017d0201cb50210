"""`pullfocus bench focus` measures the solvers and the surfaces between focus points."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from render.lab.bench.focus import SCENE
from render.lab.bench.focus_plan import POINT_COUNTS
from render.lab.reference.scenes import posts_before_wall
from tests.render.kits.cli_shots import Command

pytestmark = pytest.mark.gl


def test_solvers_and_surfaces_are_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("render.lab.bench.focus.SCENES", {SCENE: posts_before_wall})
    file = tmp_path / "focus.json"

    ended = Command(capsys)("bench", "focus", "--quick", "--json", file)

    assert ended.status == 0
    results = json.loads(file.read_text())
    assert len(results["solvers"]) == 4
    assert all(row["seconds"] > 0 for row in results["solvers"])
    assert [row["points"] for row in results["surfaces"]] == list(POINT_COUNTS)
    assert results["surfaces"][0]["share"] == 0
    assert ended.out.count("pass") + ended.out.count("FAIL") == len(results["goals"])
