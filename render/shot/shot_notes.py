"""Notes of a shot, kept in its edit layer."""

from __future__ import annotations

import secrets
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from pxr import Usd

from render.errors import CameraError, NotFoundError, SettingsError
from render.model.notes import MAX_NOTES, MAX_SHOT_POINTS, Note, fault_of
from render.shot.camera.lookup import CameraLookup
from render.shot.edits.edit_layer import Edits
from render.stage.notes import (
    NOTES,
    StageNotes,
    count_notes,
    count_points,
    delete_note,
    digest_notes,
    list_notes,
    note_prim,
    read_note,
    write_note,
)


class ShotNotes:
    """Notes of a shot: texts and drawings at a frame. To write one is an edit, and no picture depends on it.

    Args:
        stage: the composed stage.
        edits: its edit layer.
        cameras: of the stage.
    """

    def __init__(self, stage: Usd.Stage, edits: Edits, cameras: CameraLookup) -> None:
        self._stage = stage
        self._edits = edits
        self._cameras = cameras

    def read(self) -> StageNotes:
        """List the notes, those of the shot's own files too."""
        return list_notes(self._stage)

    def state(self) -> tuple[str, str]:
        """Name the state of all notes: as the stage has them, and as the edits have them, which `authored` shows one by one."""
        spec = self._edits.layer.GetPrimAtPath(NOTES)
        return digest_notes(self._stage), spec.GetAsText() if spec else ""

    def authored(self, note_id: str) -> tuple[str, ...]:
        """Opinions of the edit layer on a note, as usda text; nothing for a note that it does not touch."""
        return self._edits.properties(NOTES.AppendChild(note_id), lambda _name: True)

    def add(self, note: Note) -> str:
        """Add a note.

        Args:
            note: with an empty `id`, a free one is chosen; it is created and modified now.

        Returns:
            Its id.

        Raises:
            CameraError: it has a camera that there is not.
            SettingsError: it has a fault, the shot has no room for it, or there is one of its id.
        """
        now = _now()
        note = replace(note, id=note.id or f"note_{secrets.token_hex(6)}", created=now, modified=now)
        if note.camera and note.camera not in self._cameras.paths():
            raise CameraError(f"there is no camera at {note.camera!r} for a note", path=note.camera)
        _check(note)
        if count_notes(self._stage) >= MAX_NOTES:
            raise SettingsError(f"a shot has at most {MAX_NOTES} notes: delete some", code="too_many_notes")
        self._check_room(note)
        with self._edits.transaction("add note"):
            write_note(self._stage, note)
        return note.id

    def edit(self, note_id: str, **fields: Any) -> None:
        """Alter a note.

        Args:
            note_id: of the note.
            fields: of `Note`, which are replaced.

        Raises:
            NotFoundError: there is no such note.
            SettingsError: it would have a fault, or the shot has no room for it.
        """
        before = read_note(note_prim(self._stage, note_id))
        if before is None:
            raise NotFoundError(f"note {note_id!r} cannot be read: delete it", code="note_not_found", path=note_id)
        after = replace(before, **fields, modified=_now())
        _check(after)
        if "strokes" in fields:
            self._check_room(after)
        words = "edit note"
        if after.is_resolved != before.is_resolved:
            words = "resolve note" if after.is_resolved else "reopen note"
        with self._edits.transaction(words):
            write_note(self._stage, after, {*fields, "modified"})

    def delete(self, note_id: str) -> None:
        """Delete a note, one too that cannot be read.

        Args:
            note_id: of the note.

        Raises:
            NotFoundError: there is no such note.
        """
        note_prim(self._stage, note_id)
        with self._edits.transaction("delete note"):
            delete_note(self._stage, self._edits.layer, note_id)

    def _check_room(self, note: Note) -> None:
        """Check that the points of all notes are not too many. Raises `SettingsError`."""
        if not note.strokes:
            return
        count = note.point_count + count_points(self._stage, but=note.id)
        if count > MAX_SHOT_POINTS:
            detail = f"the drawings of a shot have at most {MAX_SHOT_POINTS:,} points, these would be {count:,}: delete notes"
            raise SettingsError(detail, code="too_many_notes")


def _check(note: Note) -> None:
    fault = fault_of(note)
    if fault:
        raise SettingsError(f"a note {fault}", code="bad_note", path=note.id[:80])


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")
