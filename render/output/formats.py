"""Which file formats there are, by the ending of a file's name."""

from __future__ import annotations

import os
from pathlib import PurePath
from typing import Literal

from render.errors import SettingsError

Format = Literal["exr", "png", "jpeg"]

FORMATS_BY_ENDING: dict[str, Format] = {".exr": "exr", ".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg"}
_MOVIE_ENDINGS = frozenset({".mp4", ".mov", ".m4v", ".mkv", ".webm", ".avi", ".gif"})


def format_of(path: str | os.PathLike[str]) -> Format:
    """Format of a file name, by its suffix; case is ignored.

    Args:
        path: the file to be written.

    Raises:
        SettingsError: no frame can be written under that name.
    """
    ending = PurePath(path).suffix.lower()
    if ending in _MOVIE_ENDINGS:
        raise SettingsError(
            f"movies come later: '{os.fspath(path)}' cannot be written yet, record a numbered PNG sequence "
            "such as frame.####.png",
            code="movies_later",
        )
    if ending not in FORMATS_BY_ENDING:
        known = ", ".join(FORMATS_BY_ENDING)
        got = f"'{ending}'" if ending else "no ending"
        raise SettingsError(
            f"unknown picture format of '{os.fspath(path)}': expected one of {known}, got {got}", code="unknown_format"
        )
    return FORMATS_BY_ENDING[ending]


def check_format(name: str) -> Format:
    """The name itself, when it is that of a format.

    Raises:
        SettingsError: it is not.
    """
    known = sorted(set(FORMATS_BY_ENDING.values()))
    if name not in known:
        raise SettingsError(
            f"unknown picture format '{name}': expected one of {', '.join(known)}", code="unknown_format"
        )
    return name
