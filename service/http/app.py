"""The application: its routes, its middleware and its lifespan."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from typing import Any

from fastapi import FastAPI
from starlette.concurrency import run_in_threadpool

from render.errors import OutputError, PullfocusError
from service.hidden_folders import hide_folder
from service.http.auditing import AuditMiddleware
from service.http.bucket_upkeep import tidy_bucket
from service.http.cache_upkeep import end_greedy_workers, fill_caches, retry_filling
from service.http.change_notes import note_presence
from service.http.clients import ClientMiddleware
from service.http.errors import install_error_handlers
from service.http.guard import GuardMiddleware
from service.http.identity import Identity, IdentityMiddleware
from service.http.last_shot import draw_last_shot
from service.http.metrics import MetricsMiddleware
from service.http.page import install_page
from service.http.product_runner import make_products
from service.http.reference import install_reference
from service.http.render_runner import run_renders
from service.http.request_context import RequestContextMiddleware
from service.http.routes import (
    cameras,
    choices,
    curves,
    edits,
    events,
    exposure_maps,
    focus,
    frames,
    keys,
    lenses,
    libraries,
    live,
    long_exposure,
    metering,
    notes,
    photography,
    quarantine,
    render_logs,
    render_plans,
    render_products,
    render_reports,
    renders,
    shots,
    solving,
    system,
    trash,
    webhooks,
)
from service.http.routes.parameters import refusals
from service.http.security_headers import SecurityHeadersMiddleware
from service.http.service import Service
from service.http.settings import Settings
from service.http.stopping import StoppingMiddleware
from service.http.tracing import install_tracing
from service.workers.errors import WorkerError

log = logging.getLogger("pullfocus.service")

DESCRIPTION = """Shows a USD shot through a real lens: send a shot, look at graded frames, click on what must be sharp,
and take the keyframed focus curve away.

Times are USD time codes; lengths are metres in the scene and millimetres in the lens, and say so in their names; `null`
is an infinite distance, or one that does not exist. Every error is `{code, detail, path, errors}`."""
DEMO_ID = "demo"
SAVING_PAUSE_S = 30.0
"""Time between two saves of the processor time that was used, which a killed service forgets."""
EMPTYING_PAUSE_S = 600.0
"""Time between two looks at what has been in the trash, or among the events, for long enough."""
DAY_S = 86_400.0


def create_app(settings: Settings) -> FastAPI:
    """The service as an ASGI application. Nothing is opened or started before its lifespan begins.

    Args:
        settings: where it keeps shots, and its limits.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        service = Service.start(settings)
        app.state.service = service
        upkeep = [_begin(work, service) for work in WORKS]
        try:
            if settings.demo:
                await _ensure_demo(service)
            upkeep.append(_begin(_prepare_pictures, service))
            yield
        finally:
            for task in upkeep:
                task.cancel()
            await asyncio.gather(*upkeep, return_exceptions=True)
            service.long_exposures.close()
            await run_in_threadpool(service.close)
            await run_in_threadpool(end_tracing)

    hide_folder(settings.data)
    app = FastAPI(
        title="Pullfocus",
        version=system.program_version(),
        description=DESCRIPTION,
        lifespan=lifespan,
        docs_url=None,  # their pages come from a foreign host
        redoc_url=None,
        license_info={"name": "Apache-2.0", "identifier": "Apache-2.0"},
    )
    app.state.identity = Identity(settings)
    app.add_middleware(IdentityMiddleware, identity=app.state.identity)
    app.add_middleware(GuardMiddleware, settings=settings)
    app.add_middleware(ClientMiddleware)
    app.add_middleware(AuditMiddleware, identity=app.state.identity)
    app.add_middleware(StoppingMiddleware)
    app.add_middleware(MetricsMiddleware)
    install_error_handlers(app)
    app.add_middleware(SecurityHeadersMiddleware)
    app.add_middleware(RequestContextMiddleware)
    end_tracing = install_tracing(app, settings)
    lens = (cameras, photography, metering, lenses, libraries)
    for routes in (
        shots,
        trash,
        quarantine,
        edits,
        choices,
        notes,
        *lens,
        frames,
        exposure_maps,
        live,
        long_exposure,
        focus,
        solving,
        curves,
        renders,
        events,
        render_logs,
        render_plans,
        render_products,
        render_reports,
        webhooks,
        keys,
    ):
        app.include_router(routes.router, prefix="/v1", responses=refusals())
    app.include_router(render_products.thumbnails, prefix="/v1", responses=refusals())
    app.include_router(system.router)
    live.describe_messages(app)
    install_reference(app)
    install_page(app, settings.static)
    return app


async def _follow_events(service: Service) -> None:
    """Tell those who follow events of new ones."""
    await service.feed.run()


def _begin(work: Callable[[Service], Coroutine[Any, Any, None]], service: Service) -> asyncio.Task[None]:
    """Begin work in the background. What ends it before the service does is logged."""

    def log_end(task: asyncio.Task[None]) -> None:
        if not task.cancelled() and task.exception() is not None:
            log.error("work in the background has failed: %s", task.get_name(), exc_info=task.exception())

    task = asyncio.create_task(work(service), name=work.__name__)
    task.add_done_callback(log_end)
    return task


async def _prepare_pictures(service: Service) -> None:
    """Do in advance what makes the first picture late."""
    service.preparing.set()
    try:
        is_filled = await fill_caches(service)
        await draw_last_shot(service)
    finally:
        service.preparing.clear()
    if not is_filled:
        await retry_filling(service)


async def _save_usage(service: Service) -> None:
    """Save what processor time was used, now and then."""
    while True:
        await asyncio.sleep(SAVING_PAUSE_S)
        await run_in_threadpool(service.quotas.cpu.save)


async def _deliver_webhooks(service: Service) -> None:
    """Send events to the webhooks."""
    await service.deliveries.run()


async def _forget_events(service: Service) -> None:
    """Forget old events, now and then."""
    while True:
        try:
            await run_in_threadpool(service.events.prune, service.settings.event_days * DAY_S)
        except OutputError as error:
            log.error("old events cannot be forgotten: %s", error)
        await asyncio.sleep(EMPTYING_PAUSE_S)


async def _empty_trash(service: Service) -> None:
    """Remove what has been in the trash for long enough, now and then."""
    while True:
        try:
            count = await run_in_threadpool(service.trash.empty)
            if count:
                log.info("%d shots were removed from the trash", count)
        except OSError as error:
            log.error("the trash could not be emptied: %s", error)
        await asyncio.sleep(EMPTYING_PAUSE_S)


async def _ensure_demo(service: Service) -> None:
    """Write the demo shot where there is none. A service without it is still a service."""
    if any(record.id == DEMO_ID for record in service.store.list()):
        return
    try:
        begun = service.store.begin("Demo shot", DEMO_ID)
        try:
            root = await service.write_demo(begun)
            await run_in_threadpool(service.store.accept, begun, root)
        except BaseException:
            service.store.discard(begun)
            raise
    except (OSError, PullfocusError, WorkerError) as error:
        log.error("the demo shot could not be written, the service runs without it: %s", error)


WORKS = (
    _empty_trash,
    _save_usage,
    note_presence,
    _follow_events,
    _forget_events,
    _deliver_webhooks,
    end_greedy_workers,
    run_renders,
    make_products,
    tidy_bucket,
)
"""Work in the background of a service."""
