"""Messages, progress and results of commands. Messages go to standard error; standard output is for results."""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any

from rich.console import Console, RenderableType
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from render.errors import one_line

if TYPE_CHECKING:
    from render.stage.findings import Finding  # its package imports USD, which `pullfocus serve` does not load

MAX_WARNINGS = 8
_PIPED_WIDTH = 240
"""Width of tables where standard output is no terminal."""

_console = Console(stderr=True, highlight=False, markup=False, emoji=False, soft_wrap=True)


def print_message(message: str) -> None:
    """Print a line on standard error, above the progress bar where there is one.

    Args:
        message: the line.
    """
    _console.print(one_line(message))


def print_findings(findings: Sequence[Finding], stage: str) -> None:
    """Print warnings for the first findings: `pullfocus inspect` has the whole list.

    Args:
        findings: settings that are not honoured or cannot be used.
        stage: the stage as the user typed it.
    """
    for finding in findings[:MAX_WARNINGS]:
        print_message(f"warning: {finding.message}")
    if len(findings) > MAX_WARNINGS:
        print_message(f"warning: and {len(findings) - MAX_WARNINGS} more, see: pullfocus inspect {stage}")


def print_json(result: Any) -> None:
    """Print a machine-readable result on standard output.

    Args:
        result: dictionaries, lists, strings and finite numbers.
    """
    json.dump(result, sys.stdout, indent=2, allow_nan=False)
    sys.stdout.write("\n")


def print_result(result: RenderableType) -> None:
    """Print a result for people on standard output; nothing is wrapped where that is no terminal.

    Args:
        result: a table, or text.
    """
    console = Console(file=sys.stdout, highlight=False, markup=False, emoji=False)
    if not console.is_terminal:
        console.width = _PIPED_WIDTH
    console.print(result)


def camel_case_keys(record: dict[str, Any]) -> dict[str, Any]:
    """Convert keys to camel case: ``focus_distance_m`` becomes ``focusDistanceM``.

    Args:
        record: flat.
    """
    return {re.sub("_(.)", lambda letter: letter[1].upper(), key): value for key, value in record.items()}


def finite(record: dict[str, Any]) -> dict[str, Any]:
    """Replace infinities and NaN, which JSON cannot hold, by null.

    Args:
        record: flat.
    """
    return {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in record.items()}


class FrameProgress:
    """Progress of a run: a bar on a terminal, a line for each frame elsewhere.

    Args:
        total: number of frames.
    """

    def __init__(self, total: int) -> None:
        self._total = total
        self._done = 0
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=_console,
            disable=not _console.is_terminal,
            transient=True,
        )
        self._task = self._progress.add_task("frames", total=total)

    def __enter__(self) -> FrameProgress:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    def begin(self, name: str) -> None:
        """Begin a frame.

        Args:
            name: of its file.
        """
        self._progress.update(self._task, description=name)

    def update(self, fraction: float) -> None:
        """Show the progress within the frame.

        Args:
            fraction: 0 to 1.
        """
        self._progress.update(self._task, completed=self._done + fraction)

    def finish(self, name: str, seconds: float) -> None:
        """Finish a frame.

        Args:
            name: of its file, which is written.
            seconds: time that it took.
        """
        self._done += 1
        self._progress.update(self._task, completed=self._done)
        if not _console.is_terminal:
            print_message(f"{self._done}/{self._total} {name} {seconds:.1f} s")
