"""The database of the renders: SQLite in the data folder, at the newest revision of the tables."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.util import CommandError
from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.exc import DBAPIError, SQLAlchemyError
from sqlalchemy.orm import Session

from render.errors import OutputError
from service.storage.database.file import DATABASE

_READS = "reads"
"""Execution option of connections that only read."""
BUSY_MS = 10_000
"""Time to wait for another writer."""
_MIGRATIONS = Path(__file__).parent / "migrations"


def open_database(folder: Path) -> Engine:
    """Open the database of a data folder; it is made where it is missing, and brought to the present tables.

    Raises:
        OutputError: it cannot be opened, or a newer version wrote it.
    """
    path = folder / DATABASE
    engine = create_engine(f"sqlite:///{path}")
    event.listen(engine, "connect", _configure)
    event.listen(engine, "begin", _begin)
    try:
        migrate(engine)
    except (SQLAlchemyError, CommandError) as error:
        engine.dispose()
        reason = str(error).strip().partition("\n")[0]
        raise OutputError(f"the database of renders {path} cannot be opened: {reason}", path=str(path)) from error
    return engine


def migrate(engine: Engine) -> None:
    """Bring the tables to their newest revision (Alembic)."""
    config = Config()
    config.set_main_option("script_location", str(_MIGRATIONS).replace("%", "%%"))
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, "head")


@contextmanager
def transaction(engine: Engine, *, only_reads: bool = False) -> Iterator[Session]:
    """Begin a transaction; what it has read can be used after its end.

    Args:
        engine: of the database.
        only_reads: whether it writes nothing, so that it waits for no writer.

    Raises:
        OutputError: the database cannot be used.
    """
    try:
        with (
            Session(engine.execution_options(**{_READS: only_reads}), expire_on_commit=False) as session,
            session.begin(),
        ):
            yield session
    except DBAPIError as error:  # as of a full disk
        reason = str(error.orig).partition("\n")[0]
        raise OutputError(f"the queue of renders cannot be used now: {reason}", code="queue_unusable") from error


def _begin(connection: Connection) -> None:
    """Begin a transaction: one that may write has the lock from its start, so that it never has to give up half way."""
    only_reads = connection.get_execution_options().get(_READS, False)
    connection.exec_driver_sql("BEGIN" if only_reads else "BEGIN IMMEDIATE")


def _configure(connection: Any, _record: object) -> None:
    """Let SQLAlchemy begin transactions by `_begin`, and make what is committed last."""
    connection.isolation_level = None
    for setting in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON", f"busy_timeout={BUSY_MS}"):
        connection.execute(f"PRAGMA {setting}")
