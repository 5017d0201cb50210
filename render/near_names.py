"""Suggestions for a name that is not known: the nearest known ones."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

_ALIKE = 0.5  # share of letters in the same order, of difflib's ratio
_AT_MOST = 3


def hint(name: str, known: Iterable[str]) -> str:
    """The second half of a message about an unknown name: ``did you mean 'a' or 'b'?``, else all names that there are.

    Names that hold the written one come first, then those that are written alike; small and capital letters are the same.

    Args:
        name: as it was written.
        known: all that would have been right.
    """
    names = list(dict.fromkeys(known))
    if not names:
        return "there are none"
    near = near_names(name, names)
    if near:
        return "did you mean " + " or ".join(f"'{n}'" for n in near) + "?"
    return "expected one of " + ", ".join(f"'{n}'" for n in names)


def near_names(name: str, known: Iterable[str]) -> list[str]:
    """Up to three of the known names that are nearest to the written one, the nearest first."""
    plain = {n: n.casefold() for n in known}
    written = name.strip().casefold()
    holding = [n for n, letters in plain.items() if written and written in letters]
    alike = difflib.get_close_matches(written, plain.values(), n=_AT_MOST, cutoff=_ALIKE)
    ranked = [*holding, *(n for letters in alike for n, own in plain.items() if own == letters)]
    return list(dict.fromkeys(ranked))[:_AT_MOST]
