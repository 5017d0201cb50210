"""The one shape of every error, and the translation of exceptions into it.

Whatever goes wrong, the answer's body is ``{code, detail, path, errors}``: a short stable word for programs, one sentence
for people, the file, prim or parameter that it is about, and the single findings where there are several.
"""

from __future__ import annotations

import errno
import logging
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import ValidationError
from starlette.exceptions import HTTPException
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
from service.terms import ChangedMeanwhileError

log = logging.getLogger("pullfocus.service")

# Nearest base class first: the first that matches gives the status.
STATUS_OF_ERROR: tuple[tuple[type[PullfocusError], int], ...] = (
    (NotFoundError, 404),
    (ChangedMeanwhileError, 412),
    (EndOfHistoryError, 409),
    (SettingsError, 422),
    (InputError, 422),
    (GraphicsError, 503),
    (OutputError, 507),
)
RETRY_AFTER = {"Retry-After": "1"}
CODE_OF_STATUS = {404: "not_found", 405: "method_not_allowed", 413: "too_large", 415: "unsupported_type"}


class ServiceError(Exception):
    """A request that the service itself refuses or cannot serve.

    Attributes:
        status: HTTP status.
        code: short stable word for programs.
        detail: one sentence.
        path: file, prim or parameter that it is about, if any.
        headers: sent with the answer.
    """

    def __init__(
        self,
        status: int,
        code: str,
        detail: str,
        *,
        path: str | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(detail)
        self.status = status
        self.code = code
        self.detail = detail
        self.path = path
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
    """An answer in the one shape."""
    body = {"code": code, "detail": detail, "path": path, "errors": errors or []}
    return JSONResponse(body, status, dict(headers or {}))


def status_of(error: PullfocusError) -> int:
    """HTTP status of an error of the library."""
    return next((status for kind, status in STATUS_OF_ERROR if isinstance(error, kind)), 500)


def answer_to(error: Exception) -> JSONResponse:
    """The answer to a request that failed with an error which is no fault of the program; a fault is raised again."""
    match error:
        case ServiceError():
            return problem(error.status, error.code, error.detail, path=error.path, headers=error.headers)
        case PullfocusError():
            status = status_of(error)
            headers = RETRY_AFTER if status == 503 else None
            return problem(status, error.code, error.detail, path=error.path, headers=headers)
        case RequestValidationError() | ValidationError():
            found = [_finding(e) for e in error.errors()]
            detail = "; ".join(f"{f['path']}: {f['detail']}" for f in found)
            return problem(422, "invalid_request", detail, path=found[0]["path"] if found else None, errors=found)
    raise error


def install_error_handlers(app: FastAPI) -> None:
    """Answer every exception in the one shape."""
    for known in (ServiceError, PullfocusError, RequestValidationError):
        app.add_exception_handler(known, _known_error)
    app.add_exception_handler(HTTPException, _http_exception)
    app.add_exception_handler(OSError, _os_error)
    app.add_middleware(FaultMiddleware)


class FaultMiddleware:
    """Answers a fault of the program in the one shape, and logs it.

    Starlette's own last resort answers too, and then raises on, whereupon the server drops the connection.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        started = False

        async def send_and_see(message: Message) -> None:
            nonlocal started
            started = True
            await send(message)

        try:
            await self.app(scope, receive, send_and_see)
        except Exception:
            if started or scope["type"] != "http":
                raise
            log.exception("%s %s failed", scope["method"], scope["path"])
            detail = "The service failed on this request; its log says why."
            await problem(500, "internal", detail, path=scope["path"])(scope, receive, send)


async def _known_error(_: Request, error: Exception) -> JSONResponse:
    return answer_to(error)


def _finding(error: Mapping[str, Any]) -> dict[str, str]:
    """One finding of the validator; what was sent is left out, since it may be large or hold NaN."""
    return {"path": ".".join(str(part) for part in error["loc"]), "detail": str(error["msg"])}


async def _http_exception(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    code = CODE_OF_STATUS.get(error.status_code, "bad_request" if error.status_code < 500 else "internal")
    detail = str(error.detail)
    if detail == HTTPStatus(error.status_code).phrase:  # the framework's own words name nothing
        detail = f"{request.method} {request.url.path}: {detail.lower()}."
    return problem(error.status_code, code, detail, path=request.url.path, headers=error.headers)


async def _os_error(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, OSError)
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return problem(507, "disk_full", "The disk that holds the shots is full; delete a shot and try again.")
    raise error
