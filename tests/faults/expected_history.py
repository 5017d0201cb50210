"""The history that a shot must have, from the answers that its editors got."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from render.model.edit_history import MAX_STATES

Step = Literal["edit", "undo", "redo"]


@dataclass(frozen=True)
class ExpectedHistory:
    """Revisions of a shot's edits, oldest first; each with the gesture that it was part of.

    Attributes:
        revisions: of the states.
        gestures: of the states; empty for none.
        now: index of the present one.
    """

    revisions: tuple[str, ...]
    gestures: tuple[str, ...]
    now: int

    @classmethod
    def beginning_with(cls, revision: str) -> ExpectedHistory:
        """Return a history in which nothing can be undone."""
        return cls((revision,), ("",), 0)

    @property
    def present(self) -> str:
        """Revision of the present state."""
        return self.revisions[self.now]

    def edited(self, revision: str, gesture: str) -> ExpectedHistory:
        """Return the history after an edit to a state that the shot never had."""
        joins = gesture and self.now > 0 and self.gestures[self.now] == gesture
        until = self.now if joins else self.now + 1
        revisions = (*self.revisions[:until], revision)[-MAX_STATES:]
        gestures = (*self.gestures[:until], gesture)[-MAX_STATES:]
        return ExpectedHistory(revisions, gestures, len(revisions) - 1)

    def walked(self, step: Step) -> ExpectedHistory | None:
        """Return the history after an undo or a redo; None where there is nothing to undo or redo."""
        now = self.now + (1 if step == "redo" else -1)
        return replace(self, now=now) if 0 <= now < len(self.revisions) else None

    def agrees(self, revisions: tuple[str, ...], now: int) -> bool:
        """Whether a shot has these states, and that present one."""
        return (self.revisions, self.now) == (revisions, now)

    def after_unanswered(
        self, step: Step, gesture: str, revisions: tuple[str, ...], now: int
    ) -> ExpectedHistory | None:
        """Explain what a shot has after a request of which nobody knows whether it was carried out.

        Args:
            step: what was asked for.
            gesture: of the edit.
            revisions: of the shot's states.
            now: index of its present one.

        Returns:
            The history before or after the request; None where it is neither.
        """
        if step == "edit":
            new = [revision for revision in revisions if revision not in self.revisions]
            carried_out = self.edited(new[0], gesture) if new else None
        else:
            carried_out = self.walked(step)
        return next((each for each in (self, carried_out) if each is not None and each.agrees(revisions, now)), None)
