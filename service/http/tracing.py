"""Traces of requests, in OpenTelemetry's protocol, for those who name a collector. Nothing is loaded where nobody does."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable

from fastapi import FastAPI

from render.errors import SettingsError
from service.http.settings import Settings

log = logging.getLogger("pullfocus.service")

ENDPOINTS = ("OTEL_EXPORTER_OTLP_TRACES_ENDPOINT", "OTEL_EXPORTER_OTLP_ENDPOINT")
"""OpenTelemetry's variables that name a collector, the first one by the address of its traces."""


def install_tracing(app: FastAPI, settings: Settings) -> Callable[[], None]:
    """Trace the requests of the application where a collector is named.

    Args:
        app: the application; its other middleware works inside a request's span.
        settings: of the service. OpenTelemetry's own variables hold beside them.

    Returns:
        What sends the last spans and ends the tracing.

    Raises:
        SettingsError: OpenTelemetry is not installed.
    """
    is_named = settings.otlp_endpoint or any(os.environ.get(name) for name in ENDPOINTS)
    if not is_named or os.environ.get("OTEL_SDK_DISABLED", "").lower() == "true":
        return _nothing
    try:
        from service.http.spans import RequestSpans, SpanMiddleware
    except ModuleNotFoundError as error:
        raise SettingsError(
            "traces need OpenTelemetry: install pullfocus[tracing], or name no collector", code="no_tracing"
        ) from error
    endpoint = f"{settings.otlp_endpoint.rstrip('/')}/v1/traces" if settings.otlp_endpoint else None
    spans = RequestSpans(endpoint)
    app.add_middleware(SpanMiddleware, spans=spans)
    log.info("Traces go to %s.", endpoint or next(os.environ[name] for name in ENDPOINTS if os.environ.get(name)))
    return spans.close


def _nothing() -> None:
    """End no tracing."""
