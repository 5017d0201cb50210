"""Tests of whose turn it is, and of processes that keep what they drew of a view."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from service.workers.calls import call
from service.workers.job_order import JobOrder
from service.workers.jobs import CallWork, Client, Job
from service.workers.places import Place
from service.workers.turns import MAX_DEBT, Turns
from tests.service.workers.fake_work import echo
from tests.service.workers.kit import tally_lane, tally_pool

SCENE = Place("scene")


def job(viewer: str, position: int, view: str | None = None) -> Job[Any]:
    return Job(CallWork(call(echo)), SCENE, Client(viewer, viewer), None, position, position, view=view)


def order_of(turns: Turns, viewers: str, count: int, cost_s: Callable[[str], float]) -> Iterator[str]:
    for _ in range(count):
        viewer = min(viewers, key=turns.used_s)
        turns.begin(viewer)
        turns.charge(viewer, cost_s(viewer))
        yield viewer


def test_one_dear_turn_costs_a_viewer_few_others():
    turns = Turns()
    list(order_of(turns, "abc", 60, lambda viewer: 0.1))
    turns.charge("a", 30.0)
    order = "".join(order_of(turns, "abc", 30, lambda viewer: 0.1))
    assert order.index("a") <= 2 * MAX_DEBT
    assert order.count("a") >= 30 / 3 - MAX_DEBT


def test_debts_shrink_where_turns_become_cheap():
    turns = Turns()
    list(order_of(turns, "abc", 60, lambda viewer: 2.0))
    turns.charge("a", 2.0)
    list(order_of(turns, "bc", 20, lambda viewer: 0.01))
    assert "a" in list(order_of(turns, "abc", 2 * int(MAX_DEBT) + 1, lambda viewer: 0.01))


def test_who_came_before_the_first_price_owes_a_usual_turn():
    turns = Turns()
    turns.charge_usual("a", 5.0)
    turns.charge("b", 0.4)
    assert turns.used_s("a") == turns.used_s("b") == 0.4


def test_a_viewer_whose_turns_are_dear_has_fewer_of_them():
    order = "".join(order_of(Turns(), "abc", 300, lambda viewer: 0.4 if viewer == "a" else 0.1))
    assert order.count("a") < 0.6 * order.count("b")
    assert order.count("b") == pytest.approx(order.count("c"), abs=2)


def test_a_view_that_a_busy_process_keeps_lets_others_go_first():
    order = JobOrder(2, is_single=False)
    for viewer in ("first", "second"):
        order.charge(job(viewer, 0), 0.1, is_usual=False)
    first, second = job("first", 1, "kept"), job("second", 2)
    assert order.next([first, second], []) is first
    assert order.next([first, second], [], lambda each: each.view == "kept") is second
    assert order.next([first], [], lambda each: each.view == "kept") is first
    for _ in range(5):
        order.begin(second)
        order.charge(second, 0.1, is_usual=False)
    assert order.next([first, second], [], lambda each: each.view == "kept") is first  # it has waited for long enough


def test_a_process_is_taken_again_for_a_view_that_it_drew():
    with tally_pool() as pool, tally_lane(pool, max_waiting=9) as lane:
        one, two = (pool.take(lane.role, SCENE, view) for view in ("one", "two"))
        assert pool.viewed(lane.role).is_elsewhere(job("a", 1, "one"))
        for process in (one, two):
            pool.give_back(process)
        assert not pool.viewed(lane.role).is_elsewhere(job("a", 1, "one"))
        again = pool.take(lane.role, SCENE, "one")
        assert again is one
        assert pool.viewed(lane.role).is_elsewhere(job("a", 1, "one"))
        assert not pool.viewed(lane.role).is_elsewhere(job("a", 1, "two"))
        assert not pool.viewed(lane.role).is_elsewhere(job("a", 1, "new"))
        assert pool.take(lane.role, SCENE, "one") is two  # any rather than a new one
        for process in (one, two):
            pool.give_back(process)


def test_no_more_processes_open_a_shot_than_jobs_may_run():
    order = JobOrder(2, is_single=False)
    waiting = [job(f"viewer {number}", number) for number in range(20)]
    opening = [job("one", 21)]
    assert order.next(waiting, opening) is not None
    opening += [job("two", 22)]
    for each in opening:
        each.is_overdue = each.starts_process = True
        each.begun_s = time.monotonic()
    assert order.next(waiting, opening) is None
    elsewhere = Job(CallWork(call(echo)), Place("another scene"), Client("three", "three"), None, 23, 23)
    assert order.next([*waiting, elsewhere], opening) is elsewhere


def test_a_dear_first_picture_counts_as_a_usual_turn():
    order = JobOrder(1, is_single=False)
    dear, cheap = job("dear", 1), job("cheap", 2)
    for each, cost_s, is_usual in ((cheap, 0.1, False), (dear, 0.9, True), (cheap, 0.1, False)):
        order.begin(each)
        order.charge(each, cost_s, is_usual=is_usual)
    assert order.next([cheap, dear], []) is dear
