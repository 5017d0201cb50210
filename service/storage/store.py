"""Store of shots: one folder each, with no other index that could disagree with it.

::

    DATA/lock                           locked by the one service that uses the folder
    DATA/layout.json                    version of this layout (`service.storage.migration`)
    DATA/shots/ID/files/...             the uploaded files, unpacked
    DATA/shots/ID/edits/edits.usda      the edit layer (absent where there are no edits)
    DATA/shots/ID/edits/history/        earlier states of the edit layer (`service.storage.edit_files`)
    DATA/shots/ID/shot.json             the record; written last, so a folder without it was not accepted
    DATA/trash/ID.STAMP/                a deleted shot (`service.storage.trash`)
"""

from __future__ import annotations

import fcntl
import json
import logging
import os
import re
import secrets
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from pydantic import BaseModel, ConfigDict
from pydantic.alias_generators import to_camel

from render.errors import NotFoundError, OutputError, StageError
from render.files import read_regular_file, sync_file_system, sync_folder, write_atomic
from render.removal import remove_tree
from service.identity.principal import DEFAULT_PROJECT
from service.storage.edit_files import EDITS, clear_unfinished
from service.storage.migration import migrate

log = logging.getLogger("pullfocus.service")

MAX_EDIT_BYTES = 64 << 20
"""Size of the edits of a shot."""
RECORD = "shot.json"
TRASH = "trash"
ID_PATTERN = re.compile(r"[a-z0-9][a-z0-9-]{0,63}")


@dataclass(frozen=True)
class ShotRecord:
    """A stored shot.

    Attributes:
        id: its name in URLs.
        name: title for people.
        folder: its folder in the store.
        root: the root layer, relative to `files`.
        created_at: time at which it was accepted.
        size_bytes: total size of its files.
        file_count: number of its files.
        project: whose shot it is.
    """

    id: str
    name: str
    folder: Path
    root: str
    created_at: datetime
    size_bytes: int
    file_count: int
    project: str = DEFAULT_PROJECT

    @property
    def files(self) -> Path:
        """Folder of the uploaded files; nothing outside it may be read."""
        return self.folder / "files"

    @property
    def root_path(self) -> Path:
        """Path of the root layer."""
        return self.files / self.root

    @property
    def edits_folder(self) -> Path:
        """Folder of all that edits write."""
        return self.folder / "edits"

    @property
    def edits(self) -> Path:
        """Path of the edit layer, which may not exist yet."""
        return self.edits_folder / EDITS

    def with_root(self, root: str) -> ShotRecord:
        """Return the same shot with another root layer."""
        return replace(self, root=root)

    def edit_text(self) -> str:
        """Read the edit layer as text; empty where there is none yet.

        Raises:
            StageError: it is no plain file of UTF-8 text, or too large. A worker wrote it, which is not trusted.
        """
        content = read_regular_file(self.edits, MAX_EDIT_BYTES)
        if content is None and not os.path.lexists(self.edits):
            return ""
        try:
            return (content if content is not None else b"\xff").decode()
        except UnicodeDecodeError as error:
            detail = f"the saved edits of shot {self.id!r} cannot be read; take them back, or delete the shot"
            raise StageError(detail, code="bad_edits", path=self.id) from error


class ShotStore:
    """The shots of one data folder.

    Args:
        data: the folder; created when missing, and brought to the present layout when an earlier version wrote it.

    Raises:
        OutputError: the folder cannot be written, another service uses it, or a newer version wrote it.
    """

    def __init__(self, data: Path) -> None:
        self._data = data
        self._shots = data / "shots"
        try:
            self._shots.mkdir(parents=True, exist_ok=True)
            (data / TRASH).mkdir(exist_ok=True)
            self._lock = (data / "lock").open("w")
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise OutputError(f"another service already works in the data folder {data}", path=str(data)) from error
        except OSError as error:
            raise OutputError(f"the data folder {data} cannot be written: {error.strerror}", path=str(data)) from error
        try:
            migrate(data)
            self._clear_unaccepted()
            self._clear_unfinished()
        except OutputError:
            self.close()
            raise
        except OSError as error:
            self.close()
            raise OutputError(f"the data folder {data} cannot be written: {error.strerror}", path=str(data)) from error

    def close(self) -> None:
        """Unlock the folder."""
        self._lock.close()

    def _clear_unaccepted(self) -> None:
        """Remove the folders of uploads that were interrupted."""
        for folder in self._shots.iterdir():
            if folder.is_dir() and not (folder / RECORD).is_file():
                remove_tree(folder)

    def _clear_unfinished(self) -> None:
        """Remove what killed writers have left of files; uploaded files are not touched."""
        for folder in (self._data, *self._shots.iterdir(), *(self._data / TRASH).iterdir()):
            clear_unfinished(folder)
            clear_unfinished(folder / "edits")

    def list(self) -> list[ShotRecord]:
        """Read the records of all shots, newest last."""
        records = (read_record(folder, folder.name) for folder in self._shots.iterdir())
        return sorted((r for r in records if r), key=lambda r: (r.created_at, r.id))

    def get(self, shot_id: str) -> ShotRecord:
        """Read the record of a shot.

        Raises:
            NotFoundError: there is no shot of this id.
        """
        record = read_record(self._shots / shot_id, shot_id) if ID_PATTERN.fullmatch(shot_id) else None
        if record is None:
            raise not_found(shot_id)
        return record

    def begin(self, name: str, shot_id: str | None = None, project: str = DEFAULT_PROJECT) -> ShotRecord:
        """Create the folder of a new shot, which is not listed until it is accepted.

        Args:
            name: title for people.
            shot_id: its id; derived from the name when left out.
            project: whose shot it is.

        Raises:
            OSError: the disk is full, or takes no folders; nothing is left.
        """
        stem = re.sub(r"[^a-z0-9]+", "-", Path(name).stem.lower()).strip("-")[:40] or "shot"
        shot_id = shot_id or f"{stem}-{secrets.token_hex(4)}"
        record = ShotRecord(shot_id, name, self._shots / shot_id, "", datetime.now(UTC), 0, 0, project)
        try:
            record.files.mkdir(parents=True)
            record.edits_folder.mkdir()
        except FileExistsError:
            raise
        except OSError:
            self.discard(record)
            raise
        return record

    def accept(self, begun: ShotRecord, root: str) -> ShotRecord:
        """Write the record of a new shot, which lists it, once the disk has its files.

        Raises:
            OutputError: the disk is full, or fails.
        """
        sizes = _sizes_of(begun)
        fields = {
            "name": begun.name,
            "root": root,
            "createdAt": begun.created_at.isoformat(),
            "sizeBytes": sum(sizes),
            "fileCount": len(sizes),
            "project": begun.project,
        }
        sync_file_system(begun.files)
        write_atomic(begun.folder / RECORD, json.dumps(fields, indent=2).encode())
        for folder in (begun.folder, self._shots):
            sync_folder(folder)
        return self.get(begun.id)

    def discard(self, begun: ShotRecord) -> None:
        """Remove a new shot that was refused; what cannot be removed is when the store is opened next."""
        try:
            remove_tree(begun.folder)
        except OSError as error:
            log.error("the upload %s cannot be removed as a whole: %s", begun.id, error)


def size_of(begun: ShotRecord) -> int:
    """Return the size of the files of a new shot, bytes."""
    return sum(_sizes_of(begun))


def _sizes_of(begun: ShotRecord) -> list[int]:
    return [path.stat().st_size for path in begun.files.rglob("*") if path.is_file()]


class _RecordFile(BaseModel):
    """Contents of a shot's record on disk."""

    model_config = ConfigDict(strict=True, alias_generator=to_camel)

    name: str
    root: str
    created_at: datetime
    size_bytes: int
    file_count: int
    project: str = DEFAULT_PROJECT


def read_record(folder: Path, shot_id: str) -> ShotRecord | None:
    """Read the record of a shot. Returns None where there is none, or where it is damaged, which is logged.

    Args:
        folder: of the shot.
        shot_id: its id.

    Raises:
        OSError: the disk fails.
    """
    try:
        fields = _RecordFile.model_validate_json((folder / RECORD).read_bytes())
        return ShotRecord(shot_id, folder=folder, **fields.model_dump() | {"created_at": _in_utc(fields.created_at)})
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (IsADirectoryError, ValueError, OverflowError) as error:  # edited by hand; the other shots stay listed
        log.error("the record of shot %s cannot be read and is left out: %r", shot_id, error)
        return None


def _in_utc(time: datetime) -> datetime:
    """Convert a time to UTC; one without a zone counts as UTC. Pydantic's own time zones may not be sent to workers.

    Raises:
        OverflowError: it is before the year 1 or after 9999.
    """
    return (time if time.tzinfo else time.replace(tzinfo=UTC)).astimezone(UTC)


def not_found(shot_id: str) -> NotFoundError:
    """Return the error of a shot that is not there, or not for the one who asks."""
    return NotFoundError(f"There is no shot {shot_id[:80]!r}.", code="shot_not_found", path=shot_id[:80])
