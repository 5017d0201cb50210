"""Log of events: what has changed in shots, edits and renders, numbered in the order of commits and kept for some days.

Writers of the database take turns (`service.storage.database.connection`), so that an event never becomes visible after one with
a higher number: a reader that goes on after the last number it has seen misses none and gets none twice.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sqlalchemy import Engine, delete, event, func, select
from sqlalchemy.orm import Session

from render.errors import OutputError
from service.storage.database.connection import time_of, transaction
from service.storage.database.tables import EventRow, plain

log = logging.getLogger("pullfocus.service")

MOST_EVENTS = 1_000_000
"""Events that are kept, whatever their age."""


@dataclass(frozen=True)
class NewEvent:
    """Something that has changed.

    Attributes:
        topic: what it is about.
        kind: what has happened to it.
        project: those who see this project may know of it.
        shot: id of the shot.
        render: id of the render; None where it is about none.
        data: what else is known of it, as JSON.
    """

    topic: str
    kind: str
    project: str
    shot: str | None = None
    render: str | None = None
    data: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Wanted:
    """Which events a reader wants.

    Attributes:
        project: whose; None for those of all projects.
        topics: of these topics; empty for all.
        shot: of this shot; None for all.
        render: of this render; None for all.
    """

    project: str | None = None
    topics: Collection[str] = ()
    shot: str | None = None
    render: str | None = None


class EventLog:
    """The log of events. Any thread may use it, and any number of processes.

    Args:
        engine: of a database that `service.storage.database.connection` has opened.
        clock: tells the time in a transaction, s since 1970; by default the clock that all users of the database share.
    """

    def __init__(self, engine: Engine, clock: Callable[[Session], float] = time_of) -> None:
        self._engine = engine
        self._clock = clock
        self.on_new: Callable[[], None] = _do_nothing
        """Called after each commit of new events, in the thread that made them."""

    def add(self, session: Session, new: NewEvent) -> None:
        """Add an event in a transaction, with which it is committed or not."""
        if not session.info.get("has_events"):
            session.info["has_events"] = True
            event.listen(session, "after_commit", lambda _: self.on_new())
        session.add(EventRow(at=self._clock(session), **vars(new) | {"data": plain(dict(new.data))}))

    def note(self, new: NewEvent) -> None:
        """Add an event of what was done elsewhere. A database that cannot be used is logged: what was done is done."""
        try:
            with transaction(self._engine) as session:
                self.add(session, new)
        except OutputError as error:
            log.error("an event of %s cannot be kept: %s", new.topic, error)

    def newest(self) -> int:
        """Return the number of the newest event; 0 where there has been none."""
        with transaction(self._engine, only_reads=True) as session:
            return session.scalar(select(func.max(EventRow.number))) or 0

    def oldest(self) -> int:
        """Return the number of the oldest event that is kept; 1 where there has been none."""
        with transaction(self._engine, only_reads=True) as session:
            return session.scalar(select(func.min(EventRow.number))) or 1

    def after(self, number: int, wanted: Wanted, most: int) -> tuple[Sequence[EventRow], int]:
        """Return the events after a number, the oldest first.

        Args:
            number: of the last event that the reader knows.
            wanted: which events.
            most: number of events.

        Returns:
            The events, and the number to go on after.
        """
        query = select(EventRow).where(EventRow.number > number).order_by(EventRow.number).limit(most)
        for column in ("project", "shot", "render"):
            if getattr(wanted, column) is not None:
                query = query.where(getattr(EventRow, column) == getattr(wanted, column))
        if wanted.topics:
            query = query.where(EventRow.topic.in_(wanted.topics))
        with transaction(self._engine, only_reads=True) as session:
            newest = session.scalar(select(func.max(EventRow.number))) or 0
            rows = session.scalars(query).all()
        return rows, rows[-1].number if len(rows) == most else max(number, newest)

    def last_of_each_shot(self, topic: str) -> Sequence[EventRow]:
        """Return the last event of a topic about each shot."""
        last = select(func.max(EventRow.number)).where(EventRow.topic == topic).group_by(EventRow.shot)
        with transaction(self._engine, only_reads=True) as session:
            return session.scalars(select(EventRow).where(EventRow.number.in_(last))).all()

    def prune(self, kept_s: float) -> int:
        """Forget old events, but for the newest one, which says where numbers are.

        Args:
            kept_s: time for which events are kept, s.

        Returns:
            How many were forgotten.
        """
        with transaction(self._engine) as session:
            newest = session.scalar(select(func.max(EventRow.number))) or 0
            is_old = (EventRow.at < self._clock(session) - kept_s) | (EventRow.number <= newest - MOST_EVENTS)
            found = session.execute(delete(EventRow).where(is_old, EventRow.number < newest))
            return found.rowcount  # type: ignore[attr-defined, no-any-return]


def _do_nothing() -> None:
    """Tell nobody."""
