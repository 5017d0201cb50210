"""Spans of a request: its answer, its wait in a lane, and the steps of its work, whose times a worker process tells.

A worker has no network, so that this process makes its spans, too. A live connection has a span from beginning to end, and in it
those of one job a second: a drag asks for many.
"""

from __future__ import annotations

import math
import os
import time
from functools import partial

from opentelemetry.context import Context
from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
from opentelemetry.sdk.resources import Resource
from opentelemetry.sdk.trace import TracerProvider
from opentelemetry.sdk.trace.export import BatchSpanProcessor
from opentelemetry.trace import Span, SpanKind, StatusCode, format_trace_id, set_span_in_context
from opentelemetry.trace.propagation.tracecontext import TraceContextTextMapPropagator
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.metrics import METHODS
from service.http.request_context import HEADER, trace_id
from service.workers.jobs import Finished, Observer, observer

EXPORT_S = 5.0
"""Time that a collector has to take spans."""
LIVE_PAUSE_S = 1.0
"""Least time between two jobs of one live connection that are traced."""
WEBSOCKET = "WEBSOCKET"
_CONTEXT = TraceContextTextMapPropagator()


class RequestSpans:
    """Makes the spans of requests and sends them to a collector, in a thread of its own. Any thread may use it.

    Args:
        endpoint: address of the collector's traces; None for that of OpenTelemetry's variables.
    """

    def __init__(self, endpoint: str | None) -> None:
        name = os.environ.get("OTEL_SERVICE_NAME", "pullfocus")
        self._provider = TracerProvider(resource=Resource.create({"service.name": name}), shutdown_on_exit=False)
        self._provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter(endpoint, timeout=EXPORT_S)))
        self._tracer = self._provider.get_tracer("pullfocus.service")

    def begin(self, scope: Scope) -> Span:
        """Begin the span of a request, in the trace that its header ``traceparent`` names (W3C Trace Context)."""
        method = scope.get("method", WEBSOCKET)
        method = method if method in (WEBSOCKET, *METHODS) else "_OTHER"
        return self._tracer.start_span(
            method,
            _CONTEXT.extract(Headers(scope=scope)),
            SpanKind.SERVER,
            {"http.request.method": method, "url.path": scope["path"], "url.scheme": scope["scheme"]},
        )

    def add_job(self, request: Context, finished: Finished) -> None:
        """Add the spans of a job that a request has waited for.

        Args:
            request: the context of its span.
            finished: the job. Its worker may be in other hands: times outside the job are not believed.
        """
        begun_ns = finished.ended_ns - round(1e9 * finished.ran_s)
        attributes = {"pullfocus.lane": finished.lane, "pullfocus.shot": finished.place.key or ""}
        queued_ns = begun_ns - round(1e9 * finished.waited_s)
        self._tracer.start_span("wait in the lane", request, attributes=attributes, start_time=queued_ns).end(begun_ns)
        steps = finished.steps or (("work", begun_ns, finished.ended_ns, -1),)
        contexts: list[Context] = []
        for name, began_ns, ended_ns, outer in steps:
            first_ns, last_ns = (min(max(at_ns, begun_ns), finished.ended_ns) for at_ns in (began_ns, ended_ns))
            span = self._tracer.start_span(
                name,
                contexts[outer] if outer >= 0 else request,
                attributes=attributes | {"process.pid": finished.worker},
                start_time=first_ns,
            )
            if outer < 0 and finished.error is not None:
                span.set_status(StatusCode.ERROR, type(finished.error).__name__)
            contexts.append(set_span_in_context(span))
            span.end(last_ns)

    def close(self) -> None:
        """Send the last spans."""
        self._provider.shutdown()


class SpanMiddleware:
    """Makes a span of each HTTP request and of each WebSocket."""

    def __init__(self, app: ASGIApp, spans: RequestSpans) -> None:
        self.app = app
        self._spans = spans

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        span = self._spans.begin(scope)
        status = 500

        async def send_and_note(message: Message) -> None:
            nonlocal status
            if message["type"] == "websocket.accept":
                status = 101
            elif message["type"] in ("http.response.start", "websocket.http.response.start"):
                status = message["status"]
                span.set_attribute("pullfocus.request_id", Headers(raw=message["headers"]).get(HEADER, ""))
            await send(message)

        named = trace_id.set(format_trace_id(span.get_span_context().trace_id))
        observed = observer.set(self._observer_of(span, scope))
        try:
            await self.app(scope, receive, send_and_note)
        finally:
            observer.reset(observed)
            trace_id.reset(named)
            _end(span, scope, status)

    def _observer_of(self, span: Span, scope: Scope) -> Observer | None:
        """Return what adds the jobs of a request to its span; None where it is not sampled."""
        if not span.is_recording():
            return None
        add = partial(self._spans.add_job, set_span_in_context(span))
        return add if scope["type"] == "http" else _seldom(add)


def _seldom(tell: Observer) -> Observer:
    """Return an observer that tells of one job in `LIVE_PAUSE_S`."""
    told_s = -math.inf

    def tell_seldom(finished: Finished) -> None:
        nonlocal told_s
        now_s = time.monotonic()
        if now_s - told_s >= LIVE_PAUSE_S:
            told_s = now_s
            tell(finished)

    return tell_seldom


def _end(span: Span, scope: Scope, status: int) -> None:
    route = getattr(scope.get("route"), "path", None)
    if route is not None:
        span.update_name(f"{scope.get('method', WEBSOCKET)} {route}")
        span.set_attribute("http.route", route)
    span.set_attribute("http.response.status_code", status)
    if status >= 500:
        span.set_status(StatusCode.ERROR)
    span.end()
