"""Id of a data folder, by which services that share a database are told apart."""

from __future__ import annotations

import re
import secrets
from pathlib import Path

from render.files import read_regular_file, write_atomic

FOLDER_ID = "folder-id"
"""Name of the file."""
_ID = re.compile(rb"[0-9a-f]{16}\n")


def folder_id(data: Path) -> str:
    """Return the id of a data folder, which it keeps over restarts; it gets one where it has none.

    Args:
        data: the folder.

    Raises:
        OutputError: it cannot be written.
        OSError: it cannot be read.
    """
    found = read_regular_file(data / FOLDER_ID, 64) or b""
    if not _ID.fullmatch(found):
        found = f"{secrets.token_hex(8)}\n".encode()
        write_atomic(data / FOLDER_ID, found)
    return found.decode().strip()
