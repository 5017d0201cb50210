"""Identity of requests: ASGI middleware that finds out who sends a request, before its body is received."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Annotated

from fastapi import Depends
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.requests import HTTPConnection, cookie_parser
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket

from service.http.access import SESSION_COOKIE, unauthorized
from service.http.addresses import address_of, counted_address
from service.http.errors import ServiceError, answer_to
from service.http.guard import SAFE_METHODS
from service.http.request_context import request_id
from service.http.settings import Settings
from service.http.token_settings import tokens_of
from service.identity.audit import AuditLog
from service.identity.errors import IssuerError, NoRoleError, TokenError
from service.identity.keys import KEY_PREFIX, Key, Keys
from service.identity.principal import ANYONE, NOBODY, Principal
from service.identity.rate import RateLimit
from service.identity.sessions import Sessions
from service.identity.tokens import looks_like_token

BURST_S = 10
"""Seconds of the allowed rate of requests that may come at once."""
FAILURES, FAILURES_PER_S = 10, 1 / 6
"""Wrong keys that one address may send at once, and from then on."""
SESSION_PATH = "/v1/session"
REFUSALS = (401, 403, 421, 429)
"""Statuses of answers that refuse the sender."""
MAX_AUDITED_PATH = 500
"""Characters of a path that the audit log keeps."""


class Identity:
    """Keys, tokens, sessions, limits and audit log of one service.

    Args:
        settings: of the service.
    """

    def __init__(self, settings: Settings) -> None:
        self._access = settings.access
        self.keys = Keys(settings.data)
        self.sessions = Sessions()
        self._tokens = tokens_of(settings)
        self._accepted_log = AuditLog(settings.data / "audit.jsonl")
        self._refused_log = AuditLog(settings.data / "audit-refused.jsonl")
        self._failures = RateLimit(FAILURES_PER_S, FAILURES)
        self._per_s = settings.requests_per_s
        self._requests = RateLimit(settings.requests_per_s, max(1.0, BURST_S * settings.requests_per_s))

    async def identify(self, scope: Scope) -> Principal:
        """Return the sender of a request.

        Args:
            scope: of the request or WebSocket.

        Raises:
            ServiceError: 401, 403, 429, or 503 where the issuer of a token cannot be reached.
        """
        headers = Headers(scope=scope)
        sent = self._sent_key(headers)
        token = cookie_parser(headers.get("cookie", "")).get(SESSION_COOKIE)
        key_id = self.sessions.key_id(token) if token else None
        key = self.keys.find(key_id) if key_id else None
        if sent is not None and self._is_token(sent):
            principal = await run_in_threadpool(self._token_holder, sent, counted_address(scope))
        elif sent is not None:
            principal = self.sign_in(sent, counted_address(scope)).principal()
        elif key is not None:
            _check_origin(scope, headers)
            principal = self.in_session(key, token or "")
        else:
            principal = NOBODY if self._access == "keys" else ANYONE
        self._limit(principal, counted_address(scope))
        if principal is NOBODY and _is_private(scope["path"]):
            raise unauthorized("This needs a key: send it as `Authorization: Bearer KEY`.")
        return principal

    def sign_in(self, sent: str, address: str) -> Key:
        """Return the key that was sent. A token is none: whoever has one sends it with each request.

        Args:
            sent: the text of the key.
            address: from where, as `counted_address` tells it.

        Raises:
            ServiceError: 401, the key is wrong, expired or revoked; 429, too many such keys came from this address.
        """
        key = self.keys.verify(sent)
        if key is not None:
            return key
        self._limit_failures(address)
        raise unauthorized("The key is wrong, expired or revoked.")

    def is_valid(self, scope: Scope) -> bool:
        """Return whether the key or session that a request was identified by is still valid.

        Args:
            scope: of a request that `identify` has let in.
        """
        principal = scope["state"]["principal"]
        if principal in (ANYONE, NOBODY):
            return True
        headers = Headers(scope=scope)
        sent = self._sent_key(headers)
        if sent is not None and self._is_token(sent):
            return bool(datetime.now(UTC) < principal.ends_at)
        if sent is not None:
            return self.keys.verify(sent) is not None
        key_id = self.sessions.key_id(cookie_parser(headers.get("cookie", "")).get(SESSION_COOKIE, ""))
        return key_id is not None and self.keys.find(key_id) is not None

    def in_session(self, key: Key, token: str) -> Principal:
        """Return the sender of a request that a session of a key signs."""
        return key.principal().until(datetime.now(UTC) + timedelta(seconds=self.sessions.left_s(token)))

    def audit(self, scope: Scope, status: int) -> None:
        """Write a line of the audit log.

        Args:
            scope: of the request.
            status: of its answer.
        """
        state = scope.get("state", {})
        principal = state.get("principal", NOBODY)
        log = self._refused_log if status in REFUSALS else self._accepted_log
        log.write(
            {
                "time": datetime.now(UTC).isoformat(timespec="milliseconds"),
                "request": request_id.get(),
                "principal": principal.id,
                "label": principal.label,
                "address": address_of(scope),
                "method": scope.get("method", "WEBSOCKET"),
                "path": scope["path"][:MAX_AUDITED_PATH],
                "status": status,
            }
        )

    def _sent_key(self, headers: Headers) -> str | None:
        """Return the key in the header. A service that needs none takes no notice of what is meant for others, as for a proxy."""
        kind, _, sent = headers.get("authorization", "").partition(" ")
        is_ours = self._access == "keys" or sent.startswith(KEY_PREFIX)
        return sent.strip() if kind.lower() == "bearer" and is_ours else None

    def _is_token(self, sent: str) -> bool:
        return self._tokens is not None and not sent.startswith(KEY_PREFIX) and looks_like_token(sent)

    def _token_holder(self, token: str, address: str) -> Principal:
        """Return the sender of a request with a token; see `Tokens.principal`."""
        assert self._tokens is not None
        try:
            return self._tokens.principal(token)
        except TokenError as error:
            self._limit_failures(address)
            detail = str(error)
            raise unauthorized(f"{detail[0].upper()}{detail[1:]}.", 'error="invalid_token"') from error
        except NoRoleError as error:
            raise ServiceError(403, "no_role", str(error)) from error
        except IssuerError as error:
            headers = {"Retry-After": str(round(error.wait_s))}
            raise ServiceError(503, "issuer_unreachable", f"{error} Try again later.", headers=headers) from error

    def _limit_failures(self, address: str) -> None:
        wait_s = self._failures.take(address)
        if wait_s is not None:
            raise _too_many("Too many wrong keys come from this address.", wait_s)

    def _limit(self, principal: Principal, address: str) -> None:
        if self._per_s == 0 or (self._access == "open" and principal is ANYONE):
            return
        name = address if principal in (ANYONE, NOBODY) else principal.id
        wait_s = self._requests.take(name)
        if wait_s is not None:
            raise _too_many("Too many requests.", wait_s)


class IdentityMiddleware:
    """Sets ``connection.state.principal``, or refuses a request.

    Args:
        app: the application.
        identity: keys, sessions and limits.
    """

    def __init__(self, app: ASGIApp, identity: Identity) -> None:
        self.app = app
        self._identity = identity

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] in ("http", "websocket"):
            try:
                scope.setdefault("state", {})["principal"] = await self._identity.identify(scope)
            except ServiceError as error:
                answer = answer_to(error)
                if scope["type"] == "websocket":
                    await WebSocket(scope, receive, send).send_denial_response(answer)
                else:
                    await answer(scope, receive, send)
                return
        await self.app(scope, receive, send)


def _identity(connection: HTTPConnection) -> Identity:
    identity = connection.app.state.identity
    assert isinstance(identity, Identity)
    return identity


IdentityDep = Annotated[Identity, Depends(_identity)]


def _check_origin(scope: Scope, headers: Headers) -> None:
    """Refuse what changes something by a cookie alone. `GuardMiddleware` has compared an ``Origin`` with the host."""
    if scope.get("method") not in SAFE_METHODS and "origin" not in headers:
        detail = "A session may change something only from the page: the request has no `Origin`. Programs send a key."
        raise ServiceError(403, "cross_site", detail, path="origin")


def _is_private(path: str) -> bool:
    """Return whether nobody gets beyond the middleware without credentials; routes check scopes by themselves."""
    return path == "/metrics" or (path.startswith("/v1/") and path != SESSION_PATH)


def _too_many(detail: str, wait_s: int) -> ServiceError:
    headers = {"Retry-After": str(wait_s)}
    return ServiceError(429, "too_many_requests", f"{detail} Try again in {wait_s} s.", headers=headers)
