"""Output of a bench: a table for people, JSON for programs."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from render.files import check_writable, write_atomic
from render.lab.bench.results import Goal


def check_file(json_path: str | None) -> None:
    """Check, before anything is measured, that the requested JSON file can be written.

    Args:
        json_path: a file, ``-`` for standard output, or None for none.

    Raises:
        OutputError: it cannot.
    """
    if json_path not in (None, "-"):
        check_writable(json_path)


def say(result: Any, table: str, json_path: str | None) -> None:
    """Write the JSON to the requested file, and print the table unless the JSON is printed.

    Args:
        result: a dataclass of all that was found.
        table: the same for people.
        json_path: as in `check_file`.

    Raises:
        OutputError: the file cannot be written.
    """
    text = json.dumps(asdict(result), indent=2) + "\n"
    if json_path not in (None, "-"):
        write_atomic(Path(json_path), text.encode())
    sys.stdout.write(text if json_path == "-" else table)


def goal_lines(goals: Sequence[Goal]) -> list[str]:
    """A line for each goal."""
    return [f"{'pass' if goal.holds else 'FAIL'}  {goal.goal} {goal.want:g}: {goal.got:.4g}" for goal in goals]
