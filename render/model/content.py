"""Digests of values by what they hold."""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np


def digest_of(value: Any) -> str:
    """Return a digest of a value: 32 hexadecimal digits, equal for values that hold the same.

    Args:
        value: a dataclass, array, sequence, mapping, or what has a ``repr`` that says all, such as numbers, strings and USD's
            values; of these, nested.
    """
    found = hashlib.sha256()
    _add(found, value)
    return found.hexdigest()[:32]


def _add(found: hashlib._Hash, value: Any) -> None:
    found.update(f"<{type(value).__name__}".encode())
    if isinstance(value, np.ndarray):
        found.update(f"{value.dtype}{value.shape}".encode() + np.ascontiguousarray(value).tobytes())
    elif is_dataclass(value):
        for field in fields(value):
            found.update(field.name.encode())
            _add(found, getattr(value, field.name))
    elif isinstance(value, (tuple, list)):
        for item in value:
            _add(found, item)
    elif isinstance(value, dict):
        for key in sorted(value):
            _add(found, key)
            _add(found, value[key])
    else:
        found.update(repr(value).encode())
    found.update(b">")
