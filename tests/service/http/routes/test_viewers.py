"""Viewers of a shot over live connections: who else is there, and at which frame."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import httpx
import pytest
import websockets.sync.client

from service.http.settings import Settings
from tests.service.conftest import running, send


def address(client: httpx.Client, shot: str, query: str = "?viewers=true") -> str:
    return f"{str(client.base_url).replace('http', 'ws')}/v1/shots/{shot}/live{query}"


def told(socket: websockets.sync.client.ClientConnection, is_wanted: Callable[[list[dict]], bool]) -> dict[str, Any]:
    """The first message about viewers who are as is wanted."""
    while True:
        message = socket.recv(timeout=300)
        fields = json.loads(message) if isinstance(message, str) else {}
        if "viewers" in fields and is_wanted(fields["viewers"]):
            return fields


def test_viewers_are_told_of_each_other_as_they_move(client, room):
    connect = websockets.sync.client.connect
    with connect(address(client, room)) as mine:
        assert len(told(mine, lambda viewers: len(viewers) == 1)["viewers"]) == 1
        with connect(address(client, room)) as other:
            both = told(mine, lambda viewers: len(viewers) == 2)
            me, them = both["viewers"]
            assert (both["you"], me["number"], them["number"]) == (me["id"], 1, 2)
            assert (them["name"], them["camera"], them["time"]) == ("anyone", None, None)
            other.send(json.dumps({"here": {"camera": "/World/cam", "time": 12.5}}))
            moved = told(mine, lambda viewers: viewers[-1]["time"] is not None)["viewers"][-1]
            assert moved == them | {"camera": "/World/cam", "time": 12.5}
            seen = told(other, lambda viewers: viewers[-1]["time"] is not None)
            assert seen["you"] == them["id"]
        told(mine, lambda viewers: [each["id"] for each in viewers] == [me["id"]])


@pytest.mark.gl
def test_a_request_for_pictures_is_a_place(client, room):
    with (
        websockets.sync.client.connect(address(client, room)) as mine,
        websockets.sync.client.connect(address(client, room, "")) as other,
    ):
        for socket in (other, mine):
            socket.send(json.dumps({"id": 1, "time": 2, "width": 32, "rays": 4, "moving": True}))
        assert len(told(mine, lambda viewers: viewers[0]["time"] == 2)["viewers"]) == 1
        assert isinstance(
            other.recv(timeout=300), bytes
        )  # whoever does not want to see others is not seen, and told of nobody


@pytest.mark.parametrize(
    "here",
    [None, 7, {}, {"time": "soon"}, {"time": 1e300}, {"time": 1, "camera": 3}, {"time": 1, "camera": "x" * 9999}],
)
def test_absurd_places_are_refused_and_change_nothing(client, room, here):
    with websockets.sync.client.connect(address(client, room)) as socket:
        socket.send(json.dumps({"here": here}))
        while "problem" not in (message := json.loads(socket.recv(timeout=300))):
            assert [each["time"] for each in message["viewers"]] == [None]
        assert (message["status"], message["problem"]["code"]) == (422, "invalid_request")


def test_viewers_of_a_shot_hear_of_nobody_elsewhere(tmp_path, room_file):
    with running(Settings(data=tmp_path, demo=False)) as service:
        first, second = (
            send(service.client, name, room_file.read_bytes()).json()["id"] for name in ("a.usda", "b.usda")
        )
        connect = websockets.sync.client.connect
        with connect(address(service.client, first)) as mine, connect(address(service.client, second)) as other:
            other.send(json.dumps({"here": {"time": 9}}))
            told(other, lambda viewers: viewers[0]["time"] == 9)
            mine.send(json.dumps({"here": {"time": 3}}))
            assert len(told(mine, lambda viewers: viewers[0]["time"] == 3)["viewers"]) == 1
