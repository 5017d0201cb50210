"""Readiness of the service: whether it can do the next piece of work."""

from __future__ import annotations

import asyncio
import shutil
import tempfile
from collections.abc import Awaitable
from pathlib import Path

from starlette.concurrency import run_in_threadpool

from render.errors import OutputError
from service.http.errors import RETRY_AFTER, ServiceError
from service.http.service import Service
from service.http.settings import MEBIBYTE
from service.picture.calls import frames
from service.stage.calls import opened
from service.workers.errors import WorkerError

ANSWER_WITHIN_S = 10.0


async def check_ready(service: Service) -> None:
    """Check that data folder, database and bucket can be used, that no lane is held up, and that workers answer.

    Raises:
        ServiceError: 503, it is not so.
        GraphicsError: no picture can be drawn on this machine.
    """
    await run_in_threadpool(_check_folder, service.settings.data, service.settings.min_free_mb)
    await _check_stores(service)
    _check_lanes(service)
    await _check_workers(service)


def _check_folder(folder: Path, min_free_mb: int) -> None:
    try:
        with tempfile.TemporaryFile(dir=folder, buffering=0) as file:
            file.write(b"ready")
        free_mb = shutil.disk_usage(folder).free // MEBIBYTE
    except OSError as error:
        raise _not_ready(f"The data folder cannot be written: {error.strerror}.") from error
    if free_mb < min_free_mb:
        raise _not_ready(
            f"The disk of the data folder has {free_mb} MiB free, less than {min_free_mb} MiB (min_free_mb); make room on it."
        )


async def _check_stores(service: Service) -> None:
    """Check that the database and the bucket of renders answer."""
    try:
        async with asyncio.timeout(ANSWER_WITHIN_S):
            await run_in_threadpool(service.renders.check)
            if service.shared is not None:
                await run_in_threadpool(service.shared.bucket.check)
    except TimeoutError as error:
        raise _not_ready(f"The database or the bucket did not answer within {ANSWER_WITHIN_S:g} s.") from error
    except OutputError as error:
        raise _not_ready(f"{error.detail[:1].upper()}{error.detail[1:]}.") from error


def _check_lanes(service: Service) -> None:
    for lane in service.lanes:
        age_s = lane.oldest_waiting_s
        if age_s > service.settings.max_lane_age_s:
            raise _not_ready(f"A request has waited for the {lane.role.name} lane for {age_s:.0f} s.")


async def _check_workers(service: Service) -> None:
    # In a thread that is left alone where it takes too long: a template that does not answer is replaced there.
    await _check_process("template of the workers", asyncio.to_thread(service.pool.template.check, ANSWER_WITHIN_S))
    await _check_process("stage worker", service.call_stage(opened.warm_up))
    await _check_process("picture worker", service.call_picture(frames.warm_up))


async def _check_process(name: str, answer: Awaitable[None]) -> None:
    try:
        async with asyncio.timeout(ANSWER_WITHIN_S):
            await answer
    except TimeoutError as error:
        raise _not_ready(f"The {name} did not answer within {ANSWER_WITHIN_S:g} s.") from error
    except WorkerError as error:
        raise _not_ready(f"The {name} did not answer: {error}") from error


def _not_ready(detail: str) -> ServiceError:
    return ServiceError(503, "not_ready", detail, headers=RETRY_AFTER)
