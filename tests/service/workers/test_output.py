"""Output of workers: what a call writes to standard error, and no more of it than there is room for."""

from __future__ import annotations

import asyncio
import os
import re

import pytest

from service.workers.calls import call
from service.workers.errors import WorkerError
from service.workers.output import MOST_OUTPUT, JobOutput, WorkerOutput, create_output, log_line
from tests.service.workers.fake_work import complain, echo, process_id, refuse
from tests.service.workers.kit import tally_lane, tally_pool


@pytest.fixture(scope="module")
def lane():
    with tally_pool() as pool, tally_lane(pool) as lane:
        yield lane


def result(lane, wanted, output=None):
    try:
        return asyncio.run(lane.result(wanted, output=output))
    finally:
        if output is not None:
            output.end()


def output_of(lane, text, **options) -> str:
    output = JobOutput()
    result(lane, call(complain, text, **options), output)
    return output.text()


def test_output_has_what_is_written_and_the_steps(lane):
    lines = output_of(lane, "Warning: in _ReportErrors -- Could not open asset @tram.usd@\n").splitlines()
    assert lines[0] == "Warning: in _ReportErrors -- Could not open asset @tram.usd@"
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z complain: \d+\.\d{3} s", lines[1])
    assert len(lines) == 2


def test_each_call_has_its_own_output(lane):
    first, second = (output_of(lane, text) for text in ("a longer first line\n", "second\n"))
    assert "first" in first
    assert first.count("complain") == 1
    assert second.startswith("second\n")
    assert "first" not in second


def test_calls_without_an_output_write_where_they_did(capfd):
    with tally_pool() as pool, tally_lane(pool) as lane:  # whose template has this test's standard error
        worker = result(lane, call(process_id))
        assert "hidden" in output_of(lane, "hidden\n")
        result(lane, call(complain, "seen by the service\n"))
        assert result(lane, call(process_id)) == worker
    told = capfd.readouterr().err
    assert "seen by the service" in told
    assert "hidden" not in told


def test_errors_leave_the_output_of_their_call(lane):
    output = JobOutput()
    with pytest.raises(Exception, match="no USD stage"):
        result(lane, call(refuse), output)
    assert "refuse: " in output.text()


def test_what_a_crash_was_preceded_by_is_kept(lane):
    output = JobOutput()
    with pytest.raises(WorkerError):
        result(lane, call(complain, "the driver gives up\nand says no mo", ends=True), output)
    assert output.text() == "the driver gives up\nand says no mo\n"
    assert result(lane, call(echo, "a new process"))[0] == "a new process"


def test_output_that_has_no_room_is_lost_and_said_so(lane):
    text = output_of(lane, "x" * 1023 + "\n", times=200)
    assert MOST_OUTPUT - 1024 <= len(text) <= MOST_OUTPUT + 100
    assert text.endswith("this log is full.\n")
    assert "x" * 1023 in output_of(lane, "x" * 1023 + "\n", times=3)


def test_signs_that_steer_a_terminal_are_left_out(lane):
    text = output_of(lane, "\x1b]0;title\x07red\x1b[31m\ttab \x9b5n\r\nnext\x00\n")
    assert text.splitlines()[:2] == ["]0;titlered[31m\ttab 5n", "next"]


def test_half_a_line_waits_for_its_end():
    descriptor = create_output()
    output, job = WorkerOutput(descriptor), JobOutput()
    with job.collect(output):
        os.write(descriptor, b"whole\nhal")
        assert job.text() == "whole\n"
        os.write(descriptor, "f \N{LATIN SMALL LETTER E WITH ACUTE}\n".encode())
        assert job.text() == "whole\nhalf \N{LATIN SMALL LETTER E WITH ACUTE}\n"
    output.close()
    assert job.text().count("\n") == 2


def test_a_job_has_nothing_of_the_one_before():
    descriptor = create_output()
    output, first, second = WorkerOutput(descriptor), JobOutput(), JobOutput()
    with first.collect(output):
        os.write(descriptor, b"first\n")
    with second.collect(output):
        assert second.text() == ""
        os.write(descriptor, b"second\n")
    output.close()
    assert (first.text(), second.text()) == ("first\n", "second\n")


def test_a_worker_cannot_make_its_memory_larger():
    descriptor = create_output()
    with pytest.raises(PermissionError):
        os.ftruncate(descriptor, MOST_OUTPUT + 1)
    os.lseek(descriptor, 1 << 40, os.SEEK_SET)
    assert len(WorkerOutput(descriptor).read()) <= MOST_OUTPUT
    os.close(descriptor)


def test_lines_of_a_log_are_single_lines_in_utc():
    assert log_line("failed: a\nb", 1_795_810_443.12) == "2026-11-27T20:14:03.120Z failed: a b\n"
