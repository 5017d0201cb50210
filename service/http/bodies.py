"""Bodies of requests: received only from those who may send them, and JSON read as RFC 8259 has it.

A router with routes that take a body is made with ``route_class=BodyRoute``.
"""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Sequence
from typing import Any

from fastapi import Request, Response
from fastapi.params import Security
from fastapi.routing import APIRoute
from starlette.concurrency import run_in_threadpool

from service.http.access import check_access, principal_of
from service.http.json_bodies import read_json
from service.http.service import service_of


class BodyRoute(APIRoute):
    """Route that looks at the sender's scopes, and at the shot, before it receives the body. It reads JSON by `read_json`."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the function that answers a request."""
        answer = super().get_route_handler()
        scopes = [
            scope for needed in self.dependencies if isinstance(needed, Security) for scope in needed.scopes or ()
        ]

        async def answer_sender(request: Request) -> Response:
            await run_in_threadpool(_check, request, scopes)
            return await answer(_JsonRequest(request.scope, request.receive))

        return answer_sender


def _check(request: Request, scopes: Sequence[str]) -> None:
    """Refuse a sender without the scopes of a route, and a shot that there is not."""
    service = service_of(request)
    if scopes:
        check_access(request, service, principal_of(request), scopes)
    if "shot" in request.path_params:
        service.store.get(request.path_params["shot"])


class _JsonRequest(Request):
    async def json(self) -> Any:
        if not hasattr(self, "_json"):
            self._json = read_json(await self.body())
        return self._json
