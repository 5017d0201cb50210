"""The trash over HTTP: shots are deleted as they were read, listed, restored and removed."""

from __future__ import annotations

import time

import pytest

from service.http.settings import Settings
from service.storage import trash
from tests.service.conftest import running, send, until


def trashed(client, shot: str) -> list[dict]:
    """The entries of a shot."""
    return [entry for entry in client.get("/v1/trash").json()["shots"] if entry["shot"] == shot]


def test_a_deleted_shot_is_restored_with_its_edits(client, room):
    assert client.patch(f"/v1/shots/{room}/camera", json={"fStop": 5.6}).status_code == 200
    before = client.get(f"/v1/shots/{room}/edits/history").json()
    assert client.delete(f"/v1/shots/{room}").status_code == 204
    (entry,) = trashed(client, room)
    restored = client.post(f"/v1/trash/{entry['id']}/restore")
    assert (restored.status_code, restored.json()["id"]) == (200, room)
    assert restored.headers["Location"] == f"/v1/shots/{room}"
    assert client.get(f"/v1/shots/{room}/edits/history").json() == before
    assert client.post(f"/v1/shots/{room}/edits/undo").status_code == 200
    readout = client.get(f"/v1/shots/{room}/readout", params={"time": 1}).json()
    assert readout["fStop"] == pytest.approx(1.4)
    assert trashed(client, room) == []


def test_a_shot_is_deleted_as_it_was_read(client, room):
    read = client.get(f"/v1/shots/{room}").headers["ETag"]
    assert client.patch(f"/v1/shots/{room}/camera", json={"fStop": 4}).status_code == 200
    refused = client.delete(f"/v1/shots/{room}", headers={"If-Match": read})
    assert (refused.status_code, refused.json()["code"]) == (412, "changed_meanwhile")
    assert trashed(client, room) == []
    now = client.get(f"/v1/shots/{room}/edits").headers["ETag"]
    assert client.delete(f"/v1/shots/{room}", headers={"If-Match": now}).status_code == 204


def test_a_deleted_shot_has_no_workers(service, client, room):
    assert client.get(f"/v1/shots/{room}/frame", params={"time": 1, "width": 16}).status_code == 200
    assert client.post(
        f"/v1/shots/{room}/long-exposure", json={"first": 1, "last": 5, "width": 96, "rays": 4}
    ).is_success
    assert client.delete(f"/v1/shots/{room}").status_code == 204
    until(lambda: room not in {worker.place.key for worker in service.internal.pool.processes()})
    assert client.get(f"/v1/shots/{room}/long-exposure").status_code == 404


def test_a_removed_shot_leaves_nothing(service, client, room):
    client.delete(f"/v1/shots/{room}")
    (entry,) = trashed(client, room)
    assert client.delete(f"/v1/trash/{entry['id']}").status_code == 204
    assert trashed(client, room) == []
    assert not (service.settings.data / "trash" / entry["id"]).exists()
    assert client.post(f"/v1/trash/{entry['id']}/restore").json()["code"] == "not_in_trash"
    assert client.delete(f"/v1/trash/{entry['id']}").status_code == 404


def test_the_demo_shot_comes_back_beside_its_trash(tmp_path):
    with running(Settings(data=tmp_path)) as service:
        assert service.client.delete("/v1/shots/demo").status_code == 204
    with running(Settings(data=tmp_path)) as service:
        assert [shot["id"] for shot in service.client.get("/v1/shots").json()["shots"]] == ["demo"]
        (entry,) = trashed(service.client, "demo")
        refused = service.client.post(f"/v1/trash/{entry['id']}/restore")
        assert (refused.status_code, refused.json()["code"]) == (409, "shot_exists")


def test_a_service_empties_its_trash(tmp_path, room_file, monkeypatch):
    monkeypatch.setattr(trash, "SETTLING_S", 0)
    settings = Settings(data=tmp_path, demo=False)
    with running(settings) as service:
        for name in ("old.usda", "new.usda"):
            shot = send(service.client, name, room_file.read_bytes()).json()["id"]
            assert service.client.delete(f"/v1/shots/{shot}").status_code == 204
    (old,) = (tmp_path / "trash").glob("old-*")
    long_ago = time.strftime("%Y%m%d%H%M%S000000", time.gmtime(time.time() - 31 * 86400))
    old.rename(old.with_name(f"{old.name.split('.')[0]}.{long_ago}"))
    with running(settings) as service:
        until(lambda: len(list((tmp_path / "trash").iterdir())) == 1)
        (kept,) = service.client.get("/v1/trash").json()["shots"]
        assert kept["name"] == "new.usda"


def test_without_days_a_shot_is_removed_at_once(tmp_path, room_file):
    with running(Settings(data=tmp_path, demo=False, trash_days=0)) as service:
        shot = send(service.client, "room.usda", room_file.read_bytes()).json()["id"]
        assert service.client.delete(f"/v1/shots/{shot}").status_code == 204
        assert service.client.get("/v1/trash").json() == {"shots": []}
        assert list((tmp_path / "trash").iterdir()) == []
