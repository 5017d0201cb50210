"""`pullfocus bench soak` edits, leaves work half way, and finds no drift."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.render.kits.cli_shots import Command

pytestmark = pytest.mark.gl


def test_a_short_soak_finds_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "soak.json"
    ended = Command(capsys)("bench", "soak", "--edits", "150", "--quick", "--json", file)
    assert ended.status == 0
    found = json.loads(file.read_text())
    assert sum(found["edits_by_kind"].values()) == found["edits"] == 150
    assert found["checks"] == len(found["memory_mb"]) == 8
    assert 0 < found["finals"] < found["pictures"]
    assert found["left"] > 0, "some of the work is left half way"
    assert all(goal["holds"] for goal in found["goals"]), found["goals"]
    assert ended.out.count("pass") + ended.out.count("FAIL") == 3
