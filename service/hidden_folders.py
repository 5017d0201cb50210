"""Folders of this machine, which no answer names: an error tells its reader about the shot, not about the server."""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path

_hidden: list[str] = []


def hide_folder(folder: Path) -> None:
    """Hide a folder, by the path that it is given and by the one that links lead to."""
    for path in (str(folder.absolute()), str(folder.resolve())):
        if path not in _hidden and path != "/":
            _hidden.append(path)


def without_folders(text: str) -> str:
    """A message with the files of hidden folders named by what comes after the folder."""
    for folder in sorted(_hidden, key=len, reverse=True):
        text = re.sub(rf"{re.escape(folder)}/(?:{_IN_HIDDEN})?", "", text)
        text = text.replace(folder, "the service's folder")
    return _TEMPORARY.sub("", text)


_IN_HIDDEN = r"shots/[^/\s]+/(?:files/|edits/)?|run-[0-9a-f]+/\d+/(?:(?:pullfocus-|tmp)[^/\s'\"]*/?)?"
"""Part of a path between a hidden folder and the names that a reader knows."""
_TEMPORARY = re.compile(rf"{re.escape(tempfile.gettempdir())}/(?:pullfocus-|tmp)[^/\s'\"]*/?")
hide_folder(Path(__file__).parents[1])  # the program
hide_folder(Path(sys.prefix))
