"""Edits on disk: an edit is there with its history, or neither is, wherever its writer ends."""

from __future__ import annotations

import errno
import os
import signal
import sys
from contextlib import suppress

import pytest

from render.errors import OutputError
from render.model.edit_history import EditHistory
from service.storage import edit_files
from service.storage.edit_files import clear_unfinished, load_history, save_edits


def history(*texts: str) -> EditHistory:
    """States one after the other, with nothing to begin with."""
    made = EditHistory.beginning_with("")
    for text in texts:
        made = made.after(text, f"edit {text}", "drag" if text.startswith("drag") else "")
    return made


FIRST = history("a", "b")
CASES = {
    "an edit": (FIRST, FIRST.after("c", "edit")),
    "an edit after an undo": (FIRST.undone(), FIRST.undone().after("c", "edit")),
    "an edit within a gesture": (history("a", "drag 1"), history("a", "drag 1").after("drag 2", "edit", "drag")),
    "a gesture back to its begin": (history("a", "drag 1"), history("a", "drag 1").after("a", "edit", "drag")),
    "an undo to no edits": (history("a"), history("a").undone()),
    "an undo between equal states": (history("a", "b", "a"), history("a", "b", "a").undone()),
    "a redo between equal states": (history("a", "b", "a").undone(), history("a", "b", "a")),
}


def killed_at(folder, after, before, step) -> bool:
    """Save in a process that is killed before its ``step``-th change of a file. Returns whether it was."""
    child = os.fork()
    if child == 0:
        count = 0

        def hook(event, _):
            nonlocal count
            if event in ("os.rename", "os.mkdir", "os.remove", "open"):
                if count == step:
                    os.kill(os.getpid(), signal.SIGKILL)
                count += 1

        with suppress(BaseException):
            sys.addaudithook(hook)
            save_edits(folder, after, before)
            os._exit(0)
        os._exit(1)
    status = os.waitpid(child, 0)[1]
    assert os.WIFSIGNALED(status) or os.WEXITSTATUS(status) == 0
    return os.WIFSIGNALED(status)


def edit_text(folder) -> str:
    file = folder / "edits.usda"
    return file.read_text() if file.exists() else ""


@pytest.mark.parametrize("case", CASES)
def test_an_edit_killed_anywhere_is_whole_or_never_was(case, tmp_path):
    before, after = CASES[case]
    step, seen, is_killed = 0, set(), True
    while is_killed:
        folder = tmp_path / str(step)
        folder.mkdir()
        save_edits(folder, before, EditHistory.beginning_with(""))
        is_killed = killed_at(folder, after, before, step)
        found = load_history(folder)
        assert found in (before, after), f"killed before change {step}"
        assert edit_text(folder) == found.present.text
        seen.add(found == after)
        clear_unfinished(folder)
        assert not list(folder.rglob("*.part"))
        step += 1
    assert seen == {False, True}
    assert step > 4
    assert load_history(folder) == after


@pytest.mark.parametrize("case", CASES)
def test_a_disk_that_fills_up_anywhere_costs_no_redo(case, tmp_path, monkeypatch):
    before, after = CASES[case]
    save_edits(tmp_path, before, EditHistory.beginning_with(""))
    for writes_left in range(3):
        _fill_after(writes_left, monkeypatch)
        with suppress(OutputError):
            save_edits(tmp_path, after, before)
        monkeypatch.undo()
        found = load_history(tmp_path)
        assert found in (before, after)
        assert edit_text(tmp_path) == found.present.text
    save_edits(tmp_path, after, before)
    assert load_history(tmp_path) == after


def _fill_after(writes, monkeypatch) -> None:
    """Let a number of files be written, and the next ones find the disk full."""
    left, write = [writes], edit_files.write_atomic

    def limited(path, content):
        left[0] -= 1
        if left[0] < 0:
            raise OutputError("the disk is full", code="disk_full")
        write(path, content)

    monkeypatch.setattr(edit_files, "write_atomic", limited)


def test_a_disk_that_fails_does_not_begin_a_history_anew(tmp_path, monkeypatch):
    save_edits(tmp_path, FIRST, EditHistory.beginning_with(""))

    def fail(_):
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    with monkeypatch.context() as patch:
        patch.setattr(edit_files.Path, "read_bytes", fail)
        with pytest.raises(OutputError, match="cannot be read"):
            load_history(tmp_path)
    assert load_history(tmp_path) == FIRST
