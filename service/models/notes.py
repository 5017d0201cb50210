"""Notes of a shot: texts and drawings at frames, and the changes that write them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import FailFast, Field, WithJsonSchema
from pydantic.config import JsonDict

from render.model.notes import (
    LEAST_WIDTH,
    MAX_AUTHOR,
    MAX_ID,
    MAX_NOTES,
    MAX_POINTS,
    MAX_SHOT_POINTS,
    MAX_STROKES,
    MAX_TEXT,
    MOST_WIDTH,
)
from service.models.base import NAME_PATTERN, Model, PrimPath, Ratio, TimeCode, shown_as

STROKE_EXAMPLE: JsonDict = {"points": [[0.41, 0.32], [0.44, 0.35]], "colour": "red", "width": 0.006}
NOTE_EXAMPLE: JsonDict = {
    "id": "note_4c7e12ab90d3",
    "time": 24.0,
    "camera": "/World/main_cam",
    "text": "Hold on Mara until she turns.",
    "strokes": [STROKE_EXAMPLE],
    "author": "Ines",
    "created": "2026-11-28T09:41:00Z",
    "modified": "2026-11-28T09:41:00Z",
    "resolved": False,
    "etag": '"0b64bf18a0860070"',
}

Colour = Literal["red", "yellow", "cyan", "white"]
NotesTag = Annotated[
    str,
    Field(
        description="Another one whenever a note of the shot is another: `notesTag` of the history tells so whether the list has "
        "to be read again."
    ),
]
NoteId = Annotated[str, Field(pattern=NAME_PATTERN, max_length=MAX_ID)]
NoteText = Annotated[str, Field(max_length=MAX_TEXT)]
Place = Annotated[
    tuple[Ratio, Ratio],
    WithJsonSchema(
        {"type": "array", "items": {"type": "number", "minimum": 0, "maximum": 1}, "minItems": 2, "maxItems": 2}
    ),
]


class NoteStroke(Model):
    """A line that is drawn over the picture; one point alone is a dot."""

    points: Annotated[tuple[Place, ...], Field(min_length=1, max_length=MAX_POINTS), FailFast()] = Field(
        description="From (0, 0) in the picture's top left corner to (1, 1) in the bottom right one."
    )
    colour: Colour
    width: float = Field(ge=LEAST_WIDTH, le=MOST_WIDTH, description="Share of the picture's height.")


Strokes = Annotated[tuple[NoteStroke, ...], Field(max_length=MAX_STROKES)]
_STROKES = f"With {MAX_POINTS:,} points in all at most; all notes of a shot together have {MAX_SHOT_POINTS:,}."
_CAMERA = "Prim path of the camera through whose picture it is seen; null for any."
_TEXT = "Plain text; of the control characters, line breaks alone are taken."


class NoteCreate(Model):
    """A note to add. It has text, a drawing, or both."""

    id: NoteId | None = Field(default=None, description="A name that no other note has; left out, a free one.")
    time: TimeCode = Field(description="USD time code.")
    camera: PrimPath | None = Field(default=None, description=_CAMERA)
    text: NoteText = Field(default="", description=_TEXT)
    strokes: Strokes = Field(default=(), description=_STROKES)


class NoteEdit(Model):
    """Values of a note to alter; what is left out or null stays."""

    time: TimeCode | None = Field(default=None, description="USD time code.")
    text: NoteText | None = Field(default=None, description=_TEXT)
    strokes: Strokes | None = Field(default=None, description=f"All of its strokes. {_STROKES}")
    resolved: bool | None = None


class AddNote(Model):
    """Add a note at a frame. The sender is its author, where senders are known by name."""

    model_config = shown_as(
        {"type": "addNote", "note": {"time": 24, "text": "Hold on Mara until she turns.", "strokes": [STROKE_EXAMPLE]}}
    )

    type: Literal["addNote"] = "addNote"
    note: NoteCreate


class EditNote(Model):
    """Alter a note, such as to resolve it. Its author stays."""

    model_config = shown_as({"type": "editNote", "id": "note_4c7e12ab90d3", "values": {"resolved": True}})

    type: Literal["editNote"] = "editNote"
    id: NoteId
    values: NoteEdit


class DeleteNote(Model):
    """Delete a note."""

    model_config = shown_as({"type": "deleteNote", "id": "note_4c7e12ab90d3"})

    type: Literal["deleteNote"] = "deleteNote"
    id: NoteId


class ShotNote(Model):
    """A note at a frame."""

    id: str
    time: float = Field(description="USD time code.")
    camera: str | None = Field(description=_CAMERA)
    text: str = Field(description="Plain text, with line breaks.")
    strokes: list[NoteStroke]
    author: str = Field(max_length=MAX_AUTHOR, description="Name for people; empty where nobody is known by name.")
    created: str = Field(description="Time of the clock, ISO 8601.")
    modified: str = Field(description="Time of its last change.")
    resolved: bool
    etag: str = Field(description="Tag of the note, for `If-Match`.")


class NoteList(Model):
    """Notes of a shot, in order of time."""

    model_config = shown_as(
        {"etag": '"77aebf18a0860070"', "notesTag": "f00dbf18a0860070", "notes": [NOTE_EXAMPLE], "skipped": []}
    )

    etag: str = Field(description="Tag of all edits, for `If-Match`.")
    notes_tag: NotesTag
    notes: list[ShotNote] = Field(description=f"{MAX_NOTES} at most.")
    skipped: list[str] = Field(
        description="Prim paths below `/PullfocusNotes` that hold no note that can be read, 100 at most."
    )
