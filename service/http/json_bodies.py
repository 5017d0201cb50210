"""Reads JSON as RFC 8259 has it: in UTF-8, with no NaN, and no key twice in an object, and not very many values."""

from __future__ import annotations

import json
import sys
from typing import Any

MAX_KEYS = 20_000
"""Keys of one object: each that a model does not know costs the event loop an error of its own."""
MAX_VALUES = 200_000
"""Values of one text, by its commas and opening brackets, those in strings too: it is read on the event loop. What is large in a
valid request is a file in base64, which has none."""
_MARKS = b",[{"


def read_json(content: bytes) -> Any:
    """Parse JSON.

    Raises:
        json.JSONDecodeError: it is none, says the same key twice, has more than `MAX_KEYS` in an object or more than `MAX_VALUES`
            in all, or is nested too deeply; NaN and Infinity are none.
        UnicodeDecodeError: it is no UTF-8.
    """
    text = content.decode("utf-8")
    if sum(content.count(mark) for mark in _MARKS) > MAX_VALUES:
        raise json.JSONDecodeError(f"it has more than {MAX_VALUES:,} values", text, 0)
    try:
        return json.loads(text, parse_constant=_refuse_constant, object_pairs_hook=_to_object)
    except json.JSONDecodeError:
        raise
    except RecursionError as error:
        raise json.JSONDecodeError("it is nested too deeply", text, 0) from error
    except ValueError as error:  # of `int`
        most = sys.get_int_max_str_digits()
        raise json.JSONDecodeError(f"an integer has more than {most:,} digits", text, 0) from error


def _refuse_constant(name: str) -> Any:
    raise json.JSONDecodeError(f"{name} is no number of JSON", name, 0)


def _to_object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if len(pairs) > MAX_KEYS:
        raise json.JSONDecodeError(f"an object has more than {MAX_KEYS:,} keys", pairs[0][0], 0)
    for name, value in pairs:
        if name in found:
            raise json.JSONDecodeError(f"the key {name[:80]!r} stands there twice", name, 0)
        found[name] = value
    return found
