"""The commands of `pullfocus` that run in this process with USD and GL, and their argument tree."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from typing import Any

from render.cli.command_list import COMMANDS
from render.cli.parser import Parser
from render.stage.opening import quiet_diagnostics


def parse_command(typed: Sequence[str], added: Sequence[str]) -> Callable[[], None]:
    """Parse the arguments of a command, and return a function that runs it.

    Args:
        typed: the arguments as typed after `pullfocus`.
        added: names of the commands that entry points add, for the help.

    Raises:
        PullfocusError: the arguments are wrong. The returned function raises it where the command fails.
    """
    return partial(_run, _argument_tree(typed, added).parse_args(typed))


def _run(parsed: argparse.Namespace) -> None:
    with quiet_diagnostics():
        parsed.run(parsed)


class _ShowVersion(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *values: Any) -> None:
        from importlib import metadata  # takes a while to import

        parser.exit(message=f"{parser.prog} {metadata.version('pullfocus')}\n")


def _argument_tree(typed: Sequence[str], added: Sequence[str]) -> argparse.ArgumentParser:
    """Make the parser. Only the module of the typed command is imported: each takes a while."""
    parser = Parser(prog="pullfocus", description="See a USD shot through a real lens.")
    parser.add_argument("--version", action=_ShowVersion, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name, (module, purpose) in COMMANDS.items():
        command = commands.add_parser(name, help=purpose)
        if name in typed:
            import_module(f"render.cli.{module}").add_arguments(command)
    for name in added:
        commands.add_parser(name, help=f"pullfocus {name} --help says what it does")
    return parser
