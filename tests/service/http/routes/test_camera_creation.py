"""Creation of a camera over HTTP, in a shot that has none."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.service.conftest import ROOM, send
from tests.service.kits.edits import TWO_POINTS, edit, edited, layer


@pytest.fixture
def shot(room) -> str:
    return f"/v1/shots/{room}"


@pytest.fixture
def bare(client) -> Iterator[str]:
    """The room without its camera."""
    begin, end = ROOM.index("    def Camera"), ROOM.index("    def Mesh")
    sent = send(client, "bare.usda", (ROOM[:begin] + ROOM[end:]).encode())
    assert sent.status_code == 201, sent.text
    address = f"/v1/shots/{sent.json()['id']}"
    assert sent.json()["cameras"] == []
    yield address
    client.delete(address)


def test_a_camera_is_created_where_there_is_none(client, bare):
    (framing,) = client.get(f"{bare}/cameras", params={"time": 1}).json()["cameras"]
    answer = edited(client, bare, {"type": "createCamera"}, answer={"time": 1, "curve": True})
    assert answer["cameras"] == ["/main_cam"]
    assert {changed["resource"] for changed in answer["changed"]} == {"camera", "focus-points"}
    assert answer["history"]["undo"] == "create camera main_cam"
    assert answer["state"]["readout"]["focusDistanceM"] == pytest.approx(framing["focusDistanceM"], rel=1e-6)
    assert len(answer["state"]["curve"]["samples"]) == 24
    shot = client.get(bare).json()
    assert (shot["cameras"], shot["defaultCamera"]["path"]) == (["/main_cam"], "/main_cam")
    (camera,) = client.get(f"{bare}/cameras", params={"time": 1}).json()["cameras"]
    assert camera["focusDistanceM"] == pytest.approx(framing["focusDistanceM"], rel=1e-6)
    assert (camera["lensModel"], camera["fStop"]) == ("thin", pytest.approx(2.8))
    assert 'def Camera "main_cam"' in layer(client, bare)
    picture = client.get(f"{bare}/frame", params={"time": 1, "width": 64, "height": 36, "rays": 16})
    assert picture.status_code == 200, picture.text


def test_undo_takes_a_created_camera_away_and_redo_brings_it_back(client, bare):
    edited(client, bare, {"type": "createCamera", "name": "hero", "time": 12})
    assert client.get(f"{bare}/edits/history").json()["cameras"] == ["/hero"]
    assert client.post(f"{bare}/edits/undo").json()["cameras"] == []
    assert client.get(bare).json()["defaultCamera"]["path"] is None
    assert client.post(f"{bare}/edits/redo").json()["cameras"] == ["/hero"]
    pick = client.post(f"{bare}/pick", json={"time": 1, "width": 320, "height": 180, "x": 190, "y": 90})
    assert pick.json()["hit"], pick.text


def test_changes_after_its_creation_are_made_to_the_camera(client, bare):
    changes = [{"type": "createCamera"}, *TWO_POINTS, {"type": "setFocus", "values": {"mode": "points"}}]
    answer = edited(client, bare, *changes, label="Begin", answer={"time": 1})
    assert (answer["cameras"], answer["added"]) == (["/main_cam"], ["near", "far"])
    assert [point["name"] for point in answer["state"]["focusPoints"]["focusPoints"]] == ["near", "far"]
    assert answer["state"]["readout"]["source"] == "points"
    assert client.post(f"{bare}/edits/undo").json()["cameras"] == []


def test_a_camera_is_created_upon_the_view_that_was_seen(client, bare):
    (framing,) = client.get(f"{bare}/cameras", params={"time": 1}).json()["cameras"]
    seen = {"if-match": f'"{framing["etag"].strip(chr(34))}"'}
    assert edit(client, bare, {"type": "createCamera", "name": "a"}, headers=seen).status_code == 200
    again = edit(client, bare, {"type": "createCamera", "name": "b"}, headers=seen)
    assert (again.status_code, again.json()["code"]) == (412, "changed_meanwhile")


@pytest.mark.parametrize("name", ["", "../a", "a/b", "1st", "a b", "a" * 101, "ä\0"])
def test_a_cameras_name_is_an_identifier(client, bare, name):
    refused = edit(client, bare, {"type": "createCamera", "name": name})
    assert (refused.status_code, refused.json()["code"]) == (422, "invalid_request")


def test_a_camera_is_created_once_and_only_where_there_is_none(client, bare, shot):
    taken = edit(client, bare, {"type": "createCamera", "name": "World"})
    assert (taken.status_code, taken.json()["code"]) == (422, "name_taken")
    twice = edit(client, bare, {"type": "createCamera"}, {"type": "createCamera"})
    assert (twice.status_code, twice.json()["code"]) == (422, "has_camera")
    assert client.get(bare).json()["cameras"] == []
    refused = edit(client, shot, {"type": "createCamera"})
    assert (refused.status_code, refused.json()["code"]) == (422, "has_camera")
    assert refused.json()["path"] == "/World/cam"
