"""Programs of networks of nodes that the device of this process refuses: materials that need one are drawn otherwise."""

from __future__ import annotations

import hashlib


class RefusedPrograms:
    """Functions of networks that could not be compiled or linked, and why.

    What draws adds them, and what reads materials leaves them out from then on.
    """

    def __init__(self) -> None:
        self._reasons: dict[bytes, str] = {}

    @property
    def count(self) -> int:
        """Number of them, which grows alone."""
        return len(self._reasons)

    def add(self, functions: str, reason: str) -> None:
        """Add the functions of a network; the first reason stays."""
        self._reasons.setdefault(_digest(functions), reason)

    def reason(self, functions: str) -> str | None:
        """Return why functions are refused; None where they are not."""
        return self._reasons.get(_digest(functions))


def _digest(functions: str) -> bytes:
    return hashlib.sha256(functions.encode()).digest()


REFUSED = RefusedPrograms()
"""Those of this process, whose devices are alike."""
