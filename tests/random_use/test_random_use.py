"""A sample of random use by two browsers; ``python -m tests.random_use`` goes on for an hour."""

from __future__ import annotations

import shutil

import pytest

from tests.random_use.__main__ import summary, use_at_random
from tests.random_use.use import Found, Noted


@pytest.mark.e2e
@pytest.mark.gl
def test_two_browsers_at_random_come_to_one_state() -> None:
    if shutil.which("chromium") is None:
        pytest.skip("chromium is not installed")
    found = use_at_random(seed=3, minutes=60, browsers=2, most_steps=24)
    assert found.findings == []
    assert sum(found.kinds.values()) > 10
    assert any(note.kind == "shown" for note in found.notes)


def test_delays_are_of_the_same_edit_or_a_later_one() -> None:
    notes = [
        Noted(10_000, 0, "edit", "a"),
        Noted(10_100, 1, "shown", "a"),
        Noted(20_000, 0, "edit", "b"),
        Noted(20_050, 0, "shown", "b"),
        Noted(20_200, 0, "edit", "c"),
        Noted(20_400, 1, "shown", "c"),
    ]
    assert Found(notes=notes).delays_ms() == [100, 400, 200]
    assert summary(Found(notes=notes))["delayMs"] == {"median": 200, "p95": 380, "most": 400}
    assert summary(Found())["delayMs"] == {"median": None, "p95": None, "most": None}
