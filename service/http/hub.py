"""What every request shares: the store, the two lanes, the picture cache and the counters."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Hashable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, TypeVar

from fastapi import Depends, WebSocket
from starlette.requests import HTTPConnection

from service.http.errors import ServiceError
from service.http.exposing import Exposures
from service.http.frame_cache import FrameCache
from service.http.metrics import Metrics
from service.http.settings import MEBIBYTE, Settings
from service.picture.frames import Darkroom, ForgetPictures
from service.stage.opened import OpenedShots
from service.stage.shots import ForgetShot
from service.storage.store import ShotStore
from service.workers.lane import Lane
from service.workers.process import Request as Work
from service.workers.process import WorkerProcess

Reply = TypeVar("Reply")


@dataclass(frozen=True)
class Hub:
    """One running service.

    Attributes:
        settings: its limits.
        store: the shots on disk.
        stages: the lane to the process that reads and edits stages; the one writer of edit layers.
        pictures: the lane to the process that owns GL.
        frames: encoded pictures, by their entity tag.
        metrics: counters.
        watching: the live connections that are open.
        run_id: another one each time a service starts: the same inputs may give other pixels after an update.
    """

    settings: Settings
    store: ShotStore
    stages: Lane[OpenedShots]
    pictures: Lane[Darkroom]
    frames: FrameCache
    metrics: Metrics
    watching: set[WebSocket] = field(default_factory=set)
    run_id: str = field(default_factory=lambda: secrets.token_hex(8))

    @classmethod
    def start(cls, settings: Settings) -> Hub:
        """Open the data folder and start the lanes; their processes start with the first request.

        Raises:
            OutputError: the data folder cannot be written, or another service works in it.
        """
        store = ShotStore(settings.data)
        stages = Lane(
            WorkerProcess("stage", OpenedShots),
            max_waiting=settings.max_waiting,
            timeout_s=settings.stage_timeout_s,
        )
        pictures = Lane(
            WorkerProcess("picture", Darkroom),
            max_waiting=settings.max_waiting,
            timeout_s=settings.frame_timeout_s,
        )
        frames = FrameCache(settings.frame_cache_mb * MEBIBYTE)
        return cls(settings, store, stages, pictures, frames, Metrics(lanes=(stages, pictures)))

    @cached_property
    def exposures(self) -> Exposures:
        """The long exposures that go on."""
        return Exposures(self.ask_picture, self.settings.max_picture_px)

    def close(self) -> None:
        """End the workers and let go of the data folder."""
        self.stages.close()
        self.pictures.close()
        self.store.close()

    async def ask_stage(self, work: Work[OpenedShots, Reply]) -> Reply:
        """Have the stage process do something."""
        return await asyncio.wrap_future(self.stages.submit(work))

    async def ask_picture(self, work: Work[Darkroom, Reply], group: Hashable | None = None) -> Reply:
        """Have the picture process do something; newer work of the same group takes the place of older."""
        return await asyncio.wrap_future(self.pictures.submit(work, group=group))

    def forget(self, shot_id: str) -> None:
        """Have the workers close a shot that is gone; nobody waits for that, and a busy worker may leave it open."""
        with suppress(ServiceError):
            self.stages.submit(ForgetShot(shot_id))
            self.pictures.submit(ForgetPictures(shot_id))


def _hub(connection: HTTPConnection) -> Hub:
    hub = connection.app.state.hub
    assert isinstance(hub, Hub)
    return hub


HubDep = Annotated[Hub, Depends(_hub)]
