"""Access: every route says which scope it needs."""

from __future__ import annotations

import pytest

from tests.service.conftest import send
from tests.service.kits.calls import APP, CALLS, PUBLIC, scopes_of


@pytest.mark.parametrize(("method", "path", "call"), CALLS, ids=[f"{m} {p}" for m, p, _ in CALLS])
def test_every_route_declares_a_scope(method, path, call):
    needed = scopes_of(call)
    assert bool(needed) == (path not in PUBLIC)
    assert {"401", "403", "429"} <= set(call["responses"]) or not needed
    if method in ("put", "patch", "delete") and path not in PUBLIC:
        assert needed & {"edit", "render", "admin"}


def test_routes_beyond_the_document_are_the_page_and_its_help():
    paths = {getattr(route, "path", None) for route in APP.routes} - {None}
    assert paths == {"/", "/assets", "/docs", "/docs/style.css", "/openapi.json"}


def test_a_shot_is_stored_in_the_project_that_is_named(client, room_file):
    sent = send(client, "room.usda", room_file.read_bytes(), project="night-tram").json()
    assert sent["project"] == "night-tram"
    assert client.get(f"/v1/shots/{sent['id']}").json()["project"] == "night-tram"
    client.delete(f"/v1/shots/{sent['id']}")


def test_a_shot_without_a_project_is_in_the_default_one(client, room):
    assert client.get(f"/v1/shots/{room}").json()["project"] == "default"


@pytest.mark.parametrize("project", ["*", "a b", "../x", "A", ""])
def test_a_project_has_a_plain_name(client, room_file, project):
    answer = send(client, "room.usda", room_file.read_bytes(), project=project)
    assert answer.status_code == (201 if project == "" else 422)  # an empty field is one that is left out
    client.delete(f"/v1/shots/{answer.json().get('id', 'none')}")
