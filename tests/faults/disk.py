"""A small disk for the data folder, which can be filled: a tmpfs in a mount namespace of the run, where that is permitted."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

SIZE_MIB = 64
_IN_NAMESPACE = "PULLFOCUS_TEST_NAMESPACE"


@dataclass(frozen=True)
class Disk:
    """Folder of the data.

    Attributes:
        folder: where it is mounted, or a plain folder.
        can_fill: whether it is a disk of its own.
    """

    folder: Path
    can_fill: bool

    @contextmanager
    def full(self) -> Iterator[None]:
        """Take all its room for a while."""
        filler = self.folder / "filler"
        with filler.open("wb", buffering=0) as file, suppress(OSError):
            while True:
                file.write(bytes(1 << 16))
        with filler.open("ab", buffering=0) as file, suppress(OSError):
            while True:
                file.write(bytes(1))
        try:
            yield
        finally:
            filler.unlink()


def enter_namespace(module: str) -> None:
    """Run the program again in a mount namespace of its own, where this machine permits that; else go on without."""
    if os.environ.get(_IN_NAMESPACE) or subprocess.run(["unshare", "-m", "true"], capture_output=True).returncode:
        return
    os.environ[_IN_NAMESPACE] = "1"
    os.execvp("unshare", ["unshare", "-m", sys.executable, "-m", module, *sys.argv[1:]])


def make_disk(folder: Path) -> Disk:
    """Mount a small disk at a folder, inside `enter_namespace`."""
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={SIZE_MIB}m", "pullfocus", str(folder)]
    can_fill = bool(os.environ.get(_IN_NAMESPACE)) and not subprocess.run(command, capture_output=True).returncode
    return Disk(folder, can_fill)
