"""The `pullfocus` command: it dispatches to a command, and turns errors into one line and an exit status.

Exit status: 0 done, 1 failed, 2 wrong arguments, 130 stopped by Ctrl-C.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from render.cli.command_list import COMMANDS
from render.cli.console import print_message
from render.cli.late_dataclasses import compile_methods_late
from render.cli.parser import WRONG_ARGUMENTS
from render.errors import PullfocusError, SettingsError
from render.gl.late_package import import_late

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

DONE, FAILED, INTERRUPTED = 0, 1, 130

ENTRY_POINT_GROUP = "pullfocus.commands"
"""Entry points of commands in other packages: functions from arguments to the exit status. Each is loaded when it is called,
and may raise `PullfocusError`."""

_LATE_PACKAGES = ("OpenImageIO", "xml.etree.ElementTree")
"""Packages that not every command uses: their code runs when one of their names is first used."""

_STOPPED = "stopped; what is written is whole"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `pullfocus` and return its exit status.

    Args:
        arguments: as typed after `pullfocus`; None takes the process's own.
    """
    typed = list(sys.argv[1:] if arguments is None else arguments)
    try:
        return _run(typed)
    except SettingsError as error:
        return _print_failure(error.detail, WRONG_ARGUMENTS)
    except PullfocusError as error:
        return _print_failure(error.detail, FAILED)
    except KeyboardInterrupt:
        return _print_failure(_STOPPED, INTERRUPTED)
    except BrokenPipeError:  # the reader of our output has ended, such as `head`
        _drop_output()
        return FAILED
    except OSError as error:
        if error.filename is not None:
            return _print_failure(f"{error.filename}: {error.strerror}", FAILED)
        _drop_output()
        return _print_failure(f"standard output cannot be written: {error.strerror}", FAILED)
    except Exception as error:
        if _hides_interrupt(error):
            return _print_failure(_STOPPED, INTERRUPTED)
        if os.environ.get("PULLFOCUS_TRACEBACK"):
            raise
        return _print_failure(
            f"a fault of the program, {type(error).__name__}: {_one_line(error)}; "
            "PULLFOCUS_TRACEBACK=1 shows where, please report it",
            FAILED,
        )


def _run(typed: list[str]) -> int:
    added = {} if typed and typed[0] in COMMANDS else _added_commands()
    if typed and typed[0] in added:
        return added[typed[0]].load()(typed[1:])  # type: ignore[no-any-return]  # the contract of the group
    compile_methods_late()
    for name in _LATE_PACKAGES:
        import_late(name)
    with _without_collection():
        # Imported here because these commands import USD and GL, which the process of an added command (`serve`) does not load.
        from render.cli.commands import parse_command

        run = parse_command(typed, list(added))
    run()
    sys.stdout.flush()
    return DONE


@contextmanager
def _without_collection() -> Iterator[None]:
    """Turn garbage collection off while modules are imported. The first time, exempt them from later collections too.

    They live as long as the process, and searching them takes a tenth of the start.
    """
    was_enabled, is_first = gc.isenabled(), "render.cli.commands" not in sys.modules
    gc.disable()
    try:
        yield
        if is_first:
            gc.freeze()
    finally:
        if was_enabled:
            gc.enable()


def _added_commands() -> dict[str, EntryPoint]:
    from importlib import (
        metadata,
    )  # takes a while to import, and entry points to read: not for the commands of this package

    return {entry.name: entry for entry in metadata.entry_points(group=ENTRY_POINT_GROUP)}


def _drop_output() -> None:
    """Redirect standard output to the null device, so that flushing it at exit does not raise."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _print_failure(message: str, status: int) -> int:
    print_message(f"pullfocus: {message}")
    return status


def _hides_interrupt(error: BaseException | None) -> bool:
    """True where Ctrl-C caused an error: ctypes reports a KeyboardInterrupt while it converts an argument as an ArgumentError."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt) or "KeyboardInterrupt" in str(error):
            return True
        error = error.__cause__ or error.__context__
    return False


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
