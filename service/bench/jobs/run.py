"""The jobs bench: requests about a queue of many renders, workers who are kept busy, and readers of events.

pullfocus bench jobs
pullfocus bench jobs --database postgresql://pullfocus@db.studio.example/bench
"""

from __future__ import annotations

import argparse
import asyncio
import http.client
import tempfile
from pathlib import Path

from render.errors import PullfocusError
from render.lab.bench.progress import check_file, say
from service.bench.jobs.plan import JobsPlan, plan_from_arguments
from service.bench.jobs.report import report
from service.bench.jobs.requests import NO_WORKERS, measure_requests
from service.bench.jobs.results import GrowthRow, JobsBench, ReaderRow, RequestRow, goals_of, reader_row
from service.bench.jobs.streams import read_streams
from service.bench.jobs.workers import kept_events, measure_workers
from service.bench.machine import this_machine
from service.bench.server import running_service
from service.storage.database.connection import open_database
from service.storage.events import EventLog

PACKAGES = ("pullfocus", "sqlalchemy", "uvicorn", "fastapi")


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables on standard output, and write the JSON.

    Args:
        arguments: as `service.bench.jobs.plan.add_arguments` declares them.

    Raises:
        SettingsError: a number is out of range, or the database is none that can be used.
        PullfocusError: the service does not run, or its database has renders.
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    result = measure(plan_from_arguments(arguments), arguments.database)
    say(result, report(result), arguments.json)


def measure(plan: JobsPlan, database: str = "") -> JobsBench:
    """Measure a service that draws nothing, and then one whose workers sleep.

    Args:
        plan: of the measurements.
        database: address of an empty PostgreSQL database; empty for SQLite.

    Raises:
        SettingsError: the database is none that can be used.
        PullfocusError: a service does not run, or its database has renders.
        GraphicsError: there is no device to draw on.
    """
    machine = this_machine(PACKAGES)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        asked, working = Path(name, "asked"), Path(name, "working")
        for folder in (asked, working):
            folder.mkdir()
        kind, requests, growth, streams = _ask(asked, plan, database)
        found = asyncio.run(measure_workers(working, plan, database))
    readers = [*found.readers, *streams]
    goals = goals_of(requests, found.workers, readers)
    return JobsBench(machine, plan, kind, requests, growth, found.workers, found.queue, readers, goals)


def _ask(folder: Path, plan: JobsPlan, database: str) -> tuple[str, list[RequestRow], list[GrowthRow], list[ReaderRow]]:
    """Measure a service over HTTP, and return the kind of its database, too."""
    settings = {"dask": NO_WORKERS} | ({"database": database} if database else {})
    try:
        with running_service(folder, settings=settings) as port:
            requests, growth = measure_requests(port, plan)
            readers, until = read_streams(port, plan)
    except (OSError, http.client.HTTPException) as error:
        raise PullfocusError(f"the service of the bench does not answer: {type(error).__name__}: {error}") from error
    engine = open_database(folder / "data", database)
    kept = kept_events(EventLog(engine))
    version = ".".join(map(str, getattr(engine.dialect, "server_version_info", None) or ()))
    engine.dispose()
    kind = {"sqlite": "SQLite", "postgresql": "PostgreSQL"}[engine.dialect.name]
    return f"{kind} {version}", requests, growth, [reader_row(reader, kept, until) for reader in readers]
