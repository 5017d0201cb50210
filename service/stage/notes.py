"""Functions of the stage process that read the notes of a shot, and what the changes of notes write."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from render.model.notes import Note, Stroke
from render.shot import Shot
from service.edit_context import edits_tag, tag_of
from service.models.notes import NoteCreate, NoteEdit, NoteList, NoteStroke, ShotNote
from service.stage.opened import OpenedShot, stage_function
from service.storage.store import ShotRecord


@dataclass(frozen=True)
class AddedNote:
    """A note that a change added.

    Attributes:
        id: name of its prim.
    """

    id: str


@stage_function
def read_notes(
    opened: OpenedShot, record: ShotRecord, camera: str | None, span: tuple[float | None, float | None]
) -> NoteList:
    """Read the notes of a shot.

    Args:
        opened: the open shots.
        record: the shot.
        camera: prim path: notes of other cameras are left out; None for all notes.
        span: first and last time code, None for no limit.
    """
    with opened.use(record) as shot:
        found = shot.notes.read()
        tag, state = edits_tag(shot.edits.history.present.revision), state_of_notes(shot)
        tags = {note.id: note_tag(shot, note.id) for note in found.notes}
    first, last = span
    notes = [
        _note_model(note, tags[note.id])
        for note in found.notes
        if (camera is None or note.camera in ("", camera))
        and (first is None or note.time >= first)
        and (last is None or note.time <= last)
    ]
    return NoteList(etag=tag, notes_tag=state, notes=notes, skipped=list(found.skipped))


def state_of_notes(shot: Shot) -> str:
    """Name the state of all notes: it is another one whenever a note, or the tag of one, is another."""
    return tag_of(*shot.notes.state()).strip('"')


def notes_tag(shot: Shot) -> str:
    """Entity tag of the list of notes, which changes when one is added or deleted."""
    return tag_of(*(note.id for note in shot.notes.read().notes))


def note_tag(shot: Shot, note_id: str) -> str:
    """Entity tag of a note.

    Args:
        shot: its shot.
        note_id: of the note; of one that there is not, the tag is another one than that of any note.
    """
    return tag_of(*shot.notes.authored(note_id))


def note_to_add(sent: NoteCreate, author: str) -> Note:
    """Make a note of what was sent.

    Args:
        sent: the note.
        author: name of the sender; empty for none.
    """
    return Note(
        id=sent.id or "",
        time=sent.time,
        camera=sent.camera or "",
        text=sent.text,
        strokes=_strokes(sent.strokes),
        author=author,
    )


def note_fields(sent: NoteEdit) -> dict[str, Any]:
    """Fields of a note that an edit sets."""
    fields = sent.model_dump(include={"time", "text"}, exclude_none=True)
    if sent.strokes is not None:
        fields["strokes"] = _strokes(sent.strokes)
    if sent.resolved is not None:
        fields["is_resolved"] = sent.resolved
    return fields


def _strokes(sent: tuple[NoteStroke, ...]) -> tuple[Stroke, ...]:
    return tuple(Stroke(stroke.points, stroke.colour, stroke.width) for stroke in sent)


def _note_model(note: Note, etag: str) -> ShotNote:
    return ShotNote(
        id=note.id,
        time=note.time,
        camera=note.camera or None,
        text=note.text,
        strokes=[NoteStroke.model_validate(stroke) for stroke in note.strokes],
        author=note.author,
        created=note.created,
        modified=note.modified,
        resolved=note.is_resolved,
        etag=etag,
    )
