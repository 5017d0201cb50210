"""The database of the renders: its address, its opening and its migrations, over SQLite and PostgreSQL."""

from __future__ import annotations

import sys
from contextlib import ExitStack

import pytest
from sqlalchemy import inspect, text

from render.errors import OutputError, SettingsError
from service.http.settings import Settings
from service.storage.database.connection import open_database, revisions, transaction
from service.storage.database.file import DATABASE, noted_database
from service.storage.database.tables import Table
from service.upkeep.doctor import _database

SECRET = "pa55word"


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        (f"mysql://mara:{SECRET}@host/name", "the kind 'mysql'"),
        (f"sqlite:///{SECRET}", "the kind 'sqlite'"),
        (f"postgresql+psycopg2://mara:{SECRET}@host/name", r"the kind 'postgresql\+psycopg2'"),
        (f"host=db password={SECRET}", "is no address"),
        (f"postgresql://mara:{SECRET}@host:port/name", "is no address"),
    ],
)
def test_an_address_of_another_kind_is_refused(tmp_path, setting, message):
    with pytest.raises(SettingsError, match=message) as raised:
        open_database(tmp_path, setting)
    assert SECRET not in str(raised.value)
    assert raised.value.__context__ is None


def test_postgresql_without_its_package_names_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(SettingsError, match=r"pip install 'pullfocus\[postgresql\]'"):
        open_database(tmp_path, "postgresql://mara@host/name")


@pytest.mark.parametrize(
    "host", ["127.0.0.1:1/name", "/name?host=127.0.0.1&port=1", "/name?host=127.0.0.1&port=1&bad=1"]
)
def test_a_server_that_is_not_there_is_named_alone(tmp_path, host):
    pytest.importorskip("psycopg")
    with pytest.raises(OutputError, match=r"'name' of PostgreSQL on 127\.0\.0\.1 cannot be opened: ") as raised:
        open_database(tmp_path, f"postgresql://mara:{SECRET}@{host}")
    assert SECRET not in str(raised.value)
    assert "\n" not in str(raised.value)


def test_settings_do_not_show_a_password():
    assert SECRET not in repr(Settings(database=f"postgresql://mara:{SECRET}@host/name"))


def test_a_database_that_is_not_there_is_named(tmp_path, postgresql):
    with pytest.raises(OutputError, match=r'of PostgreSQL on /.*database "other" does not exist'):
        open_database(tmp_path, postgresql.url("other"))
    found = _database(tmp_path, postgresql.url("other"))
    assert (found.state, "does not exist" in found.text) == ("fail", True)


def test_migrations_make_the_tables_that_the_code_has(tmp_path, database):
    engine = open_database(tmp_path, database)
    with engine.begin() as connection:
        found = inspect(connection)
        for table in Table.metadata.sorted_tables:
            columns = {column["name"]: column["nullable"] for column in found.get_columns(table.name)}
            assert columns == {column.name: column.nullable for column in table.columns}
    engine.dispose()


def test_a_reader_sees_one_moment_and_writes_nothing(tmp_path, postgresql_database):
    engine = open_database(tmp_path, postgresql_database)
    number, add = text("SELECT count(*) FROM numbers"), text("INSERT INTO numbers VALUES (1)")
    with transaction(engine) as session:
        session.execute(text("CREATE TABLE numbers (value int)"))
    with transaction(engine, only_reads=True) as reading:
        assert reading.scalar(number) == 0
        with transaction(engine) as writing:  # it waits for no reader, and no reader for it
            writing.execute(add)
            assert reading.scalar(number) == 0
        assert reading.scalar(number) == 0
    with pytest.raises(OutputError, match="read-only transaction"), transaction(engine, only_reads=True) as session:
        session.execute(add)
    engine.dispose()


def test_a_writer_waits_for_another_for_a_while_alone(tmp_path, postgresql_database, monkeypatch):
    patient = open_database(tmp_path, postgresql_database)
    monkeypatch.setattr("service.storage.database.connection.BUSY_MS", 500)
    other = open_database(tmp_path, postgresql_database)
    with transaction(patient) as first:
        first.execute(text("SELECT 1"))
        with pytest.raises(OutputError, match="timeout") as raised, transaction(other) as second:
            second.execute(text("SELECT 1"))
    assert raised.value.code == "queue_unusable"
    with transaction(other) as second:
        assert second.scalar(text("SELECT 1")) == 1
    for engine in (patient, other):
        engine.dispose()


def test_writers_of_one_process_take_turns(tmp_path, monkeypatch):
    engine = open_database(tmp_path)
    monkeypatch.setattr("service.storage.database.connection.BUSY_MS", 1)
    with transaction(engine):
        with pytest.raises(OutputError, match="too many requests") as raised, transaction(engine):
            pass
        with transaction(engine, only_reads=True) as reading:
            assert reading.scalar(text("SELECT 1")) == 1
    assert raised.value.code == "queue_unusable"
    with pytest.raises(ZeroDivisionError), transaction(engine):
        raise ZeroDivisionError
    with transaction(engine):  # the turn of one that has failed is over
        pass
    engine.dispose()


def test_requests_beyond_all_connections_are_refused(tmp_path, postgresql_database, monkeypatch):
    monkeypatch.setattr("service.storage.database.connection._CONNECTIONS", 4)
    monkeypatch.setattr("service.storage.database.connection.BUSY_MS", 500)  # less than a second: none waits
    engine = open_database(tmp_path, postgresql_database)
    with ExitStack() as held:
        for _ in range(4):
            held.enter_context(transaction(engine, only_reads=True)).scalar(text("SELECT 1"))
        with pytest.raises(OutputError, match="too many requests") as raised, transaction(engine) as more:
            more.scalar(text("SELECT 1"))
    assert raised.value.code == "queue_unusable"
    engine.dispose()


def test_doctor_tells_the_revision_of_the_tables(tmp_path, database):
    assert "will be made" in _database(tmp_path, database).text
    assert not (tmp_path / DATABASE).exists()
    engine = open_database(tmp_path, database)
    _, (newest, *_) = revisions(tmp_path, database)
    found = _database(tmp_path, database)
    assert (found.state, f"revision {newest}" in found.text) == ("ok", True)
    with engine.begin() as connection:
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    engine.dispose()
    found = _database(tmp_path, database)
    assert (found.state, found.remedy) == ("fail", "install that version")


def test_a_folder_notes_its_database_outside(tmp_path, postgresql_database):
    open_database(tmp_path, postgresql_database).dispose()
    assert "of PostgreSQL on /" in noted_database(tmp_path)
    found = _database(tmp_path, "")
    assert (found.state, "--config" in found.remedy) == ("warn", True)
    open_database(tmp_path).dispose()
    assert noted_database(tmp_path) is None
