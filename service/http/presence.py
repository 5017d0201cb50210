"""Presence: who looks at which shot."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager


class Presence:
    """Those who look at shots through live connections. Used in the event loop alone.

    Whoever writes events asks for the shots whose viewers have changed one by one, so that viewers wait for no event, and a crowd
    that comes at once is one event.
    """

    def __init__(self) -> None:
        self._viewers: dict[str, Counter[str]] = {}
        self._changed: dict[str, None] = {}
        self._has_changed = asyncio.Event()

    def names(self, shot: str) -> list[str]:
        """Return the names of those who look at a shot, in the order of the alphabet."""
        return sorted(self._viewers.get(shot, ()))

    async def next_change(self) -> str:
        """Return the id of a shot whose viewers have changed since it was returned; wait for one where there is none."""
        await self._has_changed.wait()
        shot = next(iter(self._changed))
        self._mark(shot, is_changed=False)
        return shot

    def _mark(self, shot: str, *, is_changed: bool) -> None:
        if is_changed:
            self._changed[shot] = None
        else:
            del self._changed[shot]
        (self._has_changed.set if self._changed else self._has_changed.clear)()

    @contextmanager
    def enter(self, shot: str, name: str) -> Iterator[None]:
        """Count a viewer until the end of the block.

        Args:
            shot: id of the shot.
            name: of the viewer, for people.
        """
        viewers = self._viewers.setdefault(shot, Counter())
        viewers[name] += 1
        if viewers[name] == 1:
            self._mark(shot, is_changed=True)
        try:
            yield
        finally:
            viewers[name] -= 1
            if not viewers[name]:
                del viewers[name]
                self._mark(shot, is_changed=True)
            if not viewers:
                self._viewers.pop(shot, None)
