"""Messages, progress and results of commands. Messages go to standard error; standard output is for results."""

from __future__ import annotations

import json
import math
import re
import sys
from collections import Counter
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar

from render.errors import one_line

if TYPE_CHECKING:
    from render.cli.rich_output import FrameBar
    from render.stage.findings import Finding  # its package imports USD, which `pullfocus serve` does not load

MAX_WARNINGS = 8


def print_message(message: str) -> None:
    """Print a line on standard error, above the progress bar where there is one.

    Args:
        message: the line.
    """
    line = one_line(message)
    if FrameProgress.shown is None:
        print(line, file=sys.stderr, flush=True)
    else:
        FrameProgress.shown.print_above(line)


def print_findings(findings: Sequence[Finding], stage: str) -> None:
    """Print warnings for some findings, the first one of each code before the second ones; `pullfocus inspect` lists all.

    Args:
        findings: settings that are not honoured or cannot be used.
        stage: the stage as the user typed it.
    """
    numbers: Counter[str] = Counter()

    def number_of_its_code(finding: Finding) -> int:
        numbers[finding.code] += 1
        return numbers[finding.code]

    for finding in sorted(findings, key=number_of_its_code)[:MAX_WARNINGS]:
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

    Attributes:
        shown: the bar on the terminal; None where there is none.
    """

    shown: ClassVar[FrameBar | None] = None

    def __init__(self, total: int) -> None:
        self._total = total
        self._done = 0
        self._bar: FrameBar | None = None
        if sys.stderr.isatty():
            from render.cli.rich_output import FrameBar  # rich takes a while to import: only where there is a bar

            self._bar = FrameBar(total)

    def __enter__(self) -> FrameProgress:
        if self._bar is not None:
            self._bar.start()
        FrameProgress.shown = self._bar
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        FrameProgress.shown = None
        if self._bar is not None:
            self._bar.stop()

    def begin(self, name: str) -> None:
        """Begin a frame.

        Args:
            name: of its file.
        """
        if self._bar is not None:
            self._bar.describe(name)

    def update(self, fraction: float) -> None:
        """Show the progress within the frame.

        Args:
            fraction: 0 to 1.
        """
        if self._bar is not None:
            self._bar.update(self._done + fraction)

    def finish(self, name: str, seconds: float) -> None:
        """Finish a frame.

        Args:
            name: of its file, which is written.
            seconds: time that it took.
        """
        self._done += 1
        if self._bar is None:
            print_message(f"{self._done}/{self._total} {name} {seconds:.1f} s")
        else:
            self._bar.update(self._done)
