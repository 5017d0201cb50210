"""Renders while the database is gone for a moment, or the disk is full."""

from __future__ import annotations

from collections import namedtuple

import pytest

from render.errors import OutputError
from service.http import render_runner
from service.storage.errors import UnavailableError
from tests.service.conftest import until
from tests.service.kits.renders import ended, render_of

pytestmark = pytest.mark.gl


def test_a_drawn_frame_waits_for_a_database_that_is_gone(service, client, room, monkeypatch):
    monkeypatch.setattr(render_runner, "NOTE_PAUSE_S", 0.01)
    queue, calls = service.internal.renders, []
    finish = queue.finish

    def flaky(*arguments):
        calls.append(arguments)
        if len(calls) == 2:
            assert finish(*arguments)  # its answer is lost
        if len(calls) < 3:
            raise UnavailableError("its database cannot be reached", code="queue_unusable")
        return finish(*arguments)

    monkeypatch.setattr(queue, "finish", flaky)
    render = render_of(client, room, frames="1")
    assert ended(client, render)["state"] == "done"
    until(lambda: len(calls) == 3)
    (task,) = client.get(f"/v1/renders/{render['id']}/tasks").json()["tasks"]
    assert [attempt["outcome"] for attempt in task["attempts"]] == ["done"]
    assert client.get(f"/v1/renders/{render['id']}/frames/1").status_code == 200


def test_a_claim_whose_answer_was_lost_is_taken_back(service, client, room, monkeypatch):
    queue, lost = service.internal.renders, []
    claim = queue.claim

    def flaky(*arguments):
        claimed = claim(*arguments)
        if claimed is not None and not lost:
            lost.append(claimed)
            raise UnavailableError("its database cannot be reached", code="queue_unusable")
        return claimed

    monkeypatch.setattr(queue, "claim", flaky)
    render = render_of(client, room, frames="1")
    assert ended(client, render)["state"] == "done"
    (task,) = client.get(f"/v1/renders/{render['id']}/tasks").json()["tasks"]
    assert [attempt["outcome"] for attempt in task["attempts"]] == ["given-back", "done"]


def test_a_full_disk_is_waited_for(service, client, room, monkeypatch):
    monkeypatch.setattr(render_runner, "ROOM_PAUSE_S", 0.01)
    write, fulls = service.internal.render_files.write, []

    def full(*arguments):
        if len(fulls) < 5:
            fulls.append(arguments)
            raise OutputError("the disk is full", code="disk_full")
        return write(*arguments)

    monkeypatch.setattr(service.internal.render_files, "write", full)
    render = render_of(client, room, frames="1")
    assert ended(client, render)["state"] == "done"
    (task,) = client.get(f"/v1/renders/{render['id']}/tasks").json()["tasks"]
    assert [attempt["outcome"] for attempt in task["attempts"]] == ["done"]


def test_no_frame_is_begun_while_the_disk_is_nearly_full(service, client, room, monkeypatch, caplog):
    usage = namedtuple("usage", "total used free")
    with monkeypatch.context() as patch:
        patch.setattr(render_runner.shutil, "disk_usage", lambda _: usage(10**12, 10**12, 2**20))
        render = render_of(client, room, frames="1")
        until(lambda: "renders wait: the disk has 1 MiB free" in caplog.text)
        assert client.get(f"/v1/renders/{render['id']}").json()["state"] == "queued"
    assert ended(client, render)["state"] == "done"
