"""Background thread that makes levels of geometries."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from threading import Event

from render.layers.levels.simplify import Levels, make_levels
from render.model.scene import Geometry


class _Work:
    """Levels of one geometry that are made or being made."""

    def __init__(self, geometry: Geometry, threads: ThreadPoolExecutor, may_run: Event) -> None:
        self.geometry = geometry  # its id stays its own as long as this lives
        self._is_stale = Event()
        self._may_run = may_run
        self.result: Future[Levels | None] = threads.submit(make_levels, geometry, self._wait_for_turn)

    def _wait_for_turn(self) -> bool:
        """Wait while the maker is paused; true once the work is stale."""
        self._may_run.wait()
        return self._is_stale.is_set()

    def stop(self) -> None:
        self._is_stale.set()
        self.result.cancel()


class LevelMaker:
    """Makes levels one geometry after another, in a thread of its own, and keeps them. Geometries are recognised by identity."""

    def __init__(self) -> None:
        self._threads: ThreadPoolExecutor | None = None
        self._work: dict[int, _Work] = {}
        self._may_run = Event()
        self._may_run.set()

    def pause(self, *, is_paused: bool) -> None:
        """Pause between two sections of a geometry, or go on: levels take processor time that others may wait for."""
        (self._may_run.clear if is_paused else self._may_run.set)()

    def want(self, geometries: Iterable[Geometry]) -> None:
        """Make the levels of these geometries, and drop those of all others."""
        wanted = {id(geometry): geometry for geometry in geometries}
        for key in self._work.keys() - wanted.keys():
            self._work.pop(key).stop()
        for key in wanted.keys() - self._work.keys():
            if self._threads is None:
                self._threads = ThreadPoolExecutor(1, "pullfocus-levels")
            self._work[key] = _Work(wanted[key], self._threads, self._may_run)

    def made(self) -> dict[int, Levels]:
        """Levels that are ready, by the id of their geometry. A mesh whose levels could not be made has none."""
        found = {}
        for key, work in self._work.items():
            made = work.result
            if (
                made.done()
                and not made.cancelled()
                and made.exception() is None
                and (levels := made.result()) is not None
            ):
                found[key] = levels
        return found

    def wait(self) -> None:
        """Wait until all levels that are wanted are made; a pause ends."""
        self._may_run.set()
        wait([work.result for work in self._work.values()])

    def release(self) -> None:
        """Stop, and drop all levels."""
        self.want(())
        self._may_run.set()
        if self._threads is not None:
            self._threads.shutdown(wait=False, cancel_futures=True)
            self._threads = None
