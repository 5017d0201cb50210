"""Webhooks: receivers of events."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as
from service.models.events import Topic

URL_EXAMPLE = "https://hooks.studio.example/pullfocus"
WEBHOOK_EXAMPLE: JsonDict = {
    "id": "w-3f2a9c51d07b",
    "url": URL_EXAMPLE,
    "project": "night-tram",
    "topics": ["renders"],
    "shot": None,
    "render": None,
    "createdAt": "2026-11-27T08:00:00Z",
    "after": 1824,
    "lastStatus": 503,
    "lastError": "the receiver answered with status 503",
    "failures": 3,
    "nextTryAt": "2026-11-27T09:12:08Z",
    "disabled": None,
}


class WebhookRequest(Model):
    """A webhook that is to be made."""

    model_config = shown_as({"url": URL_EXAMPLE, "topics": ["renders"], "project": "night-tram"})

    url: str = Field(min_length=1, max_length=2000, description="Where events are sent to, http or https.")
    topics: list[Topic] = Field(default=[], max_length=5, description="Of these topics; all when left out.")
    project: str | None = Field(default=None, max_length=64, description="Of this project; of all when left out.")
    shot: str | None = Field(default=None, max_length=80, description="About this shot.")
    render: str | None = Field(default=None, max_length=80, description="About this render.")
    secret: Annotated[str, Field(min_length=16, max_length=200, pattern=r"^[!-~]*$")] | None = Field(
        default=None, description="What deliveries are signed with, printable ASCII; one is made when left out."
    )


class Webhook(Model):
    """A webhook, without its secret."""

    model_config = shown_as(WEBHOOK_EXAMPLE)

    id: str
    url: str
    project: str | None = Field(description="Project whose events it gets; null for every project.")
    topics: list[Topic] = Field(description="Empty for all.")
    shot: str | None = Field(description="null for all.")
    render: str | None = Field(description="null for all.")
    created_at: datetime
    after: int = Field(description="Number of the last event that is delivered, or not wanted.")
    last_status: int | None = Field(description="Status of the last answer; null where there was none.")
    last_error: str | None = Field(description="Reason why the last try was no success; null where it was one.")
    failures: int = Field(description="Tries in succession without success.")
    next_try_at: datetime | None = Field(description="null where none is waited for.")
    disabled: str | None = Field(description="Reason why nothing is delivered; null where events are.")


class NewWebhook(Webhook):
    """A webhook that was just made. Its secret cannot be read again."""

    model_config = shown_as(WEBHOOK_EXAMPLE | {"secret": "whsec_" + "x" * 43})

    secret: str = Field(description="What its deliveries are signed with; shown this once.")


class WebhookList(Model):
    """The webhooks, oldest first."""

    model_config = shown_as({"webhooks": [WEBHOOK_EXAMPLE]})

    webhooks: list[Webhook]


class WebhookTest(Model):
    """Body of a test."""

    webhook: str = Field(description="Id of the webhook.")
    at: datetime


class WebhookAnswer(Model):
    """Answer of a receiver to a test."""

    model_config = shown_as({"status": 200, "text": "ok", "error": None})

    status: int | None = Field(description="null where it did not answer.")
    text: str = Field(description="Body of the answer, at most its first 1024 bytes.")
    error: str | None = Field(description="Reason why an event would not be delivered; null where it would.")
