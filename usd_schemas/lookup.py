"""What a library answers to a name that nothing in it has."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def hint(name: str, names: Iterable[str]) -> str:
    """The second half of a message: the nearest names, else all that there are.

    Args:
        name: as it was asked for, in the library's own spelling.
        names: of the library.
    """
    known = list(names)
    near = difflib.get_close_matches(name, known, n=3, cutoff=0.5)
    return f"did you mean {' or '.join(near)}?" if near else f"the library has {', '.join(known)}"
