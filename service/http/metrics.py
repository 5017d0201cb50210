"""Counters for Prometheus: requests, their times, and the state of the workers."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.workers.worker_queue import WorkerQueue

BUCKETS_S = (0.005, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 60)
LIVE_BUCKETS_S = (0.03, 0.06, 0.09, 0.12, 0.18, 0.25, 0.4, 0.8, 1.6, 4)
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
LABELS = ("method", "route", "status")


class Metrics:
    """Counters of one service, in a registry of their own so that two services can share a process.

    Args:
        queues: queues of the workers, which are measured too.
    """

    def __init__(self, queues: Sequence[WorkerQueue[Any]]) -> None:
        self.registry = CollectorRegistry()
        self.requests = Histogram(
            "pullfocus_request_seconds", "Time to answer a request.", LABELS, buckets=BUCKETS_S, registry=self.registry
        )
        self.frames = Counter(
            "pullfocus_frames", "Frames by where they came from.", ("source",), registry=self.registry
        )
        self.live_pictures = Counter(
            "pullfocus_live_pictures", "Live pictures by how good they are.", ("stage",), registry=self.registry
        )
        self.live_first = Histogram(
            "pullfocus_live_first_picture_seconds",
            "From a live request to its first picture.",
            buckets=LIVE_BUCKETS_S,
            registry=self.registry,
        )
        self.live_viewers = Gauge("pullfocus_live_viewers", "Open live connections.", registry=self.registry)
        self.registry.register(_QueueCollector(queues))

    def text(self) -> bytes:
        """All counters in Prometheus' text format."""
        return generate_latest(self.registry)


class _QueueCollector(Collector):
    """Measures the queues when the counters are read."""

    def __init__(self, queues: Sequence[WorkerQueue[Any]]) -> None:
        self._queues = queues

    def collect(self) -> Iterable[Metric]:
        return self._families()

    def _families(self) -> Iterator[Metric]:
        waiting = GaugeMetricFamily("pullfocus_lane_waiting", "Requests that wait for a worker.", labels=["worker"])
        busy = GaugeMetricFamily("pullfocus_lane_busy", "Whether a worker is at work.", labels=["worker"])
        starts = CounterMetricFamily("pullfocus_worker_starts", "Times a worker was started.", labels=["worker"])
        for queue in self._queues:
            waiting.add_metric([queue.worker.name], queue.waiting)
            busy.add_metric([queue.worker.name], queue.busy)
            starts.add_metric([queue.worker.name], queue.worker.starts)
        yield waiting
        yield busy
        yield starts


class MetricsMiddleware:
    """Times each request. Labels hold the template of a route and not its address, so that their number is bounded."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request and count it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        status = 500
        began_s = time.perf_counter()

        async def send_and_note(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            await send(message)

        try:
            await self.app(scope, receive, send_and_note)
        finally:
            route = getattr(scope.get("route"), "path", "none")
            histogram = scope["app"].state.service.metrics.requests
            method = scope["method"] if scope["method"] in METHODS else "other"
            histogram.labels(method, route, str(status)).observe(time.perf_counter() - began_s)
