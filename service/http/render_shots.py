"""Shots of renders: those of this service, or copies from the bucket."""

from __future__ import annotations

import asyncio
from contextlib import ExitStack
from datetime import datetime
from typing import Protocol

from starlette.concurrency import run_in_threadpool

from render.errors import InputError, NotFoundError
from service.http.service import Service
from service.storage.errors import UnavailableError
from service.storage.store import ShotRecord


class ShotOfRender(Protocol):
    """The shot of a render, as the render knows it; see `service.jobs.claims.Claim`."""

    @property
    def shot(self) -> str:
        """Id of the shot."""

    @property
    def shot_created_at(self) -> str:
        """Time at which it was accepted."""

    @property
    def files(self) -> str | None:
        """Hash of its files in the bucket; None where it is in the data folder alone."""

    @property
    def root(self) -> str | None:
        """Its root layer."""

    @property
    def project(self) -> str:
        """Project of the render."""


async def shot_of(service: Service, render: ShotOfRender, stack: ExitStack) -> ShotRecord:
    """Return the shot of a render, of this service or from the bucket.

    Args:
        service: that uses it.
        render: the render, or a claim of a frame.
        stack: keeps what was fetched from the bucket.

    Raises:
        NotFoundError: it was deleted.
        InputError: another one has its id now, or there is no bucket.
        UnavailableError: the bucket cannot be used, the disk is full, or what was fetched was removed by others.
    """
    try:
        record = service.store.get(render.shot)
        if record.created_at.isoformat() == render.shot_created_at:
            return record
        if render.files is None:
            raise InputError(f"shot {render.shot!r} is another one than when the render was sent", code="shot_replaced")
    except NotFoundError:
        if render.files is None:
            raise
    if service.shared is None:
        raise InputError("the shot of the render is in a bucket, which this service does not have", code="no_bucket")
    shots, fetching = service.shared.shots, service.shared.fetching
    async with fetching.setdefault(render.files, asyncio.Lock()):  # so that only one thread waits for a shot
        try:
            await run_in_threadpool(shots.fetch, render.files)
        except OSError as error:
            detail = f"the shot cannot be fetched now: {error.strerror or error}"
            raise UnavailableError(detail, code="shot_not_fetched") from error
        finally:
            fetching.pop(render.files, None)
    folder = stack.enter_context(shots.use(render.files))
    if folder is None:
        detail = "the shot was removed by others while it was fetched: raise fetched_mb"
        raise UnavailableError(detail, code="shot_not_kept")
    created_at = datetime.fromisoformat(render.shot_created_at)
    own_id = f"render-{render.files[:16]}"  # a shot of this service may have the same id as the other one's
    return ShotRecord(own_id, render.shot, folder, render.root or "", created_at, 0, 0, render.project)
