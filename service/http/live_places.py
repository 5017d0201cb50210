"""Places of live connections: a bounded number, which clients share."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

LEAST_LEAD = 2
"""Places that the client who holds the most has to be ahead of the one who takes one of them. With a smaller lead, the two could
take the same place from each other again and again."""


@dataclass(frozen=True, eq=False)
class LivePlace:
    """Place of one live connection.

    Attributes:
        client: whose it is: the key or, without one, the counted address.
        taken: set once another client has taken the place.
    """

    client: str
    taken: asyncio.Event = field(default_factory=asyncio.Event)


class LivePlaces:
    """Places of all live connections. Used in the event loop alone.

    While there are free places, anybody may have them. Once there are none, a client who holds at least two fewer than whoever
    holds the most takes the newest of that one's places. So shares become equal, to within one place, and stay so.

    Args:
        most: number of places.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._held: list[LivePlace] = []

    def __len__(self) -> int:
        """Return the number of places that are held."""
        return len(self._held)

    @contextmanager
    def hold(self, client: str) -> Iterator[LivePlace | None]:
        """Hold a place; None where the client gets none.

        Args:
            client: who asks for it.
        """
        if len(self._held) >= self._most and not self._take_one(client):
            yield None
            return
        place = LivePlace(client)
        self._held.append(place)
        try:
            yield place
        finally:
            if place in self._held:
                self._held.remove(place)

    def _take_one(self, client: str) -> bool:
        """Take a place from the client who holds the most; false where the one who asks has nearly as many."""
        counts = Counter(place.client for place in self._held)
        if not counts:
            return False
        holder, most = counts.most_common(1)[0]
        if counts[client] > most - LEAST_LEAD:
            return False
        newest = next(place for place in reversed(self._held) if place.client == holder)
        self._held.remove(newest)
        newest.taken.set()
        return True
