"""The contract of the API: version 1 breaks no client, and each kind of break is found."""

from __future__ import annotations

import copy
import json

import pytest

from service.http.contract.__main__ import main
from service.http.contract.operations import breaking_changes
from service.http.contract.record import RECORD, contract_of, contract_text, report
from service.http.openapi import openapi_text

PRESENT = json.loads(openapi_text())


@pytest.fixture
def now():
    """The present contract, to be changed."""
    return copy.deepcopy(contract_of(PRESENT))


def changes(now):
    """Changes against the present contract, as text."""
    return [str(finding) for finding in breaking_changes(contract_of(PRESENT), now)]


def schema(now, name):
    return now["components"]["schemas"][name]


def test_version_1_breaks_no_client():
    breaks = breaking_changes(json.loads(RECORD.read_text(encoding="utf-8")), contract_of(PRESENT))
    assert not breaks, report(breaks)


def test_what_was_added_is_recorded():
    """Additions are promised, too, once they are on the main branch: run ``python -m service.http.contract``."""
    assert RECORD.read_text(encoding="utf-8") == contract_text(PRESENT)


def test_prose_is_no_promise(now):
    document = copy.deepcopy(PRESENT)
    document["info"]["version"] = "99"
    document["paths"]["/v1/shots"]["get"] |= {"summary": "x", "description": "x", "tags": ["x"]}
    document["components"]["schemas"]["Problem"]["properties"]["code"] |= {"description": "x", "examples": ["x"]}
    assert contract_of(document) == now
    assert {"name", "title"} <= schema(now, "Lens")["properties"].keys(), "properties may be named as prose is"


def replace(keys, value):
    """Return a function that changes a value deep in a document; None removes it."""

    def change(document):
        for key in keys[:-1]:
            document = document[key]
        if value is None:
            del document[keys[-1]]
        else:
            document[keys[-1]] = value

    return change


SHOTS = ("paths", "/v1/shots", "get")
SEND = ("paths", "/v1/renders", "post")
GET = ("paths", "/v1/shots/{shot}", "get")
NEW = {"name": "new", "in": "query", "required": False, "schema": {"type": "string"}}
PROBLEM = {"description": "", "content": {"application/json": {"schema": {"$ref": "#/components/schemas/Problem"}}}}


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (replace(("paths", "/v1/keys"), None), ["GET /v1/keys: is removed", "POST /v1/keys: is removed"]),
        (replace(SHOTS, None), ["GET /v1/shots: is removed"]),
        (
            replace((*SHOTS, "operationId"), "shots"),
            ["GET /v1/shots: its operationId was listShots, is shots"],
        ),
        (replace((*SEND, "requestBody"), None), ["body: is removed"]),
        (replace((*SHOTS, "requestBody"), {"required": True, "content": {}}), ["body: is new, and required"]),
        (replace((*SEND, "requestBody", "content"), {}), ["body as application/json: is removed"]),
        (replace((*GET, "responses", "404"), None), ["answer 404: is removed"]),
        (replace((*GET, "responses", "200", "content"), {}), ["answer 200 as application/json: is removed"]),
        (
            replace((*SHOTS, "security"), [{"bearer": ["admin"]}, {"session": ["read"]}]),
            ["security: `bearer` (read) is not enough any longer"],
        ),
        (replace(("paths", "/version", "get", "security"), [{"bearer": []}]), ["security: no key is not enough any longer"]),
        (replace(("components", "securitySchemes", "session"), None), ["security scheme `session`: is removed"]),
        (replace(("components", "securitySchemes", "bearer", "scheme"), "basic"), ["security scheme `bearer`: has changed"]),
        (replace(("x-websocket-messages", "fromClient"), []), [
            "message LiveRequest: is removed", "message LiveAck: is removed", "message LiveStop: is removed",
            "message LiveHere: is removed",
        ]),
        (
            replace((*SHOTS, "x-rate"), 7),
            ["GET /v1/shots: `x-rate` has changed, of which a check cannot tell whether it breaks clients"],
        ),
    ],
)  # fmt: skip
def test_breaks_of_operations_are_found(now, change, expected):
    change(now)
    assert changes(now) == expected


def parameters_of(now, method, path):
    return now["paths"][path][method]["parameters"]


def test_breaks_of_parameters_are_found(now):
    parameters = parameters_of(now, "get", "/v1/events")
    by_name = {one["name"]: one for one in parameters}
    by_name["after"]["required"] = True
    by_name["render"]["schema"] = {"type": "string", "maxLength": 80}
    by_name["shot"]["style"] = "simple"
    parameters.remove(by_name["topic"])
    parameters.append(NEW | {"required": True})
    assert sorted(changes(now)) == [
        "query `after`: is required now",
        "query `new`: is new, and required",
        "query `render`, in requests: null is not taken any longer",
        "query `shot`: `style` has changed, of which a check cannot tell whether it breaks clients",
        "query `topic`: is removed",
    ]


def test_additions_break_nobody(now):
    now["paths"]["/v1/new"] = copy.deepcopy(now["paths"]["/v1/shots"])
    now["paths"]["/v1/shots"]["put"] = copy.deepcopy(now["paths"]["/v1/shots"]["post"])
    parameters_of(now, "get", "/v1/events").append(NEW)
    now["paths"]["/v1/shots"]["get"]["responses"]["410"] = PROBLEM
    now["paths"]["/v1/shots"]["get"]["security"].append({"basic": []})
    now["paths"]["/v1/shots"]["get"]["requestBody"] = {"required": False, "content": {}}
    now["paths"]["/v1/shots"]["get"]["deprecated"] = True
    now["paths"]["/v1/renders"]["post"]["requestBody"]["content"]["application/yaml"] = {}
    now["components"]["securitySchemes"]["basic"] = {"type": "http", "scheme": "basic"}
    now["components"]["schemas"]["New"] = {"type": "string"}
    now["x-websocket-messages"]["toClient"].append({"$ref": "#/components/schemas/New"})
    for name in ("Render", "RenderRequest", "Problem", "LiveRequest", "Event"):
        schema(now, name)["properties"]["new"] = {"anyOf": [{"type": "string"}, {"type": "null"}]}
    schema(now, "Render")["properties"]["state"]["enum"].append("archived")
    schema(now, "RenderRequest")["properties"]["formats"]["items"]["enum"].append("tiff")
    assert changes(now) == []


def test_breaks_of_errors_are_found_in_each_operation(now):
    schema(now, "Problem")["required"].remove("detail")
    del schema(now, "Finding")["properties"]["path"]
    breaks = {str(one): operations for one, operations in breaking_changes(contract_of(PRESENT), now).items()}
    assert breaks.keys() == {"Problem.detail, in answers: may be missing now", "Finding.path, in answers: is removed"}
    with_errors = [
        one["operationId"]
        for methods in PRESENT["paths"].values()
        for one in methods.values()
        if "401" in one["responses"]
    ]
    assert set(with_errors) <= set(breaks["Problem.detail, in answers: may be missing now"])


def test_breaks_of_messages_are_found(now):
    schema(now, "LiveRequest")["properties"]["budgetMs"]["maximum"] = 100
    schema(now, "LivePictureHead")["required"].remove("final")
    del schema(now, "EventGap")["properties"]["oldest"]
    assert changes(now) == [
        "LiveRequest.budgetMs, in requests: `maximum` was 60000, is 100",
        "LivePictureHead.final, in answers: may be missing now",
        "EventGap.oldest, in answers: is removed",
    ]


def test_items_of_a_stream_are_compared(now):
    content = now["paths"]["/v1/events"]["get"]["responses"]["200"]["content"]["text/event-stream"]
    del content["itemSchema"]["properties"]["id"]
    assert changes(now) == ["answer 200.id, in answers: is removed"]


def test_the_report_names_field_operations_and_way_on(now):
    schema(now, "RenderRequest")["properties"]["width"]["maximum"] = 64
    text = report(breaking_changes(contract_of(PRESENT), now))
    assert "- RenderRequest.width, in requests: `maximum` was 8192" in text
    assert "Concerns planRender, sendRender." in text
    assert "python -m service.http.contract --accept" in text


def test_a_break_is_recorded_only_on_purpose(tmp_path, now, capsys):
    record = tmp_path / "v1.json"
    schema(now, "Render")["properties"]["gone"] = {"type": "string"}
    record.write_text(json.dumps(now), encoding="utf-8")
    assert main([], record) == 1
    assert "Render.gone, in answers: is removed" in capsys.readouterr().err
    assert json.loads(record.read_text(encoding="utf-8")) == now
    assert main(["--accept"], record) == 0
    assert record.read_text(encoding="utf-8") == contract_text(PRESENT)
    assert main([], record) == 0


def test_an_addition_is_recorded(tmp_path, now):
    record = tmp_path / "v1.json"
    del schema(now, "Render")["properties"]["name"]
    del now["paths"]["/v1/events"]
    record.write_text(json.dumps(now), encoding="utf-8")
    assert main([], record) == 0
    assert record.read_text(encoding="utf-8") == contract_text(PRESENT)
