"""Rate limits: token buckets by name, in bounded memory."""

from __future__ import annotations

import math
import time
from collections import OrderedDict
from collections.abc import Callable

MAX_BUCKETS = 50_000


class RateLimit:
    """Limits how often each name may do something: `burst` times at once, and `per_s` times a second from then on.

    Buckets that were not used for the longest time are forgotten first where there are too many; they are mostly full again.

    Args:
        per_s: tokens that a bucket gets each second.
        burst: tokens that a bucket holds.
        clock: seconds that never go back.
    """

    def __init__(self, per_s: float, burst: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._per_s = per_s
        self._burst = burst
        self._clock = clock
        self._buckets: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def take(self, name: str) -> int | None:
        """Take a token from a bucket.

        Returns:
            None where there was one; else the seconds after which there will be one.
        """
        now = self._clock()
        tokens, filled = self._buckets.pop(name, (self._burst, now))
        tokens = min(self._burst, tokens + (now - filled) * self._per_s)
        has_one = tokens >= 1
        self._buckets[name] = tokens - has_one, now
        if len(self._buckets) > MAX_BUCKETS:
            self._buckets.popitem(last=False)
        return None if has_one else math.ceil((1 - tokens) / self._per_s)
