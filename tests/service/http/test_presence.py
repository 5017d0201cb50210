"""Tests of `service.http.presence`: a crowd is one change, and names that stay the same are none."""

from __future__ import annotations

import asyncio
from contextlib import ExitStack

import pytest

from service.http.presence import Presence

END = "end"
"""Shot whose change comes after all others."""


def changes(presence: Presence) -> list[str]:
    """Shots whose viewers have changed, as whoever writes events takes them."""

    async def take_all() -> list[str]:
        with presence.enter(END, "nobody"):
            pass
        taken = [await presence.next_change()]
        while taken[-1] != END:
            taken.append(await presence.next_change())
        return taken[:-1]

    return asyncio.run(take_all())


@pytest.fixture
def presence():
    return Presence()


def test_a_crowd_that_enters_is_one_change(presence):
    with ExitStack() as crowd:
        for number in range(50):
            crowd.enter_context(presence.enter("stage", f"viewer {number}"))
        assert changes(presence) == ["stage"]
        assert len(presence.names("stage")) == 50
        assert changes(presence) == []
    assert changes(presence) == ["stage"]
    assert presence.names("stage") == []


def test_a_second_connection_changes_nothing(presence):
    with presence.enter("stage", "Mara"):
        assert changes(presence) == ["stage"]
        with presence.enter("stage", "Mara"):
            assert changes(presence) == []
        assert changes(presence) == []
        assert presence.names("stage") == ["Mara"]


def test_shots_are_told_in_the_order_of_their_changes(presence):
    with presence.enter("b", "Mara"), presence.enter("a", "Jon"), presence.enter("b", "Jon"):
        assert changes(presence) == ["b", "a"]
