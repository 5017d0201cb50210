"""Hints for a name that no library entry has."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

_ALIKE = 0.5  # share of letters in the same order, of difflib's ratio
_AT_MOST = 3
_SHORTEST_PART = 3  # letters: shorter ones are like everything


def hint(name: str, names: Iterable[str]) -> str:
    """The second half of a message: the nearest names, else all that there are.

    Args:
        name: as it was asked for, in the library's own spelling.
        names: of the library.
    """
    known = list(names)
    alike = {own: _likeness(name, own) for own in known}
    near = [own for own in sorted(known, key=lambda own: alike[own], reverse=True) if max(alike[own]) >= _ALIKE]
    return f"did you mean {' or '.join(near[:_AT_MOST])}?" if near else f"the library has {', '.join(known)}"


def _likeness(name: str, known: str) -> tuple[float, float]:
    """Return the likeness of a name to the nearest word of a known name, and to the whole of it."""
    whole, *words = (
        difflib.SequenceMatcher(None, name, own).ratio()
        for own in (known, *(word for word in known.split("_") if len(word) >= _SHORTEST_PART))
    )
    return max([whole, *words]), whole
