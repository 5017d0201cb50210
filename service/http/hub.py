"""What every request shares: the store, the two lanes, the picture cache and the counters."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Concatenate, ParamSpec, TypeVar

from fastapi import Depends, WebSocket
from starlette.requests import HTTPConnection

from service.http.errors import ServiceError
from service.http.exposing import Exposures
from service.http.frame_cache import FrameCache
from service.http.metrics import Metrics
from service.http.settings import MEBIBYTE, Settings
from service.picture.calls import frames as picture_frames
from service.picture.calls import state as picture_state
from service.stage.calls import opened as stage_state
from service.stage.calls import shots as stage_shots
from service.storage.store import ShotStore
from service.workers.calls import call
from service.workers.lane import Lane
from service.workers.process import WorkerProcess

if TYPE_CHECKING:
    from service.picture.state import PictureWorkerState
    from service.stage.opened import OpenedShots

Arguments = ParamSpec("Arguments")
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
    pictures: Lane[PictureWorkerState]
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
            WorkerProcess("stage", stage_state.OpenedShots),
            max_waiting=settings.max_waiting,
            timeout_s=settings.stage_timeout_s,
        )
        pictures = Lane(
            WorkerProcess("picture", picture_state.PictureWorkerState),
            max_waiting=settings.max_waiting,
            timeout_s=settings.frame_timeout_s,
        )
        frames = FrameCache(settings.frame_cache_mb * MEBIBYTE)
        return cls(settings, store, stages, pictures, frames, Metrics(lanes=(stages, pictures)))

    @cached_property
    def exposures(self) -> Exposures:
        """The long exposures that go on."""
        return Exposures(self.pictures, self.settings.max_picture_px)

    def close(self) -> None:
        """End the workers and let go of the data folder."""
        self.stages.close()
        self.pictures.close()
        self.store.close()

    async def ask_stage(
        self,
        function: Callable[Concatenate[OpenedShots, Arguments], Reply],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Reply:
        """Call a function in the stage process.

        Args:
            function: one of a module of `service.stage.calls`.
            *args: its arguments after the worker's state.
            **kwargs: its keyword arguments.
        """
        return await self.stages.result(call(function, *args, **kwargs))

    async def ask_picture(
        self,
        function: Callable[Concatenate[PictureWorkerState, Arguments], Reply],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Reply:
        """Call a function in the picture process.

        Args:
            function: one of a module of `service.picture.calls`.
            *args: its arguments after the worker's state.
            **kwargs: its keyword arguments.
        """
        return await self.pictures.result(call(function, *args, **kwargs))

    def forget(self, shot_id: str) -> None:
        """Have the workers close a shot that is gone; nobody waits for that, and a busy worker may leave it open."""
        with suppress(ServiceError):
            self.stages.submit(call(stage_shots.close_shot, shot_id))
            self.pictures.submit(call(picture_frames.close_shot, shot_id))


def _hub(connection: HTTPConnection) -> Hub:
    hub = connection.app.state.hub
    assert isinstance(hub, Hub)
    return hub


HubDep = Annotated[Hub, Depends(_hub)]
