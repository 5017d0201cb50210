"""Processor time in a window of a day."""

from __future__ import annotations

import logging

import pytest

from service.identity.cpu_usage import HOUR_S, WINDOW_HOURS, CpuUsage

DAY_S = WINDOW_HOURS * HOUR_S


class Clock:
    """A clock that tests turn."""

    def __init__(self) -> None:
        self.now_s = 1000.0 * HOUR_S

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_time_comes_back_after_a_day(tmp_path, clock):
    usage = CpuUsage(tmp_path, clock)
    usage.charge("mara", 10.0)
    clock.now_s += HOUR_S
    usage.charge("mara", 5.0)
    assert usage.used_s("mara") == 15.0
    assert usage.used_s("ida") == 0.0
    assert usage.wait_s("mara", 20.0) == 0
    assert usage.wait_s("mara", 12.0) == DAY_S - HOUR_S
    assert usage.wait_s("mara", 5.0) == DAY_S
    clock.now_s += DAY_S - HOUR_S
    assert (usage.used_s("mara"), usage.wait_s("mara", 12.0)) == (5.0, 0)


@pytest.mark.parametrize("jump_s", [-400 * DAY_S, 4000 * DAY_S])
def test_a_jump_of_the_clock_locks_nobody_out(tmp_path, clock, jump_s):
    usage = CpuUsage(tmp_path, clock)
    usage.charge("mara", 10.0)
    clock.now_s += jump_s
    assert usage.wait_s("mara", 5.0) <= DAY_S
    usage.charge("mara", 1.0)
    clock.now_s += DAY_S
    assert usage.wait_s("mara", 5.0) == 0


def test_what_was_used_is_kept(tmp_path, clock):
    usage = CpuUsage(tmp_path, clock)
    usage.charge("mara", 10.0)
    usage.save()
    assert CpuUsage(tmp_path, clock).used_s("mara") == 10.0


@pytest.mark.parametrize(
    "content", ["", "[]", '{"cpu_s": 5}', '{"cpu_s": {"a": {"x": 1}}}', '{"cpu_s": {"a": {"1": -1}}}']
)
def test_a_damaged_file_counts_for_nothing(tmp_path, clock, caplog, content):
    (tmp_path / "usage.json").write_text(content)
    with caplog.at_level(logging.ERROR):
        assert CpuUsage(tmp_path, clock).used_s("a") == 0.0
    assert "usage.json" in caplog.text


def test_a_file_that_cannot_be_written_is_written_later(tmp_path, clock, caplog):
    folder = tmp_path / "data"
    folder.mkdir()
    usage = CpuUsage(folder, clock)
    usage.charge("mara", 10.0)
    folder.rmdir()
    with caplog.at_level(logging.ERROR):
        usage.save()
    assert "is not kept" in caplog.text
    folder.mkdir()
    usage.save()
    assert CpuUsage(folder, clock).used_s("mara") == 10.0
