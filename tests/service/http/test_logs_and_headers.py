"""Each answer has an id that the log has too, and the headers that keep a browser to the service's own files."""

from __future__ import annotations

import json
import logging
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace

import httpx
import pytest

from service.http.logs import JsonFormatter
from service.http.request_context import request_id
from service.http.security_headers import CONTENT_POLICY
from tests.service.conftest import running
from tests.service.kits.renders import ended, render_of


def test_a_sane_request_id_is_kept_and_another_is_not(client):
    assert client.get("/livez", headers={"X-Request-ID": "trace-1.A_b"}).headers["x-request-id"] == "trace-1.A_b"
    for sent in ("", "a b", 'x"y', "a" * 65, "\u00e9".encode("latin-1")):
        own = client.get("/livez", headers={"X-Request-ID": sent}).headers["x-request-id"]
        assert re.fullmatch("[0-9a-f]{32}", own)


def test_a_json_line_has_what_the_record_has():
    record = logging.LogRecord("pullfocus.service", logging.ERROR, "", 0, "a \n%s", ("b",), None)
    token = request_id.set("r1")
    line = JsonFormatter().format(record)
    request_id.reset(token)
    assert "\n" not in line
    parsed = json.loads(line)
    assert (parsed["level"], parsed["logger"], parsed["message"], parsed["request_id"]) == (
        "error",
        "pullfocus.service",
        "a \nb",
        "r1",
    )
    assert "request_id" not in json.loads(JsonFormatter().format(record))


def test_each_answer_is_a_json_line_without_its_query(tmp_path):
    command = [sys.executable, "-m", "render.cli", "serve", "--port", "0", "--no-demo", "--log-format", "json"]
    with subprocess.Popen([*command, "--data", str(tmp_path)], stderr=subprocess.PIPE, text=True) as process:
        said = next(line for line in process.stderr if "http://" in line)
        address = re.search(r"http://[^/ ]+", json.loads(said)["message"])[0]
        headers = {"X-Request-ID": "mine", "Authorization": "Bearer secret"}
        assert httpx.get(f"{address}/v1/shots?key=secret", headers=headers, timeout=60).status_code == 200
        process.terminate()
        lines = [json.loads(line) for line in process.stderr]
    (answer,) = [line for line in lines if line.get("path") == "/v1/shots"]
    assert (answer["request_id"], answer["method"], answer["status"], answer["client"]) == (
        "mine",
        "GET",
        200,
        "127.0.0.1",
    )
    assert "secret" not in json.dumps(lines)


class LoggedLines:
    """Lines that were logged in JSON."""

    def __init__(self) -> None:
        self._lines: list[dict] = []
        self._changed = threading.Condition()

    def __iter__(self) -> Iterator[dict]:
        return iter(list(self._lines))

    def add(self, line: dict) -> None:
        with self._changed:
            self._lines.append(line)
            self._changed.notify_all()

    def wait_for(self, path: str) -> None:
        """Wait for the line of a request, which is logged after it is answered."""
        with self._changed:
            assert self._changed.wait_for(lambda: any(line.get("path") == path for line in self._lines), 60)


@pytest.fixture
def logged():
    """Lines that the service logs in JSON."""
    lines = LoggedLines()

    class Lines(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            lines.add(json.loads(JsonFormatter().format(record)))

    handler, names = Lines(), ("pullfocus.access", "pullfocus.service")
    levels = {name: logging.getLogger(name).level for name in names}
    for name in names:
        logging.getLogger(name).addHandler(handler)
        logging.getLogger(name).setLevel(logging.INFO)
    yield lines
    for name, level in levels.items():
        logging.getLogger(name).removeHandler(handler)
        logging.getLogger(name).setLevel(level)


def test_lines_name_shot_render_and_frame(client, room, logged):
    render = ended(client, render_of(client, room, frames="3", camera="/World/nobody"))
    client.get(f"/v1/renders/{render['id']}/frames/3/log")
    client.get(f"/v1/shots/{room}")
    logged.wait_for(f"/v1/shots/{room}")
    answers = {line["path"]: line for line in logged if line["logger"] == "pullfocus.access"}
    asked = answers[f"/v1/renders/{render['id']}/frames/3/log"]
    assert (asked["render"], asked["frame"], asked["status"]) == (render["id"], 3, 200)
    assert answers[f"/v1/shots/{room}"]["shot"] == room
    assert "render" not in answers["/v1/renders"]
    (failed,) = [line for line in logged if "could not be drawn" in line["message"]]
    assert (failed["render"], failed["frame"], failed["attempt"]) == (render["id"], 3, 1)
    assert failed["worker"]


@pytest.mark.parametrize("path", ["/", "/livez", "/docs", "/v1/shots", "/nowhere", "/assets/none.js"])
def test_every_answer_has_the_headers(client, path):
    headers = client.get(path).headers
    assert headers["content-security-policy"] == CONTENT_POLICY
    assert "unsafe" not in CONTENT_POLICY
    assert "http" not in CONTENT_POLICY
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cross-origin-opener-policy"] == headers["cross-origin-resource-policy"] == "same-origin"
    assert "camera=()" in headers["permissions-policy"]
    assert "strict-transport-security" not in headers


def test_a_refusal_of_the_guard_has_them_too(client):
    refused = client.get("/livez", headers={"Host": "evil.example"})
    assert refused.status_code == 421
    assert refused.headers["content-security-policy"] == CONTENT_POLICY
    assert refused.headers["x-request-id"]


def test_https_at_a_trusted_proxy_is_kept(service, tmp_path):
    forwarded = {"X-Forwarded-Proto": "https"}
    assert "strict-transport-security" not in service.client.get("/livez", headers=forwarded).headers
    with running(replace(service.settings, data=tmp_path), forwarded_allow_ips=["127.0.0.1"]) as proxied:
        assert "strict-transport-security" in proxied.client.get("/livez", headers=forwarded).headers
        assert "strict-transport-security" not in proxied.client.get("/livez").headers
