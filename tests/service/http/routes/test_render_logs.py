"""Logs of a render's frames over REST: whole, in parts, followed, and without a word about this machine."""

from __future__ import annotations

import pytest

from render.errors import OutputError
from tests.service.conftest import hold_back, send, until
from tests.service.kits.renders import ended, render_of

LEASE_S = 60.0


@pytest.fixture
def log_of(client):
    def get(render, frame, path="", headers=None, **query):
        address = f"/v1/renders/{render['id']}/frames/{frame}/log{path}"
        return client.get(address, params=query, headers=headers or {})

    return get


@pytest.fixture
def held(client, room, service, monkeypatch):
    """A render whose frames this test draws, and the claim of its first frame."""
    queue = service.internal.renders
    claim = queue.claim
    hold_back(queue, monkeypatch)
    monkeypatch.setattr(queue, "claim_again", claim, raising=False)
    render = render_of(client, room, frames="1-2")
    claimed = claim("one", LEASE_S)
    yield render, claimed
    client.post(f"/v1/renders/{render['id']}/cancel")
    queue.give_back(claimed, "the test ends")


def test_a_frame_that_is_drawn_has_a_log(client, room, log_of):
    render = ended(client, render_of(client, room, frames="3", formats=["png", "exr"]))
    answer = log_of(render, 3)
    assert answer.headers["content-type"] == "text/plain; charset=utf-8"
    assert (answer.headers["pullfocus-attempt"], answer.headers["pullfocus-ended"]) == ("1", "true")
    told = [line.partition("Z ")[2] for line in answer.text.splitlines()]
    assert told[0].startswith(f"attempt 1 at frame 3 of render {render['id']}, by worker ")
    steps = [line.partition(":")[0] for line in told]
    assert {"load scene", "expose frame", "encode", "render_files"} <= set(steps)
    files = client.get(f"/v1/renders/{render['id']}/tasks").json()["tasks"][0]["files"]
    for file in files:
        assert f"stored {file['format']}: {file['sizeBytes']} bytes, SHA-256 {file['sha256']}" in told


def test_what_usd_says_names_no_folder_of_this_machine(client, service, log_of):
    torn = b"""#usda 1.0
(defaultPrim = "World")
def Xform "World" (references = @./gone.usda@)
{
    def Cube "box" {}
}
"""
    shot = send(client, "torn.usda", torn).json()
    text = log_of(ended(client, render_of(client, shot["id"], frames="1")), 1).text
    assert "gone.usda" in text
    assert str(service.internal.settings.data) not in text
    assert "/shots/" not in text


def test_an_error_names_no_folder_of_this_machine(client, room, service, log_of, monkeypatch):
    data = service.internal.settings.data

    def refuse(*_):
        raise OutputError(f"cannot write {data}/renders/r-1/1.1.exr: it is not allowed")

    monkeypatch.setattr(service.internal.render_files, "write", refuse)
    monkeypatch.setattr("service.jobs.attempts.MOST_FAILURES", 1)
    render = ended(client, render_of(client, room, frames="1"))
    assert log_of(render, 1).text.splitlines()[-1].endswith("it is not allowed")
    assert str(data) not in log_of(render, 1).text


def test_a_frame_that_fails_says_why_in_its_log(client, room, log_of):
    render = ended(client, render_of(client, room, frames="1", camera="/World/nobody"))
    assert render["state"] == "failed"
    assert "failed: " in log_of(render, 1).text.splitlines()[-1]
    assert "/World/nobody" in log_of(render, 1, attempt=1).text


@pytest.mark.parametrize(
    ("wanted", "status", "content", "told"),
    [
        ("bytes=0-", 206, "abc\ndef\n", "bytes 0-7/8"),
        ("bytes=4-5", 206, "de", "bytes 4-5/8"),
        ("bytes=4-99", 206, "def\n", "bytes 4-7/8"),
        ("bytes=-3", 206, "ef\n", "bytes 5-7/8"),
        ("bytes=-99", 206, "abc\ndef\n", "bytes 0-7/8"),
        ("bytes=8-", 416, None, "bytes */8"),
        ("bytes=-0", 416, None, "bytes */8"),
        ("bytes=5-4", 416, None, "bytes */8"),
        ("bytes=0-1,4-5", 200, "abc\ndef\n", None),
        ("lines=1-2", 200, "abc\ndef\n", None),
        ("bytes=-", 200, "abc\ndef\n", None),
    ],
)
def test_a_range_of_bytes_is_answered(held, service, log_of, wanted, status, content, told):
    render, claim = held
    service.internal.renders.logs.append(claim, "abc\ndef\n")
    answer = log_of(render, 1, headers={"Range": wanted})
    assert (answer.status_code, answer.headers.get("content-range")) == (status, told)
    assert content is None or answer.text == content
    assert status != 416 or answer.json()["code"] == "no_such_range"


def test_the_last_lines_are_answered(held, service, log_of):
    render, claim = held
    service.internal.renders.logs.append(claim, "a\nb\nc\n")
    assert log_of(render, 1, tail=2).text == "b\nc\n"
    assert log_of(render, 1, tail=9).text == "a\nb\nc\n"
    assert log_of(render, 1).headers["pullfocus-ended"] == "false"
    assert log_of(render, 1, tail=0).status_code == 422


def test_logs_that_are_not_there_are_refused(held, log_of):
    render, _ = held
    for frame, query, code in (
        (2, {}, "frame_not_begun"),
        (9, {}, "frame_not_found"),
        (1, {"attempt": 2}, "attempt_not_found"),
    ):
        for path in ("", "/stream"):
            if path and code == "frame_not_begun":
                continue  # it is waited for
            answer = log_of(render, frame, path, **query)
            assert (answer.status_code, answer.json()["code"]) == (404, code)


def streamed(client, render, frame, on_text):
    """All text of a stream; told of what there is after each part."""
    text = ""
    with client.stream("GET", f"/v1/renders/{render['id']}/frames/{frame}/log/stream") as answer:
        assert answer.status_code == 200
        for part in answer.iter_text():
            text += part
            on_text(text)
    return text


def test_a_log_is_followed_until_its_attempt_has_ended(held, service, client):
    render, claim = held
    queue = service.internal.renders
    queue.logs.append(claim, "one\n")

    def go_on(text):
        if text == "one\n":
            queue.logs.append(claim, "two\n")
        elif text == "one\ntwo\n":
            queue.fail(claim, "enough", may_pass=False)

    text = streamed(client, render, 1, go_on)
    assert text.startswith("one\ntwo\n")
    assert text.endswith("failed: enough\n")


def test_a_frame_that_is_put_off_is_waited_for(held, service, client):
    render, claim = held
    queue = service.internal.renders
    queue.logs.append(claim, "one\n")

    def go_on(text):
        if text == "one\n":
            queue.put_off(claim, 0)
            again = queue.claim_again("one", LEASE_S)
            queue.fail(again, "enough", "other\n", may_pass=False)

    text = streamed(client, render, 1, go_on)
    assert text.startswith("one\nother\n")
    assert text.endswith("failed: enough\n")


def test_a_frame_that_waits_is_waited_for_and_one_given_up_is_not(held, client):
    render, _ = held
    until(lambda: client.post(f"/v1/renders/{render['id']}/cancel").status_code == 200)
    assert streamed(client, render, 2, lambda text: None) == ""


def test_a_stream_is_one_of_the_readers_of_events(held, service, client):
    render, claim = held
    places = service.internal.event_places
    service.internal.renders.logs.append(claim, "one\n")
    with client.stream("GET", f"/v1/renders/{render['id']}/frames/1/log/stream") as answer:
        parts = answer.iter_text()
        assert next(parts) == "one\n"
        assert len(places) == 1
    until(lambda: len(places) == 0)


def test_logs_of_renders_that_are_not_there_are_refused(client):
    for path in ("log", "log/stream"):
        answer = client.get(f"/v1/renders/r-000000000000/frames/1/{path}")
        assert (answer.status_code, answer.json()["code"]) == (404, "render_not_found")
