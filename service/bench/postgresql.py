"""A PostgreSQL of a bench's or a test's own, from the distribution's packages, on a socket in a folder of its own."""

from __future__ import annotations

import os
import pwd
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from render.errors import PullfocusError

OWNER = "pullfocus"
_QUICK = {
    "fsync": "off",
    "full_page_writes": "off",
    "shared_buffers": "16MB",
    "listen_addresses": "",
    "unix_socket_permissions": "0700",
}


def postgresql_programs() -> Path | None:
    """Return the folder of PostgreSQL's programs, of the newest version; None where none is installed."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"), key=lambda path: int(path.parts[-3]))
    return found[-1].parent if found else None


class PostgresqlServer:
    """A server with an empty database `postgres`. It trusts everybody who reaches its socket.

    Args:
        programs: folder of PostgreSQL's programs.
        folder: an empty one, for its data and its socket, which other users may enter.

    Raises:
        PullfocusError: its data cannot be made.
    """

    def __init__(self, programs: Path, folder: Path) -> None:
        self._programs, self._folder = programs, folder
        self.user = _user()
        if self.user is not None:
            shutil.chown(folder, self.user)
        self._run("initdb", "--no-sync", "--auth=trust", "--encoding=UTF8", "--locale=C.UTF-8", f"--username={OWNER}")
        settings = _QUICK | {"unix_socket_directories": str(folder)}
        with (folder / "data" / "postgresql.conf").open("a") as file:
            file.writelines(f"{name} = '{value}'\n" for name, value in settings.items())

    def start(self) -> None:
        """Start it, and return once it can be used. Raises `PullfocusError`."""
        self._run("pg_ctl", "start", "--wait", "--silent", f"--log={self._folder / 'log'}")

    def stop(self) -> None:
        """Stop it; connections are cut off. Raises `PullfocusError`."""
        self._run("pg_ctl", "stop", "--wait", "--silent", "--mode=fast")

    def command(self) -> Sequence[str]:
        """Return the command that serves, as a process of `who`."""
        return [str(self._programs / "postgres"), "-D", str(self._folder / "data")]

    def who(self) -> dict[str, Any]:
        """Return the user and groups of its processes, as `subprocess` takes them: root may not run it."""
        if self.user is None:
            return {}
        return {"user": self.user, "group": pwd.getpwnam(self.user).pw_gid, "extra_groups": []}

    def url(self, database: str = "postgres") -> str:
        """Return the address of a database of it."""
        return f"postgresql://{OWNER}@/{database}?host={self._folder}"

    def _run(self, program: str, *arguments: str) -> None:
        command = [str(self._programs / program), f"--pgdata={self._folder / 'data'}", *arguments]
        environment = {"PATH": os.defpath, "LC_ALL": "C.UTF-8"}
        ran = subprocess.run(
            command, env=environment, cwd=self._folder, capture_output=True, text=True, check=False, **self.who()
        )
        if ran.returncode != 0:
            raise PullfocusError(f"{program} of PostgreSQL has failed: {(ran.stdout + ran.stderr).strip()[-500:]}")


def _user() -> str | None:
    """Return the user who runs it; None for the present one."""
    if os.geteuid() != 0:
        return None
    names = {user.pw_name for user in pwd.getpwall()}
    return "postgres" if "postgres" in names else "nobody"
