"""Events: what has changed in shots, edits and renders, and who looks at a shot."""

from __future__ import annotations

from datetime import datetime
from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as
from service.models.render_products import ProductName, ProductState
from service.models.renders import RenderState, TaskState

Topic = Literal["shots", "edits", "renders", "tasks", "presence"]
Kind = Literal[
    "shot-added",
    "shot-deleted",
    "shot-restored",
    "edits-changed",
    "render-sent",
    "render-changed",
    "render-removed",
    "product-changed",
    "task-changed",
    "presence-changed",
]

EVENT_EXAMPLE: JsonDict = {
    "number": 1824,
    "at": "2026-11-27T08:00:42Z",
    "topic": "tasks",
    "kind": "task-changed",
    "project": "default",
    "shot": "demo",
    "render": "r-5f0c1d2e3a4b",
    "data": {"frame": 25, "state": "done", "attempt": 1, "worker": "camera-pc", "count": 96, "done": 25},
}


class EventData(Model):
    """Fields of an event; those that do not concern it are left out."""

    name: str | None = Field(default=None, description="Name of the shot or of the render.")
    revision: str | None = Field(default=None, description="Revision of the edits.")
    frame: int | None = Field(default=None, description="Frame of the task.")
    product: ProductName | None = Field(default=None, description="Product of the render.")
    state: RenderState | TaskState | ProductState | None = Field(
        default=None, description="State that the render, task or product has now."
    )
    attempt: int | None = Field(default=None, description="Number of the attempt at the task or product.")
    worker: str | None = Field(default=None, description="Who works on the task, or did.")
    error: str | None = Field(default=None, description="What went wrong with the attempt.")
    count: int | None = Field(default=None, description="Frames of the render.")
    ready: int | None = Field(default=None, description="Those that wait.")
    running: int | None = Field(default=None, description="Those that are drawn.")
    done: int | None = Field(default=None, description="Those that are stored.")
    failed: int | None = Field(default=None, description="Those that could not be drawn.")
    canceled: int | None = Field(default=None, description="Those that were given up.")
    viewers: list[str] | None = Field(default=None, description="Names of those who look at the shot.")


class Event(Model):
    """Something that has changed."""

    model_config = shown_as(EVENT_EXAMPLE)

    number: int = Field(description="Rises with each event of the service; numbers in between may be missing.")
    at: datetime
    topic: Topic
    kind: Kind
    project: str
    shot: str | None = Field(description="Id of the shot that it is about.")
    render: str | None = Field(description="Id of the render that it is about.")
    data: EventData


class EventGap(Model):
    """Tells a reader that events which it has not seen are kept no longer: what it shows has to be read again."""

    model_config = shown_as({"after": 12, "oldest": 4711})

    after: int = Field(description="Number of the last event that the reader knew.")
    oldest: int = Field(description="Number of the oldest event that is kept.")
