"""Renders that wait for others or need a bucket, and those that are accepted as they are."""

from __future__ import annotations

from dataclasses import replace

import pytest

from render.errors import NotFoundError
from service.jobs.errors import ConflictError
from service.jobs.states import state_of
from tests.service.kits.queues import LEASE_S, drawn, opened, render


def test_a_render_waits_for_those_before_it(queue, clock):
    first = queue.submit(render([1]))
    clock.now += 1
    second = queue.submit(render([2]))
    third = queue.submit(replace(render([3], priority=90), after=[first.id, second.id, first.id]))
    assert queue.lookups.unmet_needs([first.id, third.id]) == {third.id: sorted((first.id, second.id))}
    assert drawn(queue)[1] == 1
    queue.fail(queue.claim("one", LEASE_S), "no such camera", may_pass=False)
    assert queue.lookups.unmet_needs([third.id]) == {third.id: [second.id]}
    assert drawn(queue) is None
    queue.accept(second.id)
    assert queue.lookups.unmet_needs([third.id]) == {}
    assert drawn(queue)[1] == 3


def test_a_render_that_is_removed_holds_nothing_up(queue):
    first = queue.submit(render([1]))
    queue.submit(replace(render([2]), after=[first.id]))
    queue.cancel(first.id)
    assert drawn(queue) is None
    queue.remove(first.id, lambda: None)
    assert drawn(queue)[1] == 2
    with pytest.raises(NotFoundError):
        queue.submit(replace(render([3]), after=[first.id]))
    assert drawn(queue) is None


def test_renders_in_a_bucket_are_left_to_those_who_have_it(queue, tmp_path, clock, database):
    sent = queue.submit(replace(render([1]), files="0" * 32))
    assert queue.claim("one", LEASE_S) is None
    assert not queue.is_at_hand(sent)
    sharing = opened(tmp_path, database, clock, "other", has_bucket=True)
    assert sharing.is_at_hand(sent)
    assert sharing.claim("two", LEASE_S).files == "0" * 32
    sharing.close()


def test_a_failed_render_is_accepted_until_it_is_tried_again(queue):
    sent = queue.submit(render([1, 2]))
    with pytest.raises(ConflictError, match="is queued"):
        queue.accept(sent.id)
    queue.fail(queue.claim("one", LEASE_S), "no such camera", may_pass=False)
    drawn(queue)
    accepted = queue.accept(sent.id)
    assert (state_of(accepted), accepted.failed) == ("done", 1)
    with pytest.raises(ConflictError, match="is done"):
        queue.accept(sent.id)
    assert state_of(queue.retry(sent.id)) == "running"
    queue.fail(queue.claim("one", LEASE_S), "no such camera", may_pass=False)
    assert state_of(queue.get(sent.id)) == "failed"
