"""The states that an edit layer has had, in order: what undo and redo walk along.

A state is the whole layer as text. Layers are some kilobytes and pack well, and a whole state can neither be undone by half nor
depend on how an edit was made.
"""

from __future__ import annotations

import hashlib
import zlib
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

from render.errors import InputError


class EndOfHistoryError(InputError):
    """There is no further edit to undo, or to do again."""


MAX_STATES = 200
"""States that are kept; the oldest go first."""

MAX_PACKED_BYTES = 32 * 2**20
"""Limit on all packed states together, which are kept in memory: a curve of many thousand keys is some hundred kilobytes."""

MAX_HISTORY_BYTES = 256 * 2**20
"""Limit on the text of all states together, as it is kept on the disk."""

MAX_TEXT_BYTES = 64 * 2**20
"""Limit on the text of one state."""


def check_size(text: str, before_bytes: int) -> None:
    """Refuse an edit that makes its layer too large.

    Args:
        text: of the layer after the edit.
        before_bytes: size of its text before. One that is too large already may shrink.

    Raises:
        InputError: it is too large.
    """
    if len(text.encode()) > max(MAX_TEXT_BYTES, before_bytes):
        most = MAX_TEXT_BYTES >> 20
        detail = (
            f"the edits of the shot would take more than {most} MiB: import curves with fewer keys, or remove points"
        )
        raise InputError(detail, code="edits_too_large")


def revision_of(text: str) -> str:
    """A word that is another one for every other edit layer.

    Args:
        text: of the layer; empty for no edits.
    """
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclass(frozen=True)
class EditState:
    """One state of an edit layer.

    Attributes:
        packed: the layer's text, packed.
        revision: names the state.
        label: label of the edit that led to it, such as "set fStop"; empty for the first state.
        made_at: when.
        size_bytes: size of the text.
        gesture: names the drag of a hand that the edit was part of; empty for none.
    """

    packed: bytes = field(repr=False)
    revision: str
    label: str
    made_at: datetime
    size_bytes: int
    gesture: str = ""

    @classmethod
    def of(cls, text: str, label: str = "", gesture: str = "") -> EditState:
        """A state that is made now.

        Args:
            text: of the layer; empty for no edits.
            label: label of the edit.
            gesture: names the drag of a hand that it was part of.
        """
        content = text.encode()
        return cls(zlib.compress(content), revision_of(text), label, datetime.now(UTC), len(content), gesture)

    @property
    def text(self) -> str:
        """The layer."""
        return zlib.decompress(self.packed).decode()


@dataclass(frozen=True)
class EditHistory:
    """A row of states, and which of them is the present one; those behind it were undone.

    Attributes:
        states: oldest first; there is always one.
        now: index of the present one.
    """

    states: tuple[EditState, ...]
    now: int = 0

    @classmethod
    def beginning_with(cls, text: str) -> EditHistory:
        """A history in which nothing can be undone.

        Args:
            text: of the layer; empty for no edits.
        """
        return cls((EditState.of(text),))

    @property
    def present(self) -> EditState:
        """The state that the layer is in."""
        return self.states[self.now]

    @property
    def undo_label(self) -> str | None:
        """Label of the edit that undo would revert; None for nothing."""
        return self.present.label if self.now > 0 else None

    @property
    def redo_label(self) -> str | None:
        """Label of the edit that redo would apply; None for nothing."""
        return self.states[self.now + 1].label if self.now + 1 < len(self.states) else None

    def after(self, text: str, label: str, gesture: str = "") -> EditHistory:
        """History after an edit. Undone edits are dropped.

        An edit that changes nothing leaves no trace. Edits of one gesture, one after the other, are one step.

        Args:
            text: of the layer after the edit.
            label: label of the edit.
            gesture: names the drag of a hand that it was part of.
        """
        if revision_of(text) == self.present.revision:
            return self
        until = self.now if gesture and self.now > 0 and self.present.gesture == gesture else self.now + 1
        kept = self.states[:until]
        if kept[-1].revision == revision_of(text):  # dragged back to where the gesture began
            return EditHistory(kept, len(kept) - 1)
        states = (*kept, EditState.of(text, label, gesture))
        return EditHistory(states, len(states) - 1)._bounded()

    def undone(self) -> EditHistory:
        """One step back.

        Raises:
            EndOfHistoryError: there is nothing to undo.
        """
        if self.now == 0:
            raise EndOfHistoryError("there is no edit to undo", code="nothing_to_undo")
        return replace(self, now=self.now - 1)

    def redone(self) -> EditHistory:
        """One step forward.

        Raises:
            EndOfHistoryError: there is nothing to do again.
        """
        if self.now + 1 == len(self.states):
            raise EndOfHistoryError("there is no undone edit to do again", code="nothing_to_redo")
        return replace(self, now=self.now + 1)

    def find(self, revision: str) -> EditState | None:
        """The state of that name, the nearest to the present one's, or None.

        Args:
            revision: its name.
        """
        found = [index for index, state in enumerate(self.states) if state.revision == revision]
        return self.states[min(found, key=lambda index: abs(index - self.now))] if found else None

    def agreeing_with(self, text: str) -> EditHistory:
        """This history if its present state is the layer as it was found; else with that as its present state.

        A program that was ended between writing the layer and writing the history leaves them apart.

        Args:
            text: of the layer as it was found.
        """
        near = sorted(range(len(self.states)), key=lambda index: abs(index - self.now))
        for index in near:
            if self.states[index].revision == revision_of(text):
                return replace(self, now=index)
        return self.after(text, "edited elsewhere")

    def _bounded(self) -> EditHistory:
        """Without the oldest states where there are too many, or they are too large; the present one stays."""
        kept = self.states[-MAX_STATES:]
        while len(kept) > 1 and _are_too_large(kept):
            kept = kept[1:]
        return EditHistory(kept, len(kept) - 1)


def _are_too_large(states: tuple[EditState, ...]) -> bool:
    packed_bytes, text_bytes = sum(len(state.packed) for state in states), sum(state.size_bytes for state in states)
    return packed_bytes > MAX_PACKED_BYTES or text_bytes > MAX_HISTORY_BYTES
