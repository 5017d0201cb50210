"""The database of the renders: SQLite in the data folder or PostgreSQL by its address, at the newest revision of the tables.

This module alone knows how the two differ. On both, transactions that write come one after the other, and those that only read
see one moment and wait for no one. SQLite is so by itself. On PostgreSQL a transaction that writes holds the advisory lock
`WRITERS` of its database until its end. So the queue needs no locks of rows, and what one transaction has numbered is there for
all before the next one numbers anything.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from alembic.util import CommandError
from sqlalchemy import URL, Connection, Engine, create_engine, event, text
from sqlalchemy import exc as sqlalchemy_errors
from sqlalchemy.orm import Session

from render.errors import OutputError, SettingsError
from service.storage.database.address import address_of, name_of
from service.storage.database.file import note_database
from service.storage.errors import UnavailableError

_READS = "reads"
"""Execution option of connections that only read."""
_LOCK = "lock"
"""Execution option of SQLite: the lock of this process's threads that write."""
BUSY_MS = 10_000
"""Time to wait for another writer; on PostgreSQL also for a connection, and for a statement."""
WRITERS = 0x70756C6C666F6375
"""Key of PostgreSQL's advisory lock that a transaction holds which writes: `pullfocu` in ASCII."""
_CONNECTIONS = 16
"""Connections to PostgreSQL at a time."""
_MIGRATIONS = Path(__file__).parent / "migrations"


def open_database(folder: Path, setting: str = "") -> Engine:
    """Open the database of a data folder; its tables are made where they are missing, and brought to the present ones.

    Args:
        folder: the data folder.
        setting: address of a PostgreSQL database; empty for SQLite in the folder.

    Raises:
        SettingsError: the setting is no address of a database that can be used.
        OutputError: the database cannot be opened, or a newer version wrote it.
    """
    url = address_of(folder, setting)
    engine = _engine(url)
    try:
        migrate(engine)
        note_database(folder, name_of(url) if is_shared(engine) else None)
    except (sqlalchemy_errors.SQLAlchemyError, CommandError, OSError) as error:
        engine.dispose()
        raise _unopened(url, error) from error
    return engine


def revisions(folder: Path, setting: str = "") -> tuple[str | None, list[str]]:
    """Look at the tables of a database, and leave them as they are.

    Args:
        folder: the data folder.
        setting: as for `open_database`.

    Returns:
        Their revision, None where there are none yet, and all revisions that this version knows, the newest first.

    Raises:
        SettingsError: the setting is no address of a database that can be used.
        OutputError: the database cannot be opened.
    """
    url = address_of(folder, setting)
    engine = _engine(url)
    try:
        with engine.execution_options(**{_READS: True}).begin() as connection:
            present = MigrationContext.configure(connection).get_current_revision()
    except (sqlalchemy_errors.SQLAlchemyError, CommandError) as error:
        raise _unopened(url, error) from error
    finally:
        engine.dispose()
    known = ScriptDirectory.from_config(_configuration()).walk_revisions()
    return present, [script.revision for script in known]


def migrate(engine: Engine) -> None:
    """Bring the tables to their newest revision (Alembic). The transaction writes: of several services one does it."""
    config = _configuration()
    with engine.begin() as connection:
        if is_shared(engine):
            connection.exec_driver_sql("SET LOCAL statement_timeout = 0")  # a migration may take long
        config.attributes["connection"] = connection
        command.upgrade(config, "head")


@contextmanager
def transaction(engine: Engine, *, only_reads: bool = False) -> Iterator[Session]:
    """Begin a transaction; what it has read can be used after its end.

    Args:
        engine: of the database.
        only_reads: whether it writes nothing, so that it waits for no writer.

    Raises:
        UnavailableError: the database cannot be used now.
        OutputError: it cannot do what is asked of it.
    """
    try:
        with (
            nullcontext() if only_reads else _turn(engine),
            Session(engine.execution_options(**{_READS: only_reads}), expire_on_commit=False) as session,
            session.begin(),
        ):
            yield session
    except (sqlalchemy_errors.DBAPIError, sqlalchemy_errors.TimeoutError) as error:  # as of a full disk
        detail = f"the queue of renders cannot be used now: {_cause(error)}"
        kind = UnavailableError if _may_pass(error) else OutputError
        raise kind(detail, code="queue_unusable") from error


def is_shared(engine: Engine) -> bool:
    """Return whether services of other machines may use a database, too."""
    return engine.dialect.name == "postgresql"


def time_of(session: Session) -> float:
    """Return the time by the clock that all share who use a database, s since 1970."""
    if session.get_bind().dialect.name == "postgresql":
        return float(session.scalar(text("SELECT extract(epoch FROM clock_timestamp())")) or 0.0)
    return time.time()  # SQLite's is that of this machine, too


@contextmanager
def _turn(engine: Engine) -> Iterator[None]:
    """Wait for the other threads that write to a file of SQLite, which would have this one sleep and look again.

    Raises:
        UnavailableError: they take too long.
    """
    lock: threading.Lock | None = engine.get_execution_options().get(_LOCK)
    if lock is None:
        yield
        return
    if not lock.acquire(timeout=BUSY_MS / 1000):
        raise UnavailableError(
            "the queue of renders cannot be used now: too many requests use it", code="queue_unusable"
        )
    try:
        yield
    finally:
        lock.release()


def _engine(url: URL) -> Engine:
    if url.get_backend_name() == "sqlite":
        engine = create_engine(url, execution_options={_LOCK: threading.Lock()})
        event.listen(engine, "connect", _configure_sqlite)
        event.listen(engine, "begin", _begin_sqlite)
        return engine
    seconds = BUSY_MS // 1000
    ours = {
        "connect_timeout": seconds,
        "tcp_user_timeout": BUSY_MS,  # a machine that is gone is noticed while it is waited for
        "keepalives_idle": seconds,
        "keepalives_interval": seconds,
        "keepalives_count": 2,
        "application_name": "pullfocus",
    }
    try:
        engine = create_engine(
            url,
            pool_size=_CONNECTIONS // 4,
            max_overflow=_CONNECTIONS - _CONNECTIONS // 4,
            pool_timeout=seconds,
            pool_pre_ping=True,
            hide_parameters=True,  # an error would show the edits of a shot
            connect_args={name: value for name, value in ours.items() if name not in url.query},
        )
    except ImportError as error:
        detail = "PostgreSQL needs another package: pip install 'pullfocus[postgresql]'"
        raise SettingsError(detail, code="bad_database") from error
    except sqlalchemy_errors.SQLAlchemyError as error:  # as of a plugin that is not there
        raise SettingsError("the setting database is no address of PostgreSQL", code="bad_database") from error
    event.listen(engine, "connect", _configure_postgresql)
    event.listen(engine, "begin", _begin_postgresql)
    return engine


def _configuration() -> Config:
    config = Config()
    config.set_main_option("script_location", str(_MIGRATIONS).replace("%", "%%"))
    return config


def _unopened(url: URL, error: Exception) -> OutputError:
    said = error.orig if isinstance(error, sqlalchemy_errors.DBAPIError) else str(error).partition("\n")[0]
    reason = " ".join(str(said).split())  # libpq tells in several lines what it has tried
    path = url.database if url.get_backend_name() == "sqlite" else None
    return OutputError(f"the database of renders {name_of(url)} cannot be opened: {reason}", path=path)


def _cause(error: sqlalchemy_errors.DBAPIError | sqlalchemy_errors.TimeoutError) -> str:
    """Return why a database cannot be used, for clients: they are not told where it is."""
    if isinstance(error, sqlalchemy_errors.TimeoutError):
        return "too many requests use it"
    if error.statement is None or error.connection_invalidated:
        return "its database cannot be reached"
    return str(error.orig).partition("\n")[0]


def _may_pass(error: sqlalchemy_errors.DBAPIError | sqlalchemy_errors.TimeoutError) -> bool:
    """Return whether another try may succeed: not where the program or the data are wrong."""
    passing = (
        sqlalchemy_errors.OperationalError,
        sqlalchemy_errors.InterfaceError,
        sqlalchemy_errors.InternalError,
        sqlalchemy_errors.TimeoutError,
    )
    return isinstance(error, passing) or error.connection_invalidated


def _begin_sqlite(connection: Connection) -> None:
    """Begin a transaction: one that may write has the lock from its start, so that it never has to give up half way."""
    connection.exec_driver_sql("BEGIN" if _only_reads(connection) else "BEGIN IMMEDIATE")


def _configure_sqlite(connection: Any, _record: object) -> None:
    """Let SQLAlchemy begin transactions by `_begin_sqlite`, and make what is committed last."""
    connection.isolation_level = None
    for setting in (f"busy_timeout={BUSY_MS}", "journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
        connection.execute(f"PRAGMA {setting}")


def _begin_postgresql(connection: Connection) -> None:
    """Begin a transaction, which psycopg did. What a writer reads once it has the lock is what the last writer has left."""
    if _only_reads(connection):
        connection.exec_driver_sql("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ, READ ONLY")
    else:
        connection.exec_driver_sql("SET TRANSACTION ISOLATION LEVEL READ COMMITTED, READ WRITE")
        connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({WRITERS})")


def _configure_postgresql(connection: Any, _record: object) -> None:
    """Bound the time that a statement takes, waits, or is waited for."""
    for setting in ("statement_timeout", "lock_timeout", "idle_in_transaction_session_timeout"):
        connection.execute(f"SET {setting} = {BUSY_MS}")
    connection.commit()


def _only_reads(connection: Connection) -> bool:
    return bool(connection.get_execution_options().get(_READS, False))
