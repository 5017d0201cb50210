"""Path of the sheet that draws an entry of a library."""

from __future__ import annotations

from pathlib import Path

from render.errors import OutputError, SettingsError
from render.files import check_writable

SHEET_SUFFIXES = (".png", ".svg")


def resolve_sheet_path(out: Path, name: str) -> Path:
    """Return the file to draw: ``out`` itself, or a file in the folder ``out``, which is created where there is none.

    The file is checked to be writable before anything is computed.

    Args:
        out: as typed after ``--out``.
        name: of the entry.

    Raises:
        SettingsError: it is neither a folder nor a .png or .svg file.
        OutputError: it cannot be written.
    """
    if out.suffix.lower() in SHEET_SUFFIXES and not out.is_dir():
        check_writable(out)
        return out
    if out.suffix and not out.is_dir():
        raise SettingsError(f"--out takes a folder, or a file that ends in .png or .svg, got {out}")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot make the folder {out}: {error.strerror}", path=str(out)) from error
    check_writable(out / f"{name}.png")
    return out / f"{name}.png"
