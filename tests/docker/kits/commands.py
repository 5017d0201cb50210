"""Command lines of containers, judged by the programs' own parsers: nothing is started."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from distributed.cli.dask_scheduler import main as dask_scheduler

from docs._site.command_line import parser_of
from service.jobs.dask_executor import DaskAddress


def parse(command: Sequence[str]) -> dict[str, Any]:
    """Parse the command line of a container.

    Args:
        command: from the program that is first started on.

    Returns:
        The arguments by their names.

    Raises:
        SystemExit: `pullfocus` refuses an argument.
        click.UsageError: Dask does.
    """
    words = list(command)
    assert words[:2] == ["tini", "--"]
    match words[2:]:
        case ["pullfocus", name, *typed]:
            arguments = vars(parser_of(name).parse_args(typed))
            if arguments.get("dask"):
                assert DaskAddress.parse(arguments["dask"]).scheduler is not None
            return arguments
        case ["dask", "scheduler", *typed]:
            arguments = dask_scheduler.make_context("scheduler", list(typed)).params
            assert not arguments["preload_argv"]  # where Dask puts what it does not know
            return arguments
    raise AssertionError(f"{words} starts no program that is known here")
