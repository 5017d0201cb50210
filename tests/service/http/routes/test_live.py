"""Live pictures over a WebSocket: quick ones first, the exact one in the end, the newest request before all others."""

from __future__ import annotations

import json
import struct
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from PIL import Image
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from service.http.settings import Settings
from tests.service.conftest import Running, running, until
from tests.service.kits.focus_maps import decode_focus_map

WAIT_S = 300
SMALL = {"time": 1, "width": 96, "height": 54, "rays": 8}
UNSHAPED = {"time": 1, "rays": 8}
"""A picture whose height follows from the film gate, known only when the shot is open."""
BAD_STOP = {"type": "setCamera", "values": {"fStop": -1}}
SLOW = SMALL | {"width": 640, "height": 360, "rays": 400}


@dataclass(frozen=True)
class Picture:
    """A picture as it came."""

    head: dict[str, Any]
    data: bytes

    @property
    def picture(self) -> bytes:
        return self.data[: len(self.data) - self.head["focusMapBytes"]]

    @property
    def focus_map(self) -> bytes:
        return self.data[len(self.picture) :]

    @property
    def pixels(self) -> np.ndarray:
        return np.asarray(Image.open(BytesIO(self.picture)).convert("RGB"), np.int16)


class LiveClient:
    """A viewer's end of the socket, which says that a picture has come as soon as it has."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.acks = True

    def request(self, **fields: object) -> None:
        self.socket.send(json.dumps(SMALL | fields))

    def receive(self) -> Picture | dict[str, Any]:
        message = self.socket.recv(WAIT_S)
        if isinstance(message, str):
            return json.loads(message)
        (size,) = struct.unpack_from(">I", message)
        picture = Picture(json.loads(message[4 : 4 + size]), message[4 + size :])
        if self.acks:
            self.socket.send(json.dumps({"ack": picture.head["picture"]}))
        return picture

    def until_final(self, request: int) -> list[Picture]:
        """All pictures from here to the final one of a request."""
        pictures: list[Picture] = []
        while not pictures or not (pictures[-1].head["final"] and pictures[-1].head["id"] == request):
            received = self.receive()
            assert isinstance(received, Picture), received
            pictures.append(received)
        return pictures

    def picture_and_readout(self, request: int) -> tuple[Picture, dict[str, Any]]:
        """Wait for the first picture of a request and its readout, in either order."""
        picture: Picture | None = None
        readout: dict[str, Any] | None = None
        while picture is None or readout is None:
            received = self.receive()
            if isinstance(received, Picture):
                picture = received if received.head["id"] == request else picture
            elif received["id"] == request:
                readout = received["readout"]
        return picture, readout

    def problem(self) -> dict[str, Any]:
        received = self.receive()
        assert isinstance(received, dict)
        assert received["problem"]["detail"]
        return received


@contextmanager
def opened(client, shot: str, **headers: str) -> Iterator[LiveClient]:
    address = f"ws://{client.base_url.host}:{client.base_url.port}/v1/shots/{shot}/live"
    with connect(address, additional_headers=headers, compression=None, max_size=None) as socket:
        yield LiveClient(socket)


@pytest.fixture
def live(client, room) -> Iterator[LiveClient]:
    with opened(client, room) as watching:
        yield watching


def frame(client, shot, **fields):
    return client.get(f"/v1/shots/{shot}/frame", params=SMALL | fields).content


def test_at_rest_pictures_get_better_until_the_one_that_http_gives(client, room, live):
    live.request(id=1, time=12)
    pictures = live.until_final(1)
    stages = [picture.head["stage"] for picture in pictures]
    assert stages[0] == "preview"
    assert stages[-1] == "final"
    assert [picture.head["picture"] for picture in pictures] == list(range(1, len(pictures) + 1))
    assert all(picture.head["format"] == "jpeg" for picture in pictures[:-1])
    assert pictures[-1].data == frame(client, room, time=12)
    for picture in pictures:
        assert picture.pixels.shape == (picture.head["height"], picture.head["width"], 3)
        assert picture.head["timing"]["answeredMs"] > 0


def test_a_final_picture_is_kept_and_comes_at_once(service, client, room, live):
    file = frame(client, room, time=5)
    live.request(id=1, time=5)
    (picture,) = live.until_final(1)
    assert (picture.head["width"], picture.head["height"], picture.data == file) == (96, 54, True)
    live.request(id=2, time=6)
    live.until_final(2)
    rendered = service.internal.metrics.frames.labels("rendered")._value.get()
    frame(client, room, time=6)
    assert service.internal.metrics.frames.labels("rendered")._value.get() == rendered


def test_focus_maps_come_with_the_pictures_of_a_request(service, client, room, live):
    live.request(id=1, time=7, focusMaps=True)
    pictures = live.until_final(1)
    maps = [decode_focus_map(picture.focus_map) for picture in pictures if picture.focus_map]
    assert len(maps) >= 1
    assert pictures[-1].focus_map
    assert pictures[-1].picture == frame(client, room, time=7)
    head, coc_px, _ = maps[-1]
    assert (head["width"], head["height"], coc_px.shape) == (96, 54, (54, 96))
    at_7 = {"time": 7, "width": 96, "height": 54}
    assert pictures[-1].focus_map == client.get(f"/v1/shots/{room}/focus-map", params=at_7).content
    live.request(id=2, time=7, focusMaps=True)
    (kept,) = live.until_final(2)
    assert kept.data == pictures[-1].data


def test_a_picture_that_is_kept_is_not_drawn_again_for_its_map(service, client, room, live):
    live.request(id=1, time=8)
    assert not any(picture.focus_map for picture in live.until_final(1))
    live.request(id=2, time=8, focusMaps=True)
    (kept,) = live.until_final(2)
    assert not kept.focus_map
    focus_map = client.get(f"/v1/shots/{room}/focus-map", params={"time": 8, "width": 96, "height": 54}).content
    live.request(id=3, time=8, focusMaps=True)
    (kept,) = live.until_final(3)
    assert kept.focus_map == focus_map


def test_a_tried_focus_is_seen_in_map_and_points(client, room, live):
    anchor = client.post(f"/v1/shots/{room}/pick", json={"time": 1, "width": 96, "height": 54, "x": 10, "y": 27})
    made = client.post(
        f"/v1/shots/{room}/focus-points", params={"time": 1}, json={"name": "wall"} | anchor.json()["anchor"]
    )
    assert made.status_code == 201, made.text
    (saved,) = client.get(f"/v1/shots/{room}/focus-points", params={"time": 1}).json()["focusPoints"]
    nearer = {"type": "setCamera", "values": {"fStop": 1, "focusDistanceM": saved["depthM"] / 2, "focusMode": "manual"}}
    live.request(id=1, moving=True, focusMaps=True, changes=[nearer])
    received = [live.receive(), live.receive()]
    (picture,) = (one for one in received if isinstance(one, Picture))
    (numbers,) = (one for one in received if isinstance(one, dict))
    (point,) = numbers["points"]
    assert (point["name"], point["sharp"], point["depthM"]) == ("wall", False, saved["depthM"])
    assert point["focusDistanceM"] == pytest.approx(saved["depthM"] / 2)
    head, coc_px, depth_m = decode_focus_map(picture.focus_map)
    x, y = saved["screen"]
    here = int(y * head["height"]), int(x * head["width"])
    assert depth_m[here] == pytest.approx(saved["depthM"], rel=0.02)
    assert 2 * coc_px[here] * head["filmMmPerPx"] == pytest.approx(point["cocMm"], rel=0.05)


def test_a_drag_gets_one_picture_for_each_request_begun(live):
    live.request(id=1, moving=True)
    first = live.receive()
    assert (first.head["id"], first.head["stage"], first.head["format"]) == (1, "preview", "jpeg")
    live.request(id=2, moving=True, time=2)
    assert live.receive().head["id"] == 2


def test_the_newest_request_wins_over_one_that_is_at_work(live):
    live.request(id=1, **SLOW)
    assert live.receive().head["id"] == 1
    began_s = time.monotonic()
    for number in range(2, 6):
        live.request(id=number, moving=True, time=number)
    received = [live.receive()]
    while received[-1].head["id"] != 5:
        received.append(live.receive())
    assert time.monotonic() - began_s < 20
    assert not any(picture.head["final"] for picture in received)
    assert [picture.head["id"] for picture in received] == sorted(picture.head["id"] for picture in received)


def first_pictures(service: Running) -> float:
    """Number of requests that have got a first picture."""
    return service.internal.metrics.registry.get_sample_value("pullfocus_live_first_picture_seconds_count") or 0


def test_at_most_two_pictures_are_in_flight_and_the_newest_waits(service, live):
    live.acks = False
    for number in range(1, 6):
        made = first_pictures(service)
        live.request(id=number, moving=True, time=number)
        if number <= 2:
            assert live.receive().head["picture"] == number
        else:
            until(lambda made=made: first_pictures(service) > made)
            with pytest.raises(TimeoutError):
                live.socket.recv(0.2)
    live.socket.send('{"ack": 1}')
    late = live.receive()
    assert (late.head["id"], late.head["picture"]) == (5, 3)


def test_what_is_tried_is_seen_and_not_kept(client, room, live):
    before = client.get(f"/v1/shots/{room}").json()["revision"]
    live.request(id=1, changes=[{"type": "setCamera", "values": {"fStop": 1, "focusDistanceM": 8}}])
    received = [live.receive()]
    while not (isinstance(received[-1], Picture) and received[-1].head["final"]):
        received.append(live.receive())
    (message,) = (item for item in received if isinstance(item, dict))
    assert (message["id"], message["readout"]["focusDistanceM"], message["readout"]["fStop"]) == (1, 8, 1)
    assert client.get(f"/v1/shots/{room}").json()["revision"] == before
    saved = frame(client, room)
    client.patch(f"/v1/shots/{room}/camera", json={"fStop": 1, "focusDistanceM": 8})
    assert received[-1].data == frame(client, room) != saved


def test_every_kind_of_edit_can_be_tried(client, room, live):
    anchor = client.post(f"/v1/shots/{room}/pick", json={"time": 1, "width": 96, "height": 54, "x": 10, "y": 27})
    client.post(f"/v1/shots/{room}/focus-points", params={"time": 1}, json={"name": "a"} | anchor.json()["anchor"])
    client.patch(f"/v1/shots/{room}/camera", json={"focusMode": "points"})
    plain = live_picture(live, 1)
    tried = [
        {"type": "setCamera", "values": {"focalLengthMm": 30}},
        {"type": "setFocus", "values": {"mode": "manual", "tiltDeg": 20}},
        {"type": "setExposure", "values": {"iso": 1600}},
        {"type": "setFilm", "values": {"stock": "tri_x"}},
        {"type": "keySetting", "setting": "focalLengthMm", "key": {"time": 1, "value": 30}},
        {"type": "alterPoint", "name": "a", "time": 1, "values": {"kind": "soft", "blurMm": 1}},
        {"type": "keyPoint", "name": "a", "attribute": "blur", "key": {"time": 1, "value": 0}},
    ]
    for number, change in enumerate(tried, 2):
        if change["type"] == "keyPoint":
            client.patch(f"/v1/shots/{room}/focus-points/a", params={"time": 1}, json={"kind": "soft", "blurMm": 1})
            plain = live_picture(live, 100)
        assert (live_picture(live, number, changes=[change]) != plain).any(), change


def live_picture(live: LiveClient, number: int, **fields: object) -> np.ndarray:
    """The final picture of a request."""
    live.request(id=number, **fields)
    while True:
        received = live.receive()
        if isinstance(received, Picture) and received.head["final"] and received.head["id"] == number:
            return received.pixels
        assert isinstance(received, Picture) or "readout" in received, received


def moved_to(x: float, y: float) -> dict[str, Any]:
    return {"type": "movePoint", "name": "a", "place": [x, y], "time": 1}


def test_a_focus_point_is_tried_where_it_is_dragged_to(client, room, live):
    anchor = client.post(f"/v1/shots/{room}/pick", json={"time": 1, "width": 96, "height": 54, "x": 10, "y": 27})
    client.post(f"/v1/shots/{room}/focus-points", params={"time": 1}, json={"name": "a"} | anchor.json()["anchor"])
    client.patch(f"/v1/shots/{room}/camera", json={"focusMode": "points"})
    focused = {}
    for number, x in enumerate((0.1, 0.9)):
        live.request(id=number, moving=True, changes=[moved_to(x, 0.5)])
        focused[x] = live.picture_and_readout(number)[1]["focusDistanceM"]
    assert focused == {0.1: pytest.approx(3, abs=0.01), 0.9: pytest.approx(8, abs=0.01)}
    live.request(id=9, moving=True, changes=[moved_to(0.9, 0.02)])  # where there is nothing it stays
    assert live.picture_and_readout(9)[1]["focusDistanceM"] == pytest.approx(3, abs=0.01)


def test_a_pick_does_not_wait_for_a_picture_that_takes_long(service, client, room, live):
    live.request(id=1, **SLOW)
    assert live.receive().head["id"] == 1
    picked = client.post(f"/v1/shots/{room}/pick", json={"time": 1, "width": 96, "height": 54, "x": 10, "y": 27})
    assert picked.json()["hit"] is True
    live.request(id=2)
    pictures = live.until_final(2)
    assert not any(picture.head["final"] for picture in pictures if picture.head["id"] == 1)


def test_made_again_after_others_a_picture_is_not_sent_twice(client, room, live):
    live.request(id=1, width=480, height=270, rays=64)
    assert live.receive().head["stage"] == "preview"
    for seed in range(3):
        frame(client, room, seed=seed, engine="pinhole")
    rest = live.until_final(1)
    assert "preview" not in [picture.head["stage"] for picture in rest]
    rays = [picture.head["timing"]["rays"] for picture in rest]
    assert rays == sorted(rays)


@pytest.mark.parametrize(
    ("message", "status", "code", "path"),
    [
        ("no json", 422, "invalid_request", None),
        ("[1]", 422, "invalid_request", None),
        (b"\x00", 422, "invalid_request", None),
        ('{"ack": "all"}', 422, "invalid_request", "ack"),
        (json.dumps({"id": 3, "time": "soon"}), 422, "invalid_request", "time"),
        (json.dumps({"id": 3, "time": 1, "tiem": 1}), 422, "invalid_request", "tiem"),
        (json.dumps({"id": 3, "time": 1, "changes": [BAD_STOP]}), 422, "invalid_request", "changes.0.setCamera.values.fStop"),
        (json.dumps({"id": 3, "time": 1, "width": 8192, "height": 8192}), 422, "too_many_pixels", "query.width"),
        (json.dumps(UNSHAPED | {"id": 3, "width": 8192}), 422, "too_many_pixels", "query.width"),
        (json.dumps({"id": 3, "time": 1, "rays": 10**9}), 422, "too_costly", "query"),
        (json.dumps(SMALL | {"id": 3, "camera": "/no/camera"}), 422, "no_such_camera", "/no/camera"),
        (json.dumps(SMALL | {"id": 3, "changes": [{"type": "removePoint", "name": "nobody"}]}), 404, "not_found", "/World/cam"),
    ],
)  # fmt: skip
def test_a_bad_request_gets_a_problem_and_the_next_is_answered(live, message, status, code, path):
    live.socket.send(message)
    refusal = live.problem()
    assert refusal["status"] == status
    assert set(refusal["problem"]) == {"code", "detail", "path", "errors"}
    assert (refusal["problem"]["code"], refusal["problem"]["path"]) == (code, path)
    assert refusal["id"] == (3 if isinstance(message, str) and '"id": 3' in message else None)
    live.request(id=4, moving=True)
    assert live.receive().head["id"] == 4


def test_a_missing_shot_is_reported(client):
    with opened(client, "none") as live:
        live.request(id=1)
        refusal = live.problem()
    assert (refusal["id"], refusal["status"], refusal["problem"]["code"]) == (1, 404, "shot_not_found")


def test_a_viewer_that_disconnects_leaves_no_work_behind(service, client, room):
    with opened(client, room) as live:
        live.request(id=1, **(SLOW | {"rays": 4000}))
        live.receive()
        assert service.internal.lanes.live.running
    began_s = time.monotonic()
    until(lambda: not service.internal.lanes.live.running)
    assert time.monotonic() - began_s < 15
    until(lambda: service.internal.metrics.live_viewers._value.get() == 0)


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": "https://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": "http://[no address"}, 403),
    ],
)
def test_a_page_of_another_site_may_not_watch(client, room, headers, status):
    with pytest.raises(InvalidStatus) as refused, opened(client, room, **headers):
        pass
    assert refused.value.response.status_code == status
    assert set(json.loads(refused.value.response.body)) == {"code", "detail", "path", "errors"}


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example:8000"])
def test_live_pictures_refuse_a_foreign_host_name(client, room, host):
    headers = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    key = {"Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Host": host, "Origin": f"http://{host}"}
    answer = client.get(f"/v1/shots/{room}/live", headers=headers | key)
    assert (answer.status_code, answer.json()["code"]) == (421, "unknown_host")


def test_our_own_page_may(client, room):
    with opened(client, room, Origin=str(client.base_url).rstrip("/")) as live:
        live.request(id=1, moving=True)
        assert live.receive().head["id"] == 1


@pytest.mark.parametrize("look", ["x" * 2**20, "é" * 2**19])
def test_more_bytes_than_are_taken_end_the_connection(live, look):
    live.socket.send(json.dumps({"id": 1, "time": 1, "look": look}, ensure_ascii=False))
    with pytest.raises(ConnectionClosed) as closed:
        live.receive()
    assert closed.value.rcvd.code == 1009


def test_no_more_viewers_than_are_taken_may_watch(tmp_path):
    with running(Settings(data=tmp_path, demo=False, max_viewers=1)) as service:
        with opened(service.client, "none") as first:
            with pytest.raises(InvalidStatus) as refused, opened(service.client, "none"):
                pass
            answer = refused.value.response
            assert (answer.status_code, json.loads(answer.body)["code"]) == (503, "busy")
            assert "Retry-After" in answer.headers
            first.request(id=1)
            assert first.problem()["problem"]["code"] == "shot_not_found"
        until(lambda: not service.internal.live_places)
        with opened(service.client, "none") as next_one:
            next_one.request(id=1)
            assert next_one.problem()["id"] == 1


def test_a_viewer_that_stops_leaves_no_work_behind(service, live):
    live.request(id=1, **(SLOW | {"rays": 4000}))
    live.receive()
    assert service.internal.lanes.live.running
    live.socket.send('{"stop": true}')
    began_s = time.monotonic()
    until(lambda: not service.internal.lanes.live.running)
    assert time.monotonic() - began_s < 15


def test_a_plain_http_request_for_live_pictures_is_refused(client, room):
    answer = client.get(f"/v1/shots/{room}/live")
    assert (answer.status_code, answer.json()["code"]) == (426, "upgrade_required")


def test_viewers_are_counted(client, room, live):
    live.request(id=1, moving=True)
    live.receive()
    text = client.get("/metrics").text
    assert "pullfocus_live_viewers 1.0" in text
    assert 'pullfocus_live_pictures_total{stage="preview"}' in text
    assert "pullfocus_live_first_picture_seconds_bucket" in text
