"""Places in which workers work: a shot and the folders that belong to it, or none."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Place:
    """Part of the machine that a worker process may see beside the program.

    Attributes:
        key: the shot; a process serves one. None for work without a shot.
        read: files and folders that it may read.
        write: folders that it may also write.
    """

    key: str | None = None
    read: tuple[Path, ...] = ()
    write: tuple[Path, ...] = ()


NOWHERE = Place()
"""Work that reads nothing but the program."""
