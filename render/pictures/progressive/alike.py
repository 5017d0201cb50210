"""Whether two values say the same: dataclasses, containers and arrays are compared by what they hold."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np


def alike(one: Any, other: Any, *, but: Collection[str] = ()) -> bool:
    """Whether two values say the same.

    Args:
        one: of them.
        other: of them.
        but: fields of the two themselves, where they are dataclasses, that do not count.
    """
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return bool(np.array_equal(one, other, equal_nan=one.dtype.kind == "f"))
    if is_dataclass(one):
        names = [field.name for field in fields(one) if field.name not in but]
        return all(alike(getattr(one, name), getattr(other, name)) for name in names)
    if isinstance(one, (tuple, list)):
        return len(one) == len(other) and all(map(alike, one, other))
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(alike(value, other[key]) for key, value in one.items())
    return bool(one == other)
