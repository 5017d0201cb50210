"""The shots on disk: there as a whole or not at all, and one service for one folder."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from render.errors import NotFoundError, OutputError
from render.model.edit_history import revision_of
from service.storage import store as storage
from service.storage.edit_files import HISTORY
from service.storage.store import ShotStore


@pytest.fixture
def store(tmp_path):
    with_lock = ShotStore(tmp_path)
    yield with_lock
    with_lock.close()


def accepted(store, name="Night Shot.usda", shot_id=None):
    begun = store.begin(name, shot_id)
    (begun.files / "shot.usda").write_text("#usda 1.0\n")
    return store.accept(begun, "shot.usda")


def test_a_shot_is_there_once_it_is_accepted(store):
    begun = store.begin("Night Shot.usda")
    assert store.list() == []
    with pytest.raises(NotFoundError):
        store.get(begun.id)
    (begun.files / "shot.usda").write_text("#usda 1.0\n")
    record = store.accept(begun, "shot.usda")
    assert store.list() == [record] == [store.get(begun.id)]
    assert (record.name, record.root, record.size_bytes, record.file_count) == ("Night Shot.usda", "shot.usda", 10, 1)
    assert record.id.startswith("night-shot-")
    assert record.root_path.is_file()


def test_two_shots_of_one_name_are_two_shots(store):
    assert accepted(store).id != accepted(store).id
    assert len(store.list()) == 2


def test_a_refused_shot_leaves_nothing(store, tmp_path):
    store.discard(store.begin("bad.usda"))
    assert store.list() == []
    assert list((tmp_path / "shots").iterdir()) == []


@pytest.mark.parametrize("name", ["../x", "", "a/b", "A", "-a", "a" * 65, "nobody", "a\0b"])
def test_a_shot_that_is_not_there_is_named(store, name):
    with pytest.raises(NotFoundError) as error:
        store.get(name)
    assert error.value.code == "shot_not_found"


def test_shots_outlive_the_service_and_half_of_one_does_not(tmp_path):
    store = ShotStore(tmp_path)
    record = accepted(store)
    record.edits.write_text("#usda 1.0\n")
    half = store.begin("half.usda")
    store.close()
    again = ShotStore(tmp_path)
    assert again.list() == [record]
    assert again.get(record.id).edit_text() == "#usda 1.0\n"
    assert not half.folder.exists()
    again.close()


def test_what_killed_writers_leave_is_removed(tmp_path):
    store = ShotStore(tmp_path / "data")
    record, other = accepted(store), accepted(store)
    history = record.edits_folder / HISTORY
    history.mkdir()
    folders = tmp_path / "data", record.folder, record.edits_folder, history
    left = [folder / ".x.part" for folder in folders]
    kept = [record.files / "sent.part", tmp_path / "elsewhere" / "kept.part"]
    kept[1].parent.mkdir()
    (other.edits_folder / HISTORY).symlink_to(kept[1].parent)
    for file in (*left, *kept):
        file.touch()
    store.close()
    ShotStore(tmp_path / "data").close()
    assert not any(file.exists() for file in left)
    assert all(file.exists() for file in kept)


def test_a_folder_named_like_an_unfinished_file_stays(tmp_path):
    store = ShotStore(tmp_path)
    odd = accepted(store).edits_folder / "odd.part"
    odd.mkdir()
    store.close()
    ShotStore(tmp_path).close()
    assert odd.is_dir()


def test_a_shot_that_finds_no_room_leaves_nothing(store, tmp_path, monkeypatch):
    mkdir = Path.mkdir

    def full(folder, *arguments, **options):
        if folder.name == "edits":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        mkdir(folder, *arguments, **options)

    monkeypatch.setattr(Path, "mkdir", full)
    with pytest.raises(OSError, match="No space left"):
        store.begin("night.usda")
    assert list((tmp_path / "shots").iterdir()) == []


def test_a_shot_is_listed_once_the_disk_has_its_files(store, monkeypatch):
    begun = store.begin("night.usda")

    def failing(folder):
        assert folder == begun.files
        raise OutputError("the disk fails")

    monkeypatch.setattr(storage, "sync_file_system", failing)
    with pytest.raises(OutputError):
        store.accept(begun, "shot.usda")
    assert store.list() == []


def test_a_record_that_was_spoilt_spoils_no_other(store, caplog):
    good, bad = accepted(store), accepted(store)
    (bad.folder / "shot.json").write_text("{")
    assert store.list() == [good]
    assert bad.id in caplog.text
    assert bad.root_path.is_file()


def test_a_data_folder_takes_one_service(store, tmp_path):
    with pytest.raises(OutputError, match="another service"):
        ShotStore(tmp_path)


def test_a_data_folder_that_cannot_be_had_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        ShotStore(tmp_path / "file" / "data")


def test_every_edit_is_another_revision():
    assert revision_of("") == revision_of("")
    assert revision_of("") != revision_of("#usda 1.0\n")
