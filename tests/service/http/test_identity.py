"""A service that needs keys: who gets in, what they may do and see, and what is written down of it."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from service.http.settings import Settings
from service.identity.principal import SCOPES
from service.identity.sessions import SESSION_S
from tests.service.conftest import ROOM, Running, running, send, until
from tests.service.kits.calls import CALLS, PUBLIC, scopes_of

ORIGIN = "Origin"
WITH_BODY = [(method, path, call) for method, path, call in CALLS if "requestBody" in call and path not in PUBLIC]


@pytest.fixture(scope="module")
def locked(tmp_path_factory) -> Iterator[Running]:
    """A service that needs keys."""
    settings = Settings(data=tmp_path_factory.mktemp("locked"), demo=False, access="keys", requests_per_s=1000)
    with running(settings) as service:
        yield service


def key(service: Running, *scopes: str, project: str = "default") -> dict[str, str]:
    """Headers with a new key."""
    _, text = service.app.state.identity.keys.create("Mara", frozenset(scopes), project)
    return {"Authorization": f"Bearer {text}"}


@pytest.fixture(scope="module")
def admin(locked) -> dict[str, str]:
    return key(locked, *SCOPES, project="*")


def filled(path: str) -> str:
    """A path with a word for each parameter."""
    for name, word in (("shot", "none"), ("name", "none"), ("attribute", "weight"), ("key", "no"), ("trashed", "no")):
        path = path.replace(f"{{{name}}}", word)
    return path


@pytest.mark.parametrize(("method", "path", "call"), CALLS, ids=[f"{m} {p}" for m, p, _ in CALLS])
def test_each_route_needs_a_key_with_its_scope(locked, method, path, call):
    if path in PUBLIC:
        return
    answer = locked.client.request(method, filled(path))
    assert (answer.status_code, answer.json()["code"]) == (401, "unauthorized")
    assert answer.headers["WWW-Authenticate"].startswith("Bearer")
    needed = scopes_of(call)
    for missing in needed:
        held = SCOPES - {missing}
        answer = locked.client.request(
            method, filled(path), headers=key(locked, *held, project="*" if "admin" in held else "default")
        )
        assert (answer.status_code, answer.json()["code"]) == (403, "missing_scope"), missing


@pytest.mark.parametrize(
    ("method", "path", "call"), WITH_BODY, ids=[f"{method} {path}" for method, path, _ in WITH_BODY]
)
def test_no_body_is_received_from_a_sender_without_scopes(locked, method, path, call):
    assert status_without_body(locked, method, path, call, {}) == 401
    for missing in scopes_of(call):
        held = SCOPES - {missing}
        credentials = key(locked, *held, project="*" if "admin" in held else "default")
        assert status_without_body(locked, method, path, call, credentials) == 403, missing


@pytest.mark.parametrize(
    ("method", "path", "call"), [each for each in WITH_BODY if "{shot}" in each[1]], ids=lambda word: str(word)[:60]
)
def test_no_body_is_received_for_a_shot_that_nobody_sees(locked, method, path, call):
    for held in (key(locked, *SCOPES - {"admin"}), key(locked, *SCOPES, project="*")):
        assert status_without_body(locked, method, path, call, held) == 404


def status_without_body(locked: Running, method: str, path: str, call: dict, credentials: dict[str, str]) -> int:
    """The status of the answer to the head of a request."""
    kind = next(iter(call["requestBody"]["content"]))
    address = locked.client.base_url
    head = {"Host": address.netloc.decode(), "Content-Length": "1000", "Content-Type": kind} | credentials
    lines = "".join(f"{name}: {value}\r\n" for name, value in head.items())
    with socket.create_connection((address.host, address.port), timeout=10) as sender:
        sender.sendall(f"{method.upper()} {filled(path)} HTTP/1.1\r\n{lines}\r\n".encode())
        return int(sender.recv(100).split()[1])


@pytest.mark.gl
def test_a_long_exposure_ends_with_the_key_that_began_it(locked, admin):
    held, other = key(locked, "read", "edit", "render"), key(locked, "read", "render")
    shot = locked.client.post("/v1/shots", files={"file": ("room.usda", ROOM)}, headers=held).json()["id"]
    path = f"/v1/shots/{shot}/long-exposure"
    begin = {"first": 1, "last": 10_000, "width": 16, "rays": 1}
    assert locked.client.post(path, json=begin, headers=held, timeout=60).status_code == 201
    locked.app.state.identity.keys.revoke(held["Authorization"].split("_")[1])
    until(lambda: locked.client.get(path, headers=other).json()["shutter"] == "failed")
    assert "session has ended" in locked.client.get(path, headers=other).json()["problem"]
    assert locked.client.patch(path, json={"shutter": "open"}, headers=other).json()["shutter"] == "open"
    assert locked.client.delete(path, headers=other).status_code == 204
    assert locked.client.delete(f"/v1/shots/{shot}", headers=admin).status_code == 204


@pytest.mark.parametrize("path", ["/livez", "/version", "/docs", "/openapi.json", "/"])
def test_nothing_of_a_shot_is_public(locked, path):
    assert locked.client.get(path).status_code in (200, 503)


def test_a_wrong_key_is_refused_and_then_limited(locked):
    wrong = {"Authorization": f"Bearer pf_{'0' * 12}_{'x' * 43}"}
    answers = [locked.client.get("/v1/shots", headers=wrong) for _ in range(30)]
    assert {answer.status_code for answer in answers} == {401, 429}
    assert answers[0].status_code == 401
    assert int(answers[-1].headers["Retry-After"]) > 0
    # Nobody is locked out by another's attempts from the same address.
    assert locked.client.get("/v1/shots", headers=key(locked, "read")).status_code == 200


def test_requests_are_limited_for_each_key(tmp_path):
    with running(Settings(data=tmp_path, demo=False, access="keys", requests_per_s=1)) as service:
        busy, other = key(service, "read"), key(service, "read")
        statuses = [service.client.get("/v1/shots", headers=busy).status_code for _ in range(12)]
        assert statuses[:10] == [200] * 10
        refused = service.client.get("/v1/shots", headers=busy)
        assert (refused.status_code, refused.json()["code"]) == (429, "too_many_requests")
        assert service.client.get("/v1/shots", headers=other).status_code == 200


def test_a_limit_below_one_request_in_ten_seconds_lets_one_in(tmp_path):
    with running(Settings(data=tmp_path, demo=False, access="keys", requests_per_s=0.01)) as service:
        rare = key(service, "read")
        statuses = [service.client.get("/v1/shots", headers=rare).status_code for _ in range(2)]
        assert statuses == [200, 429]


def test_a_project_s_shots_are_unknown_to_others(locked, admin, room_file):
    mine = key(locked, "read", "edit", "render", project="tram")
    theirs = key(locked, "read", "edit", "render", project="other")
    post = {"files": {"file": ("room.usda", room_file.read_bytes())}}
    sent = locked.client.post("/v1/shots", headers=mine, **post).json()
    assert sent["project"] == "tram"
    seen = {
        name: locked.client.get("/v1/shots", headers=headers).json()
        for name, headers in (("mine", mine), ("theirs", theirs), ("admin", admin))
    }
    assert {name: [shot["id"] for shot in shots["shots"]] for name, shots in seen.items()} == {
        "mine": [sent["id"]],
        "theirs": [],
        "admin": [sent["id"]],
    }
    unknown = locked.client.get("/v1/shots/none", headers=theirs).json()
    for method, path, _ in CALLS:
        if "{shot}" not in path:
            continue
        here = filled(path.replace("{shot}", sent["id"]))
        answer = locked.client.request(method, here, headers=theirs)
        assert answer.status_code == 404, here
        assert answer.text.replace(sent["id"], "none") == json.dumps(unknown, separators=(",", ":"))
    foreign = locked.client.post("/v1/shots", headers=theirs, data={"project": "tram"}, **post)
    assert (foreign.status_code, foreign.json()["code"]) == (403, "foreign_project")
    assert locked.client.get(f"/v1/shots/{sent['id']}", headers=mine).status_code == 200
    assert locked.client.delete(f"/v1/shots/{sent['id']}", headers=admin).status_code == 204


def test_a_project_s_trash_is_unknown_to_others(locked, room_file):
    mine = key(locked, "read", "edit", project="tram")
    theirs = key(locked, "read", "edit", project="other")
    sent = locked.client.post("/v1/shots", headers=mine, files={"file": ("room.usda", room_file.read_bytes())}).json()
    assert locked.client.delete(f"/v1/shots/{sent['id']}", headers=mine).status_code == 204
    (entry,) = [
        one for one in locked.client.get("/v1/trash", headers=mine).json()["shots"] if one["shot"] == sent["id"]
    ]
    assert locked.client.get("/v1/trash", headers=theirs).json() == {"shots": []}
    for method, at in (("POST", f"/v1/trash/{entry['id']}/restore"), ("DELETE", f"/v1/trash/{entry['id']}")):
        answer = locked.client.request(method, at, headers=theirs)
        assert (answer.status_code, answer.json()["code"]) == (404, "not_in_trash")
    assert locked.client.post(f"/v1/trash/{entry['id']}/restore", headers=mine).status_code == 200
    assert locked.client.delete(f"/v1/shots/{sent['id']}", headers=mine).status_code == 204


def watch(service: Running, shot: str, headers: dict[str, str]) -> int:
    """Status of the handshake of live pictures."""
    url = str(service.client.base_url).replace("http", "ws")
    try:
        with connect(f"{url}/v1/shots/{shot}/live", additional_headers=headers):
            return 101
    except InvalidStatus as error:
        return error.response.status_code


def test_live_pictures_need_a_key_with_its_scope(locked):
    assert watch(locked, "none", {}) == 401
    assert watch(locked, "none", key(locked, "read", "edit")) == 403
    assert watch(locked, "none", key(locked, "render")) == 404
    assert (
        watch(locked, "none", key(locked, *SCOPES, project="*")) == 101
    )  # its first message would tell that there is no shot


def test_the_page_signs_in_and_out(locked, room_file):
    url = str(locked.client.base_url).rstrip("/")
    with httpx.Client(base_url=url, headers={ORIGIN: url}, timeout=60) as page:
        assert page.get("/v1/session").status_code == 401
        assert page.post("/v1/session", json={"key": "pf_wrong"}).status_code in (401, 429)
        text = key(locked, "read", "edit")["Authorization"].split()[1]
        signed_in = page.post("/v1/session", json={"key": text})
        cookie = signed_in.headers["Set-Cookie"].lower()
        assert "httponly" in cookie
        assert "samesite=strict" in cookie
        assert text.lower() not in cookie
        assert page.get("/v1/session").json()["label"] == "Mara"
        assert page.get("/v1/shots").status_code == 200
        sent = send(page, "room.usda", room_file.read_bytes())
        assert sent.status_code == 201
        # A cookie without an Origin, or with a foreign one, changes nothing.
        shot = f"/v1/shots/{sent.json()['id']}"
        cookies = {"Cookie": f"pullfocus_session={page.cookies['pullfocus_session']}"}
        assert httpx.delete(url + shot, headers=cookies).json()["code"] == "cross_site"
        assert page.delete(shot, headers={ORIGIN: "https://evil.example"}).json()["code"] == "cross_site"
        assert page.delete(shot).status_code == 204
        assert page.delete("/v1/session").status_code == 204
        assert httpx.get(f"{url}/v1/shots", headers=cookies).status_code == 401


def test_a_session_ends_with_its_key(locked):
    held = key(locked, "read")
    text = held["Authorization"].split()[1]
    url = str(locked.client.base_url).rstrip("/")
    with httpx.Client(base_url=url, headers={ORIGIN: url}) as page:
        page.post("/v1/session", json={"key": text})
        assert page.get("/v1/shots").status_code == 200
        locked.app.state.identity.keys.revoke(text.split("_")[1])
        assert page.get("/v1/shots").status_code == 401


def test_one_is_told_when_session_and_key_end(locked):
    held, now = key(locked, "read"), datetime.now(UTC)
    keys = locked.app.state.identity.keys
    brief, text = keys.create("Brief", frozenset({"read"}), "default", now + timedelta(hours=1))
    assert locked.client.get("/v1/session", headers=held).json()["endsAt"] is None
    told = locked.client.get("/v1/session", headers={"Authorization": f"Bearer {text}"}).json()
    assert datetime.fromisoformat(told["endsAt"]) == datetime.fromisoformat(brief.expires_at)
    url = str(locked.client.base_url).rstrip("/")
    for sent, hours in ((text, 1), (held["Authorization"].split()[1], SESSION_S / 3600)):
        with httpx.Client(base_url=url, headers={ORIGIN: url}) as page:
            for told in (page.post("/v1/session", json={"key": sent}), page.get("/v1/session")):
                ends_at = datetime.fromisoformat(told.json()["endsAt"])
                assert abs(ends_at - now - timedelta(hours=hours)) < timedelta(minutes=2)


def test_administrators_manage_keys(locked, admin):
    made = locked.client.post("/v1/keys", headers=admin, json={"label": "Ada", "roles": ["artist"], "days": 1}).json()
    held = {"Authorization": f"Bearer {made['key']}"}
    assert locked.client.get("/v1/shots", headers=held).status_code == 200
    listed = locked.client.get("/v1/keys", headers=admin)
    assert made["key"] not in listed.text
    assert made["id"] in [entry["id"] for entry in listed.json()["keys"]]
    assert locked.client.post("/v1/keys", headers=admin, json={"label": "x", "roles": ["king"]}).status_code == 422
    assert locked.client.delete(f"/v1/keys/{made['id']}", headers=admin).status_code == 204
    assert locked.client.get("/v1/shots", headers=held).status_code in (401, 429)  # 429: after many wrong keys
    assert locked.client.delete(f"/v1/keys/{made['id']}", headers=admin).status_code == 404


def test_the_audit_log_says_who_what_and_from_where(tmp_path):
    with running(Settings(data=tmp_path, demo=False, access="keys")) as service:
        held = key(service, "read", "edit")
        service.client.get("/v1/shots", headers=held)
        service.client.delete("/v1/shots/night", headers=held)
        answer = service.client.get("/v1/shots")
        service.client.get("/v1/shots", headers={"Host": "evil.example"})
        watch(service, "none", {})
    text = (tmp_path / "audit.jsonl").read_text() + (tmp_path / "audit-refused.jsonl").read_text()
    lines = [json.loads(line) for line in text.splitlines()]
    key_id = held["Authorization"].split("_")[1]
    assert [(line["principal"], line["method"], line["path"], line["status"]) for line in lines] == [
        (f"key:{key_id}", "DELETE", "/v1/shots/night", 404),
        ("nobody", "GET", "/v1/shots", 401),
        ("nobody", "GET", "/v1/shots", 421),
        ("nobody", "WEBSOCKET", "/v1/shots/none/live", 401),
    ]
    assert lines[1]["request"] == answer.headers["X-Request-ID"]
    assert {line["address"] for line in lines} == {"127.0.0.1"}
    assert held["Authorization"].split("_", 2)[2] not in text


def test_a_key_names_its_sender_also_where_none_is_needed(service):
    held = key(service, "read")
    assert service.client.get("/v1/session").json()["id"] == "anyone"
    assert service.client.get("/v1/session", headers=held).json()["label"] == "Mara"
    assert service.client.post("/v1/shots", headers=held).status_code == 403


def test_refused_requests_push_no_line_out_of_the_audit_log(tmp_path):
    with running(Settings(data=tmp_path, demo=False, access="keys")) as service:
        service.client.delete("/v1/shots/night", headers=key(service, "read", "edit"))
        for _ in range(5):
            service.client.get("/v1/" + "x" * 3000)
    (accepted,) = map(json.loads, (tmp_path / "audit.jsonl").read_text().splitlines())
    assert accepted["method"] == "DELETE"
    refused = [json.loads(line) for line in (tmp_path / "audit-refused.jsonl").read_text().splitlines()]
    assert {len(line["path"]) for line in refused} == {500}


@pytest.mark.parametrize("by", ["key", "session", "sign-out"])
def test_a_socket_is_closed_when_its_key_or_session_ends(locked, by):
    held = key(locked, "render", project="*")
    text = held["Authorization"].split()[1]
    url = str(locked.client.base_url).rstrip("/")
    with httpx.Client(base_url=url, headers={ORIGIN: url}, timeout=60) as page:
        if by != "key":
            page.post("/v1/session", json={"key": text})
            held = {"Cookie": f"pullfocus_session={page.cookies['pullfocus_session']}", ORIGIN: url}
        with connect(f"{url.replace('http', 'ws')}/v1/shots/none/live", additional_headers=held) as socket:
            with pytest.raises(TimeoutError):
                socket.recv(1.5)
            if by == "sign-out":
                assert page.delete("/v1/session").status_code == 204
            else:
                locked.app.state.identity.keys.revoke(text.split("_")[1])
            with pytest.raises(ConnectionClosed) as closed:
                socket.recv(5)
    assert closed.value.rcvd.code == 1008
    assert "sign in again" in closed.value.rcvd.reason
