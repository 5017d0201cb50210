"""Notes at frames over REST: written by edits, kept in the shot."""

from __future__ import annotations

import pytest

from service.http.settings import Settings
from tests.service.conftest import running, send

STROKE = {"points": [[0.25, 0.5], [1, 0]], "colour": "red", "width": 0.01}


@pytest.fixture
def shot(client, room) -> str:
    return f"/v1/shots/{room}"


def edit(client, shot, *changes, **ask):
    return client.post(f"{shot}/edits", json={"changes": changes}, **ask)


def add(client, shot, **note):
    answer = edit(client, shot, {"type": "addNote", "note": {"time": 1, **note}})
    assert answer.status_code == 200, answer.text
    return answer.json()


def notes(client, shot, **params):
    answer = client.get(f"{shot}/notes", params=params)
    assert answer.status_code == 200, answer.text
    return answer.json()["notes"]


def test_a_note_is_added_edited_deleted_and_undone(client, shot):
    added = add(client, shot, text="hold", strokes=[STROKE])
    (note_id,) = added["notes"]
    assert {change["resource"] for change in added["changed"]} == {"notes", f"notes/{note_id}"}
    (note,) = notes(client, shot)
    assert note.pop("created") == note.pop("modified")
    assert {change["resource"]: change["etag"] for change in added["changed"]}[f"notes/{note_id}"] == note["etag"]
    assert note == {
        "etag": note["etag"],
        "id": note_id,
        "time": 1,
        "camera": None,
        "text": "hold",
        "strokes": [STROKE],
        "author": "",
        "resolved": False,
    }
    assert edit(client, shot, {"type": "editNote", "id": note_id, "values": {"resolved": True}}).status_code == 200
    assert notes(client, shot)[0]["resolved"]
    assert "hold" in client.get(f"{shot}/edits").text
    assert edit(client, shot, {"type": "deleteNote", "id": note_id}).status_code == 200
    assert notes(client, shot) == []
    assert client.post(f"{shot}/edits/undo").status_code == 200
    assert notes(client, shot)[0]["resolved"]


def test_notes_of_a_downloaded_layer_are_in_a_new_shot(client, shot):
    add(client, shot, text="hold", strokes=[STROKE])
    (before,) = notes(client, shot)
    layer = client.get(f"{shot}/edits").text
    sent = send(client, "noted.usda", f'{layer}\ndef Sphere "ball"\n{{\n}}\n'.encode())
    assert sent.status_code == 201, sent.text
    (after,) = notes(client, f"/v1/shots/{sent.json()['id']}")
    assert after | {"etag": before["etag"]} == before


def test_notes_are_listed_by_time_and_camera(client, shot):
    camera = client.get(shot).json()["cameras"][0]
    add(client, shot, time=5, text="last")
    add(client, shot, time=2, text="first", camera=camera)
    assert [note["text"] for note in notes(client, shot)] == ["first", "last"]
    assert [note["text"] for note in notes(client, shot, first=3, last=5)] == ["last"]
    assert [note["text"] for note in notes(client, shot, camera="/other")] == ["last"]


@pytest.mark.parametrize(
    ("note", "status", "says"),
    [
        ({"text": "a\u0000b"}, 422, "control characters"),
        ({"text": "x" * 2_001}, 422, "2000"),
        ({}, 422, "neither text nor a drawing"),
        ({"text": "x", "camera": "/none"}, 422, "no camera"),
        ({"text": "x", "id": "../a"}, 422, "id"),
        ({"strokes": [STROKE | {"colour": "beige"}]}, 422, "colour"),
        ({"strokes": [STROKE | {"points": [[0, 2]]}]}, 422, "points"),
        ({"strokes": [STROKE | {"points": [[0, 0]] * 4_001}]}, 422, "4000"),
        ({"strokes": [STROKE | {"points": [[0, 0]] * 3_000}] * 2}, 422, "4,000 points"),
        ({"strokes": [STROKE] * 101}, 422, "100"),
    ],
)
def test_bad_notes_are_refused_over_rest(client, shot, note, status, says):
    answer = edit(client, shot, {"type": "addNote", "note": {"time": 1, **note}})
    assert answer.status_code == status
    assert says in answer.text
    assert notes(client, shot) == []


def test_numbers_that_are_none_are_refused(client, shot):
    body = '{"changes": [{"type": "addNote", "note": {"time": NaN, "text": "x"}}]}'
    answer = client.post(f"{shot}/edits", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code == 422
    points = ",".join(["[0,0]"] * 200_000)
    body = f'{{"changes": [{{"type": "addNote", "note": {{"time": 1, "strokes": [{{"points": [{points}]}}]}}}}]}}'
    answer = client.post(f"{shot}/edits", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code == 422


def test_two_editors_of_a_note_do_not_overwrite(client, shot):
    added = add(client, shot, text="hold")
    (note_id,) = added["notes"]
    tag = next(change["etag"] for change in added["changed"] if change["resource"] == f"notes/{note_id}")
    change = {"type": "editNote", "id": note_id, "values": {"text": "mine"}}
    assert edit(client, shot, change, headers={"If-Match": tag}).status_code == 200
    second = edit(client, shot, change, headers={"If-Match": tag})
    assert (second.status_code, second.json()["code"]) == (412, "changed_meanwhile")
    missing = edit(client, shot, {"type": "deleteNote", "id": "other"})
    assert (missing.status_code, missing.json()["code"]) == (404, "note_not_found")


def test_the_history_tells_whether_notes_have_changed(client, shot):
    def tag() -> str:
        tags = {client.get(f"{shot}/{name}").json()["notesTag"] for name in ("edits/history", "notes")}
        assert len(tags) == 1
        return tags.pop()

    none = tag()
    added = add(client, shot, text="hold")
    one = tag()
    assert added["history"]["notesTag"] == one != none
    answer = edit(client, shot, {"type": "setCamera", "values": {"fStop": 4}})
    assert answer.json()["history"]["notesTag"] == tag() == one
    edit(client, shot, {"type": "editNote", "id": added["notes"][0], "values": {"resolved": True}})
    assert tag() not in (none, one)
    client.post(f"{shot}/edits/undo")
    assert tag() == one
    client.post(f"{shot}/edits/undo")
    assert tag() == one
    assert client.post(f"{shot}/edits/undo").json()["notesTag"] == tag() == none


def test_the_author_is_whoever_sent_the_note(room_file, tmp_path):
    with running(Settings(data=tmp_path, demo=False, access="keys", requests_per_s=1000)) as locked:
        _, text = locked.app.state.identity.keys.create("Mara", frozenset({"read", "edit"}), "default")
        locked.client.headers["Authorization"] = f"Bearer {text}"
        shot = f"/v1/shots/{send(locked.client, 'room.usda', room_file.read_bytes()).json()['id']}"
        add(locked.client, shot, text="hold")
        assert [note["author"] for note in notes(locked.client, shot)] == ["Mara"]
