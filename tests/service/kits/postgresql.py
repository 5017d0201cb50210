"""A real PostgreSQL for tests, and empty databases of it."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psycopg
import pytest

from service.bench.postgresql import PostgresqlServer, postgresql_programs


@contextmanager
def empty_database(server: PostgresqlServer) -> Iterator[str]:
    """A database without tables, which tests have one after the other; its address. Making one for each takes too long."""
    try:
        yield server.url()
    finally:
        with psycopg.connect(server.url(), options="-c lock_timeout=10s") as connection:
            connection.execute("DROP SCHEMA public CASCADE")
            connection.execute("CREATE SCHEMA public")


@contextmanager
def running_postgresql() -> Iterator[PostgresqlServer]:
    """Run a server. The test is skipped where PostgreSQL is not installed."""
    programs = postgresql_programs()
    if programs is None:
        pytest.skip("PostgreSQL is not installed (Debian's package postgresql)")
    folder = Path(
        tempfile.mkdtemp(prefix="pullfocus-postgresql-")
    )  # not among pytest's, which other users may not enter
    try:
        server = PostgresqlServer(programs, folder)
        server.start()
        try:
            yield server
        finally:
            server.stop()
    finally:
        shutil.rmtree(folder)
