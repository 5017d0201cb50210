"""Edits of a shot: a list of changes, the answer to it, and the history of the edit layer."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated

from pydantic import FailFast, Field

from service.models.base import Model, PrimPath, TimeCode, shown_as
from service.models.cameras import READOUT_EXAMPLE, Readout
from service.models.changes import MAX_CHANGES, Change
from service.models.curve import FocusCurve, ImportedCurve
from service.models.exposure import EXPOSURE_EXAMPLE, ExposureSettings
from service.models.film_settings import FILM_EXAMPLE, FilmSettings
from service.models.focus import ANCHOR_EXAMPLE, POINT_EXAMPLE, FocusPointList
from service.models.metering import READOUT_EXAMPLE as EXPOSURE_READOUT_EXAMPLE
from service.models.metering import ExposureReadout
from service.models.notes import NotesTag
from service.models.solving import SETTINGS_EXAMPLE, FocusSettings, Rack


class StateRequest(Model):
    """Asks for the state of a camera after an edit."""

    time: TimeCode = Field(description="USD time code of the state.")
    curve: bool = Field(default=False, description="Whether the focus curve of the whole shot is wanted too.")


class EditRequest(Model):
    """An edit: changes of one camera that are applied in order, all of them or none."""

    model_config = shown_as(
        {
            "label": "Focus on the visor",
            "camera": "/World/main_cam",
            "changes": [
                {"type": "addPoint", "point": ANCHOR_EXAMPLE | {"name": "visor"}},
                {"type": "keyPoint", "name": "visor", "attribute": "weight", "key": {"time": 24, "value": 1}},
            ],
            "answer": {"time": 24, "curve": True},
        }
    )

    label: str = Field(
        default="", max_length=200, description="Name of the edit in the history; left out, the labels of its changes."
    )
    gesture: str = Field(
        default="",
        max_length=64,
        description="Names one drag of a hand: its edits, one after the other, are one step of undo.",
    )
    camera: PrimPath | None = Field(default=None, description="Prim path; the shot's default camera when left out.")
    changes: Annotated[tuple[Change, ...], Field(min_length=1, max_length=MAX_CHANGES), FailFast()]
    answer: StateRequest | None = Field(
        default=None, description="Asks for the camera's state after the edit, so that nothing has to be read again."
    )


class ChangedResource(Model):
    """A resource that an edit has changed."""

    resource: str = Field(
        description="Its address below the shot: `camera`, `focus-points` (the list), `focus-points/{name}`, `notes` (the list) "
        "or `notes/{id}`."
    )
    etag: str | None = Field(description="Its new `ETag`; null for a focus point or a note that was removed.")


class CameraStateAfter(Model):
    """A camera after an edit, as each resource answers it. A part that cannot be read is null: its own resource says why."""

    time: float = Field(description="USD time code.")
    focus_points: FocusPointList | None
    readout: Readout | None
    focus: FocusSettings | None
    exposure: ExposureSettings | None
    exposure_readout: ExposureReadout | None
    film: FilmSettings | None
    curve: FocusCurve | None = Field(description="Of the whole shot; null where none was asked for.")


class HistoryPosition(Model):
    """The present state of the edits, and its neighbours in the history."""

    revision: str = Field(description="Revision of the present state.")
    before: str | None = Field(description="Revision that an undo goes back to; null for none.")
    after: str | None = Field(description="Revision that a redo goes on to; null for none.")
    undo: str | None = Field(description="Label of the edit that an undo takes back.")
    redo: str | None = Field(description="Label of the edit that a redo does again.")
    notes_tag: NotesTag


class SimplifiedSetting(Model):
    """Result of a simplification."""

    setting: str = Field(description="The setting, as it was sent.")
    before: int = Field(description="Keys that it had.")
    after: int = Field(description="Keys that it has.")
    off: float = Field(description="How far its curve is off at most, as a share like the tolerance.")


class EditResult(Model):
    """The answer to an edit."""

    model_config = shown_as(
        {
            "history": {
                "revision": "e3b0c44298fc1c14",
                "before": "e3b0c44298fc1c14",
                "after": None,
                "undo": "Focus on driver",
                "redo": None,
                "notesTag": "f00dbf18a0860070",
            },
            "changed": [
                {"resource": "focus-points", "etag": '"77aebf18a0860070"'},
                {"resource": "focus-points/driver", "etag": '"0b64bf18a0860070"'},
            ],
            "added": ["visor"],
            "cameras": [],
            "notes": [],
            "racks": [],
            "simplified": [],
            "imported": None,
            "state": {
                "time": 24.0,
                "focusPoints": {"etag": '"77aebf18a0860070"', "focusPoints": [POINT_EXAMPLE]},
                "readout": READOUT_EXAMPLE,
                "focus": SETTINGS_EXAMPLE,
                "exposure": EXPOSURE_EXAMPLE,
                "exposureReadout": EXPOSURE_READOUT_EXAMPLE,
                "film": FILM_EXAMPLE,
                "curve": None,
            },
        }
    )

    history: HistoryPosition
    changed: list[ChangedResource] = Field(description="With their new tags, for `If-Match`; empty for no difference.")
    added: list[str] = Field(description="Names of the added focus points, in order.")
    cameras: list[str] = Field(description="Prim paths of the created cameras, in order.")
    notes: list[str] = Field(description="Ids of the added notes, in order.")
    racks: list[Rack] = Field(description="The racks as authored, in order.")
    simplified: list[SimplifiedSetting] = Field(description="The simplifications, in order.")
    imported: ImportedCurve | None = Field(
        description="Result of the import of a curve, the last if there are several."
    )
    state: CameraStateAfter | None = Field(description="As `answer` asked for it.")


class Restore(Model):
    """State of the edits to go back to."""

    model_config = shown_as({"revision": "e3b0c44298fc1c14"})

    revision: str = Field(max_length=80, description="A `revision` that the shot has had; the newest 200 are kept.")


class EditStep(Model):
    """A state of the edits."""

    revision: str = Field(description="Names it; a shot's `revision` is that of its present one.")
    label: str = Field(description="Label of the edit that led to it; empty for the oldest that is kept.")
    made_at: datetime


class EditHistory(Model):
    """The states of the edits, oldest first, and the cameras that there are in the present one."""

    model_config = shown_as(
        {
            "revision": "e3b0c44298fc1c14",
            "now": 1,
            "undo": "add focus point driver",
            "redo": None,
            "steps": [
                {"revision": "e3b0c44298fc1c14", "label": "", "madeAt": "2026-11-21T08:00:00Z"},
                {
                    "revision": "e3b0c44298fc1c14",
                    "label": "add focus point driver",
                    "madeAt": "2026-11-21T08:00:09Z",
                },
            ],
            "cameras": ["/World/main_cam"],
            "notesTag": "f00dbf18a0860070",
        }
    )

    revision: str = Field(description="Revision of the present state.")
    now: int = Field(description="Index of the present state in `steps`; those behind it were undone.")
    undo: str | None = Field(description="Label of the edit that an undo takes back; null for none.")
    redo: str | None = Field(description="Label of the edit that a redo does again; null for none.")
    steps: list[EditStep]
    cameras: list[str] = Field(description="Prim paths of the shot's cameras: a step may have created one.")
    notes_tag: NotesTag
