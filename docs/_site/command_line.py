"""The command line reference, from the argument parsers of the commands."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from unittest import mock

from docs._site.markdown import anchor, plain, table
from render.cli.main import ENTRY_POINT_GROUP, main

INTRODUCTION = """# Command line

`pullfocus COMMAND --help` prints what this page says. Commands exit with status 0 when they are done, 1 when they
failed, 2 when the arguments are wrong and 130 when Ctrl-C stopped them. An error is one line that says what to do about it.

"""


class _Parser(BaseException):
    """Carries a parser out of the command that was about to parse its arguments."""

    def __init__(self, parser: argparse.ArgumentParser) -> None:
        super().__init__(parser.prog)
        self.parser = parser


def page() -> str:
    """Every command with its arguments."""
    names = [name for name, _ in _subparsers(parser_of("--version"))]
    parsers = dict(_subparsers(parser_of(*names)))  # only commands that are typed have their arguments
    for entry in metadata.entry_points(group=ENTRY_POINT_GROUP):
        parsers[entry.name] = parser_of(entry.name)
    commands = "\n".join(_command(parser) for parser in parsers.values())
    return INTRODUCTION + _index(parsers) + commands


def parser_of(*typed: str) -> argparse.ArgumentParser:
    """The parser that `pullfocus` hands the typed arguments to."""

    def carry_out(self: argparse.ArgumentParser, *_: object, **__: object) -> None:
        raise _Parser(self)

    # `main` turns every Exception into an exit status, so that what carries the parser out is none.
    with mock.patch.object(argparse.ArgumentParser, "parse_args", carry_out):
        try:
            main(typed)
        except _Parser as carried:
            return carried.parser
    raise LookupError(f"pullfocus {' '.join(typed)} parses no arguments")


def _subparsers(parser: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """Commands under a parser, without those that only name an entry point."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            yield from action.choices.items()


def _index(parsers: dict[str, argparse.ArgumentParser]) -> str:
    return " · ".join(f"[`{name}`](#{anchor(parser.prog)})" for name, parser in parsers.items()) + "\n\n"


def _command(parser: argparse.ArgumentParser, level: int = 2) -> str:
    text = f"{'#' * level} {parser.prog} {{ #{anchor(parser.prog)} }}\n\n"
    if parser.description:
        text += plain(parser.description) + "\n\n"
    text += f"```text\n{_usage(parser)}\n```\n\n"
    for group in parser._action_groups:
        actions = [action for action in group._group_actions if _is_shown(action)]
        if actions:
            text += _group(group.title or "", actions)
    return text + "".join(_command(child, level + 1) for _, child in _subparsers(parser))


def _group(title: str, actions: list[argparse.Action]) -> str:
    heading = f"**{title[:1].upper()}{title[1:]}**\n\n"
    return heading + table(("argument", "meaning"), ((_name(action), _meaning(action)) for action in actions)) + "\n"


def _is_shown(action: argparse.Action) -> bool:
    return not isinstance(action, (argparse._HelpAction, argparse._SubParsersAction))


def _name(action: argparse.Action) -> str:
    value = action.metavar or ("" if action.nargs == 0 or action.choices else action.dest.upper())
    value = value if isinstance(value, str) else " ".join(value)
    if not action.option_strings:
        return f"`{value}`"
    value = f" [{value}]" if action.nargs == "?" else f" {value}" if value and action.nargs != 0 else ""
    return " ".join(f"`{option}{value}`" for option in action.option_strings)


def _meaning(action: argparse.Action) -> str:
    text = (action.help or "") % {**vars(action), "prog": "pullfocus"}
    if action.choices is not None and not isinstance(action.choices, dict):
        text += f"; one of {', '.join(f'`{choice}`' for choice in action.choices)}"
    if _has_default(action) and "default" not in text:
        text += f"; default `{action.default}`"
    return plain(text.replace(str(Path.home()), "~"))


def _has_default(action: argparse.Action) -> bool:
    return action.nargs != 0 and action.default not in (None, "", argparse.SUPPRESS)


def _usage(parser: argparse.ArgumentParser) -> str:
    formatter = argparse.HelpFormatter(parser.prog, width=100)
    formatter.add_usage(parser.usage, parser._actions, parser._mutually_exclusive_groups, prefix="")
    return formatter.format_help().rstrip().replace(str(Path.home()), "~")
