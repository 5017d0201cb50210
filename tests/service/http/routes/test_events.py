"""Events over Server-Sent Events: what is told, in which order, to whom, and from where a reader goes on."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest
import websockets.sync.client

from service.http.settings import Settings
from service.storage.events import NewEvent
from tests.service.conftest import running, send, until

SMALL = {"width": 32, "rays": 4, "engine": "pinhole"}


def fields_of(lines: Iterator[str]) -> Iterator[dict[str, str]]:
    """The fields of each event of a stream, as the specification of Server-Sent Events reads them."""
    fields: dict[str, str] = {}
    for line in lines:
        if line:
            name, _, value = line.partition(": ")
            fields[name] = value
        elif fields:
            yield fields
            fields = {}


@contextmanager
def followed(client: httpx.Client, headers=None, **params) -> Iterator[Iterator[dict]]:
    """The events of a stream, each as its `data`; the stream has begun."""
    with client.stream("GET", "/v1/events", params=params, headers=headers) as answer:
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith("text/event-stream")
        events = fields_of(answer.iter_lines())
        assert int(next(events)["retry"]) > 0  # where it begins
        yield (json.loads(fields["data"]) for fields in events if "data" in fields)


def kept(client: httpx.Client, headers=None, **params) -> list[dict]:
    """The events that are kept."""
    answer = client.get("/v1/events", params={"follow": False, "after": 0} | params, headers=headers)
    assert answer.status_code == 200, answer.text
    return [
        fields | {"data": json.loads(fields["data"])}
        for fields in fields_of(iter(answer.text.splitlines()))
        if "data" in fields
    ]


def newest(client: httpx.Client) -> int:
    """The number of the newest event."""
    return int(next(fields_of(iter(client.get("/v1/events", params={"follow": False}).text.splitlines())))["id"])


def socket_address(client: httpx.Client, path: str) -> str:
    return str(client.base_url).replace("http", "ws") + path


def sent(client: httpx.Client, file) -> str:
    """The id of a new shot."""
    return send(client, file.name, file.read_bytes()).json()["id"]


@pytest.mark.gl
def test_a_render_is_followed_from_its_sending_to_its_end(client, room):
    with followed(client, topic=["renders", "tasks"], shot=room) as events:
        sent = client.post("/v1/renders", json=SMALL | {"shot": room, "frames": "1-2"}).json()
        told = []
        while not told or told[-1]["data"]["state"] != "done" or told[-1]["topic"] != "renders":
            told.append(next(events))
    assert {event["render"] for event in told} == {sent["id"]}
    assert [(event["kind"], event["data"]["state"]) for event in told if event["topic"] == "renders"] == [
        ("render-sent", "queued"),
        ("render-changed", "running"),
        ("render-changed", "done"),
    ]
    frames = [(event["data"]["frame"], event["data"]["state"]) for event in told if event["topic"] == "tasks"]
    assert frames == [(1, "running"), (1, "done"), (2, "running"), (2, "done")]
    assert [event["number"] for event in told] == sorted({event["number"] for event in told})


def test_edits_and_shots_are_told(client, room_file):
    start = newest(client)
    shot = sent(client, room_file)
    edited = client.patch(f"/v1/shots/{shot}/camera/exposure", json={"compensationStops": 1})
    assert edited.status_code == 200
    client.post(f"/v1/shots/{shot}/edits/undo")
    refused = client.patch(f"/v1/shots/{shot}/camera/exposure", json={"compensationStops": "much"})
    assert refused.status_code == 422
    client.delete(f"/v1/shots/{shot}")
    (trashed,) = [entry for entry in client.get("/v1/trash").json()["shots"] if entry["shot"] == shot]
    client.post(f"/v1/trash/{trashed['id']}/restore")
    wanted = ["shot-added", "edits-changed", "edits-changed", "shot-deleted", "shot-restored"]
    until(lambda: len(kept(client, after=start, shot=shot)) >= len(wanted))
    told = [event["data"] for event in kept(client, after=start, shot=shot)]
    assert [event["kind"] for event in told] == wanted
    assert client.get(f"/v1/shots/{shot}").json()["revision"] == told[2]["data"]["revision"]
    assert told[1]["data"]["revision"] != told[2]["data"]["revision"]


def test_viewers_come_and_go(client, room):
    start = newest(client)
    with followed(client, topic="presence", shot=room) as events:
        with websockets.sync.client.connect(socket_address(client, f"/v1/shots/{room}/live")):
            assert next(events)["data"] == {"viewers": ["anyone"]}
        assert next(events)["data"] == {"viewers": []}
    assert [event["event"] for event in kept(client, after=start, shot=room)] == ["presence", "presence"]


def test_viewers_wait_for_no_event(tmp_path, room_file, monkeypatch):
    may_write = threading.Event()
    with running(Settings(data=tmp_path, demo=False, max_viewers=1)) as service:
        shot = sent(service.client, room_file)
        note = service.internal.events.note
        monkeypatch.setattr(service.internal.events, "note", lambda new: may_write.wait() and note(new))
        address = socket_address(service.client, f"/v1/shots/{shot}/live")
        try:
            for _ in range(2):
                with websockets.sync.client.connect(address) as socket:
                    socket.send(json.dumps({"id": 1, "time": "never"}))
                    assert json.loads(socket.recv(timeout=60))["problem"]["code"] == "invalid_request"
                until(lambda: not service.internal.live_places)
        finally:
            may_write.set()


def test_a_reader_goes_on_where_it_was(service, client):
    start = newest(client)
    for frame in range(1, 4):
        service.internal.events.note(NewEvent("tasks", "task-changed", "default", "none", "r-x", {"frame": frame}))
    first, second, third = (int(event["id"]) for event in kept(client, after=start, render="r-x"))
    assert [int(event["id"]) for event in kept(client, {"Last-Event-ID": str(first)}, after=0, render="r-x")] == [
        second,
        third,
    ]
    with followed(client, {"Last-Event-ID": str(second)}, render="r-x") as events:
        assert next(events)["number"] == third
        service.internal.events.note(NewEvent("tasks", "task-changed", "default", "none", "r-x", {"frame": 4}))
        assert next(events)["data"]["frame"] == 4


def test_a_reader_is_told_what_it_has_missed_for_good(tmp_path):
    with running(Settings(data=tmp_path, demo=False)) as service:
        for _ in range(3):
            service.internal.events.note(NewEvent("shots", "shot-added", "default", "none"))
        service.internal.events.prune(-1.0)
        (gap, event) = kept(service.client, after=1)
        assert (gap["event"], gap["data"]) == ("gap", {"after": 1, "oldest": 3})
        assert event["id"] == "3"
        (ahead,) = kept(service.client, after=99)
        assert (ahead["event"], ahead["data"]["after"]) == ("gap", 99)
        assert [event["id"] for event in kept(service.client, after=2)] == ["3"]


def test_each_project_hears_of_its_own(tmp_path):
    with running(Settings(data=tmp_path, demo=False, access="keys")) as service:
        keys = service.app.state.identity.keys
        (own, key), (_, all_key) = (
            keys.create("Mara", frozenset({"read"}), "tram"),
            keys.create("Ops", frozenset({"read"}), "*"),
        )
        for project in ("tram", "other"):
            service.internal.events.note(NewEvent("shots", "shot-added", project, f"of-{project}"))
        assert service.client.get("/v1/events").status_code == 401
        bearer = {"Authorization": f"Bearer {key}"}
        assert [event["data"]["shot"] for event in kept(service.client, bearer)] == ["of-tram"]
        assert len(kept(service.client, {"Authorization": f"Bearer {all_key}"})) == 2
        with followed(service.client, bearer) as events:
            keys.revoke(own.id)
            assert list(events) == []  # it is ended


def test_the_stream_ends_with_the_service(tmp_path):
    with running(Settings(data=tmp_path, demo=False)) as service, followed(service.client) as events:
        service.internal.stopping.begin()
        assert list(events) == []


def test_a_websocket_sends_the_same(service, client):
    note = service.internal.events.note
    start = newest(client)
    note(NewEvent("renders", "render-sent", "default", "none", "r-y"))
    address = socket_address(client, f"/v1/events?after={start}&render=r-y&topic=renders")
    with websockets.sync.client.connect(address) as socket:
        assert json.loads(socket.recv()) == kept(client, after=start, render="r-y")[0]["data"]
        note(NewEvent("tasks", "task-changed", "default", "none", "r-y"))
        note(NewEvent("renders", "render-changed", "default", "none", "r-y", {"state": "done"}))
        assert json.loads(socket.recv())["data"] == {"state": "done"}
    with websockets.sync.client.connect(address + "&follow=false") as socket:
        assert [json.loads(text)["kind"] for text in socket] == ["render-sent", "render-changed"]
    foreign = {"Origin": "https://elsewhere.example"}
    with pytest.raises(websockets.exceptions.InvalidStatus, match="403"):
        websockets.sync.client.connect(address, additional_headers=foreign)


def test_a_websocket_is_closed_with_its_reason(tmp_path):
    with running(Settings(data=tmp_path, demo=False, max_viewers=1)) as service:
        address = socket_address(service.client, "/v1/events")
        with websockets.sync.client.connect(address) as socket:
            with pytest.raises(websockets.exceptions.InvalidStatus, match="503"):
                websockets.sync.client.connect(address)
            service.internal.stopping.begin()
            with pytest.raises(websockets.exceptions.ConnectionClosed) as closed:
                socket.recv()
        assert closed.value.rcvd.code == 1012


def test_readers_beyond_the_places_wait(tmp_path):
    with running(Settings(data=tmp_path, demo=False, max_viewers=1)) as service, followed(service.client):
        refused = service.client.get("/v1/events")
        assert (refused.status_code, refused.json()["code"]) == (503, "busy")
        assert "Retry-After" in refused.headers


def test_a_killed_service_leaves_nobody_in_a_shot(tmp_path, room_file):
    with running(Settings(data=tmp_path, demo=False)) as service:
        shot = sent(service.client, room_file)
        service.internal.events.note(
            NewEvent("presence", "presence-changed", "default", shot, data={"viewers": ["Mara"]})
        )
    with running(Settings(data=tmp_path, demo=False)) as service:
        until(lambda: kept(service.client, topic="presence")[-1]["data"]["data"] == {"viewers": []})


@pytest.mark.parametrize(
    "wrong", [{"after": -1}, {"after": 2**53}, {"after": "now"}, {"topic": "weather"}, {"follow": "maybe"}]
)
def test_wrong_questions_are_refused(client, wrong):
    answer = client.get("/v1/events", params=wrong)
    assert (answer.status_code, answer.json()["code"]) == (422, "invalid_request")


@pytest.mark.parametrize("wrong", ["now", "-1", "1.5", "9" * 16, ""])
def test_a_wrong_last_event_is_refused(client, wrong):
    answer = client.get("/v1/events", headers={"Last-Event-ID": wrong})
    assert (answer.status_code, answer.json()["path"]) == (422, "last-event-id")
