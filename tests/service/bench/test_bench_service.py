"""`pullfocus bench service` runs a service of its own, counts what its viewers get, and judges it."""

from __future__ import annotations

import json
import socket
import threading
from pathlib import Path
from time import monotonic

import pytest

from service.bench import requests
from service.bench.requests import Abandoned, ask, repeating
from service.bench.results import AbsurdFound, DelayRow, ViewersFound, goals_of, spread_of
from service.bench.viewers import Viewer
from tests.render.kits.cli_shots import Command


def test_a_viewer_without_a_picture_misses_the_goal():
    none = spread_of([])
    starved = ViewersFound(2, 0, [], [0, 5], None, 1, none, none, none)
    unfair = ViewersFound(2, 0, [], [1, 5], 5.0, 0, none, none, none)
    row = DelayRow("edit", none, none, none, 1.5, 2.5, [])
    assert [goal.holds for goal in goals_of(starved, unfair, AbsurdFound(300, 240, was_busy=False), [row])] == [
        *(True, False),
        *(True, True, False),
        *(True, False, True, False, True),
    ]


def test_the_spread_of_times_has_the_95th_percentile():
    spread = spread_of([float(i) for i in range(1, 101)])
    assert (spread.count, spread.median_s, spread.p95_s, spread.most_s) == (100, 50.5, 95.0, 100.0)


def test_a_viewer_who_waits_at_the_end_of_a_phase_is_counted():
    began_s = monotonic() - 10
    served, starved = (
        Viewer(0, gaps_s=[0.1, 9.0, 0.9], last_s=began_s + 9.9),
        Viewer(1, gaps_s=[0.5], last_s=began_s - 2),
    )
    assert served.gaps_since(1, began_s) == [9.0, 0.9]
    assert starved.gaps_since(1, began_s) == [pytest.approx(10, abs=5)]


def test_an_answer_that_breaks_off_is_a_failure(monkeypatch):
    monkeypatch.setattr(requests, "PAUSE_S", 600.0)  # it asks once
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]

        def answer() -> None:
            for content in (b"HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\nx", b""):
                connection, _ = server.accept()
                connection.recv(1000)
                connection.sendall(content)
                connection.close()

        thread = threading.Thread(target=answer)
        thread.start()
        asked = threading.Event()

        def ask_once() -> str:
            asked.set()
            return str(ask(port, 0, "GET", "/livez"))

        with repeating({"livez": ask_once}) as found:
            asked.wait(10)
        absurd = Abandoned(port, 0, "/livez")
        with pytest.raises(ConnectionResetError):
            absurd.status_within(10)
        absurd.leave()
        thread.join()
    assert [failure[:14] for failure in found["livez"].failures] == ["IncompleteRead"]


@pytest.mark.gl
def test_three_viewers_drag_for_two_seconds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "load.json"
    ended = Command(capsys)(
        "bench",
        "service",
        "--viewers",
        "3",
        "--seconds",
        "2",
        "--phase",
        "2",
        "--width",
        "64",
        "--first",
        "--json",
        file,
    )
    assert ended.status == 0, ended.err
    found = json.loads(file.read_text())
    for together in (found["at_start"], found["running"]):
        assert together["viewers"] == len(together["pictures"]) == 3
        assert together["refusals"] == []
    assert found["absurd"]["rays_refused"] > found["absurd"]["rays_admitted"] > 0
    assert found["absurd"]["was_busy"]
    assert len(found["delays"]) == 5
    assert all(row["failures"] == [] and row["alone"]["count"] > 0 for row in found["delays"])
    assert ended.out.count("pass") + ended.out.count("FAIL") == len(found["goals"]) >= 6
