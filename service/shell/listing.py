"""Renders as tables and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, is_dataclass
from datetime import datetime
from typing import Any

from rich import box
from rich.table import Table

from render.cli.console import camel_case_keys, print_json
from render.cli.rich_output import print_result
from render.errors import one_line
from service.client import Render, RenderPlan, RenderTask
from service.shell.watching import error_of

_COLUMNS = ("id", "state", "done", "frames", "priority", "shot", "owner", "name", "sent")


def print_renders(renders: Sequence[Render], *, as_json: bool) -> None:
    """Print renders on standard output."""
    if as_json:
        print_json({"renders": [_json(render) for render in renders]})
        return
    table = _table(*_COLUMNS)
    for render in renders:
        _add(
            table,
            render.id,
            render.state,
            f"{render.done}/{render.count}",
            render.frames,
            str(render.priority),
            render.shot,
            render.owner,
            render.name,
            _local(render.created_at),
        )
    print_result(table)


def print_render(render: Render, tasks: Sequence[RenderTask], *, as_json: bool) -> None:
    """Print a render, and its frames with the attempts at them, on standard output."""
    if as_json:
        print_json(_json(render) | {"tasks": [_json(task) for task in tasks]})
        return
    about = _table("", "", header=False)
    for key, value in _json(render).items():
        _add(about, key, "" if value is None else str(value))
    print_result(about)
    table = _table("frame", "state", "attempts", "bytes", "error")
    for task in tasks:
        size = f"{sum(file.size_bytes for file in task.files):,}" if task.files else ""
        _add(table, str(task.frame), task.state, str(len(task.attempts)), size, error_of(task))
    print_result(table)


def print_plan(plan: RenderPlan) -> int:
    """Print a render that is tried on standard output.

    Returns:
        The exit status: 1 where it would be refused, or its frames would fail.
    """
    if plan.count:
        cost = f"about {plan.seconds_of_processor:g} s of processor time"
        print(f"{plan.count} {'frame' if plan.count == 1 else 'frames'}, {one_line(plan.frames)}: {cost}")
    if plan.settings is not None:
        about = _table("", "", header=False)
        for key, value in _json(plan.settings).items():
            _add(about, key, " ".join(value) if isinstance(value, list) else "" if value is None else str(value))
        print_result(about)
    for finding in plan.findings:
        place = f"{finding.path}: " if finding.path else ""
        print(one_line(f"{finding.severity}: {place}{finding.message}"))
    return 1 if any(finding.severity == "error" for finding in plan.findings) else 0


def _table(*columns: str, header: bool = True) -> Table:
    table = Table(box=box.SIMPLE, show_header=header)
    for column in columns:
        table.add_column(column, overflow="fold")
    return table


def _add(table: Table, *cells: str) -> None:
    table.add_row(*map(one_line, cells))


def _local(time: datetime) -> str:
    return f"{time.astimezone():%Y-%m-%d %H:%M}"


def _json(value: Any) -> Any:
    """Return an answer of the service as it came, in JSON."""
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, dict):
        return {key: _json(part) for key, part in camel_case_keys(value).items()}
    if isinstance(value, list):
        return [_json(part) for part in value]
    return value.isoformat() if isinstance(value, datetime) else value
