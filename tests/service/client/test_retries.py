"""Requests of the client: what is sent again, and what errors say."""

from __future__ import annotations

import json

import httpx
import pytest

from service.client import AnswerError, Client, ConnectionFailedError, RefusedError, Retries, SettingError
from service.client.steps import Answer, Call, Exchange, Pause, perform
from tests.service.client.fake import RENDER, in_turn

DONE = httpx.Response(201, json=RENDER)
BUSY = httpx.Response(503, json={"code": "queue_full", "detail": "Too many requests wait."})
LOST = httpx.ReadError("the connection broke")
UNREACHED = httpx.ConnectError("nobody listens")


def pauses(*answers: httpx.Response, retries: Retries) -> list[float]:
    """Pauses between the tries of a request that gets some answers in turn."""
    steps, found = perform(Call("GET", "/livez"), retries), []
    step, waiting = next(steps), iter(answers)
    try:
        while True:
            if isinstance(step, Pause):
                found.append(step.seconds)
                step = steps.send(None)
            else:
                assert isinstance(step, Exchange)
                answer = next(waiting)
                step = steps.send(Answer(answer.status_code, answer.headers, answer.content))
    except StopIteration:
        return found


def test_pauses_double_up_to_a_bound():
    retries = Retries(tries=6, first_s=1, longest_s=5)
    found = pauses(*[BUSY] * 5, httpx.Response(200), retries=retries)
    assert [0.75 * most <= pause <= most for pause, most in zip(found, (1, 2, 4, 5, 5), strict=True)] == [True] * 5


@pytest.mark.parametrize(
    ("asked", "seconds"), [("7", 7.0), ("Fri, 27 Nov 2026 08:00:09 GMT", 9.0), ("soon", 0.0), ("-3", 0.0)]
)
def test_the_pause_that_is_asked_for_is_kept(asked, seconds):
    headers = {"Retry-After": asked, "Date": "Fri, 27 Nov 2026 08:00:00 GMT"}
    answers = httpx.Response(429, headers=headers), httpx.Response(200)
    assert pauses(*answers, retries=Retries(first_s=0)) == [seconds]


def test_hours_are_not_waited_for():
    quota = {"code": "quota_cpu", "detail": "The processor time of the day is used up."}
    service = in_turn(httpx.Response(429, json=quota, headers={"Retry-After": "7200"}))
    with service.client() as client, pytest.raises(RefusedError, match="processor time") as refused:
        client.shots()
    assert (refused.value.status, refused.value.code) == (429, "quota_cpu")


def test_a_render_is_sent_again_under_the_same_key():
    service = in_turn(UNREACHED, LOST, DONE)
    with service.client() as client:
        assert client.render("demo", frames="1-2", motion_by="velocities").id == "r-1"
    keys = {request.headers["Idempotency-Key"] for request in service.requests}
    assert len(service.requests) == 3
    assert len(keys) == 1
    assert {request.content for request in service.requests} == {service.requests[0].content}
    assert json.loads(service.requests[0].content) == {"shot": "demo", "frames": "1-2", "motionBy": "velocities"}


def test_two_renders_have_keys_of_their_own():
    service = in_turn(DONE, DONE, DONE)
    with service.client() as client:
        for key in (None, None, "dailies"):
            client.render("demo", idempotency_key=key)
    keys = [request.headers["Idempotency-Key"] for request in service.requests]
    assert len(set(keys)) == 3
    assert keys[2] == "dailies"


def test_an_action_without_an_answer_is_not_sent_again():
    service = in_turn(LOST)
    with service.client() as client, pytest.raises(ConnectionFailedError, match="may have been carried out"):
        client.pause("r-1")
    assert service.sent == ["POST /v1/renders/r-1/pause"]


@pytest.mark.parametrize("failure", [UNREACHED, BUSY])
def test_an_action_that_was_not_begun_is_sent_again(failure):
    service = in_turn(failure, DONE)
    with service.client() as client:
        client.pause("r-1")
    assert len(service.requests) == 2


def test_an_upload_is_whole_when_it_is_sent_again(tmp_path):
    file = tmp_path / "room.usda"
    file.write_text("#usda 1.0")
    service = in_turn(BUSY, BUSY, httpx.Response(422, json={"code": "stage_unreadable", "detail": "No."}))
    with service.client() as client, pytest.raises(RefusedError, match="No"):
        client.push(file)
    assert [b"#usda 1.0" in request.content for request in service.requests] == [True] * 3


def test_an_upload_without_an_answer_is_not_sent_again(tmp_path):
    (tmp_path / "room.usda").write_text("#usda 1.0")
    service = in_turn(LOST)
    with service.client() as client, pytest.raises(ConnectionFailedError):
        client.push(tmp_path / "room.usda")
    assert len(service.requests) == 1


def test_a_removal_whose_answer_was_lost_is_done():
    gone = httpx.Response(404, json={"code": "render_not_found", "detail": "There is none."})
    with in_turn(LOST, gone).client() as client:
        client.remove("r-1")
    with in_turn(gone).client() as client, pytest.raises(RefusedError, match="none"):
        client.remove("r-1")


def test_tries_come_to_an_end():
    service = in_turn(*[BUSY] * 3)
    with service.client() as client, pytest.raises(RefusedError, match="Too many requests wait"):
        client.shots()
    service = in_turn(*[UNREACHED] * 3)
    with service.client() as client, pytest.raises(ConnectionFailedError, match="nobody listens"):
        client.shots()


def test_a_problem_has_all_that_the_service_says():
    findings = [{"path": "body.rays", "detail": "must be 1 or more"}]
    problem = {"code": "invalid_request", "detail": "body.rays: no", "path": "body.rays", "errors": findings, "new": 1}
    with in_turn(httpx.Response(422, json=problem)).client() as client, pytest.raises(RefusedError) as refused:
        client.plan("demo", rays=0)
    error = refused.value
    assert (error.status, error.code, error.path, str(error)) == (422, "invalid_request", "body.rays", "body.rays: no")
    assert [(finding.path, finding.detail) for finding in error.errors] == [("body.rays", "must be 1 or more")]


def test_the_page_of_a_proxy_is_an_error_too():
    with in_turn(httpx.Response(418, text="<html>")).client() as client, pytest.raises(RefusedError) as refused:
        client.shots()
    assert (refused.value.code, refused.value.status) == ("http_418", 418)


@pytest.mark.parametrize("content", [b"<html>", b"[]", b'{"shots": 1}', b'{"shots": [{}]}', b"[" * 100_000])
def test_an_answer_of_something_else_is_one_error(content):
    with in_turn(httpx.Response(200, content=content)).client() as client, pytest.raises(AnswerError, match="ShotList"):
        client.shots()


def test_a_redirect_is_not_followed():
    service = in_turn(httpx.Response(307, headers={"Location": "https://elsewhere.example/v1/shots"}))
    with service.client(key="secret") as client, pytest.raises(AnswerError, match=r"elsewhere\.example"):
        client.shots()
    assert len(service.requests) == 1


def test_a_compressed_answer_is_refused():
    packed = httpx.Response(200, headers={"Content-Encoding": "gzip"}, stream=httpx.ByteStream(b"\x1f\x8b"))
    with in_turn(packed).client() as client, pytest.raises(AnswerError, match="compressed"):
        client.shots()


def test_the_key_goes_with_every_request_and_is_not_shown():
    service = in_turn(httpx.Response(200, json={"shots": []}))
    with service.client("http://service/studio/", "pf_secret") as client:
        assert client.shots() == []
        assert "pf_secret" not in repr(client)
    (request,) = service.requests
    assert request.url == "http://service/studio/v1/shots"
    assert request.headers["Authorization"] == "Bearer pf_secret"
    assert request.headers["User-Agent"].startswith("pullfocus-client/")


@pytest.mark.parametrize(
    ("url", "key"),
    [
        ("ftp://service", None),
        ("service:8000", None),
        ("http://", None),
        ("http://mara:pw@service", None),
        ("http://service?x=1", None),
        ("http://service:port", None),
        ("http://service", ""),
        ("http://service", "a\r\nHost: b"),
    ],
)
def test_addresses_and_keys_that_cannot_be_used_are_refused(url, key):
    with pytest.raises(SettingError):
        Client(url, key)


@pytest.mark.parametrize("name", ["", ".", ".."])
def test_a_name_that_leads_elsewhere_is_refused(name):
    service = in_turn()
    with service.client() as client, pytest.raises(SettingError):
        client.get(name)
    assert service.requests == []


def test_names_are_quoted():
    service = in_turn(DONE)
    with service.client() as client:
        client.get("../shots?x#y")
    assert service.requests[0].url.raw_path == b"/v1/renders/..%2Fshots%3Fx%23y"


def test_settings_that_json_lacks_are_refused():
    with in_turn().client() as client, pytest.raises(SettingError):
        client.plan("demo", noise=float("nan"))
    with in_turn().client() as client, pytest.raises(SettingError):
        client.render("demo", idempotency_key="two words")


def test_a_newer_service_is_understood():
    newer = RENDER | {"state": "archived", "worker": {"name": "pc"}, "priority": 7}
    with in_turn(httpx.Response(200, json=newer)).client() as client:
        render = client.get("r-1")
    assert (render.state, render.priority) == ("archived", 7)
