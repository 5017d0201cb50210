"""Files of a recording, prepared and checked before an hour of rendering is lost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from render.errors import OutputError, SettingsError
from render.files import check_replaceable, check_writable
from render.shot import Shot


def make_folders(files: Sequence[Path]) -> None:
    """Make the folders of files.

    Raises:
        SettingsError: two of the files are the same.
        OutputError: a folder cannot be made.
    """
    twice = [str(file) for file, count in Counter(files).items() if count > 1]
    if twice:
        raise SettingsError(f"several pictures are written to {twice[0]}: give each its own name")
    for folder in dict.fromkeys(file.parent for file in files):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"the folder {folder} cannot be made: {error.strerror}", path=str(folder)) from error


def check_files(shot: Shot, files: Sequence[Path]) -> None:
    """Check that all files can be written.

    Args:
        shot: its own files may not be replaced.
        files: to be written.

    Raises:
        OutputError: one cannot be written.
        SettingsError: one is a file of the shot.
    """
    for file in {file.parent: file for file in files}.values():
        check_writable(file)
    for file in files:
        check_replaceable(file)
    for file in files:
        shot.check_not_own(file)
