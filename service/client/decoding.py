"""Answers as dataclasses. Values that a dataclass does not have are left out, since a newer service may send more."""

from __future__ import annotations

import dataclasses
import functools
import json
import re
import types
from collections.abc import Mapping
from datetime import datetime
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from .errors import AnswerError

T = TypeVar("T")


def decode(kind: type[T], content: bytes) -> T:
    """Read an answer in JSON.

    Args:
        kind: a dataclass.
        content: the body of the answer.

    Raises:
        AnswerError: it is no JSON, or lacks a value, or one is of another type.
    """
    try:
        return from_json(kind, json.loads(content))
    except (ValueError, RecursionError, OverflowError) as error:  # what json and datetime raise, too
        raise AnswerError(f"the answer is no {kind.__name__}: {_one_line(error)}") from error


def from_json(kind: type[T], value: Any) -> T:
    """Return a value of JSON as a dataclass.

    Args:
        kind: the dataclass.
        value: as `json.loads` returns it.

    Raises:
        ValueError: a value is missing, or of another type.
    """
    read: T = _read(kind, value, kind.__name__)
    return read


def camel_case(name: str) -> str:
    """Return a name as JSON has it: ``size_bytes`` is ``sizeBytes``."""
    return re.sub("_(.)", lambda letter: letter[1].upper(), name)


def _read(kind: Any, value: Any, place: str) -> Any:
    if get_origin(kind) is types.UnionType:
        (some,) = (part for part in get_args(kind) if part is not types.NoneType)
        return None if value is None else _read(some, value, place)
    if get_origin(kind) is list:
        if not isinstance(value, list):
            raise ValueError(f"{place} is no list")
        return [_read(get_args(kind)[0], item, place) for item in value]
    if dataclasses.is_dataclass(kind):
        return _read_object(kind, value, place)
    if kind is datetime and isinstance(value, str):
        return datetime.fromisoformat(value)
    if kind is float and type(value) is int:
        return float(value)
    if type(value) is not kind:
        raise ValueError(f"{place} is {type(value).__name__}, expected {kind.__name__}")
    return value


def _read_object(kind: Any, value: Any, place: str) -> Any:
    if not isinstance(value, dict):
        raise ValueError(f"{place} is no object")
    values = {}
    for name, part in _types(kind).items():
        sent = camel_case(name)
        if sent in value:
            values[name] = _read(part, value[sent], f"{place}.{sent}")
    try:
        return kind(**values)
    except TypeError as error:  # a value is missing
        raise ValueError(f"{place}: {error}") from error


@functools.cache
def _types(kind: Any) -> Mapping[str, Any]:
    return get_type_hints(kind)


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:300]
