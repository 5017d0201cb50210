"""Routes of webhooks: receivers that events are sent to."""

from __future__ import annotations

import secrets
from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path
from starlette.concurrency import run_in_threadpool

from service.http.access import ADMINISTERS, PrincipalDep
from service.http.bodies import BodyRoute
from service.http.errors import ServiceError
from service.http.receiver_addresses import check_url
from service.http.routes.parameters import problems
from service.http.service import ServiceDep
from service.identity.principal import ALL_PROJECTS
from service.models.webhooks import NewWebhook, Webhook, WebhookAnswer, WebhookList, WebhookRequest
from service.storage.database.tables import WebhookRow
from service.storage.events import Wanted
from service.storage.webhooks import MOST_WEBHOOKS

router = APIRouter(tags=["events"], route_class=BodyRoute, dependencies=ADMINISTERS)

SECRET_BYTES = 32

WebhookId = Annotated[
    str, Path(alias="webhook", max_length=80, description="A webhook's id.", examples=["w-3f2a9c51d07b"])
]


def _project(principal: PrincipalDep) -> str | None:
    """Return the project whose webhooks a sender sees; None for all."""
    return None if principal.project == ALL_PROJECTS else principal.project


ProjectDep = Annotated[str | None, Depends(_project)]


@router.get("/webhooks", operation_id="listWebhooks")
async def list_webhooks(service: ServiceDep, project: ProjectDep) -> WebhookList:
    """List the webhooks that you may see, with how their deliveries go, and without their secrets."""
    rows = await run_in_threadpool(service.webhooks.list, project)
    return WebhookList(webhooks=[Webhook(**_shown(row)) for row in rows])


@router.post("/webhooks", operation_id="createWebhook", status_code=201, responses=problems(409))
async def create_webhook(service: ServiceDep, project: ProjectDep, request: WebhookRequest) -> NewWebhook:
    """Have the events from now on sent to a URL. Who sees one project has those of that project sent.

    The answer shows the secret that deliveries are signed with, once.
    """
    check_url(request.url)
    secret = request.secret or f"whsec_{secrets.token_urlsafe(SECRET_BYTES)}"
    wanted = Wanted(project or request.project, list(dict.fromkeys(request.topics)), request.shot, request.render)
    row = await run_in_threadpool(service.webhooks.add, request.url, secret, wanted)
    if row is None:
        detail = f"There are {MOST_WEBHOOKS} webhooks, as many as a service has; delete one first."
        raise ServiceError(409, "too_many_webhooks", detail)
    service.deliveries.wake.set()
    return NewWebhook(**_shown(row), secret=secret)


@router.delete("/webhooks/{webhook}", operation_id="deleteWebhook", status_code=204, responses=problems(404))
async def delete_webhook(service: ServiceDep, project: ProjectDep, webhook: WebhookId) -> None:
    """Delete a webhook: nothing is sent to it from now on, but for a try that has begun."""
    await run_in_threadpool(service.webhooks.remove, webhook, project)
    service.deliveries.wake.set()


@router.post("/webhooks/{webhook}/test", operation_id="testWebhook", responses=problems(404))
async def test_webhook(service: ServiceDep, project: ProjectDep, webhook: WebhookId) -> WebhookAnswer:
    """Send the event `test` to the receiver now, once, and tell what it answers, also where the webhook is disabled."""
    row = await run_in_threadpool(service.webhooks.get, webhook, project)
    return WebhookAnswer.model_validate(await service.deliveries.test(row))


@router.post("/webhooks/{webhook}/enable", operation_id="enableWebhook", responses=problems(404))
async def enable_webhook(service: ServiceDep, project: ProjectDep, webhook: WebhookId) -> Webhook:
    """Let a webhook that was disabled go on after the last event that its receiver has got."""
    row = await run_in_threadpool(service.webhooks.enable, webhook, project)
    service.deliveries.wake.set()
    return Webhook(**_shown(row))


def _shown(row: WebhookRow) -> dict[str, Any]:
    """Return a webhook as it is shown, without its secret."""
    return {
        "id": row.id,
        "url": row.url,
        "project": row.project,
        "topics": row.topics,
        "shot": row.shot,
        "render": row.render,
        "created_at": datetime.fromtimestamp(row.created_at, UTC),
        "after": row.after,
        "last_status": row.last_status,
        "last_error": row.last_error,
        "failures": row.failures,
        "next_try_at": None if row.next_try_at is None else datetime.fromtimestamp(row.next_try_at, UTC),
        "disabled": row.disabled,
    }
