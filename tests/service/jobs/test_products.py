"""Products of renders in the queue: who makes them, when, and what becomes of the render meanwhile."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sqlalchemy import event

from service.jobs.attempts import MOST_BACK_OFF_S, MOST_FAILURES, MOST_LOSSES
from service.jobs.errors import ConflictError
from service.jobs.product_states import NEW, NO_FRAMES
from service.jobs.states import state_of
from service.jobs.turns import LOOKS
from service.storage.database.tables import RenderRow
from service.storage.events import EventLog, Wanted
from tests.service.kits.queues import LEASE_S, drawn, opened, render

MOVIE, REPORT = "movie.mp4", "focus-report.csv"


def with_products(*names, **fields):
    return replace(render(**fields), products=names)


def made(queue):
    """Claim and finish the next product."""
    claim = queue.products.claim(LEASE_S)
    if claim is None:
        return None
    queue.products.finish(claim, 12)
    return claim.name


def products(queue, sent):
    return {name: entry["state"] for name, entry in queue.get(sent.id).products.items()}


def kinds(queue, sent):
    """The states of a render and of its products as events tell them."""
    events, _ = EventLog(queue._engine).after(0, Wanted(topics=("renders",), render=sent.id), 1000)
    return [(event.data.get("product"), event.data["state"]) for event in events]


def test_a_movie_waits_for_the_frames_and_a_report_does_not(queue):
    sent = queue.submit(with_products(MOVIE, REPORT, frames=(1, 2)))
    assert [made(queue), made(queue)] == [REPORT, None]
    drawn(queue)
    assert made(queue) is None
    drawn(queue)
    waiting = queue.get(sent.id)
    assert (state_of(waiting), waiting.unended, waiting.finished_at) == ("running", 1, None)
    claim = queue.products.claim(LEASE_S)
    assert (claim.name, claim.owner, products(queue, sent)[MOVIE]) == (MOVIE, "key:a", "running")
    assert queue.products.claim(LEASE_S) is None  # one service makes it
    queue.products.finish(claim, 34)
    done = queue.get(sent.id)
    assert (state_of(done), done.products[MOVIE]["size_bytes"], done.finished_at) == ("done", 34, 1000.0)


def test_a_render_without_formats_draws_no_frame(queue):
    new = with_products(REPORT)
    sent = queue.submit(replace(new, request=new.request | {"formats": []}))
    assert (sent.count, sent.frames, state_of(sent)) == (0, "1-3", "queued")
    assert drawn(queue) is None
    assert made(queue) == REPORT
    assert state_of(queue.get(sent.id)) == "done"


def test_a_pause_holds_products_up(queue):
    sent = queue.submit(with_products(REPORT))
    claim = queue.products.claim(LEASE_S)
    assert state_of(queue.pause(sent.id)) == "pause-requested"
    queue.products.give_back(claim)
    assert state_of(queue.get(sent.id)) == "paused"
    assert made(queue) is None
    queue.resume(sent.id)
    assert made(queue) == REPORT


def test_a_cancel_stops_products(queue):
    sent = queue.submit(with_products(MOVIE, REPORT, frames=(1,)))
    drawn(queue)
    claim = queue.products.claim(LEASE_S)
    assert state_of(queue.cancel(sent.id)) == "cancel-requested"
    assert not queue.products.extend(claim, LEASE_S)
    queue.products.give_back(claim)
    ended = queue.get(sent.id)
    assert (state_of(ended), ended.finished_at) == ("canceled", 1000.0)
    assert products(queue, sent) == {MOVIE: "canceled", REPORT: "canceled"}
    with pytest.raises(ConflictError):
        queue.cancel(sent.id)
    queue.retry(sent.id)
    assert (made(queue), made(queue), state_of(queue.get(sent.id))) == (MOVIE, REPORT, "done")


def test_a_product_that_fails_fails_its_render(queue):
    sent = queue.submit(with_products(REPORT, frames=(1,)))
    drawn(queue)
    queue.products.fail(queue.products.claim(LEASE_S), "no shot")
    failed = queue.get(sent.id)
    assert (state_of(failed), failed.products[REPORT]["error"]) == ("failed", "no shot")
    assert kinds(queue, sent)[-2:] == [(REPORT, "failed"), (None, "failed")]
    assert state_of(queue.accept(sent.id)) == "done"
    assert products(queue, sent) == {REPORT: "failed"}
    again = queue.retry(sent.id)
    assert (state_of(again), again.finished_at, again.products[REPORT]["error"]) == ("running", None, None)
    assert (made(queue), state_of(queue.get(sent.id))) == (REPORT, "done")


def test_an_error_that_may_pass_is_tried_again(queue, clock):
    sent = queue.submit(with_products(REPORT))
    for pause_s in (2, 4):
        queue.products.fail(queue.products.claim(LEASE_S), "disk full", may_pass=True)
        clock.now += pause_s - 0.5
        assert queue.products.claim(LEASE_S) is None
        clock.now += 0.5
    queue.products.fail(queue.products.claim(LEASE_S), "disk full", may_pass=True)
    clock.now += 100
    assert (made(queue), products(queue, sent)) == (None, {REPORT: "failed"})
    assert queue.get(sent.id).products[REPORT]["failures"] == MOST_FAILURES
    queue.retry(sent.id)
    assert made(queue) == REPORT  # at once


def test_a_product_that_is_refused_pauses_alone(queue, clock):
    queue.submit(with_products(REPORT, "focus-curve.csv", frames=(1,)))
    queue.products.give_back(queue.products.claim(LEASE_S), 15)
    assert [made(queue), made(queue)] == ["focus-curve.csv", None]
    assert drawn(queue) is not None
    clock.now += 15
    assert made(queue) == REPORT
    queue.submit(with_products(REPORT, frames=(1,)))
    queue.products.give_back(queue.products.claim(LEASE_S), 15)
    clock.now -= 3600
    assert made(queue) == REPORT


def test_losses_are_no_failures_of_a_product(queue, clock):
    sent = queue.submit(with_products(REPORT))
    for losses in range(1, MOST_LOSSES + 1):
        assert queue.products.claim(LEASE_S) is not None
        clock.now += LEASE_S + 1
        assert queue.products.claim(LEASE_S) is None  # it pauses
        entry = queue.get(sent.id).products[REPORT]
        assert (entry["losses"], entry["failures"]) == (losses, 0)
        clock.now += MOST_BACK_OFF_S
    assert (entry["state"], made(queue)) == ("failed", None)


def test_a_service_keeps_what_it_makes_for_another_lease(queue, clock):
    sent = queue.submit(with_products(REPORT))
    claim = queue.products.claim(LEASE_S)
    clock.now += LEASE_S + 1  # the database was away
    queue.products.take_back_left([claim], LEASE_S)
    assert queue.products.claim(LEASE_S) is None
    queue.products.finish(claim, 7)
    assert products(queue, sent) == {REPORT: "done"}


def test_a_movie_fails_with_its_frames_until_they_are_accepted(queue):
    sent = queue.submit(with_products(MOVIE, frames=(1, 2)))
    queue.fail(queue.claim("one", LEASE_S), "no camera", may_pass=False)
    drawn(queue)
    failed = queue.get(sent.id)
    assert (state_of(failed), failed.products[MOVIE]["error"]) == ("failed", NO_FRAMES)
    assert kinds(queue, sent)[-2:] == [(MOVIE, "failed"), (None, "failed")]
    assert made(queue) is None
    assert state_of(queue.accept(sent.id)) == "running"
    assert (made(queue), state_of(queue.get(sent.id))) == (MOVIE, "done")
    queue.retry(sent.id, [2])
    assert products(queue, sent) == {MOVIE: "waiting"}  # of other frames


def test_a_canceled_render_is_accepted_with_its_movie(queue):
    sent = queue.submit(with_products(MOVIE, REPORT, frames=(1, 2)))
    queue.fail(queue.claim("one", LEASE_S), "no camera", may_pass=False)
    drawn(queue)
    assert state_of(queue.cancel(sent.id)) == "canceled"
    assert state_of(queue.accept(sent.id)) == "running"
    assert (made(queue), made(queue)) == (MOVIE, None)
    assert (state_of(queue.get(sent.id)), products(queue, sent)) == ("done", {MOVIE: "done", REPORT: "canceled"})


@pytest.mark.parametrize("end", ["finish", "fail", "give_back"])
def test_a_retry_voids_the_attempt_at_a_movie(queue, end):
    sent = queue.submit(with_products(MOVIE, REPORT, frames=(1,)))
    drawn(queue)
    movie, report = (queue.products.claim(LEASE_S) for _ in range(2))
    queue.retry(sent.id, [1])
    assert products(queue, sent) == {MOVIE: "waiting", REPORT: "running"}
    assert (queue.products.extend(movie, LEASE_S), queue.products.extend(report, LEASE_S)) == (False, True)
    ends = {"finish": [9], "fail": ["render_not_ended"], "give_back": []}
    getattr(queue.products, end)(movie, *ends[end])
    assert queue.get(sent.id).products[MOVIE] | {"attempts": 0} == NEW
    assert queue.products.claim(LEASE_S) is None  # before the frame is drawn
    drawn(queue)
    assert made(queue) == MOVIE


def test_the_text_of_an_error_has_no_movie_made_again(queue):
    sent = queue.submit(with_products(MOVIE, frames=(1,)))
    drawn(queue)
    queue.products.fail(queue.products.claim(LEASE_S), NO_FRAMES)
    assert state_of(queue.accept(sent.id)) == "done"
    assert products(queue, sent) == {MOVIE: "failed"}


def test_a_look_for_products_reads_few_renders(queue, clock):
    for _ in range(5):
        queue.submit(with_products(MOVIE, frames=(1,)))  # waits for its frame
    clock.now += 1
    first = queue.submit(with_products(MOVIE, REPORT, frames=(1,)))
    clock.now += 1
    for _ in range(5):
        queue.submit(with_products(REPORT, frames=(1,)))
    read = []
    event.listen(RenderRow, "load", note := lambda render, _: read.append(render.id))
    try:
        claim = queue.products.claim(LEASE_S)
    finally:
        event.remove(RenderRow, "load", note)
    assert (claim.render, read) == (first.id, [first.id])


def test_a_look_for_products_goes_past_those_that_pause(queue, clock):
    for _ in range(LOOKS + 1):
        queue.submit(with_products(REPORT))
        queue.products.give_back(queue.products.claim(LEASE_S), 15)
    clock.now += 1
    last = queue.submit(with_products(REPORT))
    assert queue.products.claim(LEASE_S).render == last.id


def test_each_change_of_a_product_is_an_event(queue):
    sent = queue.submit(with_products(MOVIE, REPORT, frames=(1,)))
    queue.fail(queue.claim("one", LEASE_S), "no camera", may_pass=False)
    queue.cancel(sent.id)
    queue.accept(sent.id)
    queue.retry(sent.id)
    told = [(name, state) for name, state in kinds(queue, sent) if name]
    assert told[:4] == [(MOVIE, "failed"), (REPORT, "canceled"), (MOVIE, "waiting"), (REPORT, "waiting")]


def test_a_service_that_is_gone_holds_no_product_up(queue, clock):
    sent = queue.submit(with_products(REPORT))
    lost = queue.products.claim(LEASE_S)
    clock.now += LEASE_S + 1
    assert queue.products.claim(LEASE_S) is None  # it pauses first
    clock.now += 2
    again = queue.products.claim(LEASE_S)
    assert (again.name, again.attempt) == (REPORT, 2)
    queue.products.finish(lost, 7)  # comes too late
    assert products(queue, sent) == {REPORT: "running"}
    queue.products.take_back_left([again], LEASE_S)
    assert products(queue, sent) == {REPORT: "running"}
    queue.products.take_back_left()  # as when the service starts again
    assert products(queue, sent) == {REPORT: "waiting"}
    assert made(queue) == REPORT


def test_a_render_that_others_wait_for_has_made_its_products(queue):
    first = queue.submit(with_products(REPORT, frames=(1,)))
    second = queue.submit(replace(render(frames=(2,)), after=[first.id]))
    assert drawn(queue) == (first.id, 1)
    assert drawn(queue) is None
    made(queue)
    assert drawn(queue) == (second.id, 2)


def test_two_services_make_each_product_once(tmp_path, clock):
    one = opened(tmp_path, clock=clock, holder="one")
    other = opened(tmp_path, clock=clock, holder="other")
    try:
        sent = one.submit(with_products(REPORT, "focus-curve.csv"))
        claims = [queue.products.claim(LEASE_S) for queue in (one, other, one, other)]
        assert [claim and claim.name for claim in claims] == [REPORT, "focus-curve.csv", None, None]
        other.products.finish(claims[0], 3)  # it is the other one's
        assert products(one, sent) == {REPORT: "running", "focus-curve.csv": "running"}
    finally:
        one.close()
        other.close()
