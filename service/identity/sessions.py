"""Sessions of the page: a cookie stands for a key. They are kept in memory, so that a restart ends them all."""

from __future__ import annotations

import hashlib
import secrets
import time
from collections import OrderedDict
from collections.abc import Callable

SESSION_S = 12 * 3600
MAX_SESSIONS = 10_000
MAX_SESSIONS_EACH = 100
"""Sessions of one key: whoever has it cannot end those of all others by beginning many."""


class Sessions:
    """The open sessions, by the hash of their token.

    Args:
        clock: seconds that never go back.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._open: OrderedDict[str, tuple[str, float]] = OrderedDict()

    def begin(self, key_id: str) -> str:
        """Open a session for a key and return its token. The oldest one of the key, or of all, ends where there are too many."""
        token = secrets.token_urlsafe(32)
        self._open[_hash(token)] = key_id, self._clock() + SESSION_S
        own = [hashed for hashed, (other, _) in self._open.items() if other == key_id]
        if len(own) > MAX_SESSIONS_EACH:
            del self._open[own[0]]
        if len(self._open) > MAX_SESSIONS:
            self._open.popitem(last=False)
        return token

    def key_id(self, token: str) -> str | None:
        """Return the id of a session's key; None where it has ended."""
        return self._open[_hash(token)][0] if self.left_s(token) > 0 else None

    def left_s(self, token: str) -> float:
        """Return the seconds until a session ends; 0 where it has ended."""
        _, ends = self._open.get(_hash(token), ("", 0.0))
        return max(0.0, ends - self._clock())

    def end(self, token: str) -> None:
        """End a session, if it is open."""
        self._open.pop(_hash(token), None)


def _hash(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()
