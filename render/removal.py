"""Removal of folders that a worker could write to, whatever it has put there."""

from __future__ import annotations

import os
import secrets
import stat
from pathlib import Path

_FOLDER = os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC


def remove_tree(folder: Path) -> None:
    """Remove a folder with all that is in it. Links are removed and not followed.

    A folder in it is emptied into the topmost one, so that neither depth nor the length of a path has a limit: a tree needs two
    descriptors and no recursion. One that was interrupted is a tree like any other.

    Args:
        folder: the folder; it is no error if there is none.

    Raises:
        OSError: something cannot be removed.
    """
    try:
        top = _open(folder)
    except FileNotFoundError:
        return
    try:
        while names := os.listdir(top):
            for name in names:
                if not _is_unlinked(name, top):
                    _remove_folder(name, top)
    finally:
        os.close(top)
    os.rmdir(folder)


def _remove_folder(name: str, top: int) -> None:
    """Remove a folder in the topmost one, after the folders in it were moved beside it."""
    folder = _open(name, top)
    try:
        for child in os.listdir(folder):
            if not _is_unlinked(child, folder):
                os.close(_open(child, folder))  # a folder that is moved must be writable
                os.rename(child, secrets.token_hex(16), src_dir_fd=folder, dst_dir_fd=top)
    finally:
        os.close(folder)
    os.rmdir(name, dir_fd=top)


def _is_unlinked(name: str, folder: int) -> bool:
    """Remove a file of any kind, or a link. Returns False where it is a folder."""
    try:
        os.unlink(name, dir_fd=folder)
    except FileNotFoundError:
        return True
    except (IsADirectoryError, PermissionError):
        if not stat.S_ISDIR(os.lstat(name, dir_fd=folder).st_mode):
            raise
        return False
    return True


def _open(name: str | Path, parent: int | None = None) -> int:
    """Open a folder, and give its owner the right to empty it. Returns the descriptor."""
    place = os.open(name, os.O_PATH | _FOLDER, dir_fd=parent)
    try:
        if os.fstat(place).st_mode & 0o700 != 0o700:
            os.chmod(f"/proc/self/fd/{place}", 0o700)
        return os.open(".", os.O_RDONLY | _FOLDER, dir_fd=place)
    finally:
        os.close(place)
