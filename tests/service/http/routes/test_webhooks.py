"""Webhooks over REST: who may have which, what is shown of them, tests, and deliveries of a service that starts again."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest

from service.http.access import principal_of
from service.http.settings import Settings
from service.identity.principal import SCOPES, Principal
from service.storage.events import NewEvent
from tests.service.conftest import Running, running, until
from tests.service.kits.receivers import Receiver, receiving

UNKNOWN = "/v1/webhooks/w-000000000000"


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with receiving() as receiver:
        yield receiver


@pytest.fixture
def open_service(tmp_path) -> Iterator[Running]:
    with running(Settings(data=tmp_path, demo=False)) as service:
        yield service


def key_of(service: Running, scopes: frozenset[str]) -> dict[str, str]:
    """The headers of somebody with a new key."""
    _, key = service.app.state.identity.keys.create("Mara", scopes, "*")
    return {"Authorization": f"Bearer {key}"}


@pytest.fixture
def keyed(tmp_path) -> Iterator[Running]:
    """A service that needs keys."""
    with running(Settings(data=tmp_path, demo=False, access="keys")) as service:
        yield service


def note(service: Running, project: str = "default", **fields) -> int:
    """Add an event; its number."""
    service.internal.events.note(NewEvent("shots", "shot-added", project, **fields))
    return service.internal.events.newest()


def shown(client: httpx.Client) -> list[dict]:
    return client.get("/v1/webhooks").json()["webhooks"]


def made(client: httpx.Client, url: str, **fields) -> dict:
    answer = client.post("/v1/webhooks", json={"url": url} | fields)
    assert answer.status_code == 201, answer.text
    return answer.json()


def test_a_webhook_gets_events_and_shows_its_secret_once(open_service, receiver):
    client = open_service.client
    webhook = made(client, receiver.url, topics=["shots", "shots"])
    secret = webhook.pop("secret")
    assert secret.startswith("whsec_")
    assert len(secret) > 40
    assert (webhook["topics"], webhook["after"], webhook["project"]) == (["shots"], 0, None)
    assert shown(client) == [webhook]
    number = note(open_service, shot="demo")
    until(lambda: shown(client)[0]["lastStatus"] == 200)
    (delivery,) = receiver.deliveries
    assert (delivery.name, delivery.json["shot"]) == (f"{webhook['id']}-{number}", "demo")
    assert delivery.is_signed(secret)
    assert shown(client)[0]["after"] == number
    assert secret not in client.get("/v1/webhooks").text
    assert 'pullfocus_webhook_deliveries_total{outcome="delivered"} 1.0' in client.get("/metrics").text


def test_a_service_that_starts_again_goes_on(tmp_path, receiver):
    settings = Settings(data=tmp_path, demo=False)
    with running(settings) as service:
        webhook = made(service.client, receiver.url, secret="s" * 16)
        note(service)
        until(lambda: shown(service.client)[0]["after"] == 1)
        service.client.delete(f"/v1/webhooks/{made(service.client, receiver.url)['id']}")
    with running(settings) as service:
        note(service)
        until(lambda: shown(service.client)[0]["after"] == 2)
    assert receiver.names == [f"{webhook['id']}-1", f"{webhook['id']}-2"]
    assert all(one.is_signed("s" * 16) for one in receiver.deliveries)


def test_a_test_tells_what_the_receiver_answers(open_service, receiver):
    client = open_service.client
    webhook = made(client, receiver.url)
    address = f"/v1/webhooks/{webhook['id']}/test"
    assert client.post(address).json() == {"status": 200, "text": "ok", "error": None}
    (delivery,) = receiver.deliveries
    assert (delivery.kind, delivery.json["webhook"]) == ("test", webhook["id"])
    assert delivery.is_signed(webhook["secret"])
    receiver.statuses = [500]
    answer = client.post(address).json()
    assert answer == {"status": 500, "text": "ok", "error": "the receiver answered with status 500"}
    assert len(set(receiver.names)) == 2
    assert shown(client)[0]["failures"] == 0  # a test is no delivery


def test_a_webhook_that_was_disabled_is_enabled_again(open_service, receiver):
    client = open_service.client
    receiver.statuses = [410, 200]
    webhook = made(client, receiver.url)
    number = note(open_service)
    until(lambda: shown(client)[0]["disabled"] is not None)
    assert shown(client)[0] | {"nextTryAt": None} == shown(client)[0]
    enabled = client.post(f"/v1/webhooks/{webhook['id']}/enable").json()
    assert (enabled["disabled"], enabled["failures"], enabled["lastStatus"]) == (None, 0, 410)
    until(lambda: shown(client)[0]["after"] == number)
    assert len(receiver.deliveries) == 2


def test_a_webhook_gets_events_of_the_project_that_is_named(open_service, receiver):
    webhook = made(open_service.client, receiver.url, project="tram")
    note(open_service, "other")
    note(open_service, "tram")
    until(lambda: shown(open_service.client)[0]["after"] == 2)
    assert receiver.names == [f"{webhook['id']}-2"]


def test_who_sees_one_project_has_its_webhooks_alone(open_service, receiver):
    client, overrides = open_service.client, open_service.app.dependency_overrides
    anybodys = made(client, receiver.url)
    overrides[principal_of] = lambda: Principal("key:1", "Mara", SCOPES, "tram")  # no key administers one project yet
    trams = made(client, receiver.url, project="other")
    assert (anybodys["project"], trams["project"]) == (None, "tram")
    assert [one["id"] for one in shown(client)] == [trams["id"]]
    for method, last in (("DELETE", ""), ("POST", "/test"), ("POST", "/enable")):
        for address in (f"/v1/webhooks/{anybodys['id']}", UNKNOWN):
            refused = client.request(method, address + last)
            assert (refused.status_code, refused.json()["code"]) == (404, "webhook_not_found")
    assert client.delete(f"/v1/webhooks/{trams['id']}").status_code == 204
    overrides.clear()
    assert [one["id"] for one in shown(client)] == [anybodys["id"]]


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/v1/webhooks"),
        ("POST", "/v1/webhooks"),
        ("DELETE", UNKNOWN),
        ("POST", f"{UNKNOWN}/test"),
        ("POST", f"{UNKNOWN}/enable"),
    ],
)
def test_webhooks_need_the_scope_admin(keyed, method, path):
    headers = key_of(keyed, SCOPES - {"admin"})
    refused = keyed.client.request(method, path, json={} if path == "/v1/webhooks" else None, headers=headers)
    assert (refused.status_code, refused.json()["code"]) == (403, "missing_scope")


def test_a_service_that_needs_keys_reaches_nothing_private(keyed, receiver):
    keyed.client.headers.update(key_of(keyed, SCOPES))
    webhook = made(keyed.client, receiver.url)
    answer = keyed.client.post(f"/v1/webhooks/{webhook['id']}/test").json()
    assert (answer["status"], "127.0.0.1 is this machine" in answer["error"]) == (None, True)
    assert receiver.deliveries == []


def test_a_service_may_be_let_reach_what_is_private(tmp_path, receiver):
    with running(Settings(data=tmp_path, demo=False, access="keys", webhook_private=True)) as service:
        service.client.headers.update(key_of(service, SCOPES))
        webhook = made(service.client, receiver.url)
        assert service.client.post(f"/v1/webhooks/{webhook['id']}/test").json()["status"] == 200


def test_a_service_takes_no_deliveries_itself(open_service):
    client = open_service.client
    webhook = made(client, str(client.base_url.join("/v1/shots/demo/edits/undo")))
    answer = client.post(f"/v1/webhooks/{webhook['id']}/test").json()
    assert answer["status"] == 403
    assert "own_delivery" in answer["text"]


@pytest.mark.parametrize(
    ("fields", "path"),
    [
        ({"url": "ftp://studio.example"}, "url"),
        ({"url": "http://mara:word@studio.example"}, "url"),
        ({"url": "https://studio.example/" + "a" * 2000}, "body.url"),
        ({"topics": ["all"]}, "body.topics.0"),
        ({"secret": "short"}, "body.secret"),
        ({"secret": "s" * 16 + "\n"}, "body.secret"),
        ({"owner": "mara"}, "body.owner"),
    ],
)
def test_a_webhook_that_cannot_be_is_refused(client, fields, path):
    refused = client.post("/v1/webhooks", json={"url": "https://studio.example/"} | fields)
    assert (refused.status_code, refused.json()["path"]) == (422, path)


def test_a_service_has_so_many_webhooks(open_service, monkeypatch):
    monkeypatch.setattr("service.storage.webhooks.MOST_WEBHOOKS", 1)
    made(open_service.client, "http://127.0.0.1:1/")
    refused = open_service.client.post("/v1/webhooks", json={"url": "http://127.0.0.1:1/"})
    assert (refused.status_code, refused.json()["code"]) == (409, "too_many_webhooks")
