"""Shots that a worker process holds open, so that the next request need not open them again."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from render.errors import NotFoundError, PullfocusError
from service.store import ShotRecord, revision_of

if TYPE_CHECKING:
    from render.shot import Shot

MAX_OPEN = 4
MAX_KEPT = 200
"""Edit layers that can be gone back to, of all shots together; each is some kilobytes."""


class OpenedShots:
    """The shots that were used last, by id. Lives in a worker process.

    USD is imported when the first shot is opened: the process that speaks HTTP imports this module, and no USD.
    """

    def __init__(self) -> None:
        self._shots: OrderedDict[str, Shot] = OrderedDict()
        self._kept: OrderedDict[tuple[str, str], str] = OrderedDict()

    @contextmanager
    def use(self, record: ShotRecord, edit_text: str = "") -> Iterator[Shot]:
        """Work with a shot. Errors that come out name files as they were sent, not as they lie on this machine.

        Args:
            record: which shot.
            edit_text: its edit layer; empty takes the one that it has, or else the saved one.

        Raises:
            NotFoundError: it was removed in the meantime.
            StageError: it is no stage, or refers to what was not sent with it.
        """
        try:
            shot = self._get(record)
            if edit_text and edit_text != shot.export_edits():
                shot.replace_edits(edit_text)
            yield shot
        except PullfocusError as error:
            raise _error_as_sent(error, record) from error

    @contextmanager
    def edit(self, record: ShotRecord) -> Iterator[Shot]:
        """Change a shot. What was changed is on disk when this ends, or else it is as if it had never been."""
        with self.use(record) as shot:
            before, revision = shot.export_edits(), revision_of(record.edit_text())
            try:
                yield shot
                shot.save_edits(record.edits)
                self._keep(record, revision, before)
            except BaseException:
                if shot.export_edits() != before:
                    shot.replace_edits(before)
                raise

    def kept(self, record: ShotRecord, revision: str) -> str:
        """The edits as they were at a revision, as text.

        Raises:
            NotFoundError: it is too long ago, or the worker was started anew since.
        """
        if (record.id, revision) not in self._kept:
            raise NotFoundError(
                f"The edits of shot {record.id!r} at revision {revision!r} are not kept any more.",
                code="revision_not_found",
                path=revision,
            )
        return self._kept[record.id, revision]

    def _keep(self, record: ShotRecord, revision: str, text: str) -> None:
        self._kept[record.id, revision] = text
        self._kept.move_to_end((record.id, revision))
        if len(self._kept) > MAX_KEPT:
            self._kept.popitem(last=False)

    def forget(self, shot_id: str) -> None:
        """Close a shot, if it is open."""
        self._shots.pop(shot_id, None)

    def _get(self, record: ShotRecord) -> Shot:
        from render.shot import Shot

        if record.id not in self._shots:
            if not record.root_path.is_file():
                raise NotFoundError(f"There is no shot {record.id!r} any more.", code="shot_not_found", path=record.id)
            edits = record.edits if record.edits.is_file() else None
            self._shots[record.id] = Shot.open(record.root_path, confined_to=record.files, edits=edits)
            if len(self._shots) > MAX_OPEN:
                self._shots.popitem(last=False)
        self._shots.move_to_end(record.id)
        return self._shots[record.id]


def as_sent(text: str, record: ShotRecord) -> str:
    """A text with paths relative to what was sent: where this machine keeps it is nobody's business."""
    for folder in (record.files, record.files.resolve()):
        text = text.replace(f"{folder}/", "").replace(str(folder), "the shot's folder")
    return text


def _error_as_sent(error: PullfocusError, record: ShotRecord) -> PullfocusError:
    path = as_sent(error.path, record) if error.path else None
    return type(error)(as_sent(error.detail, record), code=error.code, path=path)
