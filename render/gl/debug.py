"""Debug output of a context: what the driver reports as an error or as undefined becomes a `GraphicsError`.

The environment variable ``PULLFOCUS_GL_DEBUG`` turns it on: the tests set it, and it helps to report a fault of a driver. The
driver then checks more, and names the call. Messages about speed and general remarks are left out.
"""

from __future__ import annotations

import os
import traceback
from pathlib import Path

from render.errors import GraphicsError

_KINDS = {0x824C: "an error", 0x824D: "a deprecated use", 0x824E: "an undefined use", 0x824F: "an unportable use"}
_ALWAYS_REPORTED = (0x824C, 0x824E)
_SEVERITY_HIGH = 0x9146
_PACKAGE = Path(__file__).parent.parent
_MOST_KEPT = 20


def is_debugging() -> bool:
    """Whether the environment asks for debug output."""
    return bool(os.environ.get("PULLFOCUS_GL_DEBUG"))


class DebugLog:
    """Faults that the driver of one context reported, each with the line of our code that caused it."""

    def __init__(self) -> None:
        self._faults: list[str] = []

    def add(self, kind: int, severity: int, text: str) -> None:
        """Record a message where it reports a fault.

        Args:
            kind: type of the message, as in ``GL_KHR_debug``.
            severity: likewise.
            text: the driver's words.
        """
        is_fault = kind in _ALWAYS_REPORTED or (kind in _KINDS and severity == _SEVERITY_HIGH)
        if is_fault and len(self._faults) < _MOST_KEPT:
            self._faults.append(f"{_KINDS[kind]}: {text.strip()} ({_line_of_ours()})")

    def raise_faults(self) -> None:
        """Forget the faults so far.

        Raises:
            GraphicsError: there were some; the message holds the first one.
        """
        if not self._faults:
            return
        first, others = self._faults[0], len(self._faults) - 1
        self._faults = []
        raise GraphicsError(f"OpenGL reports {first}" + (f", and {others} more" if others else ""))


def _line_of_ours() -> str:
    """The innermost line of `render` outside this folder that is being executed."""
    frames = [frame for frame in traceback.extract_stack() if _PACKAGE in Path(frame.filename).parents]
    drawing = [frame for frame in frames if Path(frame.filename).parent != Path(__file__).parent]
    if not drawing:
        return "outside render"
    frame = drawing[-1]
    return f"{Path(frame.filename).relative_to(_PACKAGE.parent).as_posix()}:{frame.lineno}"
