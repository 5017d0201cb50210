"""Cameras that are moved and duplicated, over HTTP."""

from __future__ import annotations

from typing import Any

import pytest

HERE = {"positionM": [0.5, 1.25, 3.0], "ahead": [0.0, 0.0, -2.0], "up": [0.0, 1.0, 0.0]}
THERE = {"positionM": [-0.5, 1.0, 2.0], "ahead": [0.6, 0.0, -0.8], "up": [0.0, 1.0, 0.0]}
MOVE = {"type": "moveCamera", **HERE, "time": 5}


@pytest.fixture
def shot(room) -> str:
    return f"/v1/shots/{room}"


def edit(client, shot: str, *changes: dict[str, Any], **request: Any):
    return client.post(f"{shot}/edits", json={"changes": changes} | request)


def camera_at(client, shot: str, time: float) -> tuple[list[float], list[float]]:
    view = client.get(f"{shot}/top-view", params={"time": time}).json()
    return view["positionM"], view["ahead"]


def test_a_camera_is_moved_and_moved_back(client, shot):
    before = camera_at(client, shot, 5)
    moved = edit(client, shot, MOVE, answer={"time": 5})
    assert moved.status_code == 200, moved.text
    assert "camera" in {changed["resource"] for changed in moved.json()["changed"]}
    assert moved.json()["history"]["undo"] == "move cam"
    position, ahead = camera_at(client, shot, 20)
    assert position == pytest.approx(HERE["positionM"])
    assert ahead == pytest.approx([0, 0, -1])
    assert client.post(f"{shot}/edits/undo").status_code == 200
    assert camera_at(client, shot, 5) == before


def test_keys_of_a_camera_hold_at_their_times(client, shot):
    keyed = edit(client, shot, MOVE | {"keyed": True}, MOVE | THERE | {"time": 15, "keyed": True})
    assert keyed.status_code == 200, keyed.text
    for time, place in ((1, HERE), (5, HERE), (15, THERE), (24, THERE)):
        assert camera_at(client, shot, time)[0] == pytest.approx(place["positionM"])
    assert camera_at(client, shot, 10)[0] == pytest.approx([0, 1.125, 2.5])
    paths = client.get(f"{shot}/paths").json()
    assert paths["cameraM"][4] == pytest.approx(HERE["positionM"])


@pytest.mark.parametrize(
    "wrong",
    [
        {"positionM": [1e10, 0, 0]},
        {"positionM": [0, 0]},
        {"positionM": [None, 0, 0]},
        {"ahead": [0, 0, 0]},
        {"ahead": [0, 1, 0]},
        {"time": 1e12},
        {"keyed": 1},
    ],
)
def test_places_that_cannot_be_are_refused(client, shot, wrong):
    before = client.get(f"{shot}/edits/history").json()
    refused = edit(client, shot, MOVE | wrong)
    assert refused.status_code == 422, refused.text
    assert refused.json()["code"] in ("invalid_request", "bad_place")
    assert client.get(f"{shot}/edits/history").json() == before


def test_a_number_that_is_none_is_refused(client, shot):
    text = '{"changes": [{"type": "moveCamera", "positionM": [NaN, 0, 0], "ahead": [0, 0, -1], "time": 1}]}'
    refused = client.post(f"{shot}/edits", content=text, headers={"content-type": "application/json"})
    assert refused.status_code in (400, 422)


def test_a_camera_is_duplicated_and_the_copy_moved(client, shot):
    (own,) = client.get(shot).json()["cameras"]
    answer = edit(client, shot, {"type": "duplicateCamera"}, MOVE)
    assert answer.status_code == 200, answer.text
    (copy,) = answer.json()["cameras"]
    assert copy == f"{own}_2"
    found = client.get(shot).json()
    assert (found["cameras"], found["defaultCamera"]["path"]) == ([own, copy], own)
    view = client.get(f"{shot}/top-view", params={"time": 5, "camera": copy}).json()
    assert view["positionM"] == pytest.approx(HERE["positionM"])
    assert camera_at(client, shot, 5)[0] != pytest.approx(HERE["positionM"])
    taken = edit(client, shot, {"type": "duplicateCamera", "name": copy.rpartition("/")[2]})
    assert (taken.status_code, taken.json()["code"]) == (422, "name_taken")
    assert client.post(f"{shot}/edits/undo").json()["cameras"] == [own]


def place(client, shot: str, time: float = 5, **query: Any) -> dict[str, Any]:
    answer = client.get(f"{shot}/camera/place", params={"time": time} | query)
    assert answer.status_code == 200, answer.text
    assert answer.headers["etag"] == answer.json()["etag"]
    return answer.json()


def keys_of(told: dict[str, Any]) -> list[tuple[float, bool]]:
    return [(key["time"], key["edited"]) for key in told["keys"]]


def test_the_keys_of_a_camera_are_told_and_taken_away(client, shot):
    before = place(client, shot)
    assert (before["keys"], before["edited"], before["inShot"]) == ([], False, True)
    edit(client, shot, MOVE | {"keyed": True}, MOVE | THERE | {"time": 15, "keyed": True})
    keyed = place(client, shot, 15)
    assert (keys_of(keyed), keyed["edited"]) == ([(5, True), (15, True)], True)
    assert keyed["positionM"] == pytest.approx(THERE["positionM"])
    assert keyed["ahead"] == pytest.approx(THERE["ahead"])
    assert keyed["up"] == pytest.approx([0, 1, 0])
    taken = edit(client, shot, {"type": "unkeyCamera", "time": 15})
    assert taken.status_code == 200, taken.text
    assert taken.json()["history"]["undo"] == "remove the key of the place of cam at 15"
    assert keys_of(place(client, shot)) == [(5, True)]
    assert camera_at(client, shot, 20)[0] == pytest.approx(HERE["positionM"])
    client.post(f"{shot}/edits/undo")
    assert keys_of(place(client, shot)) == [(5, True), (15, True)]


def test_keys_of_a_camera_are_moved_and_given_back(client, shot):
    before = camera_at(client, shot, 5)
    edit(client, shot, MOVE | {"keyed": True}, MOVE | THERE | {"time": 15, "keyed": True})
    moves = [{"time": 5, "newTime": 15}, {"time": 15, "newTime": 5.5}]
    moved = edit(client, shot, {"type": "moveCameraKeys", "moves": moves})
    assert moved.status_code == 200, moved.text
    assert keys_of(place(client, shot)) == [(5.5, True), (15, True)]
    assert camera_at(client, shot, 15)[0] == pytest.approx(HERE["positionM"])
    assert edit(client, shot, {"type": "resetCameraPlace"}).status_code == 200
    assert (place(client, shot)["keys"], place(client, shot)["edited"]) == ([], False)
    assert camera_at(client, shot, 5) == before


@pytest.mark.parametrize(
    ("change", "status", "code"),
    [
        ({"type": "unkeyCamera", "time": 6}, 404, "not_found"),
        ({"type": "unkeyCamera", "time": 1e12}, 422, "invalid_request"),
        ({"type": "unkeyCamera"}, 422, "invalid_request"),
        ({"type": "moveCameraKeys", "moves": [{"time": 6, "newTime": 7}]}, 404, "not_found"),
        ({"type": "moveCameraKeys", "moves": []}, 422, "invalid_request"),
        ({"type": "moveCameraKeys", "moves": [{"time": 5, "newTime": 7}] * 2}, 422, "bad_key"),
        (
            {"type": "moveCameraKeys", "moves": [{"time": 5, "newTime": 7}, {"time": 15, "newTime": 7}]},
            422,
            "bad_key",
        ),
        ({"type": "frameSubject", "point": "none", "time": 5}, 404, "not_found"),
        ({"type": "frameSubject", "point": "none", "time": 5, "share": 1}, 422, "invalid_request"),
        ({"type": "frameSubject", "point": "none", "time": 5, "aspect": 0}, 422, "invalid_request"),
        ({"type": "frameSubject", "time": 5}, 422, "invalid_request"),
    ],
)
def test_edits_of_keys_that_cannot_be_are_refused(client, shot, change, status, code):
    edit(client, shot, MOVE | {"keyed": True}, MOVE | THERE | {"time": 15, "keyed": True})
    before = client.get(f"{shot}/edits/history").json()
    refused = edit(client, shot, change)
    assert (refused.status_code, refused.json()["code"]) == (status, code), refused.text
    assert client.get(f"{shot}/edits/history").json() == before


def test_a_place_that_is_not_edited_or_not_of_the_shot_stays(client, shot):
    refused = edit(client, shot, {"type": "resetCameraPlace"})
    assert (refused.status_code, refused.json()["code"]) == (404, "not_found")
    (copy,) = edit(client, shot, {"type": "duplicateCamera"}).json()["cameras"]
    assert place(client, shot, camera=copy)["inShot"] is False
    refused = edit(client, shot, {"type": "resetCameraPlace"}, camera=copy)
    assert (refused.status_code, refused.json()["code"]) == (422, "no_place")


def test_a_card_is_framed_by_its_height(client, shot):
    added = edit(client, shot, {"type": "addPoint", "point": {"name": "card", "target": ["/World/near"]}})
    assert added.status_code == 200, added.text
    framed = edit(client, shot, {"type": "frameSubject", "point": "card", "time": 5, "keyed": True})
    assert framed.status_code == 200, framed.text
    assert place(client, shot)["positionM"] == pytest.approx([-0.5, 0, -3 + 0.6 / (2 / 3 * 0.2025)])
    assert place(client, shot)["ahead"] == pytest.approx([0, 0, -1])
    third = {"type": "frameSubject", "point": "card", "time": 5, "share": 1 / 3, "keyed": True}
    assert edit(client, shot, third).status_code == 200
    assert place(client, shot)["positionM"] == pytest.approx([-0.5, 0, -3 + 0.6 / (1 / 3 * 0.2025)])
    assert keys_of(place(client, shot)) == [(5, True)]
