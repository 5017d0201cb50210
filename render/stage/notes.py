"""Notes in a stage: a prim for each below `/PullfocusNotes`, so that they travel with the layer that they were written to."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import accumulate, islice, pairwise
from typing import Any

import numpy as np
from pxr import Sdf, Usd, Vt

from render.errors import NotFoundError, SettingsError
from render.model.notes import MAX_NOTES, MAX_POINTS, MAX_STROKES, Note, Stroke, fault_of

NOTES = Sdf.Path("/PullfocusNotes")
"""Prim that holds the notes of a stage."""
_MOST_SKIPPED = 100
_DIGITS = 6
"""Decimals that single precision holds of a place in the picture."""
_TYPES = {
    "time": Sdf.ValueTypeNames.TimeCode,  # layer offsets retime it, as they do the camera
    "camera": Sdf.ValueTypeNames.String,
    "text": Sdf.ValueTypeNames.String,
    "author": Sdf.ValueTypeNames.String,
    "created": Sdf.ValueTypeNames.String,
    "modified": Sdf.ValueTypeNames.String,
    "resolved": Sdf.ValueTypeNames.Bool,
    "strokes:points": Sdf.ValueTypeNames.Float2Array,
    "strokes:counts": Sdf.ValueTypeNames.IntArray,
    "strokes:colours": Sdf.ValueTypeNames.TokenArray,
    "strokes:widths": Sdf.ValueTypeNames.FloatArray,
}
"""Attributes of a note's prim. Strokes lie in arrays one after the other, as those of BasisCurves do."""
_NUMBERS = (Vt.Vec2fArray, Vt.IntArray, Vt.FloatArray)
_FROM_TEXT = {"camera": str, "text": str, "author": str, "created": str, "modified": str, "resolved": bool}


@dataclass(frozen=True)
class StageNotes:
    """Notes of a stage.

    Attributes:
        notes: in order of time.
        skipped: prim paths below `/PullfocusNotes` that hold no note that can be read, the first hundred.
    """

    notes: tuple[Note, ...]
    skipped: tuple[str, ...]


def is_note(path: Sdf.Path) -> bool:
    """Return whether a path is that of a note, of a part of it, or of the prim that holds the notes: nothing that is drawn."""
    return bool(path.HasPrefix(NOTES))


def list_notes(stage: Usd.Stage) -> StageNotes:
    """List the notes of a stage, `MAX_NOTES` at most. What is no note is skipped."""
    holder = stage.GetPrimAtPath(NOTES)
    notes: list[Note] = []
    skipped: list[str] = []
    for prim in islice(holder.GetChildren() if holder else (), 2 * MAX_NOTES):
        note = read_note(prim)
        if note is not None and len(notes) < MAX_NOTES:
            notes.append(note)
        elif len(skipped) < _MOST_SKIPPED:
            skipped.append(str(prim.GetPath()))
    notes.sort(key=lambda note: (note.time, note.created, note.id))
    return StageNotes(tuple(notes), tuple(skipped))


def digest_notes(stage: Usd.Stage) -> str:
    """Hash the notes of a stage, without making any: another hash whenever one is added, deleted or changed."""
    digest = hashlib.sha256()
    holder = stage.GetPrimAtPath(NOTES)
    for prim in islice(holder.GetChildren() if holder else (), 2 * MAX_NOTES):
        digest.update(repr(prim.GetName()).encode())
        for name in _TYPES:
            attribute = prim.GetAttribute(name)
            if attribute:
                value = attribute.Get()
                digest.update(f"{name} {attribute.GetTypeName()} ".encode())
                digest.update(np.asarray(value).tobytes() if isinstance(value, _NUMBERS) else repr(value).encode())
    return digest.hexdigest()


def count_notes(stage: Usd.Stage) -> int:
    """Count the notes of a stage, and what is there in place of one."""
    holder = stage.GetPrimAtPath(NOTES)
    return len(holder.GetChildren()) if holder else 0


def count_points(stage: Usd.Stage, *, but: str) -> int:
    """Count the points of all drawings of a stage, but for those of the note with an id."""
    holder = stage.GetPrimAtPath(NOTES)
    drawings = [
        prim.GetAttribute("strokes:points")
        for prim in (holder.GetChildren() if holder else ())
        if prim.GetName() != but
    ]
    points = [drawing.Get() for drawing in drawings if drawing.GetTypeName() == _TYPES["strokes:points"]]
    return sum(len(own) for own in points if own is not None)


def read_note(prim: Usd.Prim) -> Note | None:
    """Read a note.

    Args:
        prim: below `/PullfocusNotes`.

    Returns:
        The note; None where the prim holds none, or one of wrong types or beyond the limits.
    """
    present = {name: attribute for name in _TYPES if (attribute := prim.GetAttribute(name))}
    if any(attribute.GetTypeName() != _TYPES[name] for name, attribute in present.items()):
        return None
    values = {name: present[name].Get() if name in present else None for name in _TYPES}
    time = values["time"]
    texts: dict[str, Any] = {
        name: kind() if values[name] is None else values[name] for name, kind in _FROM_TEXT.items()
    }
    strokes = _strokes(*(values[f"strokes:{name}"] for name in ("points", "counts", "colours", "widths")))
    if time is None or strokes is None:
        return None
    texts["is_resolved"] = texts.pop("resolved")
    note = Note(id=prim.GetName(), time=float(time.GetValue()), strokes=strokes, **texts)
    return None if fault_of(note) else note


def _strokes(
    points: Vt.Vec2fArray | None,
    counts: Vt.IntArray | None,
    colours: Vt.TokenArray | None,
    widths: Vt.FloatArray | None,
) -> tuple[Stroke, ...] | None:
    """Strokes of arrays; None where these do not agree or are beyond the limits."""
    if not points and not counts and not colours and not widths:
        return ()
    if points is None or counts is None or colours is None or widths is None:
        return None
    if not (len(points) <= MAX_POINTS and len(counts) == len(colours) == len(widths) <= MAX_STROKES):
        return None
    if any(count <= 0 for count in counts) or sum(counts) != len(points):
        return None
    ends = pairwise(accumulate(counts, initial=0))
    places = [(round(x, _DIGITS), round(y, _DIGITS)) for x, y in points]
    return tuple(
        Stroke(tuple(places[first:end]), str(colour), round(width, _DIGITS))
        for (first, end), colour, width in zip(ends, colours, widths, strict=True)
    )


def write_note(stage: Usd.Stage, note: Note, fields: Iterable[str] = ()) -> None:
    """Write a note, in the stage's edit target.

    Args:
        stage: the stage.
        note: without faults.
        fields: names of the fields of `Note` that are written, with the other ones as they are; none for a new note.

    Raises:
        SettingsError: the prim that holds the notes is inactive or an instance, or the note's prim is there already.
    """
    fields = set(fields)
    path = NOTES.AppendChild(note.id)
    prim = stage.GetPrimAtPath(path)
    if not fields:
        if prim:
            raise SettingsError(f"there is a note {note.id!r} already", code="note_exists", path=note.id)
        holder = stage.GetPrimAtPath(NOTES) or stage.DefinePrim(NOTES, "Scope")
        if not holder.IsActive() or holder.IsInstance():
            raise SettingsError(f"{NOTES} of this stage is inactive or an instance: it takes no notes", code="no_notes")
        prim = stage.DefinePrim(path)
    for name, value in _values_of(note).items():
        field = "is_resolved" if name == "resolved" else name.partition(":")[0]
        if not fields or field in fields:
            prim.CreateAttribute(name, _TYPES[name], custom=True).Set(value)


def _values_of(note: Note) -> dict[str, Any]:
    return {
        "time": Sdf.TimeCode(note.time),
        "camera": note.camera,
        "text": note.text,
        "author": note.author,
        "created": note.created,
        "modified": note.modified,
        "resolved": note.is_resolved,
        "strokes:points": Vt.Vec2fArray([place for stroke in note.strokes for place in stroke.points]),
        "strokes:counts": Vt.IntArray([len(stroke.points) for stroke in note.strokes]),
        "strokes:colours": Vt.TokenArray([stroke.colour for stroke in note.strokes]),
        "strokes:widths": Vt.FloatArray([stroke.width for stroke in note.strokes]),
    }


def delete_note(stage: Usd.Stage, layer: Sdf.Layer, note_id: str) -> None:
    """Delete a note: out of the layer of edits, and where the shot's own files have it, by making its prim inactive.

    Args:
        stage: whose edit target is the layer.
        layer: of the edits.
        note_id: of the note.

    Raises:
        NotFoundError: there is no such note.
    """
    path = note_prim(stage, note_id).GetPath()
    stage.RemovePrim(path)
    left = stage.GetPrimAtPath(path)
    if left:
        left.SetActive(False)
    holder = layer.GetPrimAtPath(NOTES)
    if holder and not holder.nameChildren and not holder.properties:
        stage.RemovePrim(NOTES)


def note_prim(stage: Usd.Stage, note_id: str) -> Usd.Prim:
    """Return the prim of a note, which may hold none that can be read.

    Args:
        stage: the stage.
        note_id: of the note.

    Raises:
        NotFoundError: there is none.
    """
    prim = stage.GetPrimAtPath(NOTES.AppendChild(note_id)) if Sdf.Path.IsValidIdentifier(note_id) else None
    if not prim or not prim.IsActive() or prim.IsInstanceProxy():
        raise NotFoundError(f"there is no note {note_id[:80]!r}", code="note_not_found", path=note_id[:80])
    return prim
