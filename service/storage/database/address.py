"""Addresses of databases, and what may be shown of them: never a password."""

from __future__ import annotations

from pathlib import Path

from sqlalchemy import URL, make_url
from sqlalchemy.exc import ArgumentError

from render.errors import SettingsError
from service.storage.database.file import DATABASE

_POSTGRESQL = frozenset({"postgresql", "postgres", "postgresql+psycopg"})
_FORM = "postgresql://USER@HOST/NAME, or empty for SQLite in the data folder"


def address_of(folder: Path, setting: str) -> URL:
    """Return the address of the database of a data folder.

    Args:
        folder: the data folder.
        setting: the setting `database`.

    Raises:
        SettingsError: it is no address of a database that the service can use.
    """
    if not setting:
        return URL.create("sqlite", database=str(folder / DATABASE))
    try:
        url = make_url(setting)
    except (ArgumentError, ValueError):
        url = None
    if url is None:  # raised here, so that no traceback shows what was given
        raise SettingsError(f"the setting database is no address: it is {_FORM}", code="bad_database")
    if url.drivername not in _POSTGRESQL:
        detail = (
            f"the setting database names the kind {url.drivername!r}, which is none of the service's: it is {_FORM}"
        )
        raise SettingsError(detail, code="bad_database")
    if "@" in (url.host or ""):
        raise SettingsError('the setting database has an "@" in its password: write it as "%40"', code="bad_database")
    return url.set(drivername="postgresql+psycopg")


def name_of(url: URL) -> str:
    """Return the name of a database for people, without user and password."""
    if url.get_backend_name() == "sqlite":
        return str(url.database)
    host = url.host or url.query.get("host") or "this machine"
    shown = host if isinstance(host, str) else ", ".join(host)
    return f"{url.database or url.username or 'by default'!r} of PostgreSQL on {shown}"
