"""Equality by content of dataclasses, containers and arrays, which compare by identity or elementwise themselves."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np


def have_equal_content(one: Any, other: Any, *, except_fields: Collection[str] = ()) -> bool:
    """Compare two values by what they hold; NaN equals NaN, and values of different types are unequal.

    Args:
        one: the first.
        other: the second.
        except_fields: fields of the two themselves, where they are dataclasses, that are left out.
    """
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return bool(np.array_equal(one, other, equal_nan=one.dtype.kind == "f"))
    if is_dataclass(one):
        names = [field.name for field in fields(one) if field.name not in except_fields]
        return all(have_equal_content(getattr(one, name), getattr(other, name)) for name in names)
    if isinstance(one, (tuple, list)):
        return len(one) == len(other) and all(map(have_equal_content, one, other))
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(have_equal_content(value, other[key]) for key, value in one.items())
    return bool(one == other)
