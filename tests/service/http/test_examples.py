"""Every example of the OpenAPI document works, as a request to a service with its demo shot."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import httpx
import pytest

from service.http.app import create_app
from service.http.settings import Settings
from tests.service.conftest import ROOM, running, until

DOCUMENT = create_app(Settings(data=Path("unused"))).openapi()
CALLS = {
    operation["operationId"]: (method, path, operation)
    for path, methods in DOCUMENT["paths"].items()
    for method, operation in methods.items()
    if operation["operationId"] not in ("watch", "signIn", "revokeKey")  # a WebSocket; examples of secrets fit no key
}
BEFORE = {
    "undoEdit": "edit",
    "deleteKey": "setKey",
    "deleteCameraKey": "setCameraKey",
    "deleteExposureKey": "setExposureKey",
    "deleteFilmKey": "setFilmKey",
    "getLongExposure": "beginLongExposure",
    "editLongExposure": "beginLongExposure",
    "getLongExposurePicture": "beginLongExposure",
    "deleteLongExposure": "beginLongExposure",
}
"""Calls whose example is sent first. There is another revision after it, so that the example of `If-Match` is left out."""
SPOTS = {"getPlaceReadout": ("x", "y", "depthM"), "meter": ("x", "y")}
"""Calls about a place: a focus point, or the parameters named here."""
EXAMPLE_RENDER = "r-5f0c1d2e3a4b"
EXAMPLE_WEBHOOK = "w-3f2a9c51d07b"
QUICK = {"width": "64", "height": "36", "rays": "4", "supersample": "1", "layers": "2", "motion": "1"}


@pytest.fixture(scope="module")
def demo(tmp_path_factory) -> Iterator[httpx.Client]:
    with running(Settings(data=tmp_path_factory.mktemp("data"))) as service:
        yield service.client


def examples_of(parameter: dict) -> list[Any]:
    return parameter["schema"].get("examples") or [parameter["example"]]


def bodies_of(operation: dict) -> list[Any]:
    """The example bodies of a call as JSON; None for a call without."""
    content = operation.get("requestBody", {}).get("content", {}).get("application/json")
    if content is None:
        return [None]
    name = content["schema"].get("$ref", "").rpartition("/")[2]
    model = DOCUMENT["components"]["schemas"].get(name, content["schema"])
    return model.get("examples") or [model["example"]]


def file_of(name: str, demo: httpx.Client) -> dict | None:
    """The file that a call sends along."""
    if name == "importFocusCurve":
        return {"file": ("curve.csv", demo.get("/v1/shots/demo/focus-curve?format=csv").content)}
    return {
        "createShot": {"file": ("room.usda", ROOM.encode())},
        "mountLensFile": {"file": ("plano-convex.dat", b"30 4 1.5 20\n-30 40 1 20\n")},
    }.get(name)


def choices_of(name: str, operation: dict) -> list[list[dict]]:
    """Parameters to send: the required ones, and with them each of the others."""
    given = {
        one["name"]: one
        for one in operation.get("parameters", ())
        if not (name in BEFORE and one["name"] == "if-match")
    }
    required = [one for one in given.values() if one.get("required")]
    others = [[one] for one in given.values() if not one.get("required")]
    if name in SPOTS:
        place = [given[one] for one in SPOTS[name]]
        alone = [one for one in others if one[0]["name"] == "mode"]  # it meters the whole picture
        beside = [one for one in others if one[0] not in (*place, given["point"]) and one not in alone]
        others = [*alone, *([*one, given["point"]] for one in beside), [given["point"]], place]
        return [required + one for one in others]
    return [required, *(required + one for one in others)]


def requests_of(name: str) -> Iterator[tuple[str, dict[str, str], dict[str, str], Any]]:
    """Addresses, queries, headers and bodies by example."""
    _, path, operation = CALLS[name]
    for body, chosen in itertools.product(bodies_of(operation), choices_of(name, operation)):
        for values in itertools.product(*(examples_of(one) for one in chosen)):
            address, query, headers = path, {}, {}
            for one, value in zip(chosen, values, strict=True):
                if one["in"] == "path":
                    address = address.replace(f"{{{one['name']}}}", quote(str(value), safe=""))
                else:
                    kind = query if one["in"] == "query" else headers
                    kind[one["name"]] = value if isinstance(value, list) else str(value)
            yield address, query, headers, body


def send_example(demo: httpx.Client, name: str, request: tuple) -> httpx.Response:
    method = CALLS[name][0]
    address, query, headers, body = request
    if has_render(name) and (EXAMPLE_RENDER in address or "before" in query):
        newest = demo.get("/v1/renders").json()["renders"][0]["id"]
        address = address.replace(EXAMPLE_RENDER, newest)
        query = {key: value.replace(EXAMPLE_RENDER, newest) for key, value in query.items()}
    if "{trashed}" in CALLS[name][1]:  # the id of an entry has the time at which it was made
        address = CALLS[name][1].replace("{trashed}", demo.get("/v1/trash").json()["shots"][0]["id"])
    if "{webhook}" in CALLS[name][1]:
        address = address.replace(EXAMPLE_WEBHOOK, demo.get("/v1/webhooks").json()["webhooks"][0]["id"])
    if name == "followEvents":
        query = query | {"follow": "false"}  # else it does not end
    if name == "getFrame":
        query = QUICK | query if len(query) == 1 else {**QUICK, **{k: v for k, v in query.items() if k not in QUICK}}
    return demo.request(method, address, params=query, headers=headers, json=body, files=file_of(name, demo))


def has_render(name: str) -> bool:
    """Whether a call is about a render that was sent."""
    return "{render}" in CALLS[name][1] or name == "listRenders"


def prepare_render(demo: httpx.Client, name: str) -> None:
    """Cancel the renders of before, send another one, and bring it into the state that a call needs."""
    for render in demo.get("/v1/renders").json()["renders"]:
        demo.post(f"/v1/renders/{render['id']}/cancel")
    wanted = {"shot": "demo", "frames": "24-96", "width": 16, "engine": "pinhole", "formats": ["exr", "png"]}
    sent = demo.post("/v1/renders", json=wanted)
    address = sent.headers["location"]
    if name in ("acceptRender", "retryRender", "removeRender"):
        demo.post(f"{address}/cancel")
        until(lambda: demo.get(address).json()["running"] == 0)
    of_frames = ("getRenderedFrame", "getRenderedThumbnail", "getLastThumbnail", "getFrameLog", "followFrameLog")
    if name in (*of_frames, "getRenderMovie", "getRenderContactSheet"):
        until(lambda: demo.get(address).json()["done"] > 0)
    if name in ("getRenderMovie", "getRenderContactSheet"):
        demo.post(f"{address}/cancel")
        until(lambda: demo.get(address).json()["state"] in ("canceled", "done"))


def prepare(demo: httpx.Client, name: str) -> None:
    """Bring the demo shot to the state in which it was written, and send the example that has to come before."""
    while demo.post("/v1/shots/demo/edits/undo").status_code == 200:
        pass
    demo.delete("/v1/shots/demo/long-exposure")
    if name == "redoEdit":
        send_example(demo, "edit", next(requests_of("edit")))
        demo.post("/v1/shots/demo/edits/undo")
    if "{trashed}" in CALLS[name][1]:
        sent = send_example(demo, "createShot", next(requests_of("createShot")))
        demo.delete(sent.headers["location"])
    if has_render(name):
        prepare_render(demo, name)
    if "{webhook}" in CALLS[name][1]:
        send_example(demo, "createWebhook", next(requests_of("createWebhook")))
    if name in BEFORE:
        address, query, headers, body = next(requests_of(BEFORE[name]))
        if BEFORE[name] == "beginLongExposure":
            body = body | {"width": 64, "rays": 4, "layers": 2, "supersample": 1}
        answer = send_example(demo, BEFORE[name], (address, query, headers, body))
        assert answer.is_success, answer.text


def send_when_ready(demo: httpx.Client, name: str, request: Any) -> httpx.Response:
    """Send an example; a long exposure is asked for until its first moment is over."""
    answers: list[httpx.Response] = []

    def is_answered() -> bool:
        answers.append(send_example(demo, name, request))
        return name != "getLongExposurePicture" or answers[-1].status_code != 409

    until(is_answered)
    return answers[-1]


@pytest.mark.parametrize("name", [name for name in CALLS if name != "deleteShot"] + ["deleteShot"])
def test_examples_work(demo, name):
    for request in requests_of(name):
        prepare(demo, name)
        answer = send_when_ready(demo, name, request)
        assert answer.status_code < 400, f"{name} {request}: {answer.text}"
        if name == "createShot":
            assert demo.delete(answer.headers["location"]).status_code == 204
        if name == "deleteShot":
            last = demo.get("/v1/trash").json()["shots"][0]["id"]
            assert demo.post(f"/v1/trash/{last}/restore").status_code == 200


def test_the_examples_are_many():
    assert len(CALLS) > 50
    assert sum(1 for name in CALLS for _ in requests_of(name)) > 150


def test_a_wrong_method_is_told_the_methods_of_its_address(demo):
    refused = demo.request("OPTIONS", "/v1/shots/demo/edits")
    assert refused.status_code == 405
    assert refused.headers["allow"] == "GET, POST, PUT"
