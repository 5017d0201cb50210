"""Requests with tokens of an issuer, to a service that runs."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Iterator

import httpx
import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

from render.errors import SettingsError
from service.http.exposure import with_exposure
from service.http.settings import Settings
from service.identity.tokens import LEEWAY_S
from tests.service.conftest import ROOM, Running, running, send
from tests.service.kits.issuer import TOKENS, Issuer, new_key, running_issuer

ROLES = ("focus pullers = artist @ night-tram", "guests = reader @ night-tram", "td = admin")
PULLER = {"realm_access": {"roles": ["focus pullers"]}, "preferred_username": "Mara"}


@pytest.fixture(scope="module")
def issuer() -> Iterator[Issuer]:
    with running_issuer() as issuer:
        yield issuer


@pytest.fixture(scope="module")
def service(issuer, tmp_path_factory) -> Iterator[Running]:
    settings = Settings(
        data=tmp_path_factory.mktemp("tokens"),
        demo=False,
        host="127.0.0.1",
        oidc_issuer=issuer.address,
        oidc_claim="realm_access.roles",
        oidc_roles=ROLES,
    )
    with running(with_exposure(settings)) as service:
        yield service


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


def test_a_client_gets_a_token_and_works_with_it(service, issuer, tmp_path):
    issuer.claims["previs"] = PULLER
    form = {"grant_type": "client_credentials", "client_id": "previs"}
    token = httpx.post(issuer.address + TOKENS, data=form).json()["access_token"]
    service.client.headers.update(bearer(token))
    try:
        sent = send(service.client, "room.usda", ROOM.encode())
        shot = sent.json()["id"]
        assert sent.status_code == 201
        assert service.client.patch(f"/v1/shots/{shot}/camera", json={"fStop": 8}).status_code == 200
        who = service.client.get("/v1/session").json()
        assert (who["label"], who["project"], set(who["scopes"])) == ("Mara", "night-tram", {"edit", "read", "render"})
        assert who["endsAt"] is not None
        assert service.client.get("/v1/keys").json()["code"] == "missing_scope"
    finally:
        del service.client.headers["Authorization"]
    guest = bearer(issuer.token(realm_access={"roles": ["guests"]}))
    assert service.client.get(f"/v1/shots/{shot}", headers=guest).status_code == 200
    assert service.client.delete(f"/v1/shots/{shot}", headers=guest).json()["code"] == "missing_scope"
    lines = (service.settings.data / "audit.jsonl").read_text().splitlines()
    assert {json.loads(line)["principal"] for line in lines} == {"oidc:mara"}


def test_a_service_with_an_issuer_lets_nobody_in_without(service):
    answer = service.client.get("/v1/shots")
    assert (answer.status_code, answer.json()["code"]) == (401, "unauthorized")


def test_a_wrong_token_is_refused_and_slowed_down(service, issuer):
    wrong = bearer(issuer.token(new_key("first"), **PULLER))
    answer = service.client.get("/v1/shots", headers=wrong)
    assert (answer.status_code, answer.json()["code"]) == (401, "unauthorized")
    assert 'error="invalid_token"' in answer.headers["WWW-Authenticate"]
    statuses = [service.client.get("/v1/shots", headers=wrong).status_code for _ in range(20)]
    assert statuses[-1] == 429
    assert service.client.get("/v1/shots", headers=bearer(issuer.token(**PULLER))).status_code == 200


def test_a_holder_without_a_role_is_told_so(service, issuer):
    answer = service.client.get("/v1/shots", headers=bearer(issuer.token(preferred_username="Ida")))
    assert (answer.status_code, answer.json()["code"]) == (403, "no_role")
    assert "Ida" in answer.json()["detail"]


def test_a_token_begins_no_session(service, issuer):
    answer = service.client.post("/v1/session", json={"key": issuer.token(**PULLER)})
    assert answer.status_code in (401, 422, 429)
    assert "set-cookie" not in answer.headers


def test_a_live_connection_ends_with_its_token(service, issuer):
    token = issuer.token(**PULLER)
    service.client.headers.update(bearer(token))
    shot = send(service.client, "room.usda", ROOM.encode()).json()["id"]
    del service.client.headers["Authorization"]
    ends_s = int(time.time()) - LEEWAY_S + 10

    async def watch() -> int:
        address = f"ws://127.0.0.1:{service.client.base_url.port}/v1/shots/{shot}/live"
        headers = bearer(issuer.token(**PULLER, exp=ends_s))
        async with connect(address, additional_headers=headers) as socket:
            with pytest.raises(ConnectionClosed) as closed:
                await asyncio.wait_for(socket.recv(), 30)
        return closed.value.rcvd.code

    assert asyncio.run(watch()) == 1008


def test_an_issuer_that_is_down_is_told_as_such(tmp_path):
    with running_issuer() as gone:
        token = gone.token(**PULLER)
    settings = Settings(data=tmp_path, demo=False, oidc_issuer=gone.address, oidc_roles=ROLES)
    with running(with_exposure(settings)) as service:
        answer = service.client.get("/v1/shots", headers=bearer(token))
        assert (answer.status_code, answer.json()["code"]) == (503, "issuer_unreachable")
        assert int(answer.headers["Retry-After"]) > 0
        assert service.client.get("/livez").status_code == 200


@pytest.mark.parametrize("host", ["0.0.0.0", "127.0.0.1"])
def test_an_issuer_is_as_good_as_keys(tmp_path, host):
    settings = Settings(data=tmp_path, host=host, oidc_issuer="https://login.example", oidc_roles=ROLES)
    assert with_exposure(settings).access == "keys"


def test_an_issuer_without_roles_is_a_mistake(tmp_path):
    with pytest.raises(SettingsError, match="oidc_roles"):
        with_exposure(Settings(data=tmp_path, oidc_issuer="https://login.example"))
