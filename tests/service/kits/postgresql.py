"""A real PostgreSQL for tests, from the distribution's packages, on a socket in a folder of its own."""

from __future__ import annotations

import os
import pwd
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psycopg
import pytest

OWNER = "pullfocus"
_QUICK = {"fsync": "off", "full_page_writes": "off", "shared_buffers": "16MB", "listen_addresses": ""}


class PostgresqlServer:
    """A server that tests start and stop. It trusts everybody who reaches its socket.

    Args:
        programs: folder of PostgreSQL's programs.
        folder: an empty one, for its data and its socket.
        user: name of the user who runs it; None for the present one.
    """

    def __init__(self, programs: Path, folder: Path, user: str | None) -> None:
        self._programs, self._folder, self._user = programs, folder, user
        self._run("initdb", "--no-sync", "--auth=trust", "--encoding=UTF8", "--locale=C.UTF-8", f"--username={OWNER}")
        settings = _QUICK | {"unix_socket_directories": str(folder)}
        with (folder / "data" / "postgresql.conf").open("a") as file:
            file.writelines(f"{name} = '{value}'\n" for name, value in settings.items())

    def start(self) -> None:
        """Start it, and return once it can be used."""
        self._run("pg_ctl", "start", "--wait", "--silent", f"--log={self._folder / 'log'}")

    def stop(self) -> None:
        """Stop it; connections are cut off."""
        self._run("pg_ctl", "stop", "--wait", "--silent", "--mode=fast")

    def url(self, database: str) -> str:
        """Address of a database of it."""
        return f"postgresql://{OWNER}@/{database}?host={self._folder}"

    @contextmanager
    def empty_database(self) -> Iterator[str]:
        """A database without tables, which tests have one after the other; its address. Making one for each takes too long."""
        try:
            yield self.url("postgres")
        finally:
            with psycopg.connect(self.url("postgres"), options="-c lock_timeout=10s") as connection:
                connection.execute("DROP SCHEMA public CASCADE")
                connection.execute("CREATE SCHEMA public")

    def _run(self, program: str, *arguments: str) -> None:
        command = [self._programs / program, f"--pgdata={self._folder / 'data'}", *arguments]
        who = {"user": self._user, "group": pwd.getpwnam(self._user).pw_gid, "extra_groups": []} if self._user else {}
        environment = {"PATH": os.defpath, "LC_ALL": "C.UTF-8"}
        ran = subprocess.run(
            command, env=environment, cwd=self._folder, capture_output=True, text=True, check=False, **who
        )
        assert ran.returncode == 0, ran.stdout + ran.stderr


@contextmanager
def running_postgresql() -> Iterator[PostgresqlServer]:
    """Run a server. The test is skipped where PostgreSQL is not installed."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"), key=lambda path: int(path.parts[-3]))
    if not found:
        pytest.skip("PostgreSQL is not installed (Debian's package postgresql)")
    user = _user()
    folder = Path(
        tempfile.mkdtemp(prefix="pullfocus-postgresql-")
    )  # not among pytest's, which other users may not enter
    try:
        if user is not None:
            shutil.chown(folder, user)
        server = PostgresqlServer(found[-1].parent, folder, user)
        server.start()
        try:
            yield server
        finally:
            server.stop()
    finally:
        shutil.rmtree(folder)


def _user() -> str | None:
    """User who runs it: root may not."""
    if os.geteuid() != 0:
        return None
    names = {user.pw_name for user in pwd.getpwall()}
    return "postgres" if "postgres" in names else "nobody"
