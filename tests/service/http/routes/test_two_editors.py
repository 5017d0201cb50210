"""Two editors at one shot: entity tags keep them from overwriting each other; undo walks the history of the edit layer."""

from __future__ import annotations

import json

import pytest

from service.http.settings import Settings
from service.storage.edit_files import load_history
from tests.service.conftest import running, send


@pytest.fixture
def shot(client, room) -> str:
    return f"/v1/shots/{room}"


def add(client, shot, name, **ask):
    target = {"target": ["/World/near"], "face": 0, "barycentric": [0.3, 0.3, 0.4], "name": name}
    answer = client.post(f"{shot}/focus-points", params={"time": 1}, json=target, **ask)
    assert answer.status_code == 201, answer.text
    return answer


def set_stop(client, shot, f_stop, **ask):
    return client.patch(f"{shot}/camera", json={"fStop": f_stop}, **ask)


def stop_of(client, shot):
    return client.get(f"{shot}/readout", params={"time": 1}).json()["fStop"]


def with_tag(answer):
    return {"If-Match": answer.headers["etag"]}


def refused(answer, status, code):
    assert (answer.status_code, answer.json()["code"]) == (status, code), answer.text
    assert set(answer.json()) == {"code", "detail", "path", "errors"}


def test_the_second_editor_of_a_point_gets_a_conflict(client, shot):
    add(client, shot, "hero")
    at, ask = f"{shot}/focus-points/hero", {"time": 1}
    seen = client.get(at, params=ask)
    assert seen.headers["etag"] == seen.json()["etag"]
    first = client.patch(at, params=ask, json={"weight": 2}, headers=with_tag(seen))
    assert first.status_code == 200
    assert first.headers["etag"] != seen.headers["etag"]
    before = client.get(f"{shot}/edits").text
    for method, path, body in (
        ("PATCH", at, {"weight": 3}),
        ("DELETE", at, None),
        ("PUT", f"{at}/keys/weight", {"time": 1, "value": 3}),
        ("DELETE", f"{at}/keys/weight", None),
    ):
        second = client.request(method, path, params=ask, json=body, headers=with_tag(seen))
        refused(second, 412, "changed_meanwhile")
        assert "hero" in second.json()["detail"]
    assert client.get(f"{shot}/edits").text == before
    assert client.patch(at, params=ask, json={"weight": 3}, headers=with_tag(first)).json()["weight"] == 3


def test_editors_of_different_things_do_not_disturb_each_other(client, shot):
    add(client, shot, "hero")
    add(client, shot, "heroine")
    ask = {"time": 1}
    hero = client.get(f"{shot}/focus-points/hero", params=ask)
    camera = client.get(f"{shot}/camera", params=ask)
    assert client.patch(f"{shot}/focus-points/heroine", params=ask, json={"weight": 2}).status_code == 200
    assert set_stop(client, shot, 4, headers=with_tag(camera)).status_code == 200
    assert (
        client.patch(f"{shot}/focus-points/hero", params=ask, json={"weight": 3}, headers=with_tag(hero)).status_code
        == 200
    )


def test_the_second_editor_of_a_camera_gets_a_conflict(client, shot):
    seen = client.get(f"{shot}/camera", params={"time": 1})
    listed = client.get(f"{shot}/cameras", params={"time": 1}).json()["cameras"][0]
    assert seen.headers["etag"] == seen.json()["etag"] == listed["etag"]
    first = set_stop(client, shot, 4, headers=with_tag(seen))
    assert first.status_code == 200
    refused(set_stop(client, shot, 8, headers=with_tag(seen)), 412, "changed_meanwhile")
    assert set_stop(client, shot, 8, headers=with_tag(first)).status_code == 200
    assert stop_of(client, shot) == 8


def test_a_point_is_added_to_the_list_that_was_seen(client, shot):
    seen = client.get(f"{shot}/focus-points", params={"time": 1})
    assert seen.headers["etag"] == seen.json()["etag"]
    add(client, shot, "hero", headers=with_tag(seen))
    again = {"target": ["/World/far"], "name": "other"}
    answer = client.post(f"{shot}/focus-points", params={"time": 1}, json=again, headers=with_tag(seen))
    refused(answer, 412, "changed_meanwhile")


@pytest.mark.parametrize(
    ("header", "goes_on"),
    [("*", True), ('"other", {}', True), ("W/{}", False), ('"other"', False), ("", False), ("rubbish", False)],
)
def test_if_match_is_what_http_says_it_is(client, shot, header, goes_on):
    tag = client.get(f"{shot}/camera", params={"time": 1}).headers["etag"]
    answer = set_stop(client, shot, 4, headers={"If-Match": header.format(tag)})
    assert answer.status_code == (200 if goes_on else 412), answer.text


def test_the_edit_layer_has_a_tag_and_is_not_sent_twice(client, shot):
    empty = client.get(f"{shot}/edits")
    set_stop(client, shot, 4)
    layer = client.get(f"{shot}/edits")
    assert layer.headers["etag"] == f'"{client.get(shot).json()["revision"]}"' != empty.headers["etag"]
    same = client.get(f"{shot}/edits", headers={"If-None-Match": layer.headers["etag"]})
    assert (same.status_code, same.content) == (304, b"")
    assert client.get(f"{shot}/edits", headers={"If-None-Match": empty.headers["etag"]}).text == layer.text


def test_undo_and_redo_walk_the_history(client, shot):
    empty = client.get(f"{shot}/edits")
    set_stop(client, shot, 4)
    add(client, shot, "hero")
    full = client.get(f"{shot}/edits")
    history = client.get(f"{shot}/edits/history").json()
    assert [step["label"] for step in history["steps"]] == ["", "set f-number of cam", "add focus point hero"]
    assert (history["now"], history["undo"], history["redo"]) == (2, "add focus point hero", None)
    undone = client.post(f"{shot}/edits/undo")
    assert (undone.json()["now"], undone.json()["redo"]) == (1, "add focus point hero")
    assert client.get(f"{shot}/focus-points", params={"time": 1}).json()["focusPoints"] == []
    assert stop_of(client, shot) == 4
    back = client.post(f"{shot}/edits/undo")
    assert back.headers["etag"] == empty.headers["etag"]
    assert client.get(f"{shot}/edits").text == empty.text
    assert stop_of(client, shot) == pytest.approx(1.4)
    refused(client.post(f"{shot}/edits/undo"), 409, "nothing_to_undo")
    for _ in range(2):
        assert client.post(f"{shot}/edits/redo").status_code == 200
    assert client.get(f"{shot}/edits").text == full.text
    refused(client.post(f"{shot}/edits/redo"), 409, "nothing_to_redo")


def test_an_editor_does_not_undo_anothers_later_edit(client, shot):
    set_stop(client, shot, 4)
    seen = client.get(f"{shot}/edits/history")
    set_stop(client, shot, 8)
    refused(client.post(f"{shot}/edits/undo", headers=with_tag(seen)), 412, "changed_meanwhile")
    revision = seen.json()["steps"][0]["revision"]
    refused(client.put(f"{shot}/edits", json={"revision": revision}, headers=with_tag(seen)), 412, "changed_meanwhile")
    assert stop_of(client, shot) == 8


def test_going_back_to_a_revision_can_be_undone(client, shot):
    revision = client.get(shot).json()["revision"]
    set_stop(client, shot, 4)
    set_stop(client, shot, 8)
    assert client.put(f"{shot}/edits", json={"revision": revision}).json()["revision"] == revision
    assert stop_of(client, shot) == pytest.approx(1.4)
    client.post(f"{shot}/edits/undo")
    assert stop_of(client, shot) == 8


def test_one_request_and_one_drag_are_one_step(client, shot):
    client.patch(f"{shot}/camera", json={"lens": "planar_50", "fStop": 4, "focusDistanceM": 5})
    for f_stop in (5, 6, 7):
        set_stop(client, shot, f_stop, params={"gesture": "drag-1"})
    assert client.get(f"{shot}/edits/history").json()["now"] == 2
    client.post(f"{shot}/edits/undo")
    assert stop_of(client, shot) == 4
    client.post(f"{shot}/edits/undo")
    assert client.get(f"{shot}/readout", params={"time": 1}).json()["lensName"] == ""


def test_a_picture_follows_an_undo(client, shot):
    ask = {"time": 1, "width": 16, "height": 9, "rays": 1}
    before = client.get(f"{shot}/frame", params=ask)
    client.patch(f"{shot}/camera", json={"focalLengthMm": 20})
    edited = client.get(f"{shot}/frame", params=ask)
    client.post(f"{shot}/edits/undo")
    after = client.get(f"{shot}/frame", params=ask | {"seed": 1})
    assert before.content != edited.content
    assert after.content == client.get(f"{shot}/frame", params=ask | {"seed": 1}).content
    assert client.get(f"{shot}/frame", params=ask).headers["etag"] == before.headers["etag"]
    picked = client.post(f"{shot}/pick", json={"time": 1, "width": 16, "height": 9, "x": 12, "y": 2})
    assert picked.json()["hit"], "at 20 mm there would be nothing"


def test_history_outlives_the_service_and_its_damage_spares_edits(room_file, tmp_path):
    settings = Settings(data=tmp_path, demo=False)
    with running(settings) as first:
        shot_id = send(first.client, "room.usda", room_file.read_bytes()).json()["id"]
        shot = f"/v1/shots/{shot_id}"
        for f_stop in (4, 8, 16):
            set_stop(first.client, shot, f_stop)
        first.client.post(f"{shot}/edits/undo")
        history = first.client.get(f"{shot}/edits/history").json()
    folder = tmp_path / "shots" / shot_id / "edits"
    with running(settings) as second:
        assert second.client.get(f"{shot}/edits/history").json() == history
        second.client.post(f"{shot}/edits/undo")
        assert stop_of(second.client, shot) == 4
        second.client.post(f"{shot}/edits/redo")
    index = json.loads((folder / "history" / "index.json").read_text())
    (folder / "history" / f"{index['states'][0]['revision']}.usda").write_text("#usda 1.0\n")
    assert load_history(folder) is None
    with running(settings) as third:
        assert stop_of(third.client, shot) == 8
        assert third.client.get(f"{shot}/edits/history").json()["undo"] is None
        set_stop(third.client, shot, 11)
        third.client.post(f"{shot}/edits/undo")
        assert stop_of(third.client, shot) == 8
    assert load_history(folder).now == 0


def test_an_edit_that_cannot_be_saved_never_was(service, client, room, shot):
    set_stop(client, shot, 4)
    history = client.get(f"{shot}/edits/history").json()
    edits = service.settings.data / "shots" / room / "edits" / "edits.usda"
    kept = edits.read_bytes()
    edits.unlink()
    edits.mkdir()
    try:
        assert set_stop(client, shot, 8).status_code == 507
    finally:
        edits.rmdir()
        edits.write_bytes(kept)
    assert client.get(f"{shot}/edits/history").json() == history
    assert stop_of(client, shot) == 4
    set_stop(client, shot, 8)
    client.post(f"{shot}/edits/undo")
    assert stop_of(client, shot) == 4
