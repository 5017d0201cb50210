"""Layout of the data folder, and its migration from the layouts of earlier versions.

::

    DATA/layout.json     {"layout": 2}; written last, once everything is in its place

    layout 1, without a layout.json:   DATA/shots/ID/edits.usda         DATA/shots/ID/history/
    layout 2:                          DATA/shots/ID/edits/edits.usda   DATA/shots/ID/edits/history/

Layout 2 has one folder for all that an edit writes, so that a worker may be given write access to nothing else. A migration
renames and does nothing twice: one that was ended at any point goes on at the next start.
"""

from __future__ import annotations

import json
import logging
from pathlib import Path

from render.errors import OutputError
from render.files import sync_folder, write_atomic
from service.json_text import parse_json

log = logging.getLogger("pullfocus.service")

LAYOUT = 2
LAYOUT_FILE = "layout.json"


def migrate(data: Path) -> None:
    """Bring a data folder to the present layout. The caller has locked it.

    Args:
        data: the folder; its folder ``shots`` exists.

    Raises:
        OutputError: its layout is newer than this program or cannot be read, or it cannot be written. Nothing is lost.
    """
    layout = layout_of(data)
    if layout == LAYOUT:
        return
    try:
        moved = [folder for folder in sorted((data / "shots").iterdir()) if folder.is_dir() and _gather_edits(folder)]
    except OSError as error:
        detail = f"the data folder {data} cannot be brought to layout {LAYOUT}: {error.strerror}"
        raise OutputError(detail, code="layout", path=str(data)) from error
    write_atomic(data / LAYOUT_FILE, json.dumps({"layout": LAYOUT}).encode())
    sync_folder(data)
    if moved:
        log.info("the data folder %s was brought from layout %d to layout %d", data, layout, LAYOUT)


def layout_of(data: Path) -> int:
    """Read the layout of a data folder: 1 where no file says it.

    Raises:
        OutputError: the layout is newer than this program, or the file is damaged.
    """
    file = data / LAYOUT_FILE
    try:
        layout = parse_json(file.read_bytes())["layout"]
        if not isinstance(layout, int) or layout < 1:
            raise ValueError(f"layout {layout!r}")
    except FileNotFoundError:
        return 1
    except OSError as error:
        raise OutputError(f"{file} cannot be read: {error.strerror}", code="layout", path=str(file)) from error
    except (ValueError, KeyError, TypeError) as error:
        detail = f'{file} is damaged: it should hold {{"layout": {LAYOUT}}}; restore it from a backup'
        raise OutputError(detail, code="layout", path=str(file)) from error
    if layout > LAYOUT:
        detail = (
            f"the data folder {data} has layout {layout}, which a newer Pullfocus wrote: this one knows layout {LAYOUT}"
        )
        raise OutputError(detail, code="layout", path=str(data))
    return layout


def _gather_edits(shot: Path) -> bool:
    """Move the edits of a shot from layout 1 into the folder ``edits``. Returns whether there was anything to move."""
    edits = shot / "edits"
    edits.mkdir(exist_ok=True)
    present = [shot / name for name in ("edits.usda", "history") if (shot / name).exists()]
    for old in present:
        new = edits / old.name
        if new.exists():  # an earlier version ran on a folder that was half migrated: neither may be dropped
            detail = f"there are both {old} and {new}: move the one away that is not wanted"
            raise OutputError(detail, code="layout", path=str(old))
        old.rename(new)
    sync_folder(edits)  # `LAYOUT_FILE` may not be there before what it says
    sync_folder(shot)
    return bool(present)
