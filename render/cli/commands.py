"""The commands of `pullfocus` that run in this process with USD and GL, and their argument tree."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from importlib import import_module, metadata

from render.cli.parser import Parser
from render.stage.opening import quiet_diagnostics

_COMMANDS = (
    ("record", "record", "render frames of a shot to EXR, PNG or JPEG files"),
    ("inspect", "inspect", "cameras, frame range, settings that are not honoured, validation findings"),
    ("focus-curve", "focus_curve", "write the focus over time for other tools, or import their curves as a USD layer"),
    ("meter", "meter", "light meter readings in EV, lux and stops; --key writes them as keys of the exposure"),
    ("lenses", "lenses", "the lens library; `lenses show NAME` has the numbers and a sheet of one"),
    ("films", "films", "the film library; `films show NAME` has the numbers and a data sheet of one"),
    ("bodies", "bodies", "camera bodies and film formats; `bodies show NAME` has fields of view and framing guides"),
    ("demo", "demo", "write the demo shot"),
)
"""Name, module of `render.cli` that has its ``add_arguments``, and purpose of each command."""


def run_command(typed: Sequence[str], added: Sequence[str]) -> None:
    """Parse the arguments of a command and run it.

    Args:
        typed: the arguments as typed after `pullfocus`.
        added: names of the commands that entry points add, for the help.

    Raises:
        PullfocusError: the command failed.
    """
    parsed = _argument_tree(typed, added).parse_args(typed)
    run: Callable[[argparse.Namespace], None] = parsed.run
    with quiet_diagnostics():
        run(parsed)


def _argument_tree(typed: Sequence[str], added: Sequence[str]) -> argparse.ArgumentParser:
    """Make the parser. Only the module of the typed command is imported: each takes a while."""
    parser = Parser(prog="pullfocus", description="See a USD shot through a real lens.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {metadata.version('pullfocus')}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name, module, purpose in _COMMANDS:
        command = commands.add_parser(name, help=purpose)
        if name in typed:
            import_module(f"render.cli.{module}").add_arguments(command)
    for name in added:
        commands.add_parser(name, help=f"pullfocus {name} --help says what it does")
    return parser
