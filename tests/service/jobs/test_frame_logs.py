"""Logs of attempts: as they grow, and as both kinds of databases keep them."""

from __future__ import annotations

import pytest

from render.errors import NotFoundError
from service.jobs.frame_logs import KEPT_LOGS, MOST_LOG, FrameLog
from tests.service.kits.queues import FILES, LEASE_S, render


def text_of(queue, claim) -> str:
    return queue.logs.read(claim.render, claim.frame, claim.attempt).text


def begun(queue, frames=(1,)):
    queue.submit(render(frames))
    return queue.claim("one", LEASE_S)


def test_new_lines_come_once_and_in_their_order():
    log, told = FrameLog(), ["open shot\n"]
    log.add("attempt 1")
    log.follow(lambda: "".join(told))
    first = log.take()
    assert first.endswith("Z attempt 1\nopen shot\n")
    told.append("trace rays\n")
    log.add("stored exr")
    log.put_back(first)
    lines = log.take().splitlines()
    assert [line.rpartition("Z ")[2] for line in lines] == ["attempt 1", "open shot", "trace rays", "stored exr"]
    assert log.take() == ""


def test_a_second_process_goes_on_where_the_first_one_ended():
    log = FrameLog()
    log.follow(lambda: "first process\n")
    log.follow(lambda: "second\n")
    assert log.take() == "first process\nsecond\n"


def test_a_log_grows_until_its_attempt_has_ended(queue):
    claim = begun(queue)
    assert queue.logs.read(claim.render, 1).text == ""
    queue.logs.append(claim, "a\n")
    queue.logs.append(claim, "b\n")
    found = queue.logs.read(claim.render, 1)
    assert (found.attempt, found.text, found.has_ended) == (1, "a\nb\n", False)
    queue.finish(claim, FILES, 24, "c\n")
    queue.logs.append(claim, "too late\n")
    found = queue.logs.read(claim.render, 1, 1)
    assert (found.text, found.has_ended) == ("a\nb\nc\n", True)


def test_each_attempt_has_its_log_with_its_end(queue, clock):
    first = begun(queue)
    queue.fail(first, "the disk\nis full", "lines\n", may_pass=True)
    clock.now += LEASE_S
    second = queue.claim("one", LEASE_S)
    queue.lose(second, "worker one is gone")
    clock.now += LEASE_S
    third = queue.claim("one", LEASE_S)
    queue.give_back(third, "the service stops", "few\n")
    ends = [text_of(queue, claim).splitlines() for claim in (first, second, third)]
    assert [len(lines) for lines in ends] == [2, 1, 2]
    assert ends[0][0] == "lines"
    assert ends[0][1].endswith("Z failed: the disk is full")
    assert ends[1][0].endswith("Z lost: worker one is gone")
    assert ends[2][1].endswith("Z given-back: the service stops")
    assert queue.logs.read(first.render, 1).attempt == 3


def test_a_lease_that_runs_out_is_told_in_the_log(queue, clock):
    claim = begun(queue)
    queue.logs.append(claim, "trace rays\n")
    clock.now += LEASE_S + 1
    queue.claim("two", LEASE_S)
    assert text_of(queue, claim).splitlines()[-1].endswith("lost: the worker is gone")


def test_a_log_has_a_longest_size_and_counts_as_stored(queue):
    claim = begun(queue)
    before = queue.get(claim.render).stored_bytes
    for _ in range(3):
        queue.logs.append(claim, "\N{LATIN SMALL LETTER E WITH ACUTE}" * (MOST_LOG // 4 - 1) + "\n")
    queue.finish(claim, {}, 24, "no room\n")
    stored = len(text_of(queue, claim).encode())
    assert MOST_LOG - 2 <= stored <= MOST_LOG
    assert queue.get(claim.render).stored_bytes - before == pytest.approx(stored, abs=2)


def test_lines_whose_commit_had_no_answer_are_there_once(queue):
    claim = begun(queue)
    queue.logs.append(claim, "one\n")
    for _ in range(2):
        queue.logs.append(claim, "two \N{LATIN SMALL LETTER E WITH ACUTE}\n", after_bytes=4)
    queue.logs.append(claim, "two \N{LATIN SMALL LETTER E WITH ACUTE}\nthree\n", after_bytes=4)
    assert text_of(queue, claim) == "one\ntwo \N{LATIN SMALL LETTER E WITH ACUTE}\nthree\n"


def test_the_logs_of_the_last_attempts_alone_are_kept(queue, clock):
    claims = [begun(queue)]
    before = queue.get(claims[0].render).stored_bytes
    for _ in range(KEPT_LOGS + 1):
        queue.give_back(claims[-1], "again", "line\n")
        clock.now += LEASE_S
        claims.append(queue.claim("one", LEASE_S))
    texts = [text_of(queue, claim) for claim in claims[:-1]]
    assert [bool(text) for text in texts] == [False] + [True] * KEPT_LOGS
    assert queue.get(claims[0].render).stored_bytes - before == sum(len(text.encode()) for text in texts)


def test_what_no_database_holds_does_not_end_an_attempt(queue):
    claim = begun(queue)
    queue.logs.append(claim, "a\0b\ud800c\n")
    assert text_of(queue, claim) == "a\N{REPLACEMENT CHARACTER}b?c\n"


def test_logs_go_with_their_render_and_with_attempts_forgotten(queue):
    claim = begun(queue)
    queue.logs.append(claim, "a\n")
    before = queue.get(claim.render).stored_bytes
    queue.put_off(claim, 0)
    assert queue.get(claim.render).stored_bytes == before - 2
    assert queue.logs.read(claim.render, 1) is None
    again = queue.claim("one", LEASE_S)
    queue.finish(again, FILES, 24, "b\n")
    queue.remove(again.render, lambda: None)
    with pytest.raises(NotFoundError, match="render"):
        queue.logs.read(again.render, 1)


def test_frames_and_attempts_that_are_none_are_refused(queue):
    claim = begun(queue, (1, 2))
    assert queue.logs.read(claim.render, 2) is None
    for frame, attempt, code in (
        (3, None, "frame_not_found"),
        (1, 2, "attempt_not_found"),
        (2, 1, "attempt_not_found"),
    ):
        with pytest.raises(NotFoundError) as refused:
            queue.logs.read(claim.render, frame, attempt)
        assert refused.value.code == code
