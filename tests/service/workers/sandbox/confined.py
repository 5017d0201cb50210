"""Runs short programs in a process that has entered a sandbox."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from textwrap import dedent

from service.workers.sandbox import Support, cache_environment, support, worker_environment

REPOSITORY = Path(__file__).parents[4]
OFFERED = support()
NOTHING = Support(0, False)

_PROGRAM = """\
import errno, os, sys
from pathlib import Path
from service.workers.sandbox import Limits, Sandbox, SandboxError, Support, allow_cpu, enter
{before}
held = enter(Sandbox({read!r}, {write!r}, Limits(**{limits!r}), {graphics!r}), {offered!r})

def error_of(action):
    try:
        action()
    except OSError as error:
        return errno.errorcode[error.errno]
    return "done"

{body}
"""


@dataclass(frozen=True)
class Confined:
    """A sandbox for programs of a test: a shot's folder that is read, a folder that is written, and their neighbours.

    Attributes:
        folder: of the test.
        limits: other limits than the usual ones.
        graphics: whether the program may draw.
        offered: features of the kernel that it may use; None for all.
    """

    folder: Path
    limits: dict[str, int | None] = field(default_factory=dict)
    graphics: bool = False
    offered: Support | None = None

    @property
    def shot(self) -> Path:
        """Folder that the program reads."""
        return self._made("shot")

    @property
    def edits(self) -> Path:
        """Folder that it reads and writes."""
        return self._made("edits")

    @property
    def cache(self) -> Path:
        """Another."""
        return self._made("cache")

    @property
    def other(self) -> Path:
        """Folder of another shot, with a file ``secret``."""
        (self._made("other") / "secret").write_text("secret")
        return self.folder / "other"

    def run(self, body: str, before: str = "") -> subprocess.CompletedProcess[str]:
        """Run a program and wait for its end.

        Args:
            body: what it does in the sandbox. `error_of` returns the name of an action's error, or ``done``.
            before: what it does before.
        """
        limits = {"memory_bytes": 4 << 30, "cpu_s": None, "file_bytes": 1 << 28, "descriptors": 256, "processes": 256}
        program = _PROGRAM.format(
            before=dedent(before),
            read=(self.shot,),
            write=(self.edits, self.cache),
            limits={**limits, **self.limits},
            graphics=self.graphics,
            offered=self.offered,
            body=dedent(body),
        ).replace("PosixPath(", "Path(")
        return subprocess.run(
            [sys.executable, "-c", program],
            env={**worker_environment(os.environ), **cache_environment(self.cache), "PYTHONPATH": str(REPOSITORY)},
            cwd="/",
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )

    def output(self, body: str, before: str = "") -> list[str]:
        """Run a program that must succeed, and return the lines that it prints.

        Args:
            body: as for `run`.
            before: likewise.
        """
        done = self.run(body, before)
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()

    def _made(self, name: str) -> Path:
        path = self.folder / name
        path.mkdir(exist_ok=True)
        return path
