"""Keys, and who one is."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as

KEY_EXAMPLE: JsonDict = {
    "id": "3f2a9c51d07b",
    "label": "Mara",
    "scopes": ["edit", "read", "render"],
    "project": "night-tram",
    "createdAt": "2026-11-21T08:00:00Z",
    "expiresAt": None,
}
SECRET_EXAMPLE = "pf_3f2a9c51d07b_" + "x" * 43
Label = Annotated[str, Field(min_length=1, max_length=100, description="Name for people.")]


class SignIn(Model):
    """A key that is exchanged for a session."""

    model_config = shown_as({"key": SECRET_EXAMPLE})

    key: str = Field(max_length=200, description="The key.")


class Amount(Model):
    """Amount of something that is limited."""

    used: float
    allowed: float | None = Field(description="null for any amount.")


class Usage(Model):
    """Amounts that were used, beside what is allowed."""

    shots: Amount | None = Field(description="Shots of the project, those in the trash too; null for all projects.")
    stored_mb: Amount | None = Field(description="Size of these shots and their edits, MiB; null for all projects.")
    cpu_s: Amount = Field(description="Processor time of your work in the last 24 hours, s.")


class Who(Model):
    """Sender of the request."""

    model_config = shown_as(
        {
            "id": "key:3f2a9c51d07b",
            "label": "Mara",
            "scopes": ["edit", "read", "render"],
            "project": "night-tram",
            "endsAt": "2026-11-21T20:00:00Z",
            "usage": None,
        }
    )

    id: str = Field(description="`anyone` on a service that needs no key.")
    label: str = Field(description="Name for people.")
    scopes: list[str] = Field(description="`read`, `edit`, `render`, `admin`.")
    project: str = Field(description="Project whose shots are seen; `*` for every project.")
    ends_at: datetime | None = Field(description="Time at which the session or the key ends; null for never.")
    usage: Usage | None = Field(default=None, description="Use of the quotas; null on a service without any.")


class KeySummary(Model):
    """A key, without its secret."""

    model_config = shown_as(KEY_EXAMPLE)

    id: str
    label: Label
    scopes: list[str]
    project: str = Field(description="Project whose shots it sees; `*` for every project.")
    created_at: datetime
    expires_at: datetime | None = Field(description="null for never.")


class NewKey(KeySummary):
    """A key that was just created. Its text cannot be read again."""

    model_config = shown_as(KEY_EXAMPLE | {"key": SECRET_EXAMPLE})

    key: str = Field(description="Text of the key; shown this once.")


class KeyList(Model):
    """All keys, oldest first."""

    model_config = shown_as({"keys": [KEY_EXAMPLE]})

    keys: list[KeySummary]


class KeyRequest(Model):
    """A key that is to be created."""

    model_config = shown_as({"label": "Mara", "roles": ["artist"], "project": "night-tram", "days": 90})

    label: Label
    roles: list[Annotated[str, Field(max_length=40)]] = Field(
        max_length=10, description="Roles (`reader`, `viewer`, `artist`, `admin`) and single scopes."
    )
    project: str = Field(
        default="default", max_length=64, description="Project whose shots it sees; `*` for every project."
    )
    days: int | None = Field(default=None, ge=1, le=36_500, description="Days until it expires; null for never.")
