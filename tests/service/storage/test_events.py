"""The log of events: numbers, what a reader gets, and what is forgotten."""

from __future__ import annotations

import threading

import pytest

from render.errors import OutputError
from service.storage.database.connection import open_database, transaction
from service.storage.events import EventLog, NewEvent, Wanted
from tests.service.kits.queues import Clock

ALL = Wanted()


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def log(tmp_path, clock, database):
    engine = open_database(tmp_path, database)
    yield EventLog(engine, clock)
    engine.dispose()


def note(log: EventLog, topic="shots", project="default", **fields) -> None:
    log.note(NewEvent(topic, f"{topic}-changed", project, **fields))


def numbers(log: EventLog, after=0, wanted=ALL, most=100) -> list[int]:
    return [row.number for row in log.after(after, wanted, most)[0]]


def test_events_are_numbered_in_their_order(log):
    assert (log.newest(), log.oldest()) == (0, 1)
    for _ in range(3):
        note(log)
    assert numbers(log) == [1, 2, 3]
    assert numbers(log, after=2) == [3]
    assert (log.newest(), log.oldest()) == (3, 1)


def test_a_reader_gets_what_it_wants(log):
    note(log, "renders", "tram", shot="demo", render="r-1")
    note(log, "tasks", "tram", shot="demo", render="r-2", data={"frame": 3})
    note(log, "shots", "default", shot="other")
    assert numbers(log, wanted=Wanted(project="tram")) == [1, 2]
    assert numbers(log, wanted=Wanted(topics=("renders", "shots"))) == [1, 3]
    assert numbers(log, wanted=Wanted(shot="demo", render="r-2")) == [2]
    assert numbers(log, wanted=Wanted(project="nobody's")) == []
    assert log.after(0, Wanted(render="r-2"), 10)[0][0].data == {"frame": 3}


def test_a_page_goes_on_where_the_last_one_ended(log):
    for _ in range(5):
        note(log, "tasks")
        note(log, "shots")
    wanted, after, seen = Wanted(topics=("tasks",)), 0, []
    for _ in range(3):
        rows, after = log.after(after, wanted, 2)
        seen += [row.number for row in rows]
    assert seen == [1, 3, 5, 7, 9]
    assert after == 10  # also past those that the reader does not want


def test_an_event_is_committed_with_what_it_tells(log):
    def undone():
        with transaction(log._engine) as session:
            log.add(session, NewEvent("shots", "shot-added", "default"))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        undone()
    assert log.newest() == 0


def test_those_who_follow_are_told_once_it_is_committed(log):
    seen = []
    log.on_new = lambda: seen.append(log.newest())
    with transaction(log._engine) as session:
        log.add(session, NewEvent("shots", "shot-added", "default"))
        log.add(session, NewEvent("shots", "shot-deleted", "default"))
        assert seen == []
    assert seen == [2]


def test_numbers_are_seen_in_their_order_by_a_reader_beside_writers(log):
    def write():
        for _ in range(40):
            note(log)

    writers = [threading.Thread(target=write) for _ in range(4)]
    for writer in writers:
        writer.start()
    seen, after = [], 0
    while len(seen) < 160:
        rows, after = log.after(after, ALL, 7)
        seen += [row.number for row in rows]
    for writer in writers:
        writer.join()
    assert seen == list(range(1, 161))


def test_old_events_are_forgotten_but_for_the_newest(log, clock):
    note(log)
    clock.now += 100
    note(log)
    clock.now += 100
    assert log.prune(150) == 1
    assert (numbers(log), log.oldest()) == ([2], 2)
    assert log.prune(50) == 0
    note(log)
    assert numbers(log) == [2, 3]  # a number is not given twice


def test_more_events_than_are_kept_are_forgotten(log, monkeypatch):
    monkeypatch.setattr("service.storage.events.MOST_EVENTS", 3)
    for _ in range(5):
        note(log)
    log.prune(1e9)
    assert numbers(log) == [3, 4, 5]


def test_the_last_event_of_each_shot_is_found(log):
    for shot in ("a", "b", "a"):
        note(log, "presence", shot=shot)
    note(log, "edits", shot="a")
    assert [row.number for row in log.last_of_each_shot("presence")] == [2, 3]


def test_a_note_that_cannot_be_kept_is_logged(log, monkeypatch, caplog):
    def refuse(*_, **__):
        raise OutputError("the disk is full")

    monkeypatch.setattr("service.storage.events.transaction", refuse)
    note(log)
    assert "the disk is full" in caplog.text
