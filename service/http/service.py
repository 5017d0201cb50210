"""State that all requests of one running service share: the store, the worker queues, the caches and the counters."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Concatenate, ParamSpec, TypeVar

from fastapi import Depends, WebSocket
from starlette.requests import HTTPConnection

from service.http.frame_cache import FrameCache
from service.http.long_exposures import LongExposures
from service.http.metrics import Metrics
from service.http.settings import MEBIBYTE, Settings
from service.picture import calls as picture
from service.stage import calls as stage
from service.storage.store import ShotStore
from service.workers.calls import call
from service.workers.errors import WorkerError
from service.workers.process import WorkerProcess
from service.workers.worker_queue import WorkerQueue

Arguments = ParamSpec("Arguments")
Reply = TypeVar("Reply")


@dataclass(frozen=True)
class Service:
    """One running service.

    Attributes:
        settings: its limits.
        store: the shots on disk.
        stage_queue: queue of the process that reads and edits stages; the only writer of edit layers.
        picture_queue: queue of the process that owns GL.
        frame_cache: encoded pictures, by their entity tag.
        metrics: counters.
        live_sockets: the live connections that are open.
        run_id: changes with each start: the same inputs may give other pixels after an update.
    """

    settings: Settings
    store: ShotStore
    stage_queue: WorkerQueue[stage.opened.OpenedShots]
    picture_queue: WorkerQueue[picture.state.PictureWorkerState]
    frame_cache: FrameCache
    metrics: Metrics
    live_sockets: set[WebSocket] = field(default_factory=set)
    run_id: str = field(default_factory=lambda: secrets.token_hex(8))

    @classmethod
    def start(cls, settings: Settings) -> Service:
        """Open the data folder and start the queues; their processes start with the first call.

        Raises:
            OutputError: the data folder cannot be written, or another service uses it.
        """
        store = ShotStore(settings.data)
        stage_queue = WorkerQueue(
            WorkerProcess("stage", stage.opened.OpenedShots),
            max_waiting=settings.max_waiting,
            timeout_s=settings.stage_timeout_s,
        )
        picture_queue = WorkerQueue(
            WorkerProcess("picture", picture.state.PictureWorkerState),
            max_waiting=settings.max_waiting,
            timeout_s=settings.frame_timeout_s,
        )
        frame_cache = FrameCache(settings.frame_cache_mb * MEBIBYTE)
        return cls(settings, store, stage_queue, picture_queue, frame_cache, Metrics((stage_queue, picture_queue)))

    @cached_property
    def long_exposures(self) -> LongExposures:
        """The long exposures of all shots."""
        return LongExposures(self.picture_queue, self.settings.max_picture_px)

    def close(self) -> None:
        """End the workers and release the data folder."""
        self.stage_queue.close()
        self.picture_queue.close()
        self.store.close()

    async def call_stage(
        self,
        function: Callable[Concatenate[stage.opened.OpenedShots, Arguments], Reply],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Reply:
        """Call a function in the stage process.

        Args:
            function: one of a module of `service.stage.calls`.
            *args: its arguments after the worker's state.
            **kwargs: its keyword arguments.

        Raises:
            PullfocusError: the function raised it.
            WorkerError: the worker did not complete the call.
        """
        return await self.stage_queue.result(call(function, *args, **kwargs))

    async def call_picture(
        self,
        function: Callable[Concatenate[picture.state.PictureWorkerState, Arguments], Reply],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Reply:
        """Call a function in the picture process.

        Args:
            function: one of a module of `service.picture.calls`.
            *args: its arguments after the worker's state.
            **kwargs: its keyword arguments.

        Raises:
            PullfocusError: the function raised it.
            WorkerError: the worker did not complete the call.
        """
        return await self.picture_queue.result(call(function, *args, **kwargs))

    def close_shot(self, shot_id: str) -> None:
        """Tell the workers to close a removed shot. Not awaited; a worker whose queue is full keeps the shot open."""
        with suppress(WorkerError):
            self.stage_queue.submit(call(stage.shots.close_shot, shot_id))
            self.picture_queue.submit(call(picture.frames.close_shot, shot_id))


def _service(connection: HTTPConnection) -> Service:
    service = connection.app.state.service
    assert isinstance(service, Service)
    return service


ServiceDep = Annotated[Service, Depends(_service)]
