"""Which file formats there are, by the ending of a file's name."""

from __future__ import annotations

import os
from pathlib import PurePath
from typing import Literal

from render.errors import SettingsError

Format = Literal["exr", "png", "jpeg"]
MovieFormat = Literal["mp4", "mov", "webm"]

FORMATS_BY_ENDING: dict[str, Format] = {".exr": "exr", ".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg"}
MOVIES_BY_ENDING: dict[str, MovieFormat] = {".mp4": "mp4", ".mov": "mov", ".webm": "webm"}
_OTHER_MOVIE_ENDINGS = frozenset({".m4v", ".mkv", ".avi", ".gif", ".mpg", ".mpeg", ".mxf", ".ogv"})


def movie_format_of(path: str | os.PathLike[str]) -> MovieFormat | None:
    """Movie format of a file name, by its suffix; case is ignored.

    Args:
        path: the file to be written.

    Returns:
        The format; None where the name is not that of a movie.

    Raises:
        SettingsError: it is that of a movie that cannot be written.
    """
    ending = PurePath(path).suffix.lower()
    if ending in _OTHER_MOVIE_ENDINGS:
        known = ", ".join(MOVIES_BY_ENDING)
        raise SettingsError(
            f"unknown movie format of '{os.fspath(path)}': expected one of {known}, got '{ending}'",
            code="unknown_format",
        )
    return MOVIES_BY_ENDING.get(ending)


def format_of(path: str | os.PathLike[str]) -> Format:
    """Format of a file name, by its suffix; case is ignored.

    Args:
        path: the file to be written.

    Raises:
        SettingsError: no frame can be written under that name.
    """
    ending = PurePath(path).suffix.lower()
    if movie_format_of(path) is not None:
        raise SettingsError(
            f"'{os.fspath(path)}' is a movie: expected a picture, one of {', '.join(FORMATS_BY_ENDING)}",
            code="is_movie",
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
