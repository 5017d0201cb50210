"""Long exposures over HTTP: begin, pause, continue, develop and lose them, with other pictures in between."""

from __future__ import annotations

import os
import signal
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from render.cli.main import main
from tests.service.conftest import send, until

SMALL = {"first": 1, "last": 5, "width": 96, "height": 54, "rays": 4, "supersample": 1}


def address(shot: str) -> str:
    return f"/v1/shots/{shot}/long-exposure"


def begin(client, shot, **fields):
    answer = client.post(address(shot), json=SMALL | fields)
    assert answer.status_code == 201, answer.text
    return answer.json()


def state(client, shot):
    return client.get(address(shot)).json()


def pixels(answer) -> np.ndarray:
    assert answer.status_code == 200, answer.text
    return np.asarray(Image.open(BytesIO(answer.content)), np.int16)


def test_it_goes_on_to_its_end_and_is_what_the_command_line_writes(client, room, room_file, tmp_path):
    begun = begin(client, room)
    assert (begun["shutter"], begun["intervalCount"]) == ("open", 4)
    until(lambda: state(client, room)["shutter"] == "done")
    progress = state(client, room)
    assert (progress["intervals"], progress["time"], progress["openFrames"], progress["problem"]) == (4, 5, 4, None)
    assert progress["openSeconds"] == pytest.approx(4 / 24)
    out = tmp_path / "out.png"
    arguments = ["--long-exposure", "1:5", "--imageWidth", "96", "--rays", "4", "--supersample", "1"]
    assert main(["record", str(room_file), str(out), *arguments]) == 0
    answer = client.get(f"{address(room)}/picture")
    assert answer.content == out.read_bytes()
    assert answer.headers["cache-control"] == "no-store"
    exr = client.get(f"{address(room)}/picture", params={"format": "exr"})
    assert exr.content[:4] == b"v/1\x01"


def test_closed_and_opened_again_it_is_the_same_picture(client, room):
    begin(client, room, last=41)
    until(lambda: state(client, room)["intervals"] >= 1)
    closing = client.patch(address(room), json={"shutter": "closed"}).json()
    assert closing["shutter"] == "closed"
    frame = {"time": 1, "width": 96, "height": 54, "rays": 4}
    pixels(client.get(f"/v1/shots/{room}/frame", params=frame))  # after the interval that was at work
    closed = state(client, room)
    assert 1 <= closed["intervals"] <= closing["intervals"] + 1 < 40
    peeked = pixels(client.get(f"{address(room)}/picture"))
    client.patch(f"/v1/shots/{room}/camera", json={"fStop": 1, "focusDistanceM": 8})  # is not seen by what has begun
    assert state(client, room) == closed
    assert client.patch(address(room), json={"shutter": "open"}).json()["shutter"] == "open"
    until(lambda: state(client, room)["shutter"] == "done")
    gone_on = pixels(client.get(f"{address(room)}/picture"))
    assert np.abs(gone_on - peeked).mean() < 4  # nothing moves: as bright, and less noisy
    client.post(f"/v1/shots/{room}/edits/undo")
    begin(client, room, last=41)
    until(lambda: state(client, room)["shutter"] == "done")
    np.testing.assert_array_equal(pixels(client.get(f"{address(room)}/picture")), gone_on)


def test_pictures_come_between_its_intervals(client, room):
    begin(client, room, last=1001)
    until(lambda: state(client, room)["intervals"] >= 1)
    pixels(client.get(f"/v1/shots/{room}/frame", params={"time": 1, "width": 96, "height": 54, "rays": 4, "seed": 77}))
    assert state(client, room)["shutter"] == "open"
    assert client.delete(address(room)).status_code == 204
    gone = client.get(address(room))
    assert (gone.status_code, gone.json()["code"]) == (404, "exposure_not_found")
    assert client.delete(address(room)).status_code == 204


def test_a_dead_picture_process_loses_it_and_says_so(service, client, room):
    begin(client, room, last=1001)
    until(lambda: state(client, room)["intervals"] >= 1)
    os.kill(service.worker("exposure", room), signal.SIGKILL)
    until(lambda: state(client, room)["shutter"] == "failed")
    assert state(client, room)["problem"]
    lost = client.get(f"{address(room)}/picture")
    assert (lost.status_code, lost.json()["code"]) == (404, "exposure_lost")
    assert begin(client, room, last=2)["shutter"] == "open"
    until(lambda: state(client, room)["shutter"] == "done")


def test_a_shot_that_is_removed_takes_its_exposure_along(service, client, room_file):
    shot = send(client, "gone.usda", room_file.read_bytes()).json()["id"]
    begin(client, shot, last=1001)
    assert client.delete(f"/v1/shots/{shot}").status_code == 204
    assert client.get(address(shot)).status_code == 404
    until(lambda: not service.internal.lanes.exposure.running)


@pytest.mark.parametrize(
    ("fields", "progress"),
    [
        ({"last": 1}, "cannot close before it opens"),
        ({"last": -5}, "it opens at 1 and closes at -5"),
        ({"step": 0}, "step"),
        ({"last": 1e8}, "more intervals than"),
        ({"film": "velvia_5O"}, "velvia"),
        ({"camera": "/nothing"}, "/nothing"),
        ({"width": 8192, "height": 8192}, "px are rendered"),
        ({"rays": 10**9}, "rays"),
        ({"ndStops": 1000}, "ndStops"),
        ({"ndStops": -1}, "ndStops"),
        ({"unknown": 1}, "unknown"),
    ],
)
def test_what_cannot_be_exposed_is_refused_at_once(client, room, fields, progress):
    answer = client.post(address(room), json=SMALL | fields)
    assert answer.status_code == 422, answer.text
    assert progress in answer.json()["detail"]
    assert client.get(address(room)).status_code == 404


def test_too_many_pixels_by_the_film_gates_height_are_refused(client, room):
    for height in (8192, None):
        answer = client.post(address(room), json=SMALL | {"width": 8192, "height": height, "motion": 2})
        assert (answer.status_code, answer.json()["code"], answer.json()["path"]) == (
            422,
            "too_many_pixels",
            "body.width",
        )


def test_before_the_first_interval_there_is_no_picture(client, room):
    assert client.get(f"{address(room)}/picture").status_code == 404
    assert client.patch(address(room), json={"shutter": "closed"}).status_code == 404
    assert client.patch(address(room), json={"shutter": "ajar"}).status_code == 422
