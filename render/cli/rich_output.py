"""Tables and the progress bar, drawn by rich: a module of its own, since rich takes a while to import."""

from __future__ import annotations

import sys

from rich.console import Console, RenderableType
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

_PIPED_WIDTH = 320
"""Width of tables where standard output is no terminal."""


def print_result(result: RenderableType) -> None:
    """Print a result for people on standard output; nothing is wrapped where that is no terminal.

    Args:
        result: a table, or text.
    """
    console = Console(file=sys.stdout, highlight=False, markup=False, emoji=False)
    if not console.is_terminal:
        console.width = _PIPED_WIDTH
    console.print(result)


class FrameBar:
    """Progress bar of a run of frames, on standard error.

    Args:
        total: number of frames.
    """

    def __init__(self, total: int) -> None:
        self._console = Console(stderr=True, highlight=False, markup=False, emoji=False, soft_wrap=True)
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=self._console,
            transient=True,
        )
        self._task = self._progress.add_task("frames", total=total)

    def start(self) -> None:
        """Show the bar."""
        self._progress.start()

    def stop(self) -> None:
        """Remove the bar."""
        self._progress.stop()

    def print_above(self, line: str) -> None:
        """Print a line above the bar."""
        self._console.print(line)

    def describe(self, name: str) -> None:
        """Name what is being made."""
        self._progress.update(self._task, description=name)

    def update(self, done: float) -> None:
        """Show how many frames are done."""
        self._progress.update(self._task, completed=done)
