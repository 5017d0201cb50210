"""`pullfocus bench chaos`, short: a render while parts of the system are killed, the disk fills and the clock jumps."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest

from service.bench.chaos.parts import faketime_library
from service.bench.chaos.plan import ChaosPlan
from service.bench.chaos.results import count_frames
from service.bench.chaos.run import measure
from service.bench.chaos.strikes import KINDS, order_of
from service.bench.postgresql import postgresql_programs
from service.client.models import Attempt, RenderedFile, RenderTask
from tests.service.conftest import ROOM


@pytest.fixture
def stage(tmp_path):
    """The room, in a folder of its own."""
    file = tmp_path / "room" / "room.usda"
    file.parent.mkdir()
    file.write_text(ROOM)
    return file


@pytest.mark.gl
@pytest.mark.parametrize("database", ["postgresql", "sqlite"])
def test_no_frame_is_lost_or_stored_twice(stage, database):
    if database == "postgresql" and postgresql_programs() is None:
        pytest.skip("PostgreSQL is not installed (Debian's package postgresql)")
    found = measure(ChaosPlan(24, strikes=7, width=96, rays=16, database=database, limit_s=450), stage)
    assert [goal for goal in found.goals if not goal.holds] == []
    assert {row.kind for row in found.strikes} >= {"kill worker", "kill scheduler", "kill service"}
    left_out = {"kill database"} if database == "sqlite" else set()
    if faketime_library() is None:
        left_out |= {"clock forward", "clock back"}
    assert set(found.left_out) - {"fill disk"} == left_out


def test_each_kind_of_strike_comes_as_often_as_the_others():
    order = order_of(KINDS, 3 * len(KINDS), seed=5)
    assert {order.count(kind) for kind in KINDS} == {3}
    assert order == order_of(KINDS, 3 * len(KINDS), seed=5) != order_of(KINDS, 3 * len(KINDS), seed=6)


def task(frame: int, outcomes: list[str | None], sha256: str | None) -> RenderTask:
    times = {"started_at": datetime.now(UTC), "ended_at": None}
    attempts = [
        Attempt(**times, error=None, number=number, outcome=outcome, worker="one")
        for number, outcome in enumerate(outcomes, 1)
    ]
    files = [] if sha256 is None else [RenderedFile(format="png", sha256=sha256, size_bytes=1)]
    return RenderTask(attempts=attempts, files=files, frame=frame, state="done" if sha256 else "running")


def test_frames_that_are_lost_doubled_or_wrong_are_counted():
    tasks = [
        task(1, ["lost", "done"], "a"),
        task(2, ["done", "done"], "b"),
        task(3, ["done"], "wrong"),
        task(4, [None], None),
        task(5, ["done"], "e"),
    ]
    stored = {"1.2.png": "a", "2.2.png": "b", "3.1.png": "wrong", "5.1.png": "torn", "1.1.png": "a"}
    found = count_frames(tasks, stored, {1: "a", 2: "b", 3: "c", 4: "d", 5: "e"}, "png")
    assert (found.done, found.twice, found.not_stored, found.strange) == (4, 1, 2, 1)
    assert (found.unlike_record, found.unended) == (2, 1)
    assert found.outcomes == {"lost": 1, "done": 5, "none": 1}
