"""Edit history of a shot on disk: one USD layer for each state, and an index that is written last.

::

    DATA/shots/ID/edits/history/REVISION.usda      a state of the edit layer, as a whole
    DATA/shots/ID/edits/history/index.json         order and labels of the states, and which is the present one
"""

from __future__ import annotations

import json
import logging
import zlib
from contextlib import suppress
from datetime import datetime
from pathlib import Path

from render.files import write_atomic
from render.model.edit_history import EditHistory, EditState, revision_of

log = logging.getLogger("pullfocus.service")

INDEX = "index.json"


def save_history(folder: Path, history: EditHistory) -> None:
    """Write new states, then the index, and remove states that are no longer kept.

    Args:
        folder: created when missing.
        history: the states to keep.

    Raises:
        OutputError: a file cannot be written; the previous index stays valid.
    """
    with suppress(OSError):  # writing to a folder that cannot be created fails below
        folder.mkdir(exist_ok=True)
    for state in history.states:
        if not _file(folder, state.revision).is_file():
            write_atomic(_file(folder, state.revision), state.text.encode())
    write_atomic(folder / INDEX, json.dumps(_index(history), indent=1).encode())
    kept = {state.revision for state in history.states}
    for file in folder.glob("*.usda"):
        if file.stem not in kept:
            file.unlink(missing_ok=True)


def load_history(folder: Path) -> EditHistory | None:
    """Read a history. Returns None where there is none, or where it is damaged, which is logged.

    Args:
        folder: as `save_history` wrote it.
    """
    try:
        index = json.loads((folder / INDEX).read_text(encoding="utf-8"))
        history = EditHistory(tuple(_state(folder, entry) for entry in index["states"]), int(index["now"]))
        if not 0 <= history.now < len(history.states):
            raise ValueError(f"state {history.now} of {len(history.states)}")
    except FileNotFoundError as error:
        if (folder / INDEX).exists():
            log.error("the history of edits in %s lacks a state and begins anew: %s", folder, error)
        return None
    except (OSError, ValueError, KeyError, TypeError) as error:  # edited by hand; the edits themselves are kept
        log.error("the history of edits in %s cannot be read and begins anew: %r", folder, error)
        return None
    return history


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
    return EditState(zlib.compress(text.encode()), revision, entry["label"], made_at, entry["gesture"])


def _file(folder: Path, revision: str) -> Path:
    return folder / f"{revision}.usda"
