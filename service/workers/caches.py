"""Cache folders of the workers of a service: each process has its own, which no other worker sees.

A driver trusts what it finds among its compiled shaders, so no worker may write where another one reads. Compiling them anew
for each process would take seconds, so the cache of a process that draws begins as a copy of a *base*, which workers only read.
It was filled by a worker that opened nothing but the demo shot.

::

    CACHE/base-KEY/         the base; KEY changes with the program, the machine's libraries and the workers' environment
    CACHE/run-TOKEN/        of a service that runs
        lock                locked by it
        base/               a base that is being filled; it is renamed when it is complete
        NUMBER/             of a worker process
"""

from __future__ import annotations

import fcntl
import itertools
import logging
import os
import secrets
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import IO

from render.disk_cache import code_key, content_key
from service.workers.folders import is_fuller, remove_tree

log = logging.getLogger("pullfocus.service")

_BASE, _RUN, _LOCK = "base-", "run-", "lock"
_LIBRARIES = Path("/etc/ld.so.cache")
"""Written anew when a library, such as a driver, is installed."""
KEPT_BASES, KEPT_BASE_S = 8, 14 * 86400.0
"""Bases that are kept, those that workers began with last, and time for which they are kept at most."""


class Caches:
    """Cache folders below one folder, which several services may share. Any thread may use it.

    Args:
        folder: created when missing. What services that have ended left there is removed. Where it cannot be written, the workers
            have no caches.
        environment: of the workers.
        most_bytes: space that the cache of one process may take on the disk.

    Attributes:
        is_filling: whether this service fills the base.
    """

    def __init__(self, folder: Path, environment: Mapping[str, str], most_bytes: int) -> None:
        key = content_key(code_key([""]), _stamp(_LIBRARIES), sorted(environment.items()))
        self.is_filling = False
        self._most_bytes = most_bytes
        self._base = folder / f"{_BASE}{key[:16]}"
        self._numbers = itertools.count(1)
        self._remover = ThreadPoolExecutor(1, thread_name_prefix="cache-remover")
        try:
            self._run, self._lock = _begin_run(folder)
        except OSError as error:
            log.warning("the cache folder %s cannot be written: %s", folder, error.strerror)
            self._run, self._lock = folder / f"{_RUN}none", None
        self._remover.submit(_sweep, folder, self._run, self._base)

    @property
    def base(self) -> Path | None:
        """The base, or None where there is none yet. It counts as used now."""
        with suppress(OSError):
            os.utime(self._base)
            return self._base
        return None

    def create(self) -> Path | None:
        """Create the cache folder of a process that is about to start; None where there is no room for one."""
        folder = self._run / str(next(self._numbers))
        try:
            folder.mkdir(mode=0o700, parents=True)
        except OSError as error:
            log.warning("a worker begins without a cache and a folder of temporary files: %s", error.strerror)
            return None
        return folder

    def discard(self, folder: Path) -> None:
        """Remove the cache folder of a process that has ended, soon."""
        self._remover.submit(remove_tree, folder)

    def is_full(self, folder: Path) -> bool:
        """Whether the cache folder of a process holds more than it may."""
        return is_fuller(folder, self._most_bytes)

    def fill_base(self, fill: Callable[[Path], None]) -> None:
        """Have the base filled, where there is none yet.

        Args:
            fill: writes to the folder that it is given, which becomes the base when it returns.

        Raises:
            OSError: the folder cannot be written.
        """
        if self.base is not None:
            return
        part = self._run / "base"
        part.mkdir(mode=0o700)
        self.is_filling = True
        try:
            fill(part)
            try:
                part.rename(self._base)
            except OSError:
                if self.base is None:  # else another service was quicker
                    raise
        finally:
            self.is_filling = False
            remove_tree(part)

    def close(self) -> None:
        """Remove the caches of all processes, which must have ended."""
        self._remover.shutdown()
        if self._lock is not None:
            remove_tree(self._run)
            self._lock.close()


def _begin_run(folder: Path) -> tuple[Path, IO[str] | None]:
    """Create the folder of a service and lock it. Returns the folder and the lock. Raises `OSError`: it cannot be written."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    while True:
        run = folder / f"{_RUN}{secrets.token_hex(8)}"
        run.mkdir(mode=0o700)
        with suppress(FileNotFoundError):  # the sweep of another service came between
            lock = (run / _LOCK).open("w")
            fcntl.flock(lock, fcntl.LOCK_EX)
            if (run / _LOCK).exists():
                return run, lock
            lock.close()


def _sweep(folder: Path, own: Path, base: Path) -> None:
    """Remove the folders of services that have ended, and bases that have not been used for long."""
    for run in folder.glob(f"{_RUN}*"):
        if run != own:
            with suppress(OSError), (run / _LOCK).open("w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # fails where the service lives
                remove_tree(run)
    with suppress(FileNotFoundError):  # another service removes them
        used_s = {old: old.stat().st_mtime for old in folder.glob(f"{_BASE}*") if old != base}
        for place, old in enumerate(sorted(used_s, key=lambda old: -used_s[old]), start=1):
            if place >= KEPT_BASES or used_s[old] < time.time() - KEPT_BASE_S:
                remove_tree(old)


def _stamp(path: Path) -> tuple[int, int]:
    with suppress(OSError):
        status = path.stat()
        return status.st_size, status.st_mtime_ns
    return 0, 0
