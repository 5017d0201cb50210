"""Waiting for the events of a render: a stream of Server-Sent Events is read up to the next event, and then closed.

A stream lasts no longer than one exchange, so that a client which stops waiting leaves nothing behind. The next stream goes on
after the number of the last message, and so misses nothing that happens in between.
"""

from __future__ import annotations

import time

import httpx

from .steps import Call, Exchange, Steps

LISTEN_S = 15.0
"""Longest time for an event, s."""
_EVENT_STREAM = "text/event-stream"
_FIRST_DEAF_S, _LONGEST_DEAF_S = 15.0, 600.0
"""Time without streams after one that has failed, s; it doubles with each failure."""
_MOST_BYTES = 1 << 20
_MOST_NUMBER_DIGITS = 16


class Listener:
    """Waits for events of a render, where the service tells them."""

    def __init__(self) -> None:
        self._after: int | None = None
        self._deaf_s = _FIRST_DEAF_S
        self._deaf_until = 0.0

    def listen(self, render_id: str, most_s: float) -> Steps[bool]:
        """Wait for an event; the first time, only ask for the number to go on after.

        Args:
            render_id: the render.
            most_s: time to wait at most, s.

        Returns:
            Whether the service tells events. If not, the caller has to wait by itself: for some time, no stream is asked for.
        """
        if time.monotonic() < self._deaf_until:
            return False
        is_first = self._after is None
        heard = Heard(most_s)
        params: dict[str, str | int] = {"render": render_id}
        params |= {"follow": "false"} if self._after is None else {"after": self._after}
        call = Call("GET", "/v1/events", params, headers={"Accept": _EVENT_STREAM}, answer_s=most_s)
        try:
            yield Exchange(call, heard, heard.is_enough)
            is_told = heard.is_enough() or is_first
        except httpx.ReadTimeout:  # nothing has happened
            is_told = True
        except (httpx.TransportError, OSError):
            is_told = False
        if heard.number is not None:
            self._after = heard.number
        if is_told and heard.number is not None:
            self._deaf_s = _FIRST_DEAF_S
            return True
        self._deaf_until = time.monotonic() + self._deaf_s
        self._deaf_s = min(2 * self._deaf_s, _LONGEST_DEAF_S)
        return False


class Heard:
    """Messages of a stream, up to the first event. It is a `Sink`.

    Args:
        most_s: time to wait at most, s.

    Attributes:
        number: that of the last message, to go on after; None before the first.
    """

    def __init__(self, most_s: float) -> None:
        self._end = time.monotonic() + most_s
        self.restart()

    def restart(self) -> None:
        """Drop what was heard."""
        self.number: int | None = None
        self._messages = 0
        self._has_event = False
        self._bytes = 0
        self._line = b""
        self._fields: dict[bytes, bytes] = {}

    def is_enough(self) -> bool:
        """Whether there is an event, or a second mark, or none came in time."""
        return self._has_event or self._messages > 1 or self._bytes > _MOST_BYTES or time.monotonic() >= self._end

    def write(self, chunk: bytes) -> None:
        """Read a part of the stream (HTML, section 9.2.6).

        Args:
            chunk: it may end anywhere.
        """
        self._bytes += len(chunk)
        *lines, self._line = (self._line + chunk).split(b"\n")
        for line in lines:
            self._read(line.removesuffix(b"\r"))

    def _read(self, line: bytes) -> None:
        if line:
            name, _, value = line.partition(b":")
            self._fields[name] = value.strip()
            return
        number = self._fields.get(b"id", b"")
        if number.isdigit() and len(number) <= _MOST_NUMBER_DIGITS:
            self.number = int(number)
        self._has_event |= b"data" in self._fields
        self._messages += bool(self._fields.keys() & {b"id", b"data"})
        self._fields = {}
