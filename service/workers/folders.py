"""Folders that a worker has written, which a hostile file may have filled in any way that a sandbox allows."""

from __future__ import annotations

import itertools
import os
from contextlib import suppress
from pathlib import Path

from render import removal

FILES = 20_000
"""Files and folders after which a folder counts as full, however small they are."""


def is_fuller(folder: Path, most_bytes: int) -> bool:
    """Whether the files in a folder take more space on the disk than a limit, or are more than `FILES`.

    Args:
        folder: the folder. A part that cannot be listed, because it is too deep or closed, counts as too full.
        most_bytes: the limit.
    """
    total, count, left = 0, 0, [str(folder)]
    while left and total <= most_bytes and count <= FILES:
        try:
            with os.scandir(left.pop()) as entries:
                for entry in itertools.islice(entries, FILES):
                    count += 1
                    with suppress(FileNotFoundError):  # it has just been removed
                        total += 512 * entry.stat(follow_symlinks=False).st_blocks
                    if entry.is_dir(follow_symlinks=False):
                        left.append(entry.path)
        except FileNotFoundError:  # the folder has just been removed
            continue
        except OSError:
            return True
    return total > most_bytes or count > FILES


def remove_tree(folder: Path) -> None:
    """Remove a folder as far as possible."""
    with suppress(OSError):
        removal.remove_tree(folder)


def default_cache_folder(user: str = "service") -> Path:
    """Return the folder of a cache by default: ``$XDG_CACHE_HOME/pullfocus-USER``, else in ``~/.cache``.

    Args:
        user: whose cache it is.
    """
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / f"pullfocus-{user}"
