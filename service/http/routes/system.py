"""Routes of liveness, readiness, metrics and version."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from typing import Literal

from fastapi import APIRouter, Response
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from service.http.access import ADMINISTERS
from service.http.readiness import check_ready
from service.http.routes.parameters import problems, refusals
from service.http.service import ServiceDep
from service.models.base import Model, shown_as

router = APIRouter(tags=["system"])


class Health(Model):
    """Answer of a service that is alive."""

    model_config = shown_as({"status": "ok"})

    status: Literal["ok"] = "ok"


class Readiness(Health):
    """Answer of a service that is ready."""

    model_config = shown_as({"status": "ok", "warming": False})

    warming: bool = Field(
        description="Whether shaders are compiled, or the last shot is drawn, in advance: the first picture takes longer."
    )


class Version(Model):
    """Name and version of the program."""

    model_config = shown_as({"name": "pullfocus", "version": "0.1.0"})

    name: str
    version: str


@router.get("/livez", operation_id="livez")
async def livez() -> Health:
    """Answer while the HTTP process runs."""
    return Health()


@router.get("/readyz", operation_id="readyz", responses=problems(503))
async def readyz(service: ServiceDep) -> Readiness:
    """Answer while workers answer, the data folder can be written and no request has waited for long."""
    await check_ready(service)
    return Readiness(warming=service.preparing.is_set() or service.caches.is_filling)


@router.get(
    "/metrics",
    operation_id="metrics",
    dependencies=ADMINISTERS,
    response_class=Response,
    responses=refusals()
    | {
        200: {
            "content": {
                "text/plain": {
                    "schema": {"type": "string"},
                    "example": 'pullfocus_lane_waiting{worker="picture"} 0.0\n',
                }
            }
        }
    },
)
async def metrics(service: ServiceDep) -> Response:
    """Report counters in Prometheus' text format."""
    text = await run_in_threadpool(service.metrics.text)  # which asks the database
    return Response(text, media_type="text/plain; version=0.0.4; charset=utf-8")


@router.get("/version", operation_id="version")
async def get_version() -> Version:
    """Report the version of the program."""
    return Version(name="pullfocus", version=program_version())


def program_version() -> str:
    """Return the version of the installed distribution."""
    try:
        return version("pullfocus")
    except PackageNotFoundError:
        return "unpackaged"
