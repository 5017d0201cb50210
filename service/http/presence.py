"""Presence: who looks at which shot."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager


class Presence:
    """Those who look at shots through live connections. Used in the event loop alone.

    Attributes:
        noting: held while an event of them is written, so that the last one tells who is there.
    """

    def __init__(self) -> None:
        self.noting = asyncio.Lock()
        self._viewers: dict[str, Counter[str]] = {}

    def names(self, shot: str) -> list[str]:
        """Return the names of those who look at a shot, in the order of the alphabet."""
        return sorted(self._viewers.get(shot, ()))

    @contextmanager
    def enter(self, shot: str, name: str) -> Iterator[None]:
        """Count a viewer until the end of the block.

        Args:
            shot: id of the shot.
            name: of the viewer, for people.
        """
        viewers = self._viewers.setdefault(shot, Counter())
        viewers[name] += 1
        try:
            yield
        finally:
            viewers[name] -= 1
            if not viewers[name]:
                del viewers[name]
            if not viewers:
                self._viewers.pop(shot, None)
