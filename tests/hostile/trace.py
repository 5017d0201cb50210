"""Evidence of what workers try: their system calls that name a file or use the network, as strace writes them."""

from __future__ import annotations

import re
import shutil
import subprocess
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from render.errors import PullfocusError

CALL = re.compile(r"^\d+ +(?P<name>\w+)\((?P<arguments>.*?)\)? += (?P<result>-?\d+)(?: (?P<error>E[A-Z]+))?")
SHOT = re.compile(r"shots/[^/]+")
PATH = re.compile(r'"((?:[^"\\]|\\.)*)"')
OPENING = ("open", "openat", "openat2")
NETWORK = ("socket", "connect", "bind", "sendto", "sendmsg")
REFUSED = ("EACCES", "EPERM")
OF_THE_SYSTEM = (
    "/usr/",
    "/lib",
    "/proc/",
    "/sys/",
    "/dev/dri",
    "/dev/null",
    "/dev/urandom",
    "/etc/ld.so",
    "/etc/localtime",
    "/etc/glvnd",
)
"""Beginnings of what every process of Linux reads, of libraries and the graphics driver."""
ATTACH_S = 1.0


@dataclass
class Tried:
    """System calls of all workers.

    Attributes:
        calls: number of calls that name a file or use the network.
        refused: those that the sandbox refused, by call and path.
        opened: paths that were opened, absolute ones.
    """

    calls: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    opened: Counter[str] = field(default_factory=Counter)

    def opened_outside(self, places: Iterable[str]) -> list[str]:
        """Return the paths that were opened, except for those of the system and in given folders."""
        inside = (*OF_THE_SYSTEM, *places)
        return sorted(path for path in self.opened if not path.startswith(inside))


def read_trace(lines: Iterable[str]) -> Tried:
    """Read what strace has written.

    Args:
        lines: of ``strace -f``, one for each call.
    """
    tried = Tried()
    for line in lines:
        found = CALL.match(line)
        if not found:
            continue
        tried.calls += 1
        path = PATH.search(found["arguments"])
        named = path[1] if path else found["arguments"][:60]
        if found["error"] in REFUSED:
            tried.refused[f"{found['name']} {SHOT.sub('shots/ID', named)}"] += 1
        elif found["name"] in OPENING and int(found["result"]) >= 0 and named.startswith("/"):
            tried.opened[named] += 1
    return tried


@contextmanager
def traced(process: int, file: Path) -> Iterator[None]:
    """Write the calls of a process and of those that it forks in the context to a file.

    Raises:
        PullfocusError: there is no strace, or it may not look at the process.
    """
    program = shutil.which("strace")
    if program is None:
        raise PullfocusError("--trace needs strace: install the package strace")
    command = [program, "-f", "-qq", "-s", "300", "-e", f"trace=%file,{','.join(NETWORK)}", "-o", str(file)]
    with subprocess.Popen([*command, "-p", str(process)], stderr=subprocess.PIPE, text=True) as tracing:
        time.sleep(ATTACH_S)
        if tracing.poll() is not None:
            assert tracing.stderr is not None
            raise PullfocusError(f"strace ended: {tracing.stderr.read().strip()}")
        try:
            yield
        finally:
            tracing.terminate()
