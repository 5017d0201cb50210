"""What the stage process is asked about the edits of a shot as a whole; see `service.stage.shots`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from render.errors import NotFoundError
from render.model.edit_history import EditHistory as KeptHistory
from service.models.edits import EditHistory, EditStep
from service.models.shots import Shot
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord
from service.terms import Terms


def edits_tag(revision: str) -> str:
    """The entity tag of all edits: a shot's revision in quotes.

    Args:
        revision: of the edits.
    """
    return f'"{revision}"'


@dataclass(frozen=True)
class ReadHistory:
    """The states that the edits have had."""

    record: ShotRecord

    def run(self, opened: OpenedShots) -> EditHistory:
        """All that are kept."""
        with opened.use(self.record) as shot:
            return _told(shot.history)


@dataclass(frozen=True)
class WalkHistory:
    """Undo the last edit, or do the one again that was undone last."""

    record: ShotRecord
    step: Literal["undo", "redo"]
    terms: Terms

    def run(self, opened: OpenedShots) -> EditHistory:
        """The history as it is then. Raises `EndOfHistoryError`."""
        with opened.change(self.record) as shot:
            self.terms.check(edits_tag(shot.history.present.revision), "the edit layer")
            if self.step == "undo":
                shot.undo()
            else:
                shot.redo()
            return _told(shot.history)


@dataclass(frozen=True)
class RestoreEdits:
    """Go back to a state of the edits. That is an edit too, and can be undone."""

    record: ShotRecord
    revision: str
    terms: Terms

    def run(self, opened: OpenedShots) -> Shot:
        """The shot as it is then. Raises `NotFoundError`: the revision is not kept any more."""
        from service.stage.read_shot import describe

        with opened.edit(self.record, self.terms, f"go back to revision {self.revision}") as shot:
            self.terms.check(edits_tag(shot.history.present.revision), "the edit layer")
            state = shot.history.find(self.revision)
            if state is None:
                raise NotFoundError(
                    f"The edits of shot {self.record.id!r} at revision {self.revision!r} are not kept any more.",
                    code="revision_not_found",
                    path=self.revision,
                )
            shot.replace_edits(state.text)
        with opened.use(self.record) as shot:
            return describe(self.record, shot)


def _told(history: KeptHistory) -> EditHistory:
    return EditHistory(
        revision=history.present.revision,
        now=history.now,
        undo=history.undo_label,
        redo=history.redo_label,
        steps=[EditStep.model_validate(state) for state in history.states],
    )
