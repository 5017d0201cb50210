"""Counters for Prometheus: what was asked, how long it took, and how the workers are doing."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.workers.lane import Lane

BUCKETS_S = (0.005, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 60)
LIVE_BUCKETS_S = (0.03, 0.06, 0.09, 0.12, 0.18, 0.25, 0.4, 0.8, 1.6, 4)
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
LABELS = ("method", "route", "status")


class Metrics:
    """The counters of one service; each has a registry of its own, so that two can live in one process.

    Args:
        lanes: whose queues and workers are watched.
    """

    def __init__(self, lanes: Sequence[Lane[Any]]) -> None:
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
        self.registry.register(_LaneCollector(lanes))

    def text(self) -> bytes:
        """All counters in Prometheus' text format."""
        return generate_latest(self.registry)


class _LaneCollector(Collector):
    """Reads the lanes when somebody asks."""

    def __init__(self, lanes: Sequence[Lane[Any]]) -> None:
        self._lanes = lanes

    def collect(self) -> Iterable[Metric]:
        return self._families()

    def _families(self) -> Iterator[Metric]:
        waiting = GaugeMetricFamily("pullfocus_lane_waiting", "Requests that wait for a worker.", labels=["worker"])
        busy = GaugeMetricFamily("pullfocus_lane_busy", "Whether a worker is at work.", labels=["worker"])
        starts = CounterMetricFamily("pullfocus_worker_starts", "Times a worker was started.", labels=["worker"])
        for lane in self._lanes:
            waiting.add_metric([lane.worker.name], lane.waiting)
            busy.add_metric([lane.worker.name], lane.busy)
            starts.add_metric([lane.worker.name], lane.worker.starts)
        yield waiting
        yield busy
        yield starts


class MetricsMiddleware:
    """Times each request. Routes count by their template, so that addresses do not become labels without end."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request and count it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        status = 500
        began_s = time.perf_counter()

        async def send_and_see(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            await send(message)

        try:
            await self.app(scope, receive, send_and_see)
        finally:
            route = getattr(scope.get("route"), "path", "none")
            histogram = scope["app"].state.hub.metrics.requests
            method = scope["method"] if scope["method"] in METHODS else "other"
            histogram.labels(method, route, str(status)).observe(time.perf_counter() - began_s)
