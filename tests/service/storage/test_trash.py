"""The trash on disk: a shot is in it or out of it as a whole, and goes for good when its time is over."""

from __future__ import annotations

import os
import shutil
from datetime import UTC, datetime, timedelta

import pytest

from render.errors import NotFoundError
from render.model.edit_history import revision_of
from service.edit_context import ANY_CONTEXT, ChangedMeanwhileError, EditContext, edits_tag
from service.storage.clocks import Clocks
from service.storage.store import ShotStore
from service.storage.trash import Trash


class Time:
    """Time that passes, and a wall clock that is set to another time."""

    def __init__(self):
        self.passed = timedelta()
        self.is_off_by = timedelta()

    def wall(self):
        self.passed += timedelta(milliseconds=1)
        return datetime(2026, 11, 21, 8, tzinfo=UTC) + self.passed + self.is_off_by

    def clocks(self):
        return Clocks(self.wall, lambda: self.passed.total_seconds())


@pytest.fixture
def time():
    return Time()


@pytest.fixture
def store(tmp_path):
    store = ShotStore(tmp_path)
    yield store
    store.close()


@pytest.fixture
def trash(store, tmp_path, time):
    return Trash(tmp_path, 30, time.clocks())


@pytest.fixture
def shot(store):
    return accepted(store)


def accepted(store, shot_id="night"):
    begun = store.begin("Night.usda", shot_id, "tram")
    (begun.files / "shot.usda").write_text("#usda 1.0\n")
    begun.edits.write_text("#usda 1.0\n")
    return store.accept(begun, "shot.usda")


def test_a_deleted_shot_comes_back_as_it_was(store, trash, shot):
    trash.put(shot, ANY_CONTEXT)
    assert store.list() == []
    (entry,) = trash.entries()
    assert (entry.record.id, entry.record.project, entry.record.size_bytes) == ("night", "tram", 10)
    assert entry.removed_at - entry.deleted_at == timedelta(days=30)
    trash.restore(entry)
    assert store.list() == [shot]
    assert shot.edit_text() == "#usda 1.0\n"
    assert trash.entries() == []
    with pytest.raises(NotFoundError):
        trash.restore(entry)


def test_a_shot_that_is_there_again_is_not_overwritten(store, trash, shot):
    trash.put(shot, ANY_CONTEXT)
    again = accepted(store)
    (entry,) = trash.entries()
    with pytest.raises(FileExistsError):
        trash.restore(entry)
    assert store.list() == [again]
    assert trash.entries() == [entry]


def test_shots_of_one_id_lie_beside_each_other(store, trash, shot):
    trash.put(shot, ANY_CONTEXT)
    trash.put(accepted(store), ANY_CONTEXT)
    first, second = trash.entries()
    assert first.deleted_at > second.deleted_at
    assert first.record.id == second.record.id == "night"


def test_a_shot_that_was_edited_since_stays(store, trash, shot):
    with pytest.raises(ChangedMeanwhileError):
        trash.put(shot, EditContext('"e3b0c44298fc1c14"'))
    assert store.list() == [shot]
    trash.put(shot, EditContext(edits_tag(revision_of("#usda 1.0\n"))))
    assert store.list() == []


def test_an_edit_until_the_move_brings_it_back(store, trash, shot, monkeypatch):
    rename = os.rename

    def edit_and_rename(source, target):
        if source == shot.folder:
            shot.edits.write_text("#usda 1.0\n# edited\n")
        rename(source, target)

    monkeypatch.setattr(os, "rename", edit_and_rename)
    with pytest.raises(ChangedMeanwhileError):
        trash.put(shot, EditContext(edits_tag(revision_of("#usda 1.0\n"))))
    assert store.list() == [shot]
    assert shot.edit_text() == "#usda 1.0\n# edited\n"
    assert trash.entries() == []


def test_a_shot_is_deleted_once(trash, shot):
    trash.put(shot, ANY_CONTEXT)
    with pytest.raises(NotFoundError):
        trash.put(shot, ANY_CONTEXT)


def test_the_trash_is_emptied_when_its_time_is_over(store, trash, shot, time, tmp_path):
    trash.put(shot, ANY_CONTEXT)
    time.passed += timedelta(days=29)
    trash.put(accepted(store, "later"), ANY_CONTEXT)
    assert trash.empty() == 0
    time.passed += timedelta(days=2)
    assert trash.empty() == 1
    assert [entry.record.id for entry in trash.entries()] == ["later"]
    assert len(list((tmp_path / "trash").iterdir())) == 1


@pytest.mark.parametrize("is_before", [False, True], ids=["after", "before"])
def test_a_clock_that_is_set_removes_nothing_early(trash, shot, time, is_before):
    if is_before:
        time.is_off_by = -timedelta(days=365)
    trash.put(shot, ANY_CONTEXT)
    time.is_off_by += timedelta(days=365)
    time.passed += timedelta(days=29)
    assert trash.empty() == 0
    time.is_off_by = timedelta()
    time.passed += timedelta(days=1)
    assert trash.empty() == 1


def test_nothing_is_removed_soon_after_a_start(trash, shot, time, tmp_path):
    trash.put(shot, ANY_CONTEXT)
    time.passed += timedelta(days=31)
    started = Trash(tmp_path, 30, time.clocks())
    assert started.empty() == 0
    time.passed += timedelta(hours=1)
    assert started.empty() == 1


def test_a_tree_of_any_depth_is_removed(trash, shot, tmp_path):
    place = os.open(shot.edits_folder, os.O_RDONLY)
    for _ in range(2000):
        os.mkdir("a" * 200, dir_fd=place)
        inner = os.open("a" * 200, os.O_RDONLY, dir_fd=place)
        os.close(place)
        place = inner
    os.close(place)
    trash.put(shot, ANY_CONTEXT)
    trash.remove(trash.entries()[0])
    assert list((tmp_path / "trash").iterdir()) == []


def test_no_days_keep_nothing(store, shot, time, tmp_path):
    Trash(tmp_path, 0, time.clocks()).put(shot, ANY_CONTEXT)
    assert store.list() == []
    assert list((tmp_path / "trash").iterdir()) == []


def test_an_interrupted_removal_is_finished(trash, shot, tmp_path):
    trash.put(shot, ANY_CONTEXT)
    (entry,) = trash.entries()
    (entry.record.folder / "shot.json").unlink()
    assert trash.entries() == []
    with pytest.raises(NotFoundError):
        trash.get(entry.id)
    assert trash.empty() == 1
    assert list((tmp_path / "trash").iterdir()) == []


def test_a_removed_shot_is_gone(trash, shot, tmp_path):
    trash.put(shot, ANY_CONTEXT)
    (entry,) = trash.entries()
    trash.remove(entry)
    assert list((tmp_path / "trash").iterdir()) == []
    with pytest.raises(NotFoundError):
        trash.remove(entry)


def test_a_trash_may_be_kept_for_ever(tmp_path, shot, time):
    trash = Trash(tmp_path, 10**12, time.clocks())
    trash.put(shot, ANY_CONTEXT)
    assert trash.entries()[0].removed_at.year == 9999
    assert trash.empty() == 0


@pytest.mark.parametrize("name", ["", "..", "../shots/night", "night", "night.1", "night.20269999999999999999"])
def test_nothing_else_is_in_the_trash(trash, shot, name):
    with pytest.raises(NotFoundError):
        trash.get(name)


def test_a_folder_whose_stamp_is_no_time_is_left_alone(store, trash, shot, time, tmp_path):
    trash.put(shot, ANY_CONTEXT)
    [entry] = trash.entries()
    stray = entry.record.folder.with_name("night.99999999999999999999")
    shutil.copytree(entry.record.folder, stray)
    assert [each.id for each in trash.entries()] == [entry.id]
    with pytest.raises(NotFoundError):
        trash.get(stray.name)
    time.passed += timedelta(days=31)
    assert trash.empty() == 1
    assert stray.is_dir()
