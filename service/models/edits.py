"""The edits of a shot as a whole, and the states that they have had."""

from __future__ import annotations

from datetime import datetime

from pydantic import Field

from service.models.base import Model, shown_as


class Restore(Model):
    """Which state of the edits to go back to."""

    model_config = shown_as({"revision": "5f70bf18a0860070"})

    revision: str = Field(max_length=80, description="A `revision` that the shot has had; the newest 200 are kept.")


class EditStep(Model):
    """A state of the edits."""

    revision: str = Field(description="Names it; a shot's `revision` is that of its present one.")
    label: str = Field(description="What was done to come to it; empty for the oldest that is kept.")
    made_at: datetime


class EditHistory(Model):
    """The states of the edits, oldest first."""

    model_config = shown_as(
        {
            "revision": "5f70bf18a0860070",
            "now": 1,
            "undo": "add focus point driver",
            "redo": None,
            "steps": [
                {"revision": "e3b0c44298fc1c14", "label": "", "madeAt": "2026-11-21T08:00:00Z"},
                {
                    "revision": "5f70bf18a0860070",
                    "label": "add focus point driver",
                    "madeAt": "2026-11-21T08:00:09Z",
                },
            ],
        }
    )

    revision: str = Field(description="Of the present state.")
    now: int = Field(description="Index of the present state in `steps`; those behind it were undone.")
    undo: str | None = Field(description="What an undo takes back; null for nothing.")
    redo: str | None = Field(description="What a redo does again; null for nothing.")
    steps: list[EditStep]
