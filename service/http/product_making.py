"""Recipes of the products of renders: how each of them is made, for the job of the render or for who asks for it."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Any, cast

from starlette.concurrency import run_in_threadpool

from render.errors import InputError, NotFoundError
from service.http.errors import ServiceError
from service.http.render_products import Product
from service.http.render_shots import shot_of
from service.http.service import Service
from service.jobs.frame_ranges import format_frames, parse_frames
from service.models.curve import CurveFileFormat
from service.models.focus_reports import ReportedRender, ReportFormat
from service.models.render_products import ProductName
from service.picture.calls import render_products as calls
from service.stage.calls import curves, focus_reports
from service.storage.database.tables import RenderRow
from service.storage.store import ShotRecord
from service.workers.calls import call

DEFAULT_RATE = 24.0
"""Time codes per second of USD, for renders whose frames were drawn before the service noted them."""


async def find_product(service: Service, render: RenderRow, name: ProductName) -> Product:
    """Return a product of a render, which is made where it is missing.

    Args:
        service: that has the render.
        render: it has drawn its frames, where the product needs pictures.
        name: of the product.

    Raises:
        ServiceError: as `RenderProducts.find`; 404, the shot is gone.
        PullfocusError: it cannot be made.
        WorkerError: the worker ended, or took too long.
    """
    products = service.render_products
    kind, _, suffix = name.partition(".")
    match kind:
        case "movie":
            rate = render.time_codes_per_second or DEFAULT_RATE
            return await products.find(
                render, name, lambda frames, path: call(calls.write_movie, render.name, frames, rate, path)
            )
        case "contact-sheet":
            return await products.find(
                render, name, lambda frames, path: call(calls.write_contact_sheet, render.name, frames, path)
            )
        case "focus-report":
            wanted = reported(render, parse_frames(render.frames))
            return await products.find_text(
                render, name, lambda: write_report(service, render, wanted, cast(ReportFormat, suffix))
            )
        case _:
            return await products.find_text(
                render, name, lambda: write_curve(service, render, cast(CurveFileFormat, suffix))
            )


def reported(render: RenderRow, frames: list[int]) -> ReportedRender:
    """Return what a focus report of a render is about."""
    return ReportedRender(
        id=render.id,
        shot=render.shot,
        revision=render.revision,
        camera=render.request["camera"],
        width=render.request["width"],
        height=render.request["height"],
        frames=tuple(frames),
        range=format_frames(frames),
    )


async def write_report(service: Service, render: RenderRow, wanted: ReportedRender, suffix: ReportFormat) -> str:
    """Write the focus report of a render.

    Raises:
        ServiceError: 404, the shot is gone.
        PullfocusError: it cannot be made.
        WorkerError: the worker ended, or took too long.
    """
    return await _read(service, render, "focus report", focus_reports.report_focus, wanted, suffix)


async def write_curve(service: Service, render: RenderRow, suffix: CurveFileFormat) -> str:
    """Write the focus curve of the frames of a render; raises the errors of `write_report`."""
    frames = parse_frames(render.frames)
    return await _read(
        service, render, "focus curve", curves.compute_curve_at, render.request["camera"], frames, suffix
    )


async def _read(service: Service, render: RenderRow, noun: str, function: Any, *args: object) -> str:
    """Read something of the shot of a render, with the edits that the render keeps.

    Raises `ServiceError` 409: it cannot be read.
    """
    edits = await run_in_threadpool(service.renders.lookups.edits, render.id)
    with ExitStack() as stack:
        record = await _shot_of(service, render, noun, stack)
        try:
            return cast(str, await service.call_reader_at(function, record, edits, *args))
        except NotFoundError:
            raise
        except (
            InputError
        ) as error:  # the render's camera is none, or its values are impossible: the request is in order
            detail = f"The {noun} of render {render.id!r} cannot be made: {error.detail}"
            raise ServiceError(409, error.code, detail, path="render") from error


async def _shot_of(service: Service, render: RenderRow, noun: str, stack: ExitStack) -> ShotRecord:
    """Return the shot of a render, of which only frames may be left. Raises `ServiceError` 404: it was deleted, or replaced."""
    try:
        return await shot_of(service, render, stack)
    except InputError as error:
        detail = (
            f"The {noun} of render {render.id!r} needs the shot that it was sent with, which is gone: {error.detail}"
        )
        raise ServiceError(404, error.code, detail, path="render") from error
