"""Functions of the stage process that walk the edit history of a shot."""

from __future__ import annotations

from typing import Literal

from render.errors import NotFoundError
from render.model.edit_history import EditHistory as KeptHistory
from service.edit_context import EditContext, edits_tag
from service.models.edits import EditHistory, EditStep
from service.models.shots import Shot
from service.stage.opened import OpenedShots, stage_function
from service.stage.read_shot import describe
from service.storage.store import ShotRecord


@stage_function
def read_history(opened: OpenedShots, record: ShotRecord) -> EditHistory:
    """Read the edit history of a shot."""
    with opened.use(record) as shot:
        return _history_model(shot.edits.history)


@stage_function
def walk_history(
    opened: OpenedShots, record: ShotRecord, step: Literal["undo", "redo"], context: EditContext
) -> EditHistory:
    """Undo or redo one step. Raises `EndOfHistoryError`."""
    with opened.change(record) as shot:
        context.check_tag(edits_tag(shot.edits.history.present.revision), "the edit layer")
        if step == "undo":
            shot.edits.undo()
        else:
            shot.edits.redo()
        return _history_model(shot.edits.history)


@stage_function
def restore_edits(opened: OpenedShots, record: ShotRecord, revision: str, context: EditContext) -> Shot:
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
        return describe(record, shot)


def _history_model(history: KeptHistory) -> EditHistory:
    return EditHistory(
        revision=history.present.revision,
        now=history.now,
        undo=history.undo_label,
        redo=history.redo_label,
        steps=[EditStep.model_validate(state) for state in history.states],
    )
