"""Links of the OpenAPI document: which calls take what an answer has just made (OpenAPI 3.1, section 4.8.20)."""

from __future__ import annotations

from typing import Any

SHOT_CALLS = ("getShot", "inspectShot", "getFrame", "getEdits", "edit", "getEditHistory", "listCameras", "deleteShot")
POINT_CALLS = ("getFocusPoint", "editFocusPoint", "setKey", "deleteFocusPoint")

Responses = dict[int | str, dict[str, Any]]


def shot_links(status: int) -> Responses:
    """Return the calls that take the id of the shot in an answer."""
    return _links(status, SHOT_CALLS, {"shot": "$response.body#/id"})


def point_links(status: int) -> Responses:
    """Return the calls that take the name of the focus point in an answer, of the same shot."""
    return _links(status, POINT_CALLS, {"shot": "$request.path.shot", "name": "$response.body#/name"})


def edit_links() -> Responses:
    """Return the calls that take back an edit."""
    return _links(200, ("undoEdit", "getEditHistory"), {"shot": "$request.path.shot"})


def _links(status: int, calls: tuple[str, ...], parameters: dict[str, str]) -> Responses:
    return {status: {"links": {call: {"operationId": call, "parameters": parameters} for call in calls}}}
