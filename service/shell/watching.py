"""A render that is watched from a shell: its progress, its frames as they come, and its end."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from types import TracebackType

from rich.markup import escape

from render.cli.console import FrameProgress, print_message
from render.cli.rich_output import FrameBar
from render.errors import one_line
from service.client import Client, Render, RenderTask
from service.shell.connection import again

_MOST_ERRORS = 8


def watch(client: Client, render_id: str, out: Path | None, typed: argparse.Namespace) -> int:
    """Watch a render until its end. Ctrl-C leaves it running.

    Args:
        client: of the service.
        render_id: the render.
        out: folder that frames go to as they are done; None leaves them with the service.
        typed: the address of the service, for messages.

    Returns:
        The exit status: 0 where all frames are there, else 1.

    Raises:
        ClientError: the service cannot be reached, or refuses.
    """
    try:
        with RenderProgress() as progress:
            if out is None:
                render = client.wait(render_id, on_progress=progress.show)
            else:
                client.download(
                    render_id,
                    out,
                    follow=True,
                    on_progress=progress.show,
                    on_file=lambda path: progress.tell(str(path)),
                )
                render = client.get(render_id)
    except KeyboardInterrupt:
        command = again(typed, "jobs", "watch", render_id, *(["--out", str(out)] if out else []))
        print_message(f"render {render_id} goes on: `{command}` watches it again")
        raise
    print_end(client, render, typed)
    return 0 if render.state == "done" else 1


def print_end(client: Client, render: Render, typed: argparse.Namespace) -> None:
    """Print how a render has ended, and the errors of frames that have failed."""
    print_message(f"render {render.id} is {_state(render)}")
    if not render.failed:
        return
    failed = [task for task in client.tasks(render) if task.state == "failed"]
    for task in failed[:_MOST_ERRORS]:
        print_message(f"frame {task.frame}: {error_of(task)}")
    if len(failed) > _MOST_ERRORS:
        print_message(f"and {len(failed) - _MOST_ERRORS} more: {again(typed, 'jobs', 'show', render.id)}")
    if failed:
        print_message(f"`{again(typed, 'jobs', 'log', render.id, str(failed[0].frame))}` prints the log of the first")
    print_message(f"`{again(typed, 'jobs', 'retry', render.id)}` draws them again")


def error_of(task: RenderTask) -> str:
    """Return the newest error of a frame; empty where there is none."""
    return next((attempt.error for attempt in reversed(task.attempts) if attempt.error), "")


class RenderProgress:
    """Progress of a render: a bar on a terminal, a line for each change elsewhere."""

    def __init__(self) -> None:
        self._bar: FrameBar | None = None
        self._line = ""

    def __enter__(self) -> RenderProgress:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        FrameProgress.shown = None
        if self._bar is not None:
            self._bar.stop()

    def show(self, render: Render) -> None:
        """Show how far a render is."""
        if not sys.stderr.isatty():
            line = f"{render.done}/{render.count} {render.id} {_state(render)}"
            if line != self._line:  # what has changed may not be in it
                print_message(line)
                self._line = line
            return
        if self._bar is None:
            self._bar = FrameProgress.shown = FrameBar(render.count)
            self._bar.start()
        self._bar.describe(escape(one_line(f"{render.name} {_state(render)}")))
        self._bar.update(render.done + render.failed + render.canceled)

    def tell(self, name: str) -> None:
        """Tell that a file is written."""
        if self._bar is None:
            print_message(name)


def _state(render: Render) -> str:
    """Return the state of a render in words."""
    parts = [render.state]
    parts += [f"{count} {word}" for count, word in ((render.failed, "failed"), (render.canceled, "canceled")) if count]
    if render.seconds_left is not None:
        parts.append(f"{render.seconds_left:.0f} s left")
    return ", ".join(parts)
