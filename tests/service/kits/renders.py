"""Renders that tests send and wait for."""

from __future__ import annotations

import httpx

from tests.service.conftest import until

SMALL = {"width": 32, "rays": 4, "engine": "pinhole"}
ENDED = ("done", "failed", "canceled")


def render_of(client: httpx.Client, shot: str, **request) -> dict:
    answer = client.post("/v1/renders", json=SMALL | {"shot": shot} | request)
    assert answer.status_code == 201, answer.text
    return answer.json()


def ended(client: httpx.Client, render: dict) -> dict:
    """The render, once it has ended."""
    return watched(client, render, lambda now: now["state"] in ENDED)


def watched(client: httpx.Client, render: dict, is_there) -> dict:
    until(lambda: is_there(client.get(f"/v1/renders/{render['id']}").json()))
    return client.get(f"/v1/renders/{render['id']}").json()
