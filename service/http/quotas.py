"""Quotas: how many shots a project may have, how large they may be, and how long processors may work for one sender."""

from __future__ import annotations

import os
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from service.http.clients import present_client
from service.http.errors import ServiceError
from service.http.settings import MEBIBYTE, Settings
from service.identity.cpu_usage import CpuUsage
from service.identity.principal import ALL_PROJECTS
from service.jobs.queue import RenderQueue
from service.models.keys import Amount, Usage
from service.storage.edit_files import HISTORY
from service.storage.store import ShotRecord, ShotStore
from service.storage.trash import Trash
from service.workers.jobs import Client, Finished

Stamp = tuple[int, ...]


class Quotas:
    """Judge of what senders and projects may use; see `Settings`. Any thread may use it.

    Work that was accepted is finished: several requests that are accepted at once may use more processor time than is left.

    Args:
        settings: of the service.
        store: the shots.
        trash: shots that were deleted, which count until they are removed for good.
        renders: whose frames count, too.
    """

    def __init__(self, settings: Settings, store: ShotStore, trash: Trash, renders: RenderQueue) -> None:
        self.cpu = CpuUsage(settings.data)
        self._store, self._trash, self._renders = store, trash, renders
        self._shots = settings.quota_shots
        self._bytes = settings.quota_stored_mb * MEBIBYTE
        self._cpu_s = settings.quota_cpu_s_per_day
        self._lock = threading.Lock()
        self._coming_shots: Counter[str] = Counter()
        self._coming_bytes: Counter[str] = Counter()
        self._edits: dict[str, tuple[Stamp, int]] = {}

    def check_work(self, client: Client | None = None) -> None:
        """Refuse work for a client who has used up the processor time of a day.

        Args:
            client: whose work it is; None for the client of the present request.

        Raises:
            ServiceError: 429, the time is used up.
        """
        sender = (client or present_client()).principal
        wait_s = self.cpu.wait_s(sender, self._cpu_s) if sender and self._cpu_s else 0
        if wait_s:
            detail = (
                f"You may use {self._cpu_s:,.0f} s of processor time in 24 hours, and have used "
                f"{self.cpu.used_s(sender):,.0f} s. Try again in {wait_s} s."
            )
            raise ServiceError(429, "quota_cpu", detail, headers={"Retry-After": str(wait_s)})

    def note_finished(self, finished: Finished) -> None:
        """Charge work that was done to whom it was done for."""
        self.charge(finished.client, finished.cpu_s)

    def charge(self, client: Client, cpu_s: float) -> None:
        """Charge processor time, s, to whom it was used for."""
        if client.principal and self._cpu_s:
            self.cpu.charge(client.principal, cpu_s)

    @contextmanager
    def receiving(self, project: str) -> Iterator[Reception]:
        """Reserve a shot of a project until it is stored or refused.

        Args:
            project: whose shot it will be.

        Raises:
            ServiceError: 403, the project has as many shots as it may.
        """
        reception = Reception(self, project)
        self.reserve(project, 1, 0)
        try:
            yield reception
        finally:
            with self._lock:
                self._coming_shots[project] -= 1
                self._coming_bytes[project] -= reception.size_bytes

    def usage(self, sender: str, project: str) -> Usage | None:
        """Return what a sender and a project have used and may use; None on a service without quotas.

        Args:
            sender: as `present_client` names it.
            project: whose shots are counted; for all projects none are.
        """
        if not (self._shots or self._bytes or self._cpu_s):
            return None
        shots = stored_mb = None
        if project != ALL_PROJECTS:
            count, size_bytes = self._taken(project)
            shots = Amount(used=count, allowed=self._shots or None)
            stored_mb = Amount(used=round(size_bytes / MEBIBYTE, 3), allowed=self._bytes / MEBIBYTE or None)
        return Usage(
            shots=shots,
            stored_mb=stored_mb,
            cpu_s=Amount(used=round(self.cpu.used_s(sender), 3), allowed=self._cpu_s or None),
        )

    def reserve(self, project: str, shots: int, size_bytes: int) -> None:
        """Reserve room for what comes to a project. Raises `ServiceError` 403: it is too much."""
        with self._lock:
            taken_shots, taken_bytes = self._taken(project) if self._shots or self._bytes else (0, 0)
            total_shots = taken_shots + self._coming_shots[project] + shots
            total_bytes = taken_bytes + self._coming_bytes[project] + size_bytes
            if self._shots and total_shots > self._shots:
                detail = f"Project {project!r} may have {self._shots:,} shots, those in the trash too, and has them."
                raise ServiceError(403, "quota_shots", f"{detail} Delete one, and wait until the trash is emptied.")
            if self._bytes and total_bytes > self._bytes:
                detail = (
                    f"Project {project!r} may have {self._bytes / MEBIBYTE:,.0f} MiB of shots, edits and renders, those in the "
                    f"trash too; with this there would be {total_bytes / MEBIBYTE:,.1f} MiB. Send something smaller, or delete "
                    "shots or renders."
                )
                raise ServiceError(403, "quota_stored", detail)
            self._coming_shots[project] += shots
            self._coming_bytes[project] += size_bytes

    def check_room(self, project: str, size_bytes: int) -> None:
        """Check that a project has room for a file. Raises `ServiceError` 403: it has not."""
        self.reserve(project, 0, size_bytes)
        with self._lock:
            self._coming_bytes[project] -= size_bytes

    def _taken(self, project: str) -> tuple[int, int]:
        """Return the number of the shots of a project and their size, bytes, with those in the trash."""
        records = (*self._store.list(), *(entry.record for entry in self._trash.entries()))
        self._edits = {
            name: kept for name, kept in self._edits.items() if name in {str(each.folder) for each in records}
        }
        sizes = [record.size_bytes + self._size_of_edits(record) for record in records if record.project == project]
        return len(sizes), sum(sizes) + self._renders.totals.stored_bytes(project)

    def _size_of_edits(self, record: ShotRecord) -> int:
        """Return the size of the files of a shot's edits, bytes; measured anew where files have come or gone."""
        stamp, name = _stamp_of_edits(record), str(record.folder)
        known = self._edits.get(name)
        if known is None or known[0] != stamp:
            known = self._edits[name] = stamp, size_of_edits(record)
        return known[1]


class Reception:
    """Shot that is being received.

    Args:
        quotas: that it counts for.
        project: whose shot it will be.

    Attributes:
        project: whose shot it will be.
        size_bytes: room that is reserved for it.
    """

    def __init__(self, quotas: Quotas, project: str) -> None:
        self._quotas, self.project = quotas, project
        self.size_bytes = 0

    def reserve(self, size_bytes: int) -> None:
        """Reserve room for its files. Raises `ServiceError` 403: the project would have too much."""
        self._quotas.reserve(self.project, 0, size_bytes)
        self.size_bytes += size_bytes


def _stamp_of_edits(record: ShotRecord) -> Stamp:
    stamps = []
    for folder in (record.edits_folder, record.edits_folder / HISTORY):
        with suppress(OSError):
            stamps.append(folder.lstat().st_mtime_ns)
    return tuple(stamps)


def size_of_edits(record: ShotRecord) -> int:
    """Return the size of the files of a shot's edits, bytes. A worker wrote them: links are not followed."""
    total = 0
    for folder in (record.edits_folder, record.edits_folder / HISTORY):
        if folder.is_symlink():
            continue
        with suppress(OSError), os.scandir(folder) as entries:
            for entry in entries:
                with suppress(OSError):
                    total += 0 if entry.is_dir(follow_symlinks=False) else entry.stat(follow_symlinks=False).st_size
    return total
