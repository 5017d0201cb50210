"""The shot that was worked on last, drawn when the service starts."""

from __future__ import annotations

import asyncio
import logging
import os
from pathlib import Path

import pytest

from service.http.last_shot import draw_last_shot
from service.http.settings import Settings
from service.workers.lane import Lane
from tests.service.conftest import Running, running, until

LATE_S = 4e9
"""A time in the future, s since the epoch."""


@pytest.fixture
def settings(tmp_path) -> Settings:
    return Settings(data=tmp_path, demo=False)


def upload(service: Running, file: Path) -> str:
    with file.open("rb") as sent:
        return service.client.post("/v1/shots", files={"file": sent}).json()["id"]


def write_edits(settings: Settings, shot: str, text: str) -> None:
    edits = settings.data / "shots" / shot / "edits" / "edits.usda"
    edits.parent.mkdir(exist_ok=True)
    edits.write_text(text)
    os.utime(edits, (LATE_S, LATE_S))


def shot_drawn(service: Running) -> str | None:
    """The one shot that a worker of live pictures has drawn."""
    lane = service.internal.lanes.live
    until(lambda: lane.running == 0 and any(each.role == lane.role for each in service.internal.pool.processes()))
    (worker,) = [each for each in service.internal.pool.processes() if each.role == lane.role]
    assert worker.has_served
    return worker.place.key


def test_the_shot_of_the_last_work_is_drawn_at_the_start(settings, room_file):
    with running(settings) as service:
        old, new = upload(service, room_file), upload(service, room_file)
    with running(settings) as service:
        assert shot_drawn(service) == new
    write_edits(settings, old, "#usda 1.0\n")
    with running(settings) as service:
        assert shot_drawn(service) == old


@pytest.mark.parametrize("waiting", [0, 1])
def test_nothing_is_drawn_ahead_of_those_who_wait(settings, room_file, monkeypatch, waiting):
    with running(settings) as service:
        upload(service, room_file)
        assert drawn(service, monkeypatch, waiting) == 2 * (1 - waiting)


def test_a_shot_that_has_ended_a_worker_is_left_alone(settings, room_file, monkeypatch):
    with running(settings) as service:
        service.internal.quarantine.blame(upload(service, room_file), "memory")
        assert drawn(service, monkeypatch) == 0


def drawn(service: Running, monkeypatch: pytest.MonkeyPatch, waiting: int = 0) -> int:
    """Draw the last shot, and count the jobs that it takes."""
    lane = service.internal.lanes.live
    until(lambda: not service.internal.preparing.is_set())
    finished: list[str] = []
    monkeypatch.setattr(lane, "_on_finished", lambda job: finished.append(job.lane))
    monkeypatch.setattr(Lane, "waiting", waiting)
    asyncio.run(draw_last_shot(service.internal))
    until(lambda: lane.running == 0)
    assert set(finished) <= {"live"}
    return len(finished)


def test_a_start_at_an_absurd_time_does_no_harm(settings, tmp_path, caplog):
    file = tmp_path / "late.usda"
    file.write_text('#usda 1.0\n(startTimeCode = 2e9\nendTimeCode = 2.1e9)\ndef Camera "cam" {}\n')
    with running(settings) as service:
        shot = upload(service, file)
        with caplog.at_level(logging.INFO, "pullfocus.service"):
            asyncio.run(draw_last_shot(service.internal))
        assert f"shot {shot} was not drawn in advance" in caplog.text


def test_a_shot_that_cannot_be_drawn_does_no_harm(settings, room_file, caplog):
    with running(settings) as service:
        shot = upload(service, room_file)
        write_edits(settings, shot, "no layer")
        with caplog.at_level(logging.INFO, "pullfocus.service"):
            asyncio.run(draw_last_shot(service.internal))
        assert f"shot {shot} was not drawn in advance" in caplog.text


def test_a_service_without_shots_draws_none(settings):
    with running(settings) as service:
        asyncio.run(draw_last_shot(service.internal))
        assert service.internal.pool.processes() == []
