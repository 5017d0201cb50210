"""State that all requests of one running service share: the store, the lanes of work, the caches and the counters."""

from __future__ import annotations

import asyncio
import logging
import os
import secrets
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Concatenate, ParamSpec, TypeVar

from fastapi import Depends
from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection

from render.errors import PullfocusError
from service.hidden_folders import hide_folder
from service.http.admission import Admission
from service.http.clients import present_client
from service.http.event_feed import EventFeed
from service.http.frame_cache import FrameCache
from service.http.lanes import Lanes
from service.http.live_places import LivePlaces
from service.http.long_exposures import LongExposures
from service.http.metrics import Metrics
from service.http.presence import Presence
from service.http.quarantine import Quarantine
from service.http.quotas import Quotas
from service.http.render_products import RenderProducts
from service.http.settings import MEBIBYTE, Settings
from service.http.stopping import Stopping
from service.http.viewers import Viewers
from service.http.webhook_delivery import Deliveries
from service.http.webhook_sending import Sender
from service.jobs.files import FolderFiles, FrameFiles
from service.jobs.queue import RenderQueue
from service.jobs.shared_storage import SharedStorage
from service.models.shots import Shot
from service.picture import calls as picture
from service.stage import calls as stage
from service.storage.bucket import Bucket
from service.storage.database.connection import open_database
from service.storage.events import EventLog
from service.storage.folder_id import folder_id
from service.storage.store import ShotRecord, ShotStore, not_found
from service.storage.trash import Trash
from service.storage.webhooks import Webhooks
from service.workers.caches import Caches
from service.workers.calls import call
from service.workers.forking import Template
from service.workers.jobs import Finished
from service.workers.places import Place
from service.workers.pool import WorkerPool
from service.workers.sandbox import support, worker_environment

log = logging.getLogger("pullfocus.service")

Arguments = ParamSpec("Arguments")
Reply = TypeVar("Reply")


@dataclass(frozen=True)
class Service:
    """One running service.

    Attributes:
        settings: its limits.
        store: the shots on disk.
        trash: the shots that were deleted.
        quarantine: shots that have ended too many workers.
        quotas: judge what senders and projects may use.
        pool: the worker processes.
        caches: their cache folders.
        lanes: the work that waits for them.
        admission: judges what pictures cost.
        frame_cache: encoded pictures, by their entity tag.
        metrics: counters.
        events: the log of events.
        feed: those who follow it.
        webhooks: receivers that it is sent to.
        renders: the queue of renders.
        render_files: frames that they have drawn.
        shared: the bucket where these are; None where they are in the data folder.
        renders_wake: set when a render was sent, or a frame has ended.
        products_wake: set when a render was sent, or a frame or product has ended.
        presence: who looks at which shot.
        viewers: those of them who see each other, and at which frame they are.
        stopping: whether it is stopping.
        preparing: set while it does in advance, after its start, what makes the first picture late.
        run_id: changes with each start: the same inputs may give other pixels after an update.
    """

    settings: Settings
    store: ShotStore
    trash: Trash
    quarantine: Quarantine
    quotas: Quotas
    pool: WorkerPool
    caches: Caches
    lanes: Lanes
    admission: Admission
    frame_cache: FrameCache
    metrics: Metrics
    events: EventLog
    feed: EventFeed
    webhooks: Webhooks
    renders: RenderQueue
    render_files: FrameFiles
    shared: SharedStorage | None
    renders_wake: asyncio.Event = field(default_factory=asyncio.Event)
    products_wake: asyncio.Event = field(default_factory=asyncio.Event)
    presence: Presence = field(default_factory=Presence)
    viewers: Viewers = field(default_factory=Viewers)
    stopping: Stopping = field(default_factory=Stopping)
    preparing: asyncio.Event = field(default_factory=asyncio.Event)
    run_id: str = field(default_factory=lambda: secrets.token_hex(8))

    @classmethod
    def start(cls, settings: Settings) -> Service:
        """Open the data folder and start the lanes; their processes start with the first call.

        Raises:
            OutputError: the data folder cannot be written, another service uses it, or the database or bucket cannot be used.
            SettingsError: the database or bucket is none that can be used.
        """
        store = ShotStore(settings.data)
        try:
            shared = _open_shared(settings)
            database = open_database(settings.data, settings.database)
            holder = folder_id(settings.data)
            events = EventLog(database)
            renders = RenderQueue(database, events, holder=holder, has_bucket=shared is not None)
            if shared is not None:
                shared.claim(renders.totals.database_id())
        except (PullfocusError, OSError):
            store.close()
            raise
        trash = Trash(settings.data, settings.trash_days)
        quarantine = Quarantine(store, settings.max_blames)
        quotas = Quotas(settings, store, trash, renders)
        hide_folder(settings.cache)
        environment = worker_environment(os.environ)
        caches = Caches(settings.cache, environment, settings.worker_disk_mb * MEBIBYTE)
        log.info(support().describe())
        pool = WorkerPool(
            Template(picture.PRELOAD, environment),
            max_bytes=settings.kept_memory_mb * MEBIBYTE,
            gpus=settings.gpus,
            caches=caches,
            on_blame=quarantine.blame,
        )
        metrics = Metrics(pool)
        admission = Admission(settings.max_picture_s, settings.max_picture_px)

        def note_finished(finished: Finished) -> None:
            metrics.note_finished(finished)
            admission.learn(finished)
            quotas.note_finished(finished)

        lanes = Lanes.start(settings, pool, note_finished)
        metrics.watch(lanes)
        metrics.watch_renders(renders)
        frame_cache = FrameCache(settings.frame_cache_mb * MEBIBYTE)
        files = shared.frames if shared is not None else FolderFiles(settings.data)
        return cls(
            settings,
            store,
            trash,
            quarantine,
            quotas,
            pool,
            caches,
            lanes,
            admission,
            frame_cache,
            metrics,
            events,
            EventFeed(events),
            Webhooks(database),
            renders,
            files,
            shared,
        )

    @cached_property
    def live_places(self) -> LivePlaces:
        """The places of live connections."""
        return LivePlaces(self.settings.max_viewers)

    @cached_property
    def event_places(self) -> LivePlaces:
        """The places of those who follow events."""
        return LivePlaces(self.settings.max_viewers)

    @cached_property
    def deliveries(self) -> Deliveries:
        """The deliveries to webhooks."""
        allows_private = self.settings.webhook_private
        if allows_private is None:
            allows_private = self.settings.access == "open"
        sender = Sender(allows_private, lambda outcome: self.metrics.webhook_deliveries.labels(outcome).inc())
        return Deliveries(self.webhooks, self.feed, sender, self.run_id)

    @cached_property
    def long_exposures(self) -> LongExposures:
        """The long exposures of all shots."""
        return LongExposures(self.lanes.exposure, self.place_of)

    @cached_property
    def render_products(self) -> RenderProducts:
        """The movies and contact sheets of all renders."""
        return RenderProducts(self.lanes.final, self.renders, self.render_files, self.quotas)

    def close(self) -> None:
        """End the workers and release the data folder."""
        self.lanes.close()
        self.pool.close()
        self.caches.close()
        self.quotas.cpu.save()
        self.renders.close()
        self.store.close()

    async def call_stage(
        self,
        function: Callable[Concatenate[stage.opened.OpenedShot, Arguments], Reply],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Reply:
        """Call a function in the stage worker of the shot that it is about.

        Args:
            function: one of a module of `service.stage.calls`.
            *args: its arguments after the worker's state; the first is the record of the shot, if it is about one.
            **kwargs: its keyword arguments.

        Raises:
            PullfocusError: the function raised it.
            WorkerError: the worker did not complete the call.
            ServiceError: 423, the shot is in quarantine.
        """
        place = self.place_of(_record_among(args), may_edit=True)
        return await self.lanes.stage.result(call(function, *args, **kwargs), place, present_client())

    async def call_reader(
        self,
        function: Callable[Concatenate[stage.opened.OpenedShot, ShotRecord, str, Arguments], Reply],
        record: ShotRecord,
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Reply:
        """Call a function that may take long and edits nothing, in a worker that keeps no edit of the shot waiting.

        Args:
            function: one of a module of `service.stage.calls`, which gets the present edits after the shot.
            record: the shot.
            *args: its other arguments.
            **kwargs: its keyword arguments.

        Raises:
            PullfocusError: the function raised it; and the other errors of `call_stage`.
        """
        edits = await run_in_threadpool(record.edit_text)
        return await self.call_reader_at(function, record, edits, *args, **kwargs)

    async def call_reader_at(
        self,
        function: Callable[Concatenate[stage.opened.OpenedShot, ShotRecord, str, Arguments], Reply],
        record: ShotRecord,
        edits: str,
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Reply:
        """Call a function as `call_reader` does, on a shot with other edits than the present ones.

        Args:
            function: one of a module of `service.stage.calls`.
            record: the shot.
            edits: text of the edit layer.
            *args: its other arguments.
            **kwargs: its keyword arguments.

        Raises:
            PullfocusError: the function raised it; and the other errors of `call_stage`.
        """
        wanted = call(function, record, edits, *args, **kwargs)
        return await self.lanes.read.result(wanted, self.place_of(record), present_client())

    async def call_picture(
        self,
        function: Callable[Concatenate[picture.state.PictureWorkerState, Arguments], Reply],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Reply:
        """Call a function in the live picture worker of the shot that it is about; see `call_stage`."""
        place = self.place_of(_record_among(args))
        return await self.lanes.live.result(call(function, *args, **kwargs), place, present_client())

    async def check_upload(self, begun: ShotRecord) -> Shot:
        """Open an upload for the first time, in a process of its own that ends afterwards.

        Raises:
            PullfocusError: the upload cannot be shown.
            WorkerError: the process ended or took too long.
        """
        place = Place(begun.id, (begun.files, *self.settings.worker_read))
        return await self.lanes.check.result(call(stage.shots.describe_shot, begun), place, present_client())

    async def write_demo(self, begun: ShotRecord) -> str:
        """Author the demo shot in the folder of a new shot, and return its root layer. Raises `OutputError`, `WorkerError`."""
        place = Place(begun.id, (), (begun.files,))
        return await self.lanes.check.result(call(stage.shots.write_demo, begun.files), place)

    def place_of(self, record: ShotRecord | None, *, may_edit: bool = False) -> Place:
        """Return what a worker that serves a shot may see.

        Args:
            record: the shot; None for work that is about none.
            may_edit: whether it may write the shot's edits.

        Raises:
            ServiceError: 423, the shot is in quarantine; 429, the present client has used up its processor time.
            NotFoundError: the shot was deleted meanwhile.
        """
        self.quotas.check_work()
        if record is None:
            return Place(read=self.settings.worker_read)
        self.quarantine.check(record)
        if may_edit:
            try:
                record.edits_folder.mkdir(exist_ok=True)  # a sandbox lets a worker write to folders that exist
            except FileNotFoundError as error:
                raise not_found(record.id) from error
        write = (record.edits_folder,) if may_edit else ()
        return Place(record.id, (record.files, *self.settings.worker_read), write)

    async def close_shot(self, shot_id: str) -> None:
        """End the workers of a shot that was deleted or restored."""
        await run_in_threadpool(self.pool.close_place, shot_id)


def _open_shared(settings: Settings) -> SharedStorage | None:
    """Open the bucket of the settings; None without one. Raises `SettingsError`, `OutputError`: it cannot be used."""
    if not settings.bucket:
        return None
    bucket = Bucket(settings.bucket, settings.bucket_endpoint)
    return SharedStorage.open(bucket, settings.data, settings.fetched_mb * MEBIBYTE)


def _record_among(arguments: Sequence[object]) -> ShotRecord | None:
    """Return the shot that a call is about: its first argument, where that is a shot."""
    first = arguments[0] if arguments else None
    return first if isinstance(first, ShotRecord) else None


def service_of(connection: HTTPConnection) -> Service:
    """Return the service that a request or WebSocket is sent to."""
    service = connection.app.state.service
    assert isinstance(service, Service)
    return service


ServiceDep = Annotated[Service, Depends(service_of)]
