"""Traces: one of each request, over the HTTP process and its worker, where a collector is named; and nothing else."""

from __future__ import annotations

import gzip
import json
import logging
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest
from opentelemetry.proto.collector.trace.v1.trace_service_pb2 import ExportTraceServiceRequest
from websockets.sync.client import connect

from service.http import spans
from service.http.logs import JsonFormatter
from service.http.settings import Settings
from service.workers.step_times import checked_steps
from tests.service.conftest import ROOM, running, send

TRACE = "0af7651916cd43dd8448eb211c80319c"
LIVE_TRACE = "1bf7651916cd43dd8448eb211c80319d"
CALLER = "b7ad6b7169203331"
PICTURE = {"time": 1, "width": 32, "height": 18, "rays": 4}


class Collector(ThreadingHTTPServer):
    """Keeps the spans that are sent to it."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Reception)
        self.spans: list = []

    def named(self, name: str) -> dict:
        (span,) = [span for span in self.spans if span.name == name and span.trace_id.hex() == TRACE]
        return span


class _Reception(BaseHTTPRequestHandler):
    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        sent = ExportTraceServiceRequest.FromString(
            gzip.decompress(body) if self.headers["Content-Encoding"] == "gzip" else body
        )
        if self.path == "/v1/traces":
            self.server.spans += [
                span for one in sent.resource_spans for scope in one.scope_spans for span in scope.spans
            ]
        self.send_response(200)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Log nothing."""


@pytest.fixture(scope="module")
def collector() -> Iterator[Collector]:
    with Collector() as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


class Lines(logging.Handler):
    """Formats what is logged as the service does."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[dict] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.lines.append(json.loads(JsonFormatter().format(record)))


@pytest.fixture(scope="module")
def traced(collector, tmp_path_factory) -> tuple[str, list[dict]]:
    """Request id of a frame that was traced, and the lines of the log."""
    settings = Settings(
        data=tmp_path_factory.mktemp("traced"), demo=False, otlp_endpoint=f"http://127.0.0.1:{collector.server_port}"
    )
    lines = Lines()
    access = logging.getLogger("pullfocus.access")
    access.addHandler(lines)
    access.setLevel(logging.INFO)
    with running(settings) as service:
        shot = send(service.client, "room.usda", ROOM.encode()).json()["id"]
        headers = {"traceparent": f"00-{TRACE}-{CALLER}-01"}
        answer = service.client.get(f"/v1/shots/{shot}/frame", params=PICTURE, headers=headers)
        assert answer.status_code == 200
        address = f"ws://{service.client.base_url.host}:{service.client.base_url.port}/v1/shots/{shot}/live"
        with connect(
            address, additional_headers={"traceparent": f"00-{LIVE_TRACE}-{CALLER}-01"}, max_size=None
        ) as live:
            live.send(json.dumps(PICTURE | {"id": 1, "moving": True}))
            live.recv(60)
    access.removeHandler(lines)
    return answer.headers["X-Request-ID"], lines.lines


def attribute(span, name: str):
    (value,) = [entry.value for entry in span.attributes if entry.key == name]
    return getattr(value, value.WhichOneof("value"))


def test_a_trace_goes_from_the_caller_to_the_worker(collector, traced):
    request = collector.named("GET /shots/{shot}/frame")
    wait, work, expose, trace = map(collector.named, ("wait in the lane", "render_frame", "expose frame", "trace rays"))
    assert request.parent_span_id.hex() == CALLER
    assert wait.parent_span_id == work.parent_span_id == request.span_id
    assert expose.parent_span_id == work.span_id
    assert collector.named("open shot").parent_span_id == work.span_id
    assert trace.parent_span_id == expose.span_id
    assert collector.named("peel layers").parent_span_id == trace.span_id


def test_spans_lie_in_those_that_they_are_parts_of(collector, traced):
    by_id = {span.span_id: span for span in collector.spans if span.trace_id.hex() == TRACE}
    parts = [span for span in by_id.values() if span.parent_span_id in by_id]
    assert len(parts) > 6
    for span in parts:
        outer = by_id[span.parent_span_id]
        assert outer.start_time_unix_nano <= span.start_time_unix_nano <= span.end_time_unix_nano
        # The answer may be on its way before the lane has noted the end of the work.
        assert span.end_time_unix_nano <= outer.end_time_unix_nano + 2e8


def test_a_live_connection_is_traced(collector, traced):
    by_name = {span.name: span for span in collector.spans if span.trace_id.hex() == LIVE_TRACE}
    live, wait, work = (
        by_name[name] for name in ("WEBSOCKET /v1/shots/{shot}/live", "wait in the lane", "stream_pictures")
    )
    assert live.parent_span_id.hex() == CALLER
    assert attribute(live, "http.response.status_code") == 101
    assert wait.parent_span_id == work.parent_span_id == live.span_id
    assert attribute(work, "pullfocus.lane") == "live"


def test_of_many_jobs_of_a_live_connection_one_a_second_is_traced(monkeypatch):
    times_s, told = [100.0, 100.4, 100.9, 101.1, 101.2, 103.0], []
    monkeypatch.setattr(spans.time, "monotonic", iter(times_s).__next__)
    tell = spans._seldom(told.append)
    for asked_s in times_s:
        tell(asked_s)
    assert told == [100.0, 101.1, 103.0]


def test_a_worker_has_another_process_id(collector, traced):
    pids = {attribute(collector.named(name), "process.pid") for name in ("render_frame", "trace rays")}
    assert len(pids) == 1
    assert os.getpid() not in pids


def test_spans_and_logs_name_each_other(collector, traced):
    request_id, lines = traced
    span = collector.named("GET /shots/{shot}/frame")
    assert attribute(span, "pullfocus.request_id") == request_id
    assert attribute(span, "http.response.status_code") == 200
    (line,) = [line for line in lines if line.get("request_id") == request_id]
    assert line["trace_id"] == TRACE


def test_without_a_collector_nothing_is_loaded():
    program = (
        "import sys; from pathlib import Path; from service.http.app import create_app; from service.http.settings import "
        "Settings; create_app(Settings(data=Path('unused'))); "
        "print([m for m in sys.modules if m.startswith(('opentelemetry.sdk', 'opentelemetry.exporter'))])"
    )
    # FastAPI itself loads the interface (`opentelemetry.trace`), which does nothing.
    asked = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert asked.stdout.strip() == "[]"


@pytest.mark.parametrize(
    "told",
    [
        "steps",
        (("a", 1, 2),),
        (("a", 2, 1, -1),),
        (("a", 1, 2, 0),),
        (("a", 1, 1 << 63, -1),),
        (("a" * 1000, 1, 2, -1),),
        (("a", 1, 2, -1),) * 1000,
        ((b"a", 1, 2, -1),),
    ],
)
def test_steps_of_another_shape_are_not_believed(told):
    assert checked_steps((("a", 1, 2, -1),)) == (("a", 1, 2, -1),)
    assert checked_steps(told) == ()
