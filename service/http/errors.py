"""Translation of exceptions into HTTP answers, all with the body ``{code, detail, path, errors}``.

``code`` is a short stable word for programs, ``detail`` one sentence for people, ``path`` the file, prim or parameter concerned,
and ``errors`` the single findings where there are several.
"""

from __future__ import annotations

import errno
import logging
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import ValidationError
from starlette.exceptions import HTTPException
from starlette.routing import Match
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from render.errors import (
    GraphicsError,
    InputError,
    NotFoundError,
    OutputError,
    PullfocusError,
    SettingsError,
)
from render.model.edit_history import EndOfHistoryError
from service.edit_context import ChangedMeanwhileError
from service.hidden_folders import without_folders
from service.jobs.errors import ConflictError
from service.storage.errors import UnavailableError
from service.workers.errors import (
    QueueFullError,
    StoppingError,
    SupersededError,
    UnfitError,
    WorkerDiedError,
    WorkerError,
)

log = logging.getLogger("pullfocus.service")

# Derived classes first: the first match gives the status.
STATUS_OF_ERROR: tuple[tuple[type[PullfocusError | WorkerError], int], ...] = (
    (NotFoundError, 404),
    (ChangedMeanwhileError, 412),
    (EndOfHistoryError, 409),
    (ConflictError, 409),
    (SettingsError, 422),
    (InputError, 422),
    (GraphicsError, 503),
    (UnavailableError, 503),
    (OutputError, 507),
    (SupersededError, 409),
    (QueueFullError, 503),
    (StoppingError, 503),
    (UnfitError, 422),
    (WorkerDiedError, 503),
)
RETRY_AFTER = {"Retry-After": "1"}
MAX_FINDINGS = 20
"""Findings in the answer to an invalid request; an answer is not longer than a request of many errors."""
MAX_FINDING_CHARS = 1000
CODE_OF_STATUS = {404: "not_found", 405: "method_not_allowed", 413: "too_large", 415: "unsupported_type"}


class ServiceError(Exception):
    """A request that the HTTP process refuses.

    Attributes:
        status: HTTP status.
        code: short stable word for programs.
        detail: one sentence.
        path: file, prim or parameter that it is about, if any.
        errors: paths of the single findings, with one sentence about each, where there are several.
        headers: sent with the answer.
    """

    def __init__(
        self,
        status: int,
        code: str,
        detail: str,
        *,
        path: str | None = None,
        errors: Mapping[str, str] | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(detail)
        self.status = status
        self.code = code
        self.detail = detail
        self.path = path
        self.errors = [{"path": subject, "detail": said} for subject, said in (errors or {}).items()]
        self.headers = dict(headers or {})


def problem(
    status: int,
    code: str,
    detail: str,
    *,
    path: str | None = None,
    errors: list[dict[str, str]] | None = None,
    headers: Mapping[str, str] | None = None,
) -> JSONResponse:
    """Return an answer with the body of an error, which names no folder of this machine."""
    shown = without_folders(path) if path else path
    body = {"code": code, "detail": without_folders(detail), "path": shown, "errors": errors or []}
    return JSONResponse(body, status, dict(headers or {}))


def status_of(error: PullfocusError | WorkerError) -> int:
    """Return the HTTP status of an error of the library or of a worker."""
    return next((status for kind, status in STATUS_OF_ERROR if isinstance(error, kind)), 500)


def answer_to(error: Exception) -> JSONResponse:
    """Return the answer to a request that failed. An error that is a bug is raised again."""
    match error:
        case ServiceError():
            return problem(
                error.status,
                error.code,
                error.detail,
                path=error.path,
                errors=error.errors,
                headers=error.headers,
            )
        case PullfocusError():
            status = status_of(error)
            return problem(status, error.code, error.detail, path=error.path, headers=_retry_headers(status))
        case WorkerError():
            status = status_of(error)
            return problem(status, error.code, str(error), headers=_retry_headers(status))
        case RequestValidationError() | ValidationError():
            return _invalid_request(error.errors())
    raise error


def _invalid_request(errors: Sequence[Any]) -> JSONResponse:
    first = errors[:MAX_FINDINGS]
    findings = [_finding(error) for error in first if not _is_consequence(error, first)]
    detail = "; ".join(f"{f['path']}: {f['detail']}" for f in findings)
    if len(errors) > MAX_FINDINGS:
        detail += f"; and {len(errors) - MAX_FINDINGS:,} more"
    path = findings[0]["path"] if findings else None
    return problem(422, "invalid_request", detail, path=path, errors=findings)


def _retry_headers(status: int) -> Mapping[str, str] | None:
    return RETRY_AFTER if status == 503 else None


def install_error_handlers(app: FastAPI) -> None:
    """Translate every exception into an answer."""
    for known in (ServiceError, PullfocusError, WorkerError, RequestValidationError):
        app.add_exception_handler(known, _known_error)
    app.add_exception_handler(HTTPException, _http_exception)
    app.add_exception_handler(OSError, _os_error)
    app.add_middleware(FaultMiddleware)


class FaultMiddleware:
    """Logs an unexpected exception and answers with status 500.

    Starlette's own handler answers too, but raises the exception again, whereupon the server drops the connection.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        started = False

        async def send_and_note(message: Message) -> None:
            nonlocal started
            started = True
            await send(message)

        try:
            await self.app(scope, receive, send_and_note)
        except Exception:
            if started or scope["type"] != "http":
                raise
            log.exception("%s %s failed", scope["method"], scope["path"])
            detail = "The service failed on this request; its log says why."
            await problem(500, "internal", detail, path=scope["path"])(scope, receive, send)


async def _known_error(_: Request, error: Exception) -> JSONResponse:
    return answer_to(error)


def _is_consequence(error: Mapping[str, Any], errors: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a list is too short only because the validator has left out an item with an error of its own."""
    place = error["loc"]
    return error["type"] == "too_short" and any(
        len(other["loc"]) > len(place) and other["loc"][: len(place)] == place for other in errors
    )


def _finding(error: Mapping[str, Any]) -> dict[str, str]:
    """Return one finding of the validator, without the input, which may be large or hold NaN."""
    if error["type"] == "json_invalid":
        return {
            "path": "body",
            "detail": f"The body is no JSON that can be read: {error['ctx']['error']}."[:MAX_FINDING_CHARS],
        }
    path = ".".join(str(part) for part in error["loc"])
    return {"path": path[:MAX_FINDING_CHARS], "detail": str(error["msg"])[:MAX_FINDING_CHARS]}


async def _http_exception(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    if error.status_code == 400 and isinstance(
        error.__cause__, ValueError
    ):  # as FastAPI refuses bytes that are no UTF-8
        return problem(422, "invalid_request", "The body is no text in UTF-8.", path="body")
    code = CODE_OF_STATUS.get(error.status_code, "bad_request" if error.status_code < 500 else "internal")
    detail = str(error.detail)
    if detail == HTTPStatus(error.status_code).phrase:  # Starlette's default message names nothing
        detail = f"{request.method} {request.url.path}: {detail.lower()}."
    headers = {"Allow": ", ".join(_methods_at(request))} if error.status_code == 405 else error.headers
    return problem(error.status_code, code, detail, path=request.url.path, headers=headers)


def _methods_at(request: Request) -> list[str]:
    """Return the methods that the address of a request takes, of all its routes: Starlette names those of the first."""
    app, present = request.app, request.scope["method"]
    methods = {method for methods in app.openapi()["paths"].values() for method in methods}
    candidates = [method.upper() for method in methods]
    return sorted(
        method
        for method in candidates
        if method != present
        and any(route.matches({**request.scope, "method": method})[0] is Match.FULL for route in app.router.routes)
    )


async def _os_error(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, OSError)
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return problem(507, "disk_full", "The disk that holds the shots is full; delete a shot and try again.")
    raise error
