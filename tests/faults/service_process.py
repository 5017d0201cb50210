"""A `pullfocus serve` process on a data folder, which can be killed, started again, and looked into from outside."""

from __future__ import annotations

import os
import signal
import socket
import struct
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import httpx

START_S = 60.0
ORPHAN_S = 2.0
READ_NICENESS, FINAL_NICENESS = 5, 10
DRIVERS = "libgallium", "_dri.so", "nvidia-eglcore"
"""Parts of the names of libraries that a worker maps when it draws."""


@dataclass(frozen=True)
class Child:
    """A process, told from a later one of the same id by the time of its start."""

    pid: int
    started: str

    def is_there(self) -> bool:
        """Whether it runs; one that has ended and was not waited for does not."""
        fields = _stat(self.pid)
        return bool(fields) and fields[0] != "Z" and fields[19] == self.started


@dataclass
class ServiceProcess:
    """The service of a run.

    Attributes:
        folder: holds its configuration, log, cache and clock.
        data: its data folder.
        port: stays the same after a restart.
        orphans: processes that outlived a killed service.
    """

    folder: Path
    data: Path
    port: int = 0
    orphans: list[int] = field(default_factory=list)
    _process: subprocess.Popen[bytes] | None = None

    def __post_init__(self) -> None:
        with socket.create_server(("127.0.0.1", 0)) as found:
            self.port = found.getsockname()[1]
        (self.folder / "cache").mkdir()
        (self.folder / "config.toml").write_text(
            'cache = "cache"\nlog_format = "text"\nframe_cache_mb = 0\nmin_free_mb = 2\n'
        )
        self._clock = self.folder / "clock"
        self._clock.write_bytes(struct.pack("d", 0.0))
        self._shim = self._build_shim()

    @property
    def address(self) -> str:
        """Base of its URLs."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def has_clock(self) -> bool:
        """Whether its wall clock can be set."""
        return self._shim is not None

    def start(self) -> None:
        """Start it and wait until it is alive."""
        command = [sys.executable, "-m", "render.cli", "serve", "--config", str(self.folder / "config.toml")]
        command += ["--data", str(self.data), "--port", str(self.port), "--no-demo"]
        environment = os.environ | {"PYTHONPATH": os.getcwd(), "PULLFOCUS_TEST_CLOCK": str(self._clock)}
        if self._shim:
            environment["LD_PRELOAD"] = str(self._shim)
        with (self.folder / "service.log").open("ab") as log:
            self._process = subprocess.Popen(command, stdout=log, stderr=log, env=environment)
        until = time.monotonic() + START_S
        while time.monotonic() < until:
            with suppress(httpx.TransportError):
                if httpx.get(f"{self.address}/livez", timeout=5).status_code == 200:
                    return
            if self._process.poll() is not None:
                raise AssertionError(f"the service does not start: {self.log_tail()}")
            time.sleep(0.05)
        raise AssertionError(f"the service does not answer within {START_S:g} s: {self.log_tail()}")

    def kill(self) -> None:
        """End it by a signal that it cannot see, and note which of its processes go on; they are ended too."""
        assert self._process is not None
        children = descendants(self._process.pid)
        self._process.send_signal(signal.SIGKILL)
        self._process.wait()
        until = time.monotonic() + ORPHAN_S
        while any(child.is_there() for child in children) and time.monotonic() < until:
            time.sleep(0.02)
        for child in children:
            if child.is_there():
                self.orphans.append(child.pid)
                os.kill(child.pid, signal.SIGKILL)

    def template(self) -> int | None:
        """Process id of the template of the workers."""
        assert self._process is not None
        return next((child.pid for child in _children(self._process.pid)), None)

    def workers(self, kind: str) -> list[int]:
        """Process ids of the workers of a kind, as far as can be seen from outside.

        Args:
            kind: ``read``, which are also those that open an upload, ``stage``, ``live`` or ``final``.
        """
        template = self.template()
        found = [child.pid for child in _children(template)] if template else []
        return [pid for pid in found if _kind(pid) == kind]

    def shift_clock(self, seconds: float) -> None:
        """Set the wall clock of the service this far from the machine's."""
        with self._clock.open("r+b") as file:
            file.write(struct.pack("d", seconds))

    def count_in_log(self, word: str) -> int:
        """Count the lines of its log that have a word."""
        return sum(word in line for line in (self.folder / "service.log").read_text(errors="replace").splitlines())

    def log_tail(self) -> str:
        """Return the end of its log."""
        return (self.folder / "service.log").read_text(errors="replace")[-3000:]

    def _build_shim(self) -> Path | None:
        built = self.folder / "clock.so"
        command = ["cc", "-shared", "-fPIC", "-O1", "-o", str(built), str(Path(__file__).with_name("clock.c")), "-ldl"]
        try:
            subprocess.run(command, check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError):
            return None
        return built


def descendants(pid: int) -> list[Child]:
    """Return the children of a process, theirs, and so on."""
    found: list[Child] = []
    for child in _children(pid):
        found += [child, *descendants(child.pid)]
    return found


def _children(pid: int) -> list[Child]:
    found = [(int(entry), _stat(int(entry))) for entry in os.listdir("/proc") if entry.isdigit()]
    return [Child(each, fields[19]) for each, fields in found if fields and int(fields[1]) == pid and fields[0] != "Z"]


def _kind(pid: int) -> str:
    fields = _stat(pid)
    niceness = int(fields[16]) if fields else 0
    if niceness == READ_NICENESS:
        return "read"
    if niceness == FINAL_NICENESS:
        return "final"
    with suppress(OSError):
        mapped = Path(f"/proc/{pid}/maps").read_text()
        return "live" if any(driver in mapped for driver in DRIVERS) else "stage"
    return ""


def _stat(pid: int) -> list[str]:
    """Return the fields of ``/proc/PID/stat`` behind the name; none where the process has ended."""
    with suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return []
