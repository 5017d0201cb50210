"""Edits of a shot on disk: one USD layer for each state that they have had, an index, and the edit layer itself.

::

    DATA/shots/ID/edits/history/REVISION.usda      a state of the edit layer, as a whole
    DATA/shots/ID/edits/history/index.json         order and labels of the states, and which is the present one: after the last
                                                   edit, and as it was before
    DATA/shots/ID/edits/edits.usda                 the edit layer; absent where there are no edits

An edit is made by the replacement of ``edits.usda``, which comes last. The index has both histories, and the layer tells which of
them holds: an edit that was interrupted at any point is there with its history, or neither is.
"""

from __future__ import annotations

import errno
import json
import logging
import zlib
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Any

from render.errors import OutputError
from render.files import sync_folder, write_atomic
from render.model.edit_history import EditHistory, EditState, revision_of
from service.json_text import parse_json

log = logging.getLogger("pullfocus.service")

EDITS = "edits.usda"
HISTORY = "history"
INDEX = "index.json"
_MISSING = (errno.ENOENT, errno.ENOTDIR, errno.EISDIR)


def save_edits(folder: Path, history: EditHistory, before: EditHistory) -> None:
    """Save edits with their history.

    Args:
        folder: of the shot's edits.
        history: after the edit.
        before: as it was saved last.

    Raises:
        OutputError: a file cannot be written. Where it is another than the edit layer's, the edits are as they were before.
    """
    states, kept = folder / HISTORY, _revisions(history) | _revisions(before)
    with suppress(OSError):  # writing to a folder that cannot be created fails below
        states.mkdir(exist_ok=True)
    for state in (*before.states, *history.states):
        if not _file(states, state.revision).is_file():
            write_atomic(_file(states, state.revision), state.text.encode())
    index = {**_index(history), "before": _index(before)}
    write_atomic(states / INDEX, json.dumps(index).encode())
    sync_folder(states)
    _write_edits(folder, history.present.text)
    with suppress(OSError):  # the edit has been made, and the next one tries again
        for file in states.glob("*.usda"):
            if file.stem not in kept:
                file.unlink(missing_ok=True)


def load_history(folder: Path) -> EditHistory | None:
    """Read the history of saved edits. Returns None where there is none, or where it is damaged, which is logged.

    Args:
        folder: of the shot's edits, as `save_edits` wrote it.

    Raises:
        OutputError: the disk fails. It may be another time.
    """
    states = folder / HISTORY
    try:
        index = _chosen(parse_json((states / INDEX).read_bytes()), _present_revision(folder))
        history = EditHistory(tuple(_state(states, entry) for entry in index["states"]), int(index["now"]))
        if not 0 <= history.now < len(history.states):
            raise ValueError(f"state {history.now} of {len(history.states)}")
    except OSError as error:
        if error.errno not in _MISSING:
            detail = f"the history of edits in {states} cannot be read: {error.strerror}"
            raise OutputError(detail, path=str(states)) from error
        if (states / INDEX).exists():
            log.error("the history of edits in %s lacks a state and begins anew: %s", states, error)
        return None
    except (ValueError, KeyError, TypeError) as error:  # edited by hand; the edits themselves are kept
        log.error("the history of edits in %s cannot be read and begins anew: %r", states, error)
        return None
    return history


def states_of_index(content: bytes) -> list[str]:
    """Return the revisions that an index names, after the last edit and before it. Raises what a damaged index raises."""
    index = parse_json(content)
    entries = (*index["states"], *index.get("before", {"states": []})["states"])
    return list(dict.fromkeys(str(entry["revision"]) for entry in entries))


def clear_unfinished(folder: Path) -> None:
    """Remove what killed writers have left of files (`render.files.write_atomic`).

    Args:
        folder: of a shot's edits, or one that has such files directly in it. Links are not followed.

    Raises:
        OSError: a file cannot be removed.
    """
    for place in (folder, folder / HISTORY):
        for part in () if place.is_symlink() else place.glob("*.part"):
            with suppress(IsADirectoryError):  # no writer of files has left it
                part.unlink(missing_ok=True)


def _write_edits(folder: Path, text: str) -> None:
    edits = folder / EDITS
    if text:
        write_atomic(edits, text.encode())
    else:
        try:
            edits.unlink(missing_ok=True)
        except OSError as error:
            raise OutputError(f"cannot remove {edits}: {error.strerror}", path=str(edits)) from error
    sync_folder(folder)


def _present_revision(folder: Path) -> str:
    try:
        return revision_of((folder / EDITS).read_bytes().decode())
    except FileNotFoundError:
        return revision_of("")


def _chosen(index: dict[str, Any], revision: str) -> dict[str, Any]:
    """Return the history in an index whose present state is the edit layer; where neither is, that after the last edit."""
    for history in (index, index.get("before")):
        if history and history["states"][history["now"]]["revision"] == revision:
            return history
    return index


def _revisions(history: EditHistory) -> set[str]:
    return {state.revision for state in history.states}


def _index(history: EditHistory) -> dict[str, object]:
    states = [
        {"revision": s.revision, "label": s.label, "madeAt": s.made_at.isoformat(), "gesture": s.gesture}
        for s in history.states
    ]
    return {"now": history.now, "states": states}


def _state(folder: Path, entry: dict[str, str]) -> EditState:
    revision = entry["revision"]
    text = _file(folder, revision).read_text(encoding="utf-8")
    if revision_of(text) != revision:
        raise ValueError(f"{revision}.usda is not what was written")
    made_at = datetime.fromisoformat(entry["madeAt"])
    content = text.encode()
    return EditState(zlib.compress(content), revision, entry["label"], made_at, len(content), entry["gesture"])


def _file(folder: Path, revision: str) -> Path:
    return folder / f"{revision}.usda"
