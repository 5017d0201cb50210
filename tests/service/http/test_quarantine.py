"""Shots that end workers, and how long that is remembered."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from service.http.errors import ServiceError
from service.http.quarantine import FORGET_S, Quarantine
from service.storage.blames import read_blames, write_blames


@pytest.fixture
def record(tmp_path: Path) -> SimpleNamespace:
    return SimpleNamespace(id="room", folder=tmp_path)


@pytest.fixture
def quarantine(record: SimpleNamespace) -> Quarantine:
    return Quarantine(SimpleNamespace(get=lambda shot: record), max_blames=3)


def age(record: SimpleNamespace, seconds: float) -> None:
    blames = read_blames(record.folder)
    write_blames(record.folder, replace(blames, last_s=blames.last_s - seconds))


def test_a_shot_is_in_quarantine_after_its_last_blame(quarantine, record):
    for _ in range(3):
        quarantine.check(record)
        quarantine.blame("room", "memory")
    with pytest.raises(ServiceError, match="memory"):
        quarantine.check(record)


def test_blames_of_another_day_are_forgotten(quarantine, record):
    for _ in range(5):
        quarantine.blame("room", "timeout")
        age(record, 1.1 * FORGET_S)
    quarantine.check(record)
    assert read_blames(record.folder).count == 1


def test_a_quarantine_does_not_end_by_itself(quarantine, record):
    for _ in range(3):
        quarantine.blame("room", "crash")
    age(record, 100 * FORGET_S)
    quarantine.blame("room", "crash")
    with pytest.raises(ServiceError, match="damaged"):
        quarantine.check(record)
