"""Functions of the stage process that apply edits to a shot and walk their history."""

from __future__ import annotations

from typing import Literal

from render.errors import NotFoundError
from render.shot import Shot as OpenShot
from service.edit_context import EditContext, edits_tag
from service.models.curve import ImportedCurve
from service.models.edits import (
    ChangedResource,
    EditHistory,
    EditRequest,
    EditResult,
    EditStep,
    HistoryPosition,
    SimplifiedSetting,
)
from service.models.shots import Shot
from service.models.solving import Rack
from service.stage.camera_changes import CreatedCamera
from service.stage.editing import apply_in_context, resource_tags
from service.stage.notes import AddedNote, state_of_notes
from service.stage.opened import OpenedShot, stage_function
from service.stage.read_state import read_state
from service.stage.shots import shot_model
from service.storage.store import ShotRecord


@stage_function
def apply_edit(
    opened: OpenedShot, record: ShotRecord, request: EditRequest, context: EditContext, max_curve_frames: int
) -> EditResult:
    """Apply an edit: all of its changes or none, as one entry of the history.

    Args:
        opened: the open shots.
        record: the shot.
        request: the edit, with anchors in place of places of the picture.
        context: tags of what the editor has seen, and the gesture.
        max_curve_frames: frames of a focus curve, imported or in the answer.

    Raises:
        ChangedMeanwhileError: something that is edited is not what the editor has seen.
        PullfocusError: a change cannot be applied; nothing is changed then.
    """
    camera = request.camera
    with opened.edit(record, context, request.label) as shot:
        before = resource_tags(shot, camera, request.changes)
        outcomes = apply_in_context(shot, camera, request.changes, context, max_curve_frames)
        created = [outcome.path for outcome in outcomes if isinstance(outcome, CreatedCamera)]
        camera = created[-1] if created else camera
        after = resource_tags(shot, camera, request.changes)
    with opened.use(record) as shot:
        state = read_state(shot, camera, request.answer, max_curve_frames) if request.answer else None
        return EditResult(
            history=_history_position(shot),
            changed=[
                ChangedResource(resource=address, etag=after.get(address))
                for address in dict.fromkeys((*before, *after))
                if before.get(address) != after.get(address)
            ],
            added=[outcome for outcome in outcomes if isinstance(outcome, str)],
            cameras=created,
            notes=[outcome.id for outcome in outcomes if isinstance(outcome, AddedNote)],
            racks=[outcome for outcome in outcomes if isinstance(outcome, Rack)],
            simplified=[outcome for outcome in outcomes if isinstance(outcome, SimplifiedSetting)],
            imported=next((outcome for outcome in reversed(outcomes) if isinstance(outcome, ImportedCurve)), None),
            state=state,
        )


@stage_function
def read_history(opened: OpenedShot, record: ShotRecord) -> EditHistory:
    """Read the edit history of a shot."""
    with opened.use(record) as shot:
        return _history_model(shot)


@stage_function
def walk_history(
    opened: OpenedShot, record: ShotRecord, step: Literal["undo", "redo"], context: EditContext
) -> EditHistory:
    """Undo or redo one step. Raises `EndOfHistoryError`."""
    with opened.change(record) as shot:
        context.check_tag(edits_tag(shot.edits.history.present.revision), "the edit layer")
        if step == "undo":
            shot.edits.undo()
        else:
            shot.edits.redo()
        return _history_model(shot)


@stage_function
def restore_edits(opened: OpenedShot, record: ShotRecord, revision: str, context: EditContext) -> Shot:
    """Restore the edits of an earlier revision, as an edit that can be undone.

    Raises:
        NotFoundError: the revision is no longer kept.
    """
    with opened.edit(record, context, f"go back to revision {revision}") as shot:
        context.check_tag(edits_tag(shot.edits.history.present.revision), "the edit layer")
        state = shot.edits.history.find(revision)
        if state is None:
            raise NotFoundError(
                f"The edits of shot {record.id!r} at revision {revision!r} are not kept any more.",
                code="revision_not_found",
                path=revision,
            )
        shot.edits.replace(state.text)
    with opened.use(record) as shot:
        return shot_model(record, shot)


def _history_position(shot: OpenShot) -> HistoryPosition:
    history = shot.edits.history
    states, now = history.states, history.now
    return HistoryPosition(
        revision=history.present.revision,
        before=states[now - 1].revision if now > 0 else None,
        after=states[now + 1].revision if now + 1 < len(states) else None,
        undo=history.undo_label,
        redo=history.redo_label,
        notes_tag=state_of_notes(shot),
    )


def _history_model(shot: OpenShot) -> EditHistory:
    history = shot.edits.history
    return EditHistory(
        revision=history.present.revision,
        now=history.now,
        undo=history.undo_label,
        redo=history.redo_label,
        steps=[EditStep.model_validate(state) for state in history.states],
        cameras=shot.cameras(),
        notes_tag=state_of_notes(shot),
    )
