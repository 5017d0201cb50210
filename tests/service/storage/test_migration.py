"""A data folder of layout 1, as an earlier version left it, keeps each shot, edit and undo, wherever its migration was killed."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from render.errors import OutputError
from service.http.settings import Settings
from service.storage.edit_files import load_history
from service.storage.migration import LAYOUT, layout_of
from service.storage.store import ShotStore
from tests.service.conftest import running

LAYOUT_1 = Path(__file__).parent / "layout_1"
"""Written by the version before layout 2: two shots with edits and undone edits, one without, and what the service answered."""
ANSWERS = json.loads((LAYOUT_1 / "answers.json").read_text())


@pytest.fixture
def data(tmp_path):
    return shutil.copytree(LAYOUT_1 / "data", tmp_path / "data")


def files_below(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != "layout.json"
    }


def migrated_by_hand():
    """The files of layout 1 at their places of layout 2."""
    files = files_below(LAYOUT_1 / "data")
    return {
        name.replace("/edits.usda", "/edits/edits.usda").replace("/history/", "/edits/history/"): files[name]
        for name in files
    }


def open_and_close(data):
    store = ShotStore(data)
    store.close()
    return store


def test_every_shot_edit_and_undo_is_there_after(data):
    with running(Settings(data=data, demo=False)) as service:
        client = service.client
        assert {shot["id"] for shot in client.get("/v1/shots").json()["shots"]} == set(ANSWERS)
        for shot, then in ANSWERS.items():
            at = f"/v1/shots/{shot}"
            now = client.get(at).json()
            assert {key: now[key] for key in then["shot"]} == then["shot"]
            assert client.get(f"{at}/edits").text == then["edits"]
            history = client.get(f"{at}/edits/history").json()
            if len(then["states"]) == 1:  # never edited: its one state is made when it is opened
                history["steps"][0]["madeAt"] = then["history"]["steps"][0]["madeAt"]
            assert {key: history[key] for key in then["history"]} == then["history"]
            while client.post(f"{at}/edits/undo").status_code == 200:
                pass
            states = [client.get(f"{at}/edits").text]
            while client.post(f"{at}/edits/redo").status_code == 200:
                states.append(client.get(f"{at}/edits").text)
            assert states == then["states"]


def test_files_are_moved_and_not_changed(data, caplog):
    with caplog.at_level("INFO"):
        open_and_close(data)
    assert files_below(data) == migrated_by_hand()
    assert "from layout 1 to layout 2" in caplog.text
    assert layout_of(data) == LAYOUT
    caplog.clear()
    with caplog.at_level("INFO"):
        open_and_close(data)
    assert not caplog.text


def killed_at(data, step):
    """Open a data folder in a process that is killed before its ``step``-th change of a file. Returns whether it was."""
    child = os.fork()
    if child == 0:
        count = 0

        def hook(event, _):
            nonlocal count
            if event in ("os.rename", "os.mkdir", "os.remove", "open", "os.scandir"):
                if count == step:
                    os.kill(os.getpid(), signal.SIGKILL)
                count += 1

        with suppress(BaseException):
            sys.addaudithook(hook)
            ShotStore(data)
            os._exit(0)
        os._exit(1)
    status = os.waitpid(child, 0)[1]
    assert os.WIFSIGNALED(status) or os.WEXITSTATUS(status) == 0
    return os.WIFSIGNALED(status)


def test_a_migration_killed_anywhere_goes_on(tmp_path):
    kills = 0
    while killed_at(data := shutil.copytree(LAYOUT_1 / "data", tmp_path / str(kills)), kills):
        open_and_close(data)
        files = {name: text for name, text in files_below(data).items() if not name.endswith(".part")}
        assert files == migrated_by_hand(), f"killed before change {kills}"
        assert layout_of(data) == LAYOUT
        kills += 1
    assert kills > 12  # folders to make and files to move, of three shots


def test_a_new_folder_has_the_present_layout(tmp_path):
    store = open_and_close(tmp_path)
    assert json.loads((tmp_path / "layout.json").read_text()) == {"layout": LAYOUT}
    record = store.begin("new.usda")
    assert record.edits_folder.is_dir()
    assert load_history(record.edits_folder) is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"layout": 3}', "has layout 3, which a newer Pullfocus"),
        ("{", "damaged"),
        ("[]", "damaged"),
        ('{"layout": "2"}', "damaged"),
    ],
)
def test_a_layout_that_is_not_known_is_refused(data, text, said):
    (data / "layout.json").write_text(text)
    before = files_below(data)
    with pytest.raises(OutputError, match=said):
        ShotStore(data)
    assert files_below(data) == before
    (data / "layout.json").unlink()
    open_and_close(data)  # the refusal has unlocked the folder


def test_two_sets_of_edits_are_not_mixed(data):
    room = next((data / "shots").glob("room-*"))
    (room / "edits").mkdir()
    (room / "edits" / "edits.usda").write_text("#usda 1.0\n")
    before = (room / "edits.usda").read_bytes()
    with pytest.raises(OutputError, match=r"move the one away"):
        ShotStore(data)
    assert (room / "edits.usda").read_bytes() == before
    assert (room / "edits" / "edits.usda").read_text() == "#usda 1.0\n"
