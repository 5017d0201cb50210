"""Shots in the trash."""

from __future__ import annotations

from datetime import datetime

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as

TRASHED_EXAMPLE: JsonDict = {
    "id": "night-tram-1f2e3d4c.20261121080000000000",
    "shot": "night-tram-1f2e3d4c",
    "name": "night_tram.usdz",
    "project": "default",
    "sizeBytes": 48_112_640,
    "deletedAt": "2026-11-21T08:00:00Z",
    "removedAt": "2026-12-21T08:00:00Z",
}


class TrashedShot(Model):
    """A shot in the trash."""

    model_config = shown_as(TRASHED_EXAMPLE)

    id: str = Field(description="Name of the entry in URLs.")
    shot: str = Field(description="Name that the shot had in URLs, and will have again.")
    name: str = Field(description="Name of the uploaded file.")
    project: str = Field(description="Project of the shot.")
    size_bytes: int = Field(description="Size of all files of the shot, unpacked.")
    deleted_at: datetime
    removed_at: datetime = Field(description="Time from which it is removed for good.")


class TrashList(Model):
    """The deleted shots of the projects that the sender may see, the last one first."""

    model_config = shown_as({"shots": [TRASHED_EXAMPLE]})

    shots: list[TrashedShot]
