"""The application: rooms, doors and the order in which a request meets them."""

from __future__ import annotations

import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI
from starlette.concurrency import run_in_threadpool

from render.errors import PullfocusError
from service.http.errors import ServiceError, install_error_handlers
from service.http.guard import GuardMiddleware
from service.http.hub import Hub
from service.http.metrics import MetricsMiddleware
from service.http.page import install_page
from service.http.routes import (
    cameras,
    curves,
    edits,
    focus,
    frames,
    lenses,
    libraries,
    live,
    long_exposure,
    metering,
    photography,
    shots,
    solving,
    system,
)
from service.http.settings import Settings
from service.picture.calls import frames as picture_frames
from service.stage.calls import shots as stage_shots
from service.workers.calls import call

log = logging.getLogger("pullfocus.service")

DESCRIPTION = """Shows a USD shot through a real lens: send a shot, look at graded frames, click on what must be sharp,
and take the keyframed focus curve away.

Times are USD time codes; lengths are metres in the scene and millimetres in the lens, and say so in their names; `null`
is an infinite distance, or one that does not exist. Every error is `{code, detail, path, errors}`."""
DEMO_ID = "demo"


def create_app(settings: Settings) -> FastAPI:
    """The service as an ASGI application. Nothing is opened or started before its lifespan begins.

    Args:
        settings: where it keeps shots, and its limits.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        hub = Hub.start(settings)
        app.state.hub = hub
        try:
            hub.pictures.submit(call(picture_frames.warm_up))  # not awaited: makes the first picture quicker
            if settings.demo:
                await _ensure_demo(hub)
            yield
        finally:
            hub.exposures.close()
            await run_in_threadpool(hub.close)

    app = FastAPI(
        title="Pullfocus",
        version=system.program_version(),
        description=DESCRIPTION,
        lifespan=lifespan,
        license_info={"name": "Apache-2.0", "identifier": "Apache-2.0"},
    )
    app.add_middleware(GuardMiddleware, settings=settings)
    app.add_middleware(MetricsMiddleware)
    install_error_handlers(app)
    lens = (cameras, photography, metering, lenses, libraries)
    for routes in (shots, edits, *lens, frames, live, long_exposure, focus, solving, curves):
        app.include_router(routes.router, prefix="/v1")
    app.include_router(system.router)
    live.describe_messages(app)
    install_page(app, settings.static)
    return app


async def _ensure_demo(hub: Hub) -> None:
    """Write the demo shot where there is none. A service without it is still a service."""
    if any(record.id == DEMO_ID for record in hub.store.list()):
        return
    begun = hub.store.begin("Demo shot", DEMO_ID)
    try:
        root = await hub.ask_stage(stage_shots.write_demo, begun.files)
        await run_in_threadpool(hub.store.accept, begun, root)
    except (PullfocusError, ServiceError) as error:
        log.error("the demo shot could not be written: %s", error)
        hub.store.discard(begun)
