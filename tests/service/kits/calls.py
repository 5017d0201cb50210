"""Calls of the OpenAPI document, and the scopes that they need."""

from __future__ import annotations

from pathlib import Path

from service.http.app import create_app
from service.http.settings import Settings

PUBLIC = {"/livez", "/readyz", "/version", "/v1/session"}
APP = create_app(Settings(data=Path("unused"), static=Path("none")))
DOCUMENT = APP.openapi()
CALLS = [(method, path, call) for path, calls in DOCUMENT["paths"].items() for method, call in calls.items()]


def scopes_of(call: dict) -> set[str]:
    """The scopes that a call needs, which are the same for every kind of credentials."""
    needed = {tuple(sorted(scopes)) for kind in call.get("security", ()) for scopes in kind.values()}
    assert len(needed) <= 1
    return set(next(iter(needed), ()))
