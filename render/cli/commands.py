"""The commands of `pullfocus` that run in this process with USD and GL, and their argument tree."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from importlib import metadata

from render.cli import bodies, demo, films, focus_curve, inspect, lenses, meter, record
from render.cli.parser import Parser
from render.stage.opening import quiet_diagnostics


def run_command(typed: Sequence[str], added: Sequence[str]) -> None:
    """Parse the arguments of a command and run it.

    Args:
        typed: the arguments as typed after `pullfocus`.
        added: names of the commands that entry points add, for the help.

    Raises:
        PullfocusError: the command failed.
    """
    parsed = _argument_tree(added).parse_args(typed)
    run: Callable[[argparse.Namespace], None] = parsed.run
    with quiet_diagnostics():
        run(parsed)


def _argument_tree(added: Sequence[str]) -> argparse.ArgumentParser:
    parser = Parser(prog="pullfocus", description="See a USD shot through a real lens.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {metadata.version('pullfocus')}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for module in (record, inspect, focus_curve, meter, lenses, films, bodies, demo):
        module.add_parser(commands)
    for name in added:
        commands.add_parser(name, help=f"pullfocus {name} --help says what it does")
    return parser
