"""Notes of a shot: what people write and draw at a frame, and the limits of both."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

COLOURS = ("red", "yellow", "cyan", "white")
"""Palette of the strokes."""
MAX_NOTES = 500
"""Notes of one shot."""
MAX_TEXT = 2_000
"""Characters of a note."""
MAX_STROKES = 100
"""Strokes of a note."""
MAX_POINTS = 4_000
"""Points of all strokes of a note together."""
MAX_SHOT_POINTS = 100_000
"""Points of all notes of a shot together: every state of the edits holds them as text."""
MAX_AUTHOR = 200
"""Characters of an author's name."""
MAX_ID = 40
"""Characters of a note's id."""
LEAST_WIDTH, MOST_WIDTH = 0.0005, 0.1
"""Widths of strokes, shares of the picture's height."""
MAX_TIME = 1e9
"""Largest time code of a note, either side of zero."""
_ID = re.compile(rf"[A-Za-z_][A-Za-z0-9_]{{0,{MAX_ID - 1}}}")


@dataclass(frozen=True)
class Stroke:
    """A line that is drawn over the picture.

    Attributes:
        points: from (0, 0) in the picture's top left corner to (1, 1) in the bottom right one; one alone is a dot.
        colour: of `COLOURS`.
        width: share of the picture's height.
    """

    points: tuple[tuple[float, float], ...]
    colour: str
    width: float


@dataclass(frozen=True)
class Note:
    """A note at a frame.

    Attributes:
        id: name of its prim.
        time: USD time code.
        camera: prim path of the camera through whose picture it is seen; empty for any.
        text: of several lines at most; empty where a drawing says it all.
        strokes: its drawing.
        author: name for people; empty where nobody is known by name.
        created: time of the clock, ISO 8601.
        modified: time of the last change of it.
        is_resolved: whether it is done with.
    """

    id: str
    time: float
    camera: str = ""
    text: str = ""
    strokes: tuple[Stroke, ...] = ()
    author: str = ""
    created: str = ""
    modified: str = ""
    is_resolved: bool = False

    @property
    def point_count(self) -> int:
        """Points of all strokes."""
        return sum(len(stroke.points) for stroke in self.strokes)


def fault_of(note: Note) -> str:
    """Return the first thing that is wrong with a note, as the end of a sentence that begins with the note; empty for nothing."""
    if _ID.fullmatch(note.id) is None:
        return f"needs an id of at most {MAX_ID} letters, digits and underscores, with no digit first"
    if not -MAX_TIME <= note.time <= MAX_TIME:
        return f"is at a time of at most {MAX_TIME:g} either side of zero, got {note.time:g}"
    if not note.text.strip() and not note.strokes:
        return "has neither text nor a drawing"
    if len(note.text) > MAX_TEXT:
        return f"has at most {MAX_TEXT:,} characters of text, got {len(note.text):,}"
    if not _is_plain(note.text.replace("\n", " ")):
        return "has plain text: control characters are not taken, but for line breaks"
    if len(note.author) > MAX_AUTHOR or not all(
        map(_is_plain, (note.author, note.camera, note.created, note.modified))
    ):
        return f"has an author of at most {MAX_AUTHOR} plain characters, and no control characters elsewhere"
    return _fault_of_strokes(note)


def _fault_of_strokes(note: Note) -> str:
    if len(note.strokes) > MAX_STROKES:
        return f"has at most {MAX_STROKES} strokes, got {len(note.strokes):,}"
    if note.point_count > MAX_POINTS:
        return f"has at most {MAX_POINTS:,} points in all its strokes, got {note.point_count:,}"
    for stroke in note.strokes:
        if not stroke.points:
            return "has a stroke without points"
        if stroke.colour not in COLOURS:
            return f"has strokes in {', '.join(COLOURS)}, got {stroke.colour[:40]!r}"
        if not LEAST_WIDTH <= stroke.width <= MOST_WIDTH:
            return f"has strokes {LEAST_WIDTH:g} to {MOST_WIDTH:g} of the picture's height wide, got {stroke.width:g}"
        if not all(0 <= x <= 1 and 0 <= y <= 1 for x, y in stroke.points):  # NaN is not in between either
            return "has strokes inside the picture, from (0, 0) to (1, 1)"
    return ""


def _is_plain(text: str) -> bool:
    return text.isprintable() or all(unicodedata.category(letter) not in ("Cc", "Cs", "Zl", "Zp") for letter in text)
