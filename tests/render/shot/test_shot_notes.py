"""Notes of a shot, kept in its edit layer."""

from __future__ import annotations

from pathlib import Path

import pytest

from render.errors import CameraError, NotFoundError, SettingsError
from render.model import notes as limits
from render.model.notes import Note, Stroke
from render.shot import Shot
from render.shot.picture_state import picture_states

STAGE = """#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Y"
)
def Camera "camera"
{
    float focusDistance = 4
    double3 xformOp:translate = (0, 0, 10)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Sphere "ball"
{
}
"""
BROKEN = """
def Scope "PullfocusNotes"
{
    def "kept" {
        custom timecode time = 3
        custom string text = "from the layout"
    }
    def "text_is_a_number" {
        custom timecode time = 3
        custom float text = 5
    }
    def "no_time" {
        custom string text = "when?"
    }
    def "counts_disagree" {
        custom timecode time = 3
        custom float2[] strokes:points = [(0, 0), (1, 1)]
        custom int[] strokes:counts = [5]
        custom token[] strokes:colours = ["red"]
        custom float[] strokes:widths = [0.01]
    }
    def "outside" {
        custom timecode time = 3
        custom float2[] strokes:points = [(0, nan)]
        custom int[] strokes:counts = [1]
        custom token[] strokes:colours = ["red"]
        custom float[] strokes:widths = [0.01]
    }
    def Sphere "ball" {
    }
}
"""
LINE = Stroke(((0.25, 0.5), (1.0, 0.0)), "red", 0.1)


def open_shot(folder: Path, text: str = STAGE, edits: Path | None = None) -> Shot:
    (folder / "shot.usda").write_text(text)
    return Shot.open(folder / "shot.usda", confined_to=folder, edits=edits)


@pytest.fixture
def shot(tmp_path: Path) -> Shot:
    return open_shot(tmp_path)


def test_the_state_of_notes_changes_with_each_of_them(tmp_path: Path) -> None:
    shot = open_shot(tmp_path, STAGE + BROKEN)
    states = [shot.notes.state()]
    for change in (
        lambda: shot.notes.add(Note("one", 5.0, text="later", strokes=(LINE,))),
        lambda: shot.notes.edit("one", text="sooner"),
        lambda: shot.notes.edit("one", strokes=(LINE, LINE)),
        lambda: shot.notes.edit("kept", text="from the layout"),  # as it was, but of the edits now
        lambda: shot.notes.delete("one"),
    ):
        change()
        states.append(shot.notes.state())
    assert len(set(states)) == len(states) == 6
    shot.camera.set("/camera", f_stop=4.0)
    assert shot.notes.state() == states[-1]
    for state in reversed(states):  # the first undo is that of the camera
        shot.edits.undo()
        assert shot.notes.state() == state


def test_notes_travel_with_the_edit_layer(shot: Shot, tmp_path: Path) -> None:
    shot.notes.add(Note("second", 5.0, text="later"))
    shot.notes.add(Note("first", 2.0, "/camera", "two\nlines", (LINE, LINE), "Ines"))
    shot.edits.save(tmp_path / "edits.usda")
    saved = open_shot(tmp_path, edits=tmp_path / "edits.usda").notes.read()
    assert saved == shot.notes.read()
    assert [(note.id, note.text, note.strokes, note.author) for note in saved.notes] == [
        ("first", "two\nlines", (LINE, LINE), "Ines"),
        ("second", "later", (), ""),
    ]
    assert saved.notes[0].created.endswith("Z")


def test_edits_of_notes_are_steps_of_the_history(shot: Shot) -> None:
    first = shot.notes.add(Note("", 2.0, text="hold"))
    shot.notes.edit(first, is_resolved=True, text="held", strokes=(LINE,))
    assert [shot.notes.read().notes[0].is_resolved, shot.notes.read().notes[0].strokes] == [True, (LINE,)]
    assert shot.edits.history.undo_label == "resolve note"
    shot.edits.undo()
    assert (shot.notes.read().notes[0].text, shot.notes.read().notes[0].strokes) == ("hold", ())
    shot.notes.delete(first)
    assert (shot.notes.read().notes, shot.edits.state()) == ((), "")
    shot.edits.undo()
    assert shot.notes.read().notes[0].id == first
    with pytest.raises(NotFoundError):
        shot.notes.delete("other")


def test_broken_notes_of_a_file_are_skipped(tmp_path: Path) -> None:
    shot = open_shot(tmp_path, STAGE + BROKEN)
    found = shot.notes.read()
    assert [note.id for note in found.notes] == ["kept"]
    assert {path.rpartition("/")[2] for path in found.skipped} == {
        "text_is_a_number",
        "no_time",
        "counts_disagree",
        "outside",
        "ball",
    }
    with pytest.raises(NotFoundError, match="cannot be read"):
        shot.notes.edit("no_time", text="now")
    for name in ("no_time", "kept"):
        shot.notes.delete(name)
    assert (shot.notes.read().notes, len(shot.notes.read().skipped)) == ((), 4)
    with pytest.raises(SettingsError, match="already"):
        shot.notes.add(Note("kept", 1.0, text="again"))


@pytest.mark.parametrize(
    ("note", "says"),
    [
        (Note("n", 1.0), "neither text nor a drawing"),
        (Note("n", 1.0, text="\0"), "control characters"),
        (Note("n", 1.0, text="\x1b[31m"), "control characters"),
        (Note("n", float("nan"), text="x"), "time"),
        (Note("1n", 1.0, text="x"), "id"),
        (Note("n", 1.0, text="x" * 2_001), "2,000 characters"),
        (Note("n", 1.0, strokes=(Stroke(((0.0, float("nan")),), "red", 0.01),)), "inside the picture"),
        (Note("n", 1.0, strokes=(Stroke(((0.0, 0.0),), "beige", 0.01),)), "'beige'"),
        (Note("n", 1.0, strokes=(Stroke(((0.0, 0.0),), "red", 0.2),)), "wide"),
        (Note("n", 1.0, strokes=(Stroke((), "red", 0.01),)), "without points"),
        (Note("n", 1.0, strokes=(Stroke(((0.0, 0.0),) * 4_001, "red", 0.01),)), "4,000 points"),
        (Note("n", 1.0, strokes=(LINE,) * 101), "100 strokes"),
    ],
)
def test_bad_notes_are_refused(shot: Shot, note: Note, says: str) -> None:
    with pytest.raises(SettingsError, match=says):
        shot.notes.add(note)
    assert shot.edits.state() == ""


def test_a_shot_has_room_for_so_many_notes(shot: Shot, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(CameraError):
        shot.notes.add(Note("n", 1.0, "/ball", "x"))
    monkeypatch.setattr("render.shot.shot_notes.MAX_NOTES", 2)
    monkeypatch.setattr("render.shot.shot_notes.MAX_SHOT_POINTS", 3)
    shot.notes.add(Note("a", 1.0, strokes=(LINE,)))
    with pytest.raises(SettingsError, match="3 points, these would be 4"):
        shot.notes.add(Note("b", 1.0, strokes=(LINE,)))
    shot.notes.add(Note("b", 1.0, text="b"))
    with pytest.raises(SettingsError, match="at most 2 notes"):
        shot.notes.add(Note("c", 1.0, text="c"))
    assert limits.MAX_NOTES == 500


def test_no_picture_depends_on_a_note(shot: Shot) -> None:
    scene, states = shot.scene_at(1.0), picture_states(shot, None, [1.0])
    shot.notes.add(Note("n", 1.0, text="x", strokes=(LINE,)))
    assert shot.scene_at(1.0) is scene
    assert picture_states(shot, None, [1.0]) == states
    assert not [finding for finding in shot.findings() if "Notes" in str(finding)]
