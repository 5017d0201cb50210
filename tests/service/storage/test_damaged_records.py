"""A shot's record that was edited by hand: its shot is left out, and the others stay."""

from __future__ import annotations

import errno
import json
from pathlib import Path

import pytest

from service.storage.store import RECORD, ShotStore

SOUND = {
    "name": "room.usda",
    "root": "room.usda",
    "createdAt": "2026-11-20T10:00:00+00:00",
    "sizeBytes": 12,
    "fileCount": 1,
    "project": "default",
}


@pytest.fixture
def store(tmp_path):
    made = ShotStore(tmp_path)
    yield made
    made.close()


def add(data: Path, shot_id: str, record: object) -> None:
    folder = data / "shots" / shot_id
    (folder / "files").mkdir(parents=True)
    (folder / RECORD).write_text(json.dumps(record))


@pytest.mark.parametrize(
    "wrong",
    [
        {"name": 5},
        {"name": None},
        {"root": ["room.usda"]},
        {"createdAt": 1700000000},
        {"createdAt": "yesterday"},
        {"createdAt": "0001-01-01T00:00:00+05:00"},  # before the first year of UTC
        {"createdAt": "9999-12-31T23:59:59-05:00"},
        {"sizeBytes": "12"},
        {"sizeBytes": 1.5},
        {"fileCount": None},
        {"fileCount": True},
        {"project": {"name": "default"}},
    ],
    ids=str,
)
def test_a_record_of_other_types_hides_its_shot_alone(store, tmp_path, wrong):
    add(tmp_path, "sound", SOUND)
    add(tmp_path, "damaged", SOUND | wrong)
    assert [record.id for record in store.list()] == ["sound"]


@pytest.mark.parametrize("record", [[], "room", 7, None, {}], ids=str)
def test_a_record_that_is_none_hides_its_shot_alone(store, tmp_path, record):
    add(tmp_path, "sound", SOUND)
    add(tmp_path, "damaged", record)
    assert [record.id for record in store.list()] == ["sound"]


def test_a_record_that_is_a_folder_hides_its_shot_alone(store, tmp_path):
    add(tmp_path, "sound", SOUND)
    (tmp_path / "shots" / "damaged" / RECORD).mkdir(parents=True)
    assert [record.id for record in store.list()] == ["sound"]


def test_times_without_a_zone_are_utc_and_sorted_with_others(store, tmp_path):
    add(tmp_path, "second", SOUND)
    add(tmp_path, "first", SOUND | {"createdAt": "2026-11-20T09:00:00"})
    add(tmp_path, "third", SOUND | {"createdAt": "2026-11-20T12:30:00+02:00"})
    assert [record.id for record in store.list()] == ["first", "second", "third"]


def test_a_record_without_a_project_is_of_the_default_one(store, tmp_path):
    add(tmp_path, "old", {name: value for name, value in SOUND.items() if name != "project"})
    assert [record.project for record in store.list()] == ["default"]


def test_a_disk_that_fails_is_not_taken_for_a_missing_shot(store, tmp_path, monkeypatch):
    add(tmp_path, "sound", SOUND)

    def fail(path: Path) -> bytes:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(Path, "read_bytes", fail)
    with pytest.raises(OSError, match="Input/output"):
        store.get("sound")
