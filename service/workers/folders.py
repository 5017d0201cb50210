"""Folders that a worker has written, which a hostile file may have filled in any way that a sandbox allows."""

from __future__ import annotations

import itertools
import os
import secrets
from contextlib import suppress
from pathlib import Path

FILES = 20_000
"""Files and folders after which a folder counts as full, however small they are."""
_MAX_STEPS = 1_000_000


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
                    total += 512 * entry.stat(follow_symlinks=False).st_blocks
                    if entry.is_dir(follow_symlinks=False):
                        left.append(entry.path)
        except FileNotFoundError:  # it has just been removed
            continue
        except OSError:
            return True
    return total > most_bytes or count > FILES


def remove_tree(folder: Path) -> None:
    """Remove a folder as far as possible: however deep it is, and without following links. No process may write there."""
    with suppress(OSError):
        for _ in range(_MAX_STEPS):  # what lies deeper comes up by one in each step, so that no path is too long
            nested = [entry.path for entry in list(os.scandir(folder)) if not _unlinked(entry)]
            if not nested:
                break
            for path in nested:
                os.chmod(path, 0o700)
                for entry in list(os.scandir(path)):
                    if not _unlinked(entry):
                        os.rename(entry.path, folder / secrets.token_hex(16))
                os.rmdir(path)
        folder.rmdir()


def _unlinked(entry: os.DirEntry[str]) -> bool:
    """Remove what is no folder. Returns whether it was none."""
    if entry.is_dir(follow_symlinks=False):
        return False
    os.unlink(entry.path)
    return True
