"""Renders as they are sent, and tasks as workers claim them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class NewRender:
    """A render that is sent.

    Attributes:
        name: for people and files.
        project: whose it is.
        owner: id of the principal who sends it.
        owner_label: name of that principal.
        idempotency_key: the same key again gives the same render; None for none.
        digest: of the request, so that a key that is used for another one is found out.
        shot: id of the shot.
        shot_created_at: when that shot was accepted; another one may get its id later.
        files: hash of its files in the bucket; None where it is in the data folder alone.
        root: its root layer.
        edits: text of its edit layer.
        revision: of these edits.
        request: the picture's settings and ``formats``, as JSON.
        frames: in rising order; none of them is drawn where the request has no formats.
        priority: higher ones come first.
        after: ids of renders that have to be done before its frames are drawn.
        products: names of what is made of them.
    """

    name: str
    project: str
    owner: str
    owner_label: str
    idempotency_key: str | None
    digest: str
    shot: str
    shot_created_at: str
    files: str | None
    root: str
    edits: str
    revision: str
    request: dict[str, Any]
    frames: Sequence[int]
    priority: int
    after: Sequence[str] = ()
    products: Sequence[str] = ()


@dataclass(frozen=True)
class Claim:
    """A task that a worker has claimed.

    Attributes:
        render: id of the render.
        frame: to be drawn.
        attempt: number of this attempt, from 1 on.
        worker: who holds it.
        owner: id of the principal whose render it is.
        shot: id of the shot.
        shot_created_at: when that shot was accepted.
        files: hash of its files in the bucket; None where it is in the data folder alone.
        root: its root layer; None for a render that an earlier version took.
        project: whose render it is.
        edits: text of its edit layer.
        request: the picture's settings and ``formats``.
    """

    render: str
    frame: int
    attempt: int
    worker: str
    owner: str
    shot: str
    shot_created_at: str
    files: str | None
    root: str | None
    project: str
    edits: str
    request: dict[str, Any]
