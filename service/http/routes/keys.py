"""Routes of the page's session and of keys."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Annotated

from fastapi import APIRouter, Path, Request, Response
from starlette.concurrency import run_in_threadpool

from service.http.access import ADMINISTERS, SESSION_COOKIE, PrincipalDep, unauthorized
from service.http.addresses import counted_address
from service.http.bodies import BodyRoute
from service.http.clients import present_client
from service.http.identity import IdentityDep
from service.http.routes.parameters import problems
from service.http.service import ServiceDep
from service.identity.principal import NOBODY
from service.identity.roles import scopes_of
from service.identity.sessions import SESSION_S
from service.models.keys import KeyList, KeyRequest, KeySummary, NewKey, SignIn, Who

router = APIRouter(tags=["identity"], route_class=BodyRoute)

KeyId = Annotated[str, Path(alias="key", max_length=80, description="A key's id.", examples=["3f2a9c51d07b"])]


@router.post("/session", operation_id="signIn", responses=problems())
async def sign_in(request: Request, response: Response, identity: IdentityDep, sent: SignIn) -> Who:
    """Exchange a key for a session: a cookie that the page's scripts cannot read. Programs send the key itself instead."""
    key = identity.sign_in(sent.key.strip(), counted_address(request.scope))
    request.state.principal = key.principal()
    token = identity.sessions.begin(key.id)
    response.set_cookie(
        SESSION_COOKIE,
        token,
        max_age=SESSION_S,
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
    )
    return Who.model_validate(identity.in_session(key, token))


@router.get("/session", operation_id="whoAmI")
async def who_am_i(service: ServiceDep, principal: PrincipalDep) -> Who:
    """Tell who one is. The answer is 401 where a key is needed and none was sent."""
    if principal is NOBODY:
        raise unauthorized("This needs a key: send it as `Authorization: Bearer KEY`, or sign in.")
    usage = await run_in_threadpool(service.quotas.usage, present_client().principal, principal.project)
    return Who.model_validate(principal).model_copy(update={"usage": usage})


@router.delete("/session", operation_id="signOut", status_code=204)
async def sign_out(request: Request, response: Response, identity: IdentityDep) -> None:
    """End the session. It is no error if there is none."""
    identity.sessions.end(request.cookies.get(SESSION_COOKIE, ""))
    response.delete_cookie(SESSION_COOKIE, path="/", httponly=True, samesite="strict")


@router.get("/keys", operation_id="listKeys", dependencies=ADMINISTERS)
async def list_keys(identity: IdentityDep) -> KeyList:
    """List all keys, without their secrets."""
    return KeyList(keys=[KeySummary.model_validate(key) for key in await run_in_threadpool(identity.keys.list)])


@router.post("/keys", operation_id="createKey", status_code=201, responses=problems(), dependencies=ADMINISTERS)
async def create_key(identity: IdentityDep, request: KeyRequest) -> NewKey:
    """Create a key. The answer shows it once: only a hash of it is kept."""
    expires_at = datetime.now(UTC) + timedelta(days=request.days) if request.days else None
    scopes = scopes_of(request.roles)
    key, text = await run_in_threadpool(identity.keys.create, request.label, scopes, request.project, expires_at)
    return NewKey(**KeySummary.model_validate(key).model_dump(), key=text)


@router.delete(
    "/keys/{key}", operation_id="revokeKey", status_code=204, responses=problems(404), dependencies=ADMINISTERS
)
async def revoke_key(identity: IdentityDep, key: KeyId) -> None:
    """Revoke a key: it is refused from now on, and the sessions that it began end."""
    await run_in_threadpool(identity.keys.revoke, key)
