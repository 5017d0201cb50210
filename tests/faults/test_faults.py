"""A sample of the faults against a real service; ``python -m tests.faults`` makes all of them at random."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from render.model.edit_history import EditHistory
from service.storage.edit_files import save_edits
from service.storage.store import ShotStore
from tests.faults.expected_history import ExpectedHistory
from tests.faults.folder_checks import faults_of_folder
from tests.faults.run import run_faults

SAMPLE = ("kill stage", "set clock", "kill template", "kill service after a stop")


@pytest.mark.gl
def test_acknowledged_edits_outlive_faults(tmp_path: Path) -> None:
    log = run_faults(tmp_path, seed=1, seconds=0, only=SAMPLE)
    assert log.findings == []
    assert log.counts["edit"] > 20
    assert log.counts["undo"] > 5
    assert all(log.counts[name] == 1 for name in SAMPLE if name != "set clock")  # which needs a compiler


def test_the_expected_history_is_that_of_the_service() -> None:
    choose = random.Random(1)
    history = EditHistory.beginning_with("#usda 1.0\n")
    expected = ExpectedHistory.beginning_with(history.present.revision)
    for number in range(2000):
        step = choose.choice(("edit", "edit", "edit", "undo", "redo"))
        gesture = choose.choice(("", "a", "b"))
        before = expected
        if step == "edit":
            history = history.after(f"#usda 1.0\n# {number}\n", "", gesture)
            expected = expected.edited(history.present.revision, gesture)
        elif walked := expected.walked(step):
            history, expected = history.undone() if step == "undo" else history.redone(), walked
        revisions = tuple(state.revision for state in history.states)
        assert expected.agrees(revisions, history.now)
        assert before.after_unanswered(step, gesture, revisions, history.now) in (before, expected)


def test_a_lost_or_foreign_state_is_no_outcome() -> None:
    expected = ExpectedHistory.beginning_with("a").edited("b", "").edited("c", "")
    assert expected.after_unanswered("undo", "", ("a", "b", "c"), 2) == expected
    assert expected.after_unanswered("undo", "", ("a", "b", "c"), 1) == expected.walked("undo")
    assert expected.after_unanswered("undo", "", ("a", "b", "c"), 0) is None
    assert expected.after_unanswered("edit", "", ("a", "b", "c", "d"), 2) is None, "the history alone was written"
    assert expected.after_unanswered("edit", "", ("a", "b"), 1) is None


def test_each_fault_of_a_folder_is_named(tmp_path: Path) -> None:
    store = ShotStore(tmp_path)
    begun = store.begin("night.usda")
    before = EditHistory.beginning_with("")
    save_edits(begun.edits_folder, before.after("#usda 1.0\n", "an edit"), before)
    store.accept(begun, "night.usda")
    store.close()
    assert list(faults_of_folder(tmp_path)) == []
    (begun.edits_folder / ".edits.usda.0.part").touch()
    begun.edits.write_text("#usda 1.0\ndef X")
    (tmp_path / "keys.json").write_text('{"keys"')
    (tmp_path / "audit.jsonl").write_text(json.dumps({}) + '\n{"time"\n')
    (tmp_path / "shots" / "half").mkdir()
    for state in (begun.edits_folder / "history").glob("*.usda"):
        state.unlink()
    found = "\n".join(faults_of_folder(tmp_path))
    for fault in (
        "half is left",
        ".part is left",
        "no whole USD layer",
        "keys.json",
        "record 2, is no JSON",
        "not there",
    ):
        assert fault in found, fault
