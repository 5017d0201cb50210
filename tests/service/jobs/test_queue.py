"""The queue of renders: turns, leases, tries, and what stays after a restart."""

from __future__ import annotations

import json
import threading
from dataclasses import replace

import pytest

from render.errors import NotFoundError, OutputError
from service.jobs.attempts import BACK_OFF_S, MOST_FAILURES, MOST_LOSSES
from service.jobs.errors import ConflictError
from service.jobs.queue import RenderQueue
from service.jobs.states import state_of
from service.storage.backup import back_up
from service.storage.database.connection import open_database
from service.storage.database.file import DATABASE
from service.storage.restore import restore
from tests.service.kits.queues import FILES, LEASE_S, Clock, drawn, opened, render, states


def test_frames_are_drawn_in_order_until_all_are_done(queue, clock):
    sent = queue.submit(render())
    assert state_of(sent) == "queued"
    assert [drawn(queue)[1] for _ in range(2)] == [1, 2]
    assert state_of(queue.get(sent.id)) == "running"
    assert drawn(queue)[1] == 3
    assert drawn(queue) is None
    done = queue.get(sent.id)
    assert (state_of(done), done.done, done.finished_at) == ("done", 3, clock.now)


def test_higher_priorities_come_first_then_older_renders(queue, clock):
    sent = []
    for priority in (50, 50, 80):
        sent.append(queue.submit(render([1], priority)).id)
        clock.now += 1
    assert [drawn(queue)[0] for _ in range(3)] == [sent[2], sent[0], sent[1]]


def test_a_claim_has_what_a_worker_needs(queue):
    sent = queue.submit(render([7]))
    claim = queue.claim("one", LEASE_S)
    assert (claim.render, claim.frame, claim.attempt, claim.worker) == (sent.id, 7, 1, "one")
    assert (claim.edits, claim.request, claim.owner, claim.shot) == ("#usda 1.0", {"rays": 4}, "key:a", "demo")


def test_a_key_that_is_sent_again_gives_the_same_render(queue):
    first = queue.submit(render(key="k"))
    assert queue.submit(render(key="k")).id == first.id
    with pytest.raises(ConflictError, match="send a new key"):
        queue.submit(render(key="k", digest="another"))
    assert queue.submit(render()).id != queue.submit(render()).id


def test_a_lost_lease_makes_the_frame_ready_after_a_pause(queue, clock):
    sent = queue.submit(render([1]))
    lost = queue.claim("one", LEASE_S)
    clock.now += LEASE_S - 1
    assert queue.extend(lost, LEASE_S)
    clock.now += LEASE_S - 1
    assert queue.claim("two", LEASE_S) is None
    clock.now += 2
    assert queue.claim("two", LEASE_S) is None  # taken back now, and tried again later
    clock.now += BACK_OFF_S
    again = queue.claim("two", LEASE_S)
    assert (again.frame, again.attempt) == (1, 2)
    assert not queue.extend(lost, LEASE_S)
    # The first worker was slow, not gone: its answer is not counted.
    assert not queue.finish(lost, {"exr": {"size_bytes": 1, "sha256": "late"}}, 24)
    assert queue.finish(again, FILES, 24)
    ((task, attempts),) = queue.tasks(sent.id)
    assert (task.files["exr"]["sha256"], [attempt.outcome for attempt in attempts]) == ("hash", ["lost", "done"])


def test_an_error_that_may_pass_is_tried_three_times(queue, clock):
    sent = queue.submit(render([1]))
    for number in range(1, MOST_FAILURES + 1):
        claim = queue.claim("one", LEASE_S)
        assert claim.attempt == number
        queue.fail(claim, "the disk is full", may_pass=True)
        assert queue.claim("one", LEASE_S) is None
        clock.now += BACK_OFF_S * 2**number
    assert queue.claim("one", LEASE_S) is None
    assert state_of(queue.get(sent.id)) == "failed"
    ((_, attempts),) = queue.tasks(sent.id)
    assert [attempt.error for attempt in attempts] == ["the disk is full"] * MOST_FAILURES


def test_a_frame_that_is_finished_twice_is_done_once(queue):
    sent = queue.submit(render([1]))
    claim = queue.claim("one", LEASE_S)
    assert queue.finish(claim, FILES, 24)
    assert queue.finish(claim, FILES, 24)  # the answer to the first one was lost
    assert not queue.finish(claim, {"exr": FILES["exr"]}, 24)
    assert not queue.finish(replace(claim, attempt=2), FILES, 24)
    ended = queue.get(sent.id)
    assert (ended.done, ended.stored_bytes) == (1, 10 + len("#usda 1.0"))


def test_a_lost_worker_is_no_failure_of_the_frame(queue, clock):
    sent = queue.submit(render([1]))
    for number in range(1, MOST_LOSSES + 1):
        assert state_of(queue.get(sent.id)) != "failed"
        clock.now += 100
        claim = queue.claim("one", LEASE_S, ("one", "two"))
        assert claim.attempt == number
        queue.lose(claim, "worker one is gone")
    assert state_of(queue.get(sent.id)) == "failed"  # it may be the frame after all
    queue.retry(sent.id)
    assert drawn(queue)[1] == 1


def test_a_clock_that_is_set_back_holds_nothing_up(queue, clock):
    sent = queue.submit(render([1, 2, 3]))
    queue.claim("gone", LEASE_S)
    queue.fail(queue.claim("one", LEASE_S), "the disk is full", may_pass=True)
    queue.put_off(queue.claim("one", LEASE_S), 15)
    clock.now -= 3600
    assert queue.claim("two", LEASE_S).frame == 2  # the lost one is tried later
    clock.now += BACK_OFF_S
    assert [drawn(queue)[1] for _ in range(2)] == [1, 3]
    assert queue.get(sent.id).running == 1


def test_an_error_that_stays_fails_the_frame_alone(queue):
    sent = queue.submit(render([1, 2]))
    queue.fail(queue.claim("one", LEASE_S), "no such camera", may_pass=False)
    assert drawn(queue)[1] == 2
    ended = queue.get(sent.id)
    assert (state_of(ended), ended.failed, ended.done) == ("failed", 1, 1)
    again = queue.retry(sent.id)
    assert (state_of(again), again.finished_at) == ("running", None)
    assert drawn(queue)[1] == 1
    assert state_of(queue.get(sent.id)) == "done"
    with pytest.raises(ConflictError, match="no frames or products that have failed"):
        queue.retry(sent.id)


def test_a_frame_whose_file_is_gone_is_drawn_again(queue):
    sent = queue.submit(render())
    for _ in range(3):
        drawn(queue)
    assert state_of(queue.retry(sent.id, [2])) == "running"
    assert drawn(queue)[1] == 2
    ended = queue.get(sent.id)
    assert (ended.done, ended.ready, state_of(ended)) == (3, 0, "done")


def test_a_frame_that_is_given_back_is_no_failure(queue):
    queue.submit(render([1]))
    for number in range(1, MOST_FAILURES + 3):
        claim = queue.claim("one", LEASE_S)
        assert claim.attempt == number
        queue.give_back(claim, "the service stops")


def test_a_render_that_is_put_off_lets_others_go_first(queue, clock):
    full, other = queue.submit(render(priority=90)), queue.submit(render([7]))
    queue.put_off(queue.claim("one", LEASE_S), pause_s=15)
    assert drawn(queue) == (other.id, 7)
    assert queue.claim("one", LEASE_S) is None
    clock.now += 15
    assert queue.claim("one", LEASE_S).attempt == 2  # no number is given twice
    assert [len(attempts) for _, attempts in queue.tasks(full.id)] == [1, 0, 0]


def test_a_cancellation_is_not_taken_back(queue):
    sent = queue.submit(render())
    claim = queue.claim("one", LEASE_S)
    queue.cancel(sent.id)
    for change in (queue.resume, queue.pause):
        with pytest.raises(ConflictError, match="is being canceled"):
            change(sent.id)
    queue.give_back(claim, "canceled")
    assert state_of(queue.get(sent.id)) == "canceled"


def test_what_a_project_has_stored_is_summed(queue):
    queue.submit(render([1]))
    drawn(queue)
    assert queue.totals.stored_bytes("default") == 10 + len("#usda 1.0")
    assert queue.totals.stored_bytes("another") == 0


def test_sizes_beyond_four_gigabytes_are_exact(queue):
    sent = queue.submit(render([1, 2]))
    large = {"exr": {"size_bytes": 2**32 + 1, "sha256": "hash"}}
    for _ in range(2):
        assert queue.finish(queue.claim("one", LEASE_S), large, 24)
    assert json.dumps(queue.totals.stored_bytes("default")) == str(2 * (2**32 + 1) + len("#usda 1.0"))
    assert [task.files for task, _ in queue.tasks(sent.id)] == [large] * 2


def test_text_that_no_database_holds_is_replaced(queue):
    sent = queue.submit(render([1], name="a\0b"))
    assert queue.get(sent.id).name == "a\ufffdb"
    queue.fail(queue.claim("one", LEASE_S), "bad\0file \udcff", may_pass=False)
    ((_, (attempt,)),) = queue.tasks(sent.id)
    assert attempt.error == "bad\ufffdfile \ufffd"
    with pytest.raises(NotFoundError):
        queue.get(f"{sent.id}\0")


def test_the_renders_of_an_owner_are_bounded(queue, monkeypatch):
    monkeypatch.setattr("service.jobs.queue.MOST_UNENDED", 2)
    for _ in range(2):
        queue.submit(render([1]))
    with pytest.raises(ConflictError, match="have not ended"):
        queue.submit(render([1]))
    drawn(queue)
    queue.submit(render([1]))


def test_a_paused_render_begins_no_frame(queue):
    sent = queue.submit(render())
    claim = queue.claim("one", LEASE_S)
    assert state_of(queue.pause(sent.id)) == "pause-requested"
    assert queue.claim("two", LEASE_S) is None
    assert queue.extend(claim, LEASE_S)
    queue.finish(claim, FILES, 24)
    assert state_of(queue.get(sent.id)) == "paused"
    assert state_of(queue.resume(sent.id)) == "running"
    assert drawn(queue)[1] == 2


def test_a_cancelled_render_keeps_what_it_has(queue):
    sent = queue.submit(render())
    drawn(queue)
    claim = queue.claim("one", LEASE_S)
    assert state_of(queue.cancel(sent.id)) == "cancel-requested"
    assert not queue.extend(claim, LEASE_S)
    queue.give_back(claim, "cancelled")
    assert state_of(queue.get(sent.id)) == "canceled"
    assert states(queue, sent.id) == ["done", "canceled", "canceled"]
    with pytest.raises(ConflictError, match="has ended: it is canceled"):
        queue.cancel(sent.id)
    assert queue.retry(sent.id).ready == 2


def test_only_a_render_that_has_ended_is_removed(queue):
    removed = []

    def busy():
        raise OSError("busy")

    sent = queue.submit(render([1]))
    with pytest.raises(ConflictError, match="cancel it before"):
        queue.remove(sent.id, removed.append)
    drawn(queue)
    with pytest.raises(OSError, match="busy"):
        queue.remove(sent.id, busy)
    assert queue.get(sent.id).done == 1
    queue.remove(sent.id, lambda: removed.append(sent.id))
    assert removed == [sent.id]
    with pytest.raises(NotFoundError):
        queue.get(sent.id)
    with pytest.raises(NotFoundError):
        queue.tasks(sent.id)


def test_workers_that_claim_at_once_never_share_a_frame(queue):
    queue.submit(render(range(1, 41)))
    claimed: list[int] = []

    def work(name: str) -> None:
        while (claim := queue.claim(name, LEASE_S)) is not None:
            claimed.append(claim.frame)
            queue.finish(claim, FILES, 24)

    threads = [threading.Thread(target=work, args=(f"worker {number}",)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(claimed) == list(range(1, 41))


def test_renders_are_listed_from_the_newest_on(queue, clock):
    sent = []
    for number in range(5):
        sent.append(queue.submit(render(name=f"{number}")))
        clock.now += number % 2  # some at the same time
    first = queue.list("default", 2)
    rest = queue.list("default", 9, (first[-1].created_at, first[-1].id))
    assert sorted(row.id for row in (*first, *rest)) == sorted(row.id for row in sent)
    assert [row.created_at for row in (*first, *rest)] == sorted((row.created_at for row in sent), reverse=True)
    assert queue.list("another", 9) == []
    assert len(queue.list(None, 9)) == 5


def test_everything_is_there_after_a_restart(tmp_path, clock, database):
    before = opened(tmp_path, database, clock)
    sent = before.submit(render())
    drawn(before)
    before.claim("killed", LEASE_S)
    before.close()
    after = opened(tmp_path, database, clock)
    assert states(after, sent.id) == ["done", "running", "ready"]
    after.take_back_left()
    assert states(after, sent.id) == ["done", "ready", "ready"]
    assert [drawn(after)[1] for _ in range(2)] == [2, 3]
    _, (_, attempts), _ = after.tasks(sent.id)
    assert [attempt.outcome for attempt in attempts] == ["given-back", "done"]
    assert after.totals.numbers() == {"ready": 0, "running": 0, "done": 3, "failed": 0, "canceled": 0}
    after.close()


def test_frames_that_are_worked_on_are_not_taken_back(queue, clock):
    sent = queue.submit(render())
    held = [queue.claim("one", LEASE_S) for _ in range(2)]
    clock.now += LEASE_S + 1  # the database was away
    queue.take_back_left(held[1:], LEASE_S)
    assert states(queue, sent.id) == ["ready", "running", "ready"]
    assert queue.claim("two", LEASE_S).frame == 1
    assert queue.finish(held[1], FILES, 24)


def test_frames_of_another_service_are_not_taken_back(tmp_path, clock, postgresql_database):
    first, second = (opened(tmp_path, postgresql_database, clock, holder) for holder in ("first", "second"))
    sent = first.submit(render())
    for queue, worker in ((first, "one"), (second, "two")):
        queue.claim(worker, LEASE_S)
    second.take_back_left()
    assert states(first, sent.id) == ["running", "ready", "ready"]
    for queue in (first, second):
        queue.close()


def test_a_file_that_is_no_database_is_named(tmp_path):
    (tmp_path / DATABASE).write_text("no database")
    with pytest.raises(OutputError, match="database of renders"):
        open_database(tmp_path)


def test_a_database_of_a_newer_version_is_left_alone(tmp_path, database):
    engine = open_database(tmp_path, database)
    with engine.begin() as connection:
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    engine.dispose()
    with pytest.raises(OutputError, match="cannot be opened"):
        open_database(tmp_path, database)


def test_a_backup_has_the_queue_as_it_was(tmp_path, clock):
    data = tmp_path / "data"
    (data / "shots").mkdir(parents=True)
    queue = opened(data, clock=clock)
    sent = queue.submit(render())
    drawn(queue)  # in the log that SQLite keeps beside the database
    back_up(data, tmp_path / "backup.tar.gz")
    queue.submit(render(name="later"))
    queue.close()
    restore(tmp_path / "backup.tar.gz", tmp_path / "restored")
    restored = opened(tmp_path / "restored", clock=clock)
    assert [row.id for row in restored.list(None, 9)] == [sent.id]
    assert states(restored, sent.id) == ["done", "ready", "ready"]
    restored.close()


def fail(queue: RenderQueue, clock: Clock, worker: str, present) -> int | None:
    """Have a worker fail the next frame that it gets; the frame."""
    clock.now += 100
    claim = queue.claim(worker, LEASE_S, present)
    if claim is not None:
        queue.fail(claim, "broken", may_pass=True)
    return claim and claim.frame


def test_a_worker_gets_no_frame_again_that_it_failed(queue, clock):
    queue.submit(render((1, 2)))
    present = ("one", "two")
    assert fail(queue, clock, "one", present) == 1
    assert fail(queue, clock, "one", present) == 2
    assert fail(queue, clock, "one", present) is None
    assert fail(queue, clock, "two", present) == 1
    assert fail(queue, clock, "one", present) == 1  # both have failed it, and it has a try left
    assert fail(queue, clock, "one", ("one",)) == 2  # alone


def test_a_worker_that_fails_a_render_leaves_it_to_others(queue, clock):
    sent = queue.submit(render((1, 2, 3, 4)))
    present = ("one", "two")
    assert [fail(queue, clock, "one", present) for _ in range(4)] == [1, 2, 3, None]
    queue.submit(render((7,)))
    assert fail(queue, clock, "one", present) == 7  # of another one
    assert [drawn(queue, "two") for _ in range(4)] == [(sent.id, frame) for frame in (1, 2, 3, 4)]


def test_a_render_that_all_fail_ends(queue, clock):
    sent = queue.submit(render(range(1, 5)))
    for _ in range(20):
        for worker in ("one", "two"):
            fail(queue, clock, worker, ("one", "two"))
    assert state_of(queue.get(sent.id)) == "failed"


def test_an_owner_without_time_is_put_off_with_all_renders(queue, clock):
    queue.submit(render((1,)))
    queue.submit(render((2,)))
    queue.put_off(queue.claim("one", LEASE_S), 15, is_of_owner=True)
    assert queue.claim("one", LEASE_S) is None
    clock.now += 15
    assert sorted(drawn(queue)[1] for _ in range(2)) == [1, 2]
