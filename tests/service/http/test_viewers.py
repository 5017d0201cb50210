"""Tests of `service.http.viewers`: those of a shot are told where the others look, at a bounded rate."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack

import pytest

from service.http.viewers import LEAST_PAUSE_S, MOST_TOLD_PER_S, Place, Viewers
from service.models.live import LiveViewers


class Clock:
    """Time that passes when a test says so."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self._calls: list[tuple[float, Callable[[], None]]] = []

    def later(self, pause_s: float, call: Callable[[], None]) -> None:
        self._calls.append((self.now_s + pause_s, call))

    def go_to(self, now_s: float) -> None:
        while due := [each for each in self._calls if each[0] <= now_s]:
            first = min(due, key=lambda each: each[0])
            self._calls.remove(first)
            self.now_s = first[0]
            first[1]()
        self.now_s = now_s

    @property
    def waits(self) -> bool:
        return bool(self._calls)


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def shots(clock):
    return Viewers(clock.later)


@pytest.fixture
def told():
    """Return what a viewer was told, as JSON."""
    return []


def nobody(message: str) -> None:
    """Take what a viewer is told whom the test does not look at."""


def places(message: str) -> dict[str, tuple[str | None, float | None]]:
    """Where each viewer looks, by name."""
    return {each.name: (each.camera, each.time) for each in LiveViewers.model_validate_json(message).viewers}


def test_viewers_are_told_where_the_others_look(shots, clock, told):
    with shots.join("stage", "Mara", told.append) as mara:
        clock.go_to(0)
        with shots.join("stage", "Jon", nobody) as jon, shots.join("other", "Ines", nobody) as ines:
            jon.look(Place("/cam", 40.0))
            ines.look(Place("/cam", 7.0))
            clock.go_to(1)
            jon.look(Place(None, 41.5))
            clock.go_to(2)
        clock.go_to(3)
    alone = {"Mara": (None, None)}
    assert [places(each) for each in told] == [
        alone,
        alone | {"Jon": ("/cam", 40.0)},
        alone | {"Jon": (None, 41.5)},
        alone,
    ]
    assert {LiveViewers.model_validate_json(each).you for each in told} == {mara.id}


def test_connections_of_one_name_are_told_apart(shots, clock, told):
    with shots.join("stage", "anyone", told.append), shots.join("stage", "anyone", nobody) as second:
        with shots.join("stage", "anyone", nobody):
            clock.go_to(1)
        with shots.join("stage", "anyone", nobody) as third:
            clock.go_to(2)
    first, last = (LiveViewers.model_validate_json(each).viewers for each in told)
    assert [each.number for each in first] == [each.number for each in last] == [1, 2, 3]
    assert [each.id for each in last[1:]] == [second.id, third.id]
    assert first[2].id != third.id


def test_a_crowd_that_drags_is_told_of_at_a_bounded_rate(shots, clock, told):
    seconds, crowd = 10, 50
    with ExitStack() as stack:
        viewers = [stack.enter_context(shots.join("stage", f"v{number}", told.append)) for number in range(crowd)]
        for step in range(60 * seconds):
            clock.go_to(step / 60)
            for number, viewer in enumerate(viewers):
                viewer.look(Place("/cam", float(step + number)))
        clock.go_to(seconds + 2)
        assert crowd * (seconds - 2) < len(told) <= MOST_TOLD_PER_S * seconds + 3 * crowd
        assert places(told[-1])["v7"] == ("/cam", 60 * seconds - 1 + 7.0)  # the last move of all is told


def test_one_who_drags_is_told_of_a_few_times_a_second(shots, clock, told):
    with shots.join("stage", "Mara", told.append), shots.join("stage", "Jon", nobody) as jon:
        for step in range(600):
            clock.go_to(step / 60)
            jon.look(Place("/cam", float(step)))
    assert len(told) == pytest.approx(10 / LEAST_PAUSE_S, abs=2)


def test_where_nothing_moves_nothing_is_told(shots, clock, told):
    with shots.join("stage", "Mara", told.append) as mara:
        clock.go_to(9)
        for now_s in (19, 29):
            mara.look(Place("/cam", 1.0))
            clock.go_to(now_s)
        assert len(told) == 2
        assert not clock.waits
    clock.go_to(99)
    assert not clock.waits
