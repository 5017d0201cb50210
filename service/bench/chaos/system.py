"""The system that the chaos bench strikes: a database, a scheduler, workers and a service, each a process of its own."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import psutil

from render.errors import PullfocusError
from service.bench.chaos.parts import MovableClock, Part, faketime_library, fill, free_port, small_disk
from service.bench.chaos.plan import ChaosPlan
from service.bench.chaos.strikes import JUMP_S, KINDS, Strike
from service.bench.postgresql import PostgresqlServer, postgresql_programs

_SCHEDULER = (
    "import asyncio\nfrom distributed import Scheduler\nasync def main():\n"
    " async with Scheduler(host='127.0.0.1', port={port}, dashboard=False, dashboard_address='127.0.0.1:0') as scheduler:\n"
    "  await scheduler.finished()\nasyncio.run(main())"
)


@dataclass
class System:
    """The system.

    Attributes:
        data: the data folder of the service.
        port: of the service.
        database: None where the service has SQLite.
        scheduler: of Dask.
        workers: that draw.
        service: that has the renders.
        clock: of the database; None where it cannot be set.
        has_small_disk: whether the disk of service and database is one of their own.
        families: processes that killed parts had started.
    """

    data: Path
    port: int
    database: Part | None
    scheduler: Part
    workers: list[Part]
    service: Part
    clock: MovableClock | None
    has_small_disk: bool
    families: list[psutil.Process]
    _filler: Path | None = None
    _late_s: int = 0

    @property
    def parts(self) -> list[Part]:
        """All processes, in the order in which they are started."""
        first = [self.database] if self.database is not None else []
        return [*first, self.scheduler, *self.workers, self.service]

    def kinds(self) -> list[Strike]:
        """Return the strikes that can be done here."""
        missing: set[Strike] = set()
        if self.database is None:
            missing.add("kill database")
        if not self.has_small_disk:
            missing.add("fill disk")
        if self.clock is None:
            missing |= {"clock forward", "clock back"}
        return [kind for kind in KINDS if kind not in missing]

    def tend(self) -> None:
        """Start what does not run."""
        for part in self.parts:
            part.tend()

    def strike(self, kind: Strike, number: int) -> None:
        """Do something bad.

        Args:
            kind: what.
            number: of the strike, which chooses the worker.
        """
        if kind == "fill disk":
            self._filler = fill(self.data.parent)
        elif kind in ("clock forward", "clock back"):
            assert self.clock is not None
            self._late_s += JUMP_S if kind == "clock forward" else -JUMP_S
            self.clock.set(self._late_s)
        else:
            part = {
                "kill worker": self.workers[number % len(self.workers)],
                "kill scheduler": self.scheduler,
                "kill service": self.service,
                "kill database": self.database,
            }[kind]
            assert part is not None
            self.families += part.kill()

    def heal(self) -> None:
        """Free the disk where it was filled."""
        if self._filler is not None:
            self._filler.unlink(missing_ok=True)
            self._filler = None

    def stop(self) -> list[psutil.Process]:
        """Stop all parts, and return the processes that they had started."""
        self.heal()
        return [process for part in reversed(self.parts) for process in part.stop()]


@contextmanager
def running_system(folder: Path, plan: ChaosPlan) -> Iterator[System]:
    """Make the system, whose parts start when it is tended to.

    Args:
        folder: an empty one, which other users may enter.
        plan: of the bench.

    Yields:
        The system; its parts are stopped at the end of the context.

    Raises:
        PullfocusError: a part is not installed.
    """
    disk, logs = folder / "disk", folder / "logs"
    for made in (disk, logs):
        made.mkdir()
    port, scheduler_port = free_port(), free_port()
    clock = MovableClock(folder) if faketime_library() is not None else None
    shifted = clock.environment if clock is not None else {}
    with small_disk(disk, plan.disk_mb) as has_small_disk:
        database, url = None, ""
        if plan.database == "postgresql":
            server = _postgresql(disk / "postgresql")
            database = Part("database", server.command(), logs / "database", shifted, server.who())
            url = server.url()
        scheduler = f"tcp://127.0.0.1:{scheduler_port}"
        settings = {"data": str(disk / "data"), "port": port, "dask": scheduler, "database": url, "min_free_mb": 1}
        written = "".join(f"{name} = {json.dumps(value)}\n" for name, value in settings.items())
        (folder / "serve.toml").write_text(f"{written}demo = false\n", encoding="utf-8")
        pullfocus = [sys.executable, "-m", "render.cli"]
        serve = [*pullfocus, "serve", "--log-format", "text", "--config", str(folder / "serve.toml")]
        system = System(
            disk / "data",
            port,
            database,
            Part("scheduler", [sys.executable, "-c", _SCHEDULER.format(port=scheduler_port)], logs / "scheduler"),
            [
                Part(
                    name,
                    [*pullfocus, "worker", "--dask", scheduler, "--name", name, "--folder", str(folder / name)],
                    logs / name,
                )
                for name in (f"worker-{number}" for number in range(1, plan.workers + 1))
            ],
            Part("service", serve, logs / "service", None if database is not None else shifted),
            clock,
            has_small_disk,
            [],
        )
        try:
            yield system
        finally:
            system.stop()


def _postgresql(folder: Path) -> PostgresqlServer:
    programs = postgresql_programs()
    if programs is None:
        raise PullfocusError("PostgreSQL is not installed (Debian's package postgresql); try --database sqlite")
    folder.mkdir()
    return PostgresqlServer(programs, folder)
