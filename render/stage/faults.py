"""Translation of what USD raises about damaged files into errors of ours."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from pxr import Tf

from render.errors import StageError

# RuntimeError is how USD's Python reports C++ exceptions; RecursionError is one, too.
FAULTS = (Tf.ErrorException, Tf.CppException, RuntimeError, UnicodeError, OverflowError)
_MOST_LETTERS = 300


@contextmanager
def faults_of_stage(name: str) -> Iterator[None]:
    """Context that raises USD's own exceptions as `StageError`.

    Args:
        name: of the root layer, for the message.
    """
    try:
        yield
    except FAULTS as error:
        message = f"a file of {name} is damaged, or asks for what USD cannot do"
        raise StageError(message, code="stage_unreadable", path=name) from error


def text_of(error: object) -> str:
    """Message of one of USD's errors, which may hold bytes of a damaged file."""
    try:
        return str(error)
    except UnicodeDecodeError:
        return " : 'it holds bytes that are no UTF-8 text'"


def shorten(text: str) -> str:
    """A message without the rest of the line of a file that it repeats."""
    return text if len(text) <= _MOST_LETTERS else f"{text[:_MOST_LETTERS]}…"
