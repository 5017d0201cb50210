"""Access of routes: the scope that each needs, and the shots that its sender may see.

A router or route declares its scope by ``dependencies=READS`` (or `EDITS`, `RENDERS`, `ADMINISTERS`). A route that needs to know
the sender takes a `PrincipalDep`. A route with a shot in its path answers 404 to those who may not see the project of that shot,
as if there were none. FastAPI receives the body of a request before it calls a route's dependencies: a route that takes a body is
a `service.http.bodies.BodyRoute`, which looks at the scopes and the shot earlier.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Annotated

from fastapi import Depends, Security
from fastapi.openapi.models import APIKey, HTTPBearer
from fastapi.openapi.models import SecurityBase as SecurityModel
from fastapi.params import Depends as DependsParameter
from fastapi.security import SecurityScopes
from fastapi.security.base import SecurityBase
from starlette.requests import HTTPConnection

from service.http.change_notes import note_edits
from service.http.errors import ServiceError
from service.http.service import Service, ServiceDep
from service.identity.principal import ALL_PROJECTS, NOBODY, Principal, ScopeName
from service.storage.store import not_found

SESSION_COOKIE = "pullfocus_session"


class _Scheme(SecurityBase):
    """Entry of the OpenAPI document; `IdentityMiddleware` reads the credentials, before the body of the request is received.

    Args:
        name: of the entry.
        model: the entry.
    """

    def __init__(self, name: str, model: SecurityModel) -> None:
        self.scheme_name = name
        self.model = model

    def __call__(self) -> None:
        """Do nothing."""


_BEARER = _Scheme("bearer", HTTPBearer(description="A key of this service, or a token of the issuer that it trusts."))
_COOKIE = _Scheme(
    "session",
    APIKey.model_validate(
        {"in": "cookie", "name": SESSION_COOKIE, "description": "The session of the page, from `POST /v1/session`."}
    ),
)


def principal_of(connection: HTTPConnection) -> Principal:
    """Return the sender of a request or the client of a WebSocket."""
    principal = getattr(connection.state, "principal", NOBODY)
    assert isinstance(principal, Principal)
    return principal


PrincipalDep = Annotated[Principal, Depends(principal_of)]


def _check(
    connection: HTTPConnection,
    service: ServiceDep,
    principal: PrincipalDep,
    needed: SecurityScopes,
    _bearer: Annotated[None, Depends(_BEARER)],
    _cookie: Annotated[None, Depends(_COOKIE)],
) -> None:
    """Refuse a sender without the scopes of a route, or who may not see its shot.

    Raises:
        ServiceError: 401 or 403.
        NotFoundError: there is no such shot, as far as the sender may know.
    """
    check_access(connection, service, principal, needed.scopes)


def check_access(connection: HTTPConnection, service: Service, principal: Principal, needed: Sequence[str]) -> None:
    """Refuse a sender without scopes, or who may not see the shot of the path.

    Args:
        connection: the request or WebSocket.
        service: the service.
        principal: the sender.
        needed: names of the scopes.

    Raises:
        ServiceError: 401 or 403.
        NotFoundError: there is no such shot, as far as the sender may know.
    """
    check_scopes(principal, needed)
    shot_id = connection.path_params.get("shot")
    if shot_id is None or principal.project == ALL_PROJECTS:
        return
    if not principal.sees(service.store.get(shot_id).project):
        raise not_found(shot_id)


def check_scopes(principal: Principal, needed: Iterable[str]) -> None:
    """Refuse a sender without scopes.

    Args:
        principal: the sender.
        needed: names of the scopes.

    Raises:
        ServiceError: 401 or 403.
    """
    if principal is NOBODY:
        raise unauthorized("This needs a key: send it as `Authorization: Bearer KEY`.")
    for scope in needed:
        if scope not in principal.scopes:
            held = ", ".join(sorted(principal.scopes)) or "none"
            detail = f"This needs the scope {scope!r}; {principal.label} has {held}."
            raise ServiceError(403, "missing_scope", detail, path=scope)


def unauthorized(detail: str, reason: str = "") -> ServiceError:
    """Return the error of a request without valid credentials.

    Args:
        detail: what is wrong.
        reason: parameter of the challenge that says so to programs (RFC 6750, section 3).
    """
    challenge = ", ".join(filter(None, ('Bearer realm="pullfocus"', reason)))
    return ServiceError(401, "unauthorized", detail, headers={"WWW-Authenticate": challenge})


def _needs(scope: ScopeName) -> Sequence[DependsParameter]:
    return (Security(_check, scopes=[scope]),)


READS = _needs("read")
EDITS = (*_needs("edit"), Depends(note_edits, scope="function"))
RENDERS = _needs("render")
ADMINISTERS = _needs("admin")
