"""Notes of the shots that have ended worker processes, kept beside the shots.

::

    DATA/shots/ID/blames.json    how often the shot has ended a worker, and why it last did
"""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from render.files import write_atomic
from service.json_text import parse_json

FILE = "blames.json"


@dataclass(frozen=True)
class Blames:
    """Times that a shot has ended a worker.

    Attributes:
        count: number of times.
        reason: why it last did: ``memory``, ``crash``, ``cpu``, ``timeout`` or ``unsafe``.
        last_s: when it last did, in seconds of Unix time.
    """

    count: int = 0
    reason: str = ""
    last_s: float = 0.0


def read_blames(folder: Path) -> Blames:
    """Read the notes of a shot.

    Args:
        folder: of the shot.
    """
    with suppress(OSError, ValueError, TypeError):  # there are none, or they were edited by hand
        return Blames(**parse_json((folder / FILE).read_text(encoding="utf-8")))
    return Blames()


def write_blames(folder: Path, blames: Blames) -> None:
    """Write the notes of a shot.

    Args:
        folder: of the shot, which exists.
        blames: without any, the file is removed.

    Raises:
        OutputError: the file cannot be written.
        OSError: it cannot be removed.
    """
    if blames.count:
        write_atomic(folder / FILE, json.dumps(asdict(blames)).encode())
    else:
        (folder / FILE).unlink(missing_ok=True)
