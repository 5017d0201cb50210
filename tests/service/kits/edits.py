"""Edits over HTTP of a shot like `tests.service.conftest.ROOM`, and two points of it."""

from __future__ import annotations

from typing import Any

NEAR = {"target": ["/World/near"], "face": 0, "barycentric": [0.3, 0.3, 0.4]}
FAR = {"target": ["/World/far"], "face": 0, "barycentric": [0.3, 0.3, 0.4]}
TWO_POINTS = [
    {"type": "addPoint", "point": NEAR | {"name": "near"}},
    {"type": "addPoint", "point": FAR | {"name": "far"}},
]


def edit(client, shot: str, *changes: dict[str, Any], headers: dict[str, str] | None = None, **request: Any):
    return client.post(f"{shot}/edits", json={"changes": changes} | request, headers=headers)


def edited(client, shot: str, *changes: dict[str, Any], **request: Any) -> dict[str, Any]:
    answer = edit(client, shot, *changes, **request)
    assert answer.status_code == 200, answer.text
    return answer.json()


def layer(client, shot: str) -> str:
    return client.get(f"{shot}/edits").text
