"""Logs of the service: lines for people, or one JSON object a line for programs."""

from __future__ import annotations

import json
import logging
import sys
from datetime import UTC, datetime
from typing import Literal

from service.http.request_context import request_id, trace_id, work_fields

LogFormat = Literal["text", "json"]


class JsonFormatter(logging.Formatter):
    """Formats a record as ``{time, level, logger, message}``, with ``request_id``, ``trace_id``, ``fault``, and fields.

    A record of the work on a frame has ``render``, ``frame``, ``attempt`` and ``worker``.
    """

    def format(self, record: logging.LogRecord) -> str:
        """Return one line."""
        line: dict[str, object] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        if request_id.get():
            line["request_id"] = request_id.get()
        if trace_id.get():
            line["trace_id"] = trace_id.get()
        if record.exc_info:
            line["fault"] = self.formatException(record.exc_info)
        line |= work_fields.get()
        fields = {key: value for key, value in getattr(record, "fields", {}).items() if value is not None}
        return json.dumps(line | fields, ensure_ascii=False, default=str)


class TextFormatter(logging.Formatter):
    """Formats a record as a line for people, with the id of its request in brackets."""

    def format(self, record: logging.LogRecord) -> str:
        """Return one line, and the traceback of an exception below it."""
        text = super().format(record)
        return f"{text} [{request_id.get()}]" if request_id.get() and "\n" not in text else text


def set_up_logs(chosen: LogFormat | None) -> None:
    """Send the logs of this process to standard error.

    Args:
        chosen: None takes text on a terminal, and JSON where a program reads along.
    """
    handler = logging.StreamHandler()
    is_json = chosen == "json" or (chosen is None and not sys.stderr.isatty())
    handler.setFormatter(
        JsonFormatter() if is_json else TextFormatter("%(asctime)s %(levelname)s %(name)s: %(message)s")
    )
    logging.basicConfig(level=logging.INFO, handlers=[handler], force=True)
    logging.getLogger("httpx").setLevel(logging.WARNING)  # it logs each URL, which may be a receiver's secret
