"""Processes of the chaos bench: they are killed, and started again where they are gone, as a supervisor does it."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil

from render.errors import PullfocusError

STOP_S = 60.0
"""Time for a process to end when it is told to."""


class Part:
    """A process of the system.

    Args:
        name: of it and of its log.
        command: that starts it.
        log: file of what it says, to which each start adds.
        environment: beside that of this process.
        who: user and groups, as `subprocess` takes them.
    """

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        log: Path,
        environment: Mapping[str, str] | None = None,
        who: Mapping[str, Any] | None = None,
    ) -> None:
        self.name = name
        self._command, self._log = command, log
        self._environment = {**os.environ, **(environment or {})}
        self._who = dict(who or {})
        self._process: subprocess.Popen[bytes] | None = None
        self.starts = 0

    def tend(self) -> None:
        """Start the process where it does not run."""
        if self._process is not None and self._process.poll() is None:
            return
        with self._log.open("ab") as log:
            self._process = subprocess.Popen(
                self._command,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
                **self._who,
            )
        self.starts += 1

    def kill(self) -> list[psutil.Process]:
        """Kill the process with SIGKILL, and return those that it had started."""
        if self._process is None:
            return []
        family = self._family()
        self._process.kill()
        self._process.wait()
        return family

    def stop(self) -> list[psutil.Process]:
        """Tell the process to end, and return those that it had started."""
        if self._process is None or self._process.poll() is not None:
            return []
        family = self._family()
        self._process.send_signal(signal.SIGTERM)
        try:
            self._process.wait(STOP_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        return family

    def last_words(self) -> str:
        """Return the end of the log."""
        return self._log.read_text(errors="replace")[-2000:] if self._log.exists() else ""

    def _family(self) -> list[psutil.Process]:
        assert self._process is not None
        try:
            return psutil.Process(self._process.pid).children(recursive=True)
        except psutil.NoSuchProcess:
            return []


def still_running(processes: Sequence[psutil.Process], within_s: float) -> list[psutil.Process]:
    """Return those of some processes that do not end within a time."""
    end = time.monotonic() + within_s
    left = list(processes)
    while left:
        left = [each for each in left if _runs(each)]
        if time.monotonic() > end:
            break
        time.sleep(0.1)
    return left


def _runs(process: psutil.Process) -> bool:
    try:
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


@contextmanager
def small_disk(folder: Path, size_mb: int) -> Iterator[bool]:
    """Make a folder a disk of its own until the end of the context, where this process may do so.

    Args:
        folder: an empty one.
        size_mb: size of the disk, MiB.

    Yields:
        Whether it is one.
    """
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size_mb}m,mode=755", "pullfocus-chaos", str(folder)]
    is_own = (
        shutil.which("mount") is not None and subprocess.run(mount, capture_output=True, check=False).returncode == 0
    )
    try:
        yield is_own
    finally:
        if is_own:
            subprocess.run(["umount", "--lazy", str(folder)], capture_output=True, check=False)


def fill(folder: Path) -> Path:
    """Fill the disk of a folder to its last byte, and return the file that does so."""
    path = folder / "filler"
    with path.open("wb", buffering=0) as file:
        for size in (1 << 20, 1 << 12, 1):
            try:
                while True:
                    file.write(b"\0" * size)
            except OSError:
                continue
    return path


def free_port() -> int:
    """Return a port of 127.0.0.1 that nothing listens on."""
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        port: int = bound.getsockname()[1]
        return port


class MovableClock:
    """A clock of some processes that can be set, by libfaketime.

    Args:
        folder: of the file that says how late it is, which those processes can read.

    Raises:
        PullfocusError: libfaketime is not installed.
    """

    def __init__(self, folder: Path) -> None:
        library = faketime_library()
        if library is None:
            raise PullfocusError("libfaketime is not installed (Debian's package libfaketime)")
        self._file = folder / "clock"
        self.set(0)
        self.environment = {
            "LD_PRELOAD": str(library),
            "FAKETIME_TIMESTAMP_FILE": str(self._file),
            "FAKETIME_NO_CACHE": "1",
            "FAKETIME_DONT_FAKE_MONOTONIC": "1",
            "FAKETIME_DONT_RESET": "1",
        }
        """Variables of the processes whose clock it is."""

    def set(self, seconds: int) -> None:
        """Set the clock to some seconds after the true time."""
        part = self._file.with_suffix(".part")
        part.write_text(f"{seconds:+d}\n")
        part.chmod(0o644)
        part.replace(self._file)


def faketime_library() -> Path | None:
    """Return the library of libfaketime for programs with threads; None where it is not installed."""
    return next(iter(sorted(Path("/usr/lib").glob("*/faketime/libfaketimeMT.so.1"))), None)
