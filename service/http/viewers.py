"""Viewers of shots: who else looks at a shot through a live connection of this process, and at which frame."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count

from pydantic import TypeAdapter

from service.models.live import LiveViewer

Tell = Callable[[str], None]
"""Takes a `service.models.live.LiveViewers` as JSON."""
Later = Callable[[float, Callable[[], None]], None]
"""Calls a function after so many seconds."""

LEAST_PAUSE_S = 0.25
"""Least time between two times that the viewers of a shot are told where the others are."""
MOST_TOLD_PER_S = 50.0
"""Most messages in a second to the viewers of a shot, all together: a crowd is told less often."""

_LIST = TypeAdapter(list[LiveViewer])


@dataclass(frozen=True)
class Place:
    """Place that a viewer looks at.

    Attributes:
        camera: prim path; None for the default camera of the shot.
        time: USD time code.
    """

    camera: str | None
    time: float


class Viewer:
    """One live connection that is seen by the others and sees them.

    Args:
        name: of the viewer, for people.
        number: the least that no other viewer of the shot has, from 1.
        tell: called with those who look at the shot, after they have come, gone or moved.
        on_move: called after this one has moved.
    """

    def __init__(self, name: str, number: int, tell: Tell, on_move: Callable[[], None]) -> None:
        self.id = secrets.token_hex(6)
        self.name = name
        self.number = number
        self.tell = tell
        self.place: Place | None = None
        self._on_move = on_move

    def look(self, place: Place) -> None:
        """Note where this one looks."""
        if place != self.place:
            self.place = place
            self._on_move()

    def shown(self) -> LiveViewer:
        """Return this one as the others are told of it."""
        camera, time = (self.place.camera, self.place.time) if self.place else (None, None)
        return LiveViewer(id=self.id, name=self.name, number=self.number, camera=camera, time=time)


@dataclass(eq=False)
class _Room:
    """The viewers of one shot. After a change they are told at once, unless that was done a moment ago."""

    later: Later
    viewers: list[Viewer] = field(default_factory=list)
    is_changed: bool = False
    rests: bool = False

    def change(self) -> None:
        """Tell the viewers, soon."""
        self.is_changed = True
        if not self.rests:
            self.rests = True
            self.later(0.0, self._tell)

    def _tell(self) -> None:
        if not self.is_changed or not self.viewers:
            self.rests = False
            return
        self.is_changed = False
        told = _LIST.dump_json([viewer.shown() for viewer in self.viewers], by_alias=True).decode()
        for viewer in self.viewers:
            viewer.tell(f'{{"you":"{viewer.id}","viewers":{told}}}')
        self.later(max(LEAST_PAUSE_S, len(self.viewers) / MOST_TOLD_PER_S), self._tell)


class Viewers:
    """The viewers of all shots. Used in the event loop alone.

    Moves are no events, which are kept for days: they go to the viewers of the shot alone, the newest place of each, a few times
    a second.

    Args:
        later: calls a function later; by default the running event loop does.
    """

    def __init__(self, later: Later | None = None) -> None:
        self._later = later or _later
        self._rooms: dict[str, _Room] = {}

    @contextmanager
    def join(self, shot: str, name: str, tell: Tell) -> Iterator[Viewer]:
        """Have a viewer among those of a shot until the end of the block.

        Args:
            shot: id of the shot.
            name: of the viewer, for people.
            tell: called in the event loop with those who look at the shot, soon after that has changed.
        """
        room = self._rooms.setdefault(shot, _Room(self._later))
        taken = {viewer.number for viewer in room.viewers}
        viewer = Viewer(name, next(number for number in count(1) if number not in taken), tell, room.change)
        room.viewers.append(viewer)
        room.change()
        try:
            yield viewer
        finally:
            room.viewers.remove(viewer)
            if room.viewers:
                room.change()
            else:
                self._rooms.pop(shot, None)


def _later(pause_s: float, call: Callable[[], None]) -> None:
    asyncio.get_running_loop().call_later(pause_s, call)
