"""Changes of a camera within an edit: its condition is checked first, and pictures must be possible after."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack

from render.shot import Shot
from service.edit_context import EditContext, allows, edits_tag
from service.models.camera_changes import (
    CreateCamera,
    DuplicateCamera,
    FrameSubject,
    MoveCamera,
    MoveCameraKeys,
    UnkeyCamera,
)
from service.models.changes import (
    AddPoint,
    Change,
    ChooseVariant,
    KeySetting,
    MakeRack,
    RenamePoint,
    SetCamera,
    SetExposure,
    SetFilm,
    SetFocus,
    SetSettingTangents,
    ShowPayload,
)
from service.models.curve import MAX_CURVE_FRAMES
from service.models.notes import AddNote, DeleteNote, EditNote
from service.stage.camera_changes import EditedCamera
from service.stage.changes import Outcome, apply_changes
from service.stage.notes import note_tag, notes_tag
from service.stage.read_cameras import view_tag
from service.stage.read_points import point_names, point_tag, points_tag

CAMERA, POINTS, NOTES = "camera", "focus-points", "notes"
"""Addresses, below a shot, of resources that have entity tags; a focus point's is `point_address`, a note's `note_address`."""


def point_address(name: str) -> str:
    """Address of a focus point below its shot."""
    return f"{POINTS}/{name}"


def note_address(note_id: str) -> str:
    """Address of a note below its shot."""
    return f"{NOTES}/{note_id}"


def apply_in_context(
    shot: Shot,
    camera: str | None,
    changes: Sequence[Change],
    context: EditContext,
    max_curve_frames: int = MAX_CURVE_FRAMES,
) -> list[Outcome]:
    """Apply changes to a camera within an edit of its shot (`OpenedShot.edit`), which takes them all back on an error.

    Args:
        shot: within an edit.
        camera: prim path; None for the default camera.
        changes: in order, with anchors in place of places of the picture.
        context: tags of what the editor has seen.
        max_curve_frames: frames of an imported curve.

    Returns:
        The outcome of each change.

    Raises:
        ChangedMeanwhileError: a resource that the changes are made upon is not what the editor has seen.
        PullfocusError: a change cannot be applied, or no picture can be made after it.
    """
    check_context(shot, camera, changes, context)
    with ExitStack() as usable:
        for time in checked_times(shot, changes):
            usable.enter_context(shot.keep_usable(camera, time))
        return apply_changes(EditedCamera(shot, camera, max_curve_frames, context.author), changes)


def check_context(shot: Shot, camera: str | None, changes: Sequence[Change], context: EditContext) -> None:
    """Check the condition of an edit: the editor has seen the present edits, or each resource that the changes are made upon.

    Args:
        shot: before the edit.
        camera: prim path; None for the default camera.
        changes: of the edit; a focus point that one of them adds or renames is not there by that name yet.
        context: of the edit.

    Raises:
        ChangedMeanwhileError: a resource is another than the editor has seen.
        NotFoundError: a focus point is not there.
    """
    if context.if_match is None or allows(context.if_match, edits_tag(shot.edits.history.present.revision)):
        return
    added = {
        point_address(change.point.name) for change in changes if isinstance(change, AddPoint) and change.point.name
    } | {point_address(change.new_name) for change in changes if isinstance(change, RenamePoint)}
    for address in dict.fromkeys(edited_address(change) for change in changes):
        if address not in added:
            context.check_tag(*_tag_and_words(shot, camera, address))


def edited_address(change: Change) -> str:
    """Address of the resource that a change is made upon."""
    if isinstance(change, AddPoint | MakeRack):
        return POINTS
    if isinstance(change, AddNote):
        return NOTES
    if isinstance(change, EditNote | DeleteNote):
        return note_address(change.id)
    name = None if isinstance(change, CreateCamera | DuplicateCamera) else getattr(change, "name", None)
    return CAMERA if name is None else point_address(name)


def _tag_and_words(shot: Shot, camera: str | None, address: str) -> tuple[str, str]:
    if address == CAMERA:
        return view_tag(shot, camera), "the camera"
    if address == POINTS:
        return points_tag(shot, camera), "the list of focus points"
    if address == NOTES:
        return notes_tag(shot), "the list of notes"
    if address.startswith(f"{NOTES}/"):
        note_id = address.removeprefix(f"{NOTES}/")
        return note_tag(shot, note_id), f"note {note_id!r}"
    name = address.removeprefix(f"{POINTS}/")
    return point_tag(shot, camera, name), f"focus point {name!r}"


def resource_tags(shot: Shot, camera: str | None, changes: Sequence[Change] = ()) -> dict[str, str]:
    """Entity tags of a camera, its list of focus points and each of these, by their addresses below the shot.

    Where changes write notes, those of the list of notes and of each note too.
    """
    points = {point_address(name): point_tag(shot, camera, name) for name in point_names(shot, camera)}
    notes: dict[str, str] = {}
    if any(isinstance(change, AddNote | EditNote | DeleteNote) for change in changes):
        notes = {note_address(note.id): note_tag(shot, note.id) for note in shot.notes.read().notes}
        notes[NOTES] = notes_tag(shot)
    return {CAMERA: view_tag(shot, camera), POINTS: points_tag(shot, camera)} | points | notes


def checked_times(shot: Shot, changes: Sequence[Change]) -> list[float]:
    """Times at which a picture must still be possible after the changes, if it was before."""
    times: dict[float, None] = {}
    for change in changes:
        match change:
            case SetCamera() | SetFocus() | SetExposure() | SetFilm():
                times[shot.frame_range.start if change.values.time is None else change.values.time] = None
            case KeySetting():
                times[change.key.time] = None
            case ChooseVariant() | ShowPayload() | UnkeyCamera() | MoveCameraKeys():
                times[shot.frame_range.start] = None
            case SetSettingTangents() | MoveCamera() | FrameSubject():
                times[change.time] = None
    return list(times)
