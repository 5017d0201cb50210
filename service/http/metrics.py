"""Counters for Prometheus: requests, their times, and the state of the workers."""

from __future__ import annotations

import time
from collections import Counter as Counts
from collections.abc import Iterable
from contextlib import suppress

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from render.errors import OutputError
from service.http.lanes import Lanes
from service.jobs.queue import RenderQueue
from service.workers.jobs import Finished
from service.workers.pool import WorkerPool

BUCKETS_S = (0.005, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 60)
LIVE_BUCKETS_S = (0.03, 0.06, 0.09, 0.12, 0.18, 0.25, 0.4, 0.8, 1.6, 4)
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
LABELS = ("method", "route", "status")


class Metrics:
    """Counters of one service, in a registry of their own so that two services can share a process.

    Args:
        pool: the worker processes, which are measured too.
    """

    def __init__(self, pool: WorkerPool) -> None:
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
        self.webhook_deliveries = Counter(
            "pullfocus_webhook_deliveries", "Tries to deliver to webhooks.", ("outcome",), registry=self.registry
        )
        self.waits = Histogram(
            "pullfocus_lane_wait_seconds", "Time that work waits.", ("lane",), buckets=BUCKETS_S, registry=self.registry
        )
        self.runs = Histogram(
            "pullfocus_lane_run_seconds", "Time that work takes.", ("lane",), buckets=BUCKETS_S, registry=self.registry
        )
        self.registry.register(_PoolCollector(pool))

    def watch(self, lanes: Lanes) -> None:
        """Measure the lanes, too, from now on."""
        self.registry.register(_LaneCollector(lanes))

    def watch_renders(self, renders: RenderQueue) -> None:
        """Measure the queue of renders, too, from now on."""
        self.registry.register(_RenderCollector(renders))

    def note_finished(self, finished: Finished) -> None:
        """Count work that was done. Any thread may call this."""
        self.waits.labels(finished.lane).observe(finished.waited_s)
        self.runs.labels(finished.lane).observe(finished.ran_s)

    def text(self) -> bytes:
        """All counters in Prometheus' text format."""
        return generate_latest(self.registry)


class _LaneCollector(Collector):
    """Measures the lanes when the counters are read."""

    def __init__(self, lanes: Lanes) -> None:
        self._lanes = lanes

    def collect(self) -> Iterable[Metric]:
        waiting = GaugeMetricFamily("pullfocus_lane_waiting", "Requests that wait.", labels=["lane"])
        running = GaugeMetricFamily("pullfocus_lane_running", "Requests that are worked on.", labels=["lane"])
        oldest = GaugeMetricFamily(
            "pullfocus_lane_oldest_waiting_seconds", "Time that the oldest waiting request has waited.", labels=["lane"]
        )
        for lane in self._lanes:
            waiting.add_metric([lane.role.name], lane.waiting)
            running.add_metric([lane.role.name], lane.running)
            oldest.add_metric([lane.role.name], lane.oldest_waiting_s)
        return waiting, running, oldest


class _RenderCollector(Collector):
    """Counts the frames of renders when the counters are read."""

    def __init__(self, renders: RenderQueue) -> None:
        self._renders = renders

    def collect(self) -> Iterable[Metric]:
        frames = GaugeMetricFamily("pullfocus_render_frames", "Frames of renders by their state.", labels=["state"])
        with suppress(OutputError):  # the other counters are told, too, where the disk is full
            for state, count in self._renders.totals.numbers().items():
                frames.add_metric([state], count)
        return (frames,)


class _PoolCollector(Collector):
    """Measures the worker processes when the counters are read."""

    def __init__(self, pool: WorkerPool) -> None:
        self._pool = pool

    def collect(self) -> Iterable[Metric]:
        starts = CounterMetricFamily(
            "pullfocus_worker_starts", "Worker processes that were started.", labels=["worker"]
        )
        for name, count in self._pool.starts.copy().items():
            starts.add_metric([name], count)
        ends = CounterMetricFamily("pullfocus_worker_ends", "Worker processes that ended.", labels=["worker", "reason"])
        for (name, reason), count in self._pool.ends.copy().items():
            ends.add_metric([name, reason], count)
        memory = GaugeMetricFamily(
            "pullfocus_worker_memory_bytes", "Memory of the worker processes.", labels=["worker"]
        )
        for name, total in self._memory_bytes().items():
            memory.add_metric([name], total)
        peak = GaugeMetricFamily(
            "pullfocus_worker_peak_memory_bytes",
            "Most memory that one worker process has held, ended ones included.",
            labels=["worker"],
        )
        limit = GaugeMetricFamily(
            "pullfocus_worker_memory_limit_bytes", "Memory that one worker process may take.", labels=["worker"]
        )
        for role, held in self._pool.peaks().items():
            peak.add_metric([role.name], held)
            limit.add_metric([role.name], role.limits.memory_bytes)
        return starts, ends, memory, peak, limit

    def _memory_bytes(self) -> Counts[str]:
        total: Counts[str] = Counts()
        for process in self._pool.processes():
            total[process.role.name] += process.memory_bytes()
        return total


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
