"""Links of the OpenAPI document: each leads from what a call answered to a call that succeeds, on a copy of the demo shot."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import httpx
import pytest

from service.http.app import create_app
from service.http.settings import Settings
from tests.service.conftest import running, send

DOCUMENT = create_app(Settings(data=Path("unused"))).openapi()
CALLS = {
    call["operationId"]: (method, path, call)
    for path, calls in DOCUMENT["paths"].items()
    for method, call in calls.items()
}
SMALL = {"width": 96, "height": 54, "rays": 2}
"""Parameters of pictures in place of those of the examples, so that they take no time."""


class Link(NamedTuple):
    """A link of the document: from a call that answers so to another call."""

    source: str
    status: str
    target: str
    parameters: dict[str, str]

    def __str__(self) -> str:
        return f"{self.source}-{self.target}"


LINKS = [
    Link(source, status, link["operationId"], link["parameters"])
    for source, (_, _, call) in CALLS.items()
    for status, answer in call["responses"].items()
    for link in answer.get("links", {}).values()
]


def example_of(schema: dict[str, Any]) -> Any:
    """The example of a body or a parameter, references followed."""
    if "$ref" in schema:
        return example_of(DOCUMENT["components"]["schemas"][schema["$ref"].rpartition("/")[2]])
    return schema["example"] if "example" in schema else schema["examples"][0]


class Sent(NamedTuple):
    """A request by the document's examples, and its answer."""

    path: dict[str, Any]
    answer: httpx.Response

    def value(self, expression: str) -> Any:
        """The value of a runtime expression of a link."""
        if expression.startswith("$request.path."):
            return self.path[expression.removeprefix("$request.path.")]
        value = self.answer.json()
        for key in expression.removeprefix("$response.body#/").split("/"):
            value = value[key]
        return value


def send_example(client: httpx.Client, name: str, path: dict[str, Any]) -> Sent:
    """Send a call with the document's examples of its required parameters, some of the path given."""
    method, url, call = CALLS[name]
    given: dict[str, dict[str, Any]] = {"path": {}, "query": {}, "header": {}}
    for parameter in call.get("parameters", ()):
        if parameter["required"] or parameter["name"] in SMALL:
            example = SMALL.get(parameter["name"]) or example_of(parameter["schema"])
            given[parameter["in"]][parameter["name"]] = example
    given["path"] |= path
    content = call.get("requestBody", {}).get("content", {}).get("application/json")
    body = None if content is None else content["example"] if "example" in content else example_of(content["schema"])
    answer = client.request(
        method, url.format(**given["path"]), params=given["query"], headers=given["header"], json=body
    )
    return Sent(given["path"], answer)


@pytest.fixture(scope="module")
def packed_demo(demo_file: Path) -> bytes:
    """The demo shot as a zip."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(demo_file.parent.rglob("*")):
            archive.write(file, file.relative_to(demo_file.parent))
    return packed.getvalue()


@pytest.fixture(scope="module")
def client(tmp_path_factory) -> Iterator[httpx.Client]:
    """A client of a service that takes the demo shot."""
    with running(Settings(data=tmp_path_factory.mktemp("data"), demo=False)) as service:
        yield service.client


@pytest.fixture
def uploaded(client, packed_demo) -> Iterator[httpx.Response]:
    """The answer to an upload of the demo shot."""
    answer = send(client, "demo.zip", packed_demo, root="night_street.usda")
    assert answer.status_code == 201, answer.text
    yield answer
    client.delete(f"/v1/shots/{answer.json()['id']}")


def test_the_document_links_uploads_edits_and_points():
    assert {link.source for link in LINKS} == {"createShot", "edit", "createFocusPoint"}


@pytest.mark.parametrize("link", LINKS, ids=str)
def test_a_link_leads_to_a_call_that_succeeds(client, uploaded, link):
    path = {"shot": uploaded.json()["id"]}
    sent = Sent({}, uploaded) if link.source == "createShot" else send_example(client, link.source, path)
    assert str(sent.answer.status_code) == link.status, sent.answer.text

    values = {name: sent.value(expression) for name, expression in link.parameters.items()}
    followed = send_example(client, link.target, values).answer
    assert followed.is_success, followed.text
    assert str(followed.status_code) in CALLS[link.target][2]["responses"]
