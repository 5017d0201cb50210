"""`pullfocus bench jobs` measures a queue of renders, workers that sleep and readers of events, and judges them."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import pytest

from render.errors import SettingsError
from service.bench.jobs.plan import JobsPlan, add_arguments, plan_from_arguments
from service.bench.jobs.results import (
    Reader,
    ReaderRow,
    RequestRow,
    goals_of,
    growth_of,
    reader_row,
    times_of,
    workers_row,
)
from tests.render.kits.cli_shots import Command

KEPT = [(number, "tasks" if number % 2 else "renders") for number in range(1, 11)]


def reader_with(numbers: list[int], start: int = 4, topics: tuple[str, ...] = ()) -> ReaderRow:
    reader = Reader.after("process", topics, start)
    for number in numbers:
        reader.note(number)
    reader.cuts = 1
    return reader_row(reader, KEPT, 9)


def counts(row: ReaderRow) -> tuple[int, int, int, int, int]:
    return row.events, row.missed, row.doubled, row.strange, row.out_of_order


def test_a_reader_with_every_event_once_misses_none():
    assert counts(reader_with([5, 6, 7, 8, 9])) == (5, 0, 0, 0, 0)
    assert counts(reader_with([6, 8], topics=("renders",))) == (2, 0, 0, 0, 0)
    assert counts(reader_with([5, 6, 7, 8, 9, 10])) == (5, 0, 0, 0, 0)  # later than it had to be read


def test_events_that_are_missed_doubled_or_strange_are_counted():
    assert counts(reader_with([5, 7, 8, 9])) == (5, 1, 0, 0, 0)
    assert counts(reader_with([5, 6, 6, 7, 8, 9])) == (5, 0, 1, 0, 0)
    assert counts(reader_with([6, 7, 8], topics=("renders",))) == (2, 0, 0, 1, 0)
    assert counts(reader_with([5, 7, 6, 8, 9])) == (5, 0, 0, 0, 1)
    assert counts(reader_with([4, 5, 6, 7, 8, 9])) == (5, 0, 0, 1, 0)


def test_workers_that_wait_are_less_efficient():
    row = workers_row(4, 0.5, 40, 10.0)
    assert (row.frames_per_hour, row.efficiency) == (14400, 0.5)


def test_times_have_their_high_percentiles():
    times = times_of([number / 1000 for number in range(1, 201)])
    assert (times.count, times.median_ms, times.p95_ms, times.p99_ms, times.most_ms) == (200, 100.5, 190, 198, 200)


def test_the_growth_compares_both_ends():
    growth = growth_of(1, [0.001] * 500 + [0.003] * 500)
    assert (growth.renders, growth.first_p95_ms, growth.last_p95_ms) == (100, 1, 3)
    assert growth_of(1, [0.001, 0.001, 0.003]).renders == 2


def test_a_slow_request_an_idle_worker_and_a_lost_event_fail():
    quick, slow = times_of([0.01] * 100), times_of([0.01] * 90 + [0.06] * 10)
    requests = [RequestRow("submit", 1, quick), RequestRow("cancel", 1, slow), RequestRow("get", 1, slow)]
    workers = [workers_row(2, 0.5, 40, 10.1), workers_row(4, 0.5, 80, 11.0), workers_row(8, 0.5, 160, 20.0)]
    readers = [reader_with([5, 6, 7, 8, 9]), reader_with([5, 5, 6, 8, 9])]
    assert [goal.holds for goal in goals_of(requests, workers, readers)] == [
        *(True, False),
        *(True, False),
        *(False, False, True, True),
        *(True, True),
    ]
    nothing = Reader.after("HTTP", (), 9)
    assert [goal.holds for goal in goals_of([], [], [reader_row(nothing, KEPT, 9)])][-2:] == [False, False]


@pytest.mark.parametrize(
    "arguments",
    [
        ["--renders", "0"],
        ["--workers", "1", "100"],
        ["--frame-seconds", "nan"],
        ["--seconds", "0"],
        ["--readers", "99"],
    ],
)
def test_numbers_out_of_range_are_refused(arguments):
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    with pytest.raises(SettingsError, match=arguments[0]):
        plan_from_arguments(parser.parse_args(arguments))
    assert plan_from_arguments(parser.parse_args([])) == JobsPlan()


@pytest.mark.gl
def test_a_small_queue_is_measured(tmp_path: Path, database: str, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "jobs.json"
    sizes = [
        "--renders",
        3,
        "--frames",
        5,
        "--workers",
        1,
        2,
        "--frame-seconds",
        0.02,
        "--seconds",
        0.1,
        "--readers",
        3,
    ]
    ended = Command(capsys)("bench", "jobs", *sizes, "--database", database, "--json", file)
    assert ended.status == 0, ended.err
    found = json.loads(file.read_text())
    assert found["database"].startswith("PostgreSQL" if database else "SQLite")
    requests = {(row["request"], row["clients"]): row["times"] for row in found["requests"]}
    assert len(requests) == 18
    assert {requests[name, clients]["count"] for name in ("submit", "cancel", "remove") for clients in (1, 4)} == {3}
    assert all(0 < times["median_ms"] <= times["p95_ms"] <= times["most_ms"] for times in requests.values())
    assert [(row["workers"], row["frames"]) for row in found["workers"]] == [(1, 5), (2, 10)]
    assert all(0 < row["efficiency"] <= 1 for row in found["workers"])
    assert [row["times"]["count"] for row in found["queue"]] == [15, 15, 15]
    assert [row["over"] for row in found["readers"]] == ["process"] * 3 + ["HTTP"] * 3
    assert all(row["missed"] == row["doubled"] == row["out_of_order"] == 0 for row in found["readers"])
    assert sum(row["events"] for row in found["readers"]) > 60
    assert ended.out.count("pass ") + ended.out.count("FAIL ") == len(found["goals"]) == 16
    assert "sleep as long as a frame takes" in ended.out
    assert "postgresql://" not in file.read_text()
