"""Files of the database in a data folder."""

from __future__ import annotations

from pathlib import Path

from render.files import write_atomic

DATABASE = "renders.sqlite"
"""Name of the file; SQLite has others beside it while it is open."""
NOTE = "database.txt"
"""Name of the file that tells where the database is that belongs to the folder, while it is outside."""


def note_database(folder: Path, name: str | None) -> None:
    """Note where the database of a data folder is, for those who look after the folder and do not know the settings.

    Args:
        folder: the data folder.
        name: for people; None where it is in the folder.

    Raises:
        OutputError: the note cannot be written.
        OSError: it cannot be removed.
    """
    if name is None:
        (folder / NOTE).unlink(missing_ok=True)
    elif noted_database(folder) != name:
        write_atomic(folder / NOTE, f"{name}\n".encode())


def noted_database(folder: Path) -> str | None:
    """Return where the database of a data folder is; None where it is in the folder, or there is none."""
    try:
        return (folder / NOTE).read_text(encoding="utf-8", errors="replace").strip()
    except OSError:
        return None
