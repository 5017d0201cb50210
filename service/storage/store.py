"""Where shots live: a folder each, and nothing else that could disagree with it.

::

    DATA/lock                    held by the one service that works here
    DATA/shots/ID/files/...      what was sent, unpacked
    DATA/shots/ID/edits.usda     every edit since (absent where there is none)
    DATA/shots/ID/history/       the states that it has had (`service.storage.edit_files`)
    DATA/shots/ID/shot.json      the record; written last, so a folder without it was never accepted
"""

from __future__ import annotations

import fcntl
import json
import logging
import os
import re
import secrets
import shutil
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from render.errors import NotFoundError, OutputError

log = logging.getLogger("pullfocus.service")

ID_PATTERN = re.compile(r"[a-z0-9][a-z0-9-]{0,63}")


@dataclass(frozen=True)
class ShotRecord:
    """A stored shot.

    Attributes:
        id: names it in addresses.
        name: for people.
        folder: of the shot in the store.
        root: the root layer, relative to its files.
        created_at: when it was accepted.
        size_bytes: of all its files.
        file_count: how many they are.
    """

    id: str
    name: str
    folder: Path
    root: str
    created_at: datetime
    size_bytes: int
    file_count: int

    @property
    def files(self) -> Path:
        """Folder of what was sent: nothing outside it may be read."""
        return self.folder / "files"

    @property
    def root_path(self) -> Path:
        """The root layer."""
        return self.files / self.root

    @property
    def edits(self) -> Path:
        """The edit layer; may not exist yet."""
        return self.folder / "edits.usda"

    @property
    def history(self) -> Path:
        """Folder of the states that the edit layer has had; may not exist yet."""
        return self.folder / "history"

    def with_root(self, root: str) -> ShotRecord:
        """The same shot with another root layer."""
        return replace(self, root=root)

    def edit_text(self) -> str:
        """The edit layer as text, empty where there is none yet."""
        try:
            return self.edits.read_text(encoding="utf-8")
        except FileNotFoundError:
            return ""


class ShotStore:
    """The shots of one data folder.

    Args:
        data: the folder; made when missing.

    Raises:
        OutputError: the folder cannot be written, or another service works in it.
    """

    def __init__(self, data: Path) -> None:
        self._shots = data / "shots"
        try:
            self._shots.mkdir(parents=True, exist_ok=True)
            self._lock = (data / "lock").open("w")
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise OutputError(f"another service already works in the data folder {data}", path=str(data)) from error
        except OSError as error:
            raise OutputError(f"the data folder {data} cannot be written: {error.strerror}", path=str(data)) from error
        self._clear_unaccepted()

    def close(self) -> None:
        """Let another service have the folder."""
        self._lock.close()

    def _clear_unaccepted(self) -> None:
        """Remove what a service that was stopped in the middle of an upload or a removal left behind."""
        for folder in self._shots.iterdir():
            if folder.is_dir() and not (folder / "shot.json").is_file():
                shutil.rmtree(folder)

    def list(self) -> list[ShotRecord]:
        """All shots, newest last."""
        records = (self._read(folder) for folder in self._shots.iterdir())
        return sorted((r for r in records if r), key=lambda r: (r.created_at, r.id))

    def get(self, shot_id: str) -> ShotRecord:
        """One shot.

        Raises:
            NotFoundError: there is none of this id.
        """
        record = self._read(self._shots / shot_id) if ID_PATTERN.fullmatch(shot_id) else None
        if record is None:
            raise NotFoundError(f"There is no shot {shot_id[:80]!r}.", code="shot_not_found", path=shot_id[:80])
        return record

    def begin(self, name: str, shot_id: str | None = None) -> ShotRecord:
        """Make the folder of a new shot, which nobody sees until it is accepted.

        Args:
            name: for people.
            shot_id: made up from the name when left out.
        """
        stem = re.sub(r"[^a-z0-9]+", "-", Path(name).stem.lower()).strip("-")[:40] or "shot"
        shot_id = shot_id or f"{stem}-{secrets.token_hex(4)}"
        record = ShotRecord(shot_id, name, self._shots / shot_id, "", datetime.now(UTC), 0, 0)
        record.files.mkdir(parents=True)
        return record

    def accept(self, begun: ShotRecord, root: str) -> ShotRecord:
        """Write the record of a begun shot: from now on it is there."""
        sizes = [path.stat().st_size for path in begun.files.rglob("*") if path.is_file()]
        fields = {
            "name": begun.name,
            "root": root,
            "createdAt": begun.created_at.isoformat(),
            "sizeBytes": sum(sizes),
            "fileCount": len(sizes),
        }
        beside = begun.folder / "shot.json.part"
        beside.write_text(json.dumps(fields, indent=2), encoding="utf-8")
        os.replace(beside, begun.folder / "shot.json")
        return self.get(begun.id)

    def discard(self, begun: ShotRecord) -> None:
        """Remove a begun shot that was refused."""
        shutil.rmtree(begun.folder, ignore_errors=True)

    def remove(self, record: ShotRecord) -> None:
        """Remove a shot: first its record, so that it is never half there."""
        (record.folder / "shot.json").unlink(missing_ok=True)
        shutil.rmtree(record.folder, ignore_errors=True)

    def _read(self, folder: Path) -> ShotRecord | None:
        try:
            fields = json.loads((folder / "shot.json").read_text(encoding="utf-8"))
            return ShotRecord(
                id=folder.name,
                name=fields["name"],
                folder=folder,
                root=fields["root"],
                created_at=datetime.fromisoformat(fields["createdAt"]),
                size_bytes=fields["sizeBytes"],
                file_count=fields["fileCount"],
            )
        except (FileNotFoundError, NotADirectoryError):
            return None
        except (ValueError, KeyError, TypeError) as error:  # somebody's hand was in it: the others must not suffer
            log.error("the record of shot %s cannot be read and is left out: %r", folder.name, error)
            return None
