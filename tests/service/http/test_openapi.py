"""The OpenAPI document: every call has an example, every refusal the one shape, and it is the same every time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from service.http.app import create_app
from service.http.openapi import openapi_text
from service.http.settings import Settings
from service.models.focus import POINT_EXAMPLE, FocusPoint
from service.models.focus_reports import REPORT_EXAMPLE, FocusReport
from service.models.renders import RENDER_EXAMPLE, Render

DOCUMENT = create_app(Settings(data=Path("unused"))).openapi()
CALLS = [(f"{m.upper()} {p}", call) for p, calls in DOCUMENT["paths"].items() for m, call in calls.items()]
PROMISED = """
GET /v1/shots, POST /v1/shots, GET /v1/shots/{shot}, DELETE /v1/shots/{shot}, GET /v1/shots/{shot}/inspect,
DELETE /v1/shots/{shot}/quarantine, GET /v1/trash, POST /v1/trash/{trashed}/restore, DELETE /v1/trash/{trashed},
GET /v1/shots/{shot}/cameras, PATCH /v1/shots/{shot}/camera, GET /v1/shots/{shot}/frame, POST /v1/shots/{shot}/pick,
GET /v1/shots/{shot}/notes, GET /v1/shots/{shot}/choices, GET /v1/shots/{shot}/exposure-map, GET /v1/shots/{shot}/picture-states,
GET /v1/shots/{shot}/focus-map,
GET /v1/shots/{shot}/focus-points, POST /v1/shots/{shot}/focus-points, GET /v1/shots/{shot}/focus-points/{name},
PATCH /v1/shots/{shot}/focus-points/{name}, DELETE /v1/shots/{shot}/focus-points/{name},
PUT /v1/shots/{shot}/focus-points/{name}/keys/{attribute}, DELETE /v1/shots/{shot}/focus-points/{name}/keys/{attribute},
GET /v1/shots/{shot}/focus-curve, PUT /v1/shots/{shot}/focus-curve,
GET /v1/shots/{shot}/camera, GET /v1/shots/{shot}/camera/place, GET /v1/shots/{shot}/edits/history,
POST /v1/shots/{shot}/edits/undo, POST /v1/shots/{shot}/edits/redo,
GET /v1/shots/{shot}/readout, GET /v1/shots/{shot}/edits, POST /v1/shots/{shot}/edits,
PUT /v1/shots/{shot}/edits, PUT /v1/shots/{shot}/camera/lens, GET /v1/lenses, GET /v1/lenses/{name},
GET /v1/lenses/{name}/section.svg, GET /v1/lenses/{name}/sheet.png,
GET /v1/films, GET /v1/films/{name}, GET /v1/films/{name}/sheet.png, GET /v1/bodies, GET /v1/bodies/{name},
GET /v1/shots/{shot}/camera/focus, PATCH /v1/shots/{shot}/camera/focus, POST /v1/shots/{shot}/racks,
PUT /v1/shots/{shot}/camera/keys/{attribute}, DELETE /v1/shots/{shot}/camera/keys/{attribute},
GET /v1/shots/{shot}/readout/place, GET /v1/shots/{shot}/top-view, GET /v1/shots/{shot}/paths,
GET /v1/shots/{shot}/camera/exposure, PATCH /v1/shots/{shot}/camera/exposure,
PUT /v1/shots/{shot}/camera/exposure/keys/{attribute}, DELETE /v1/shots/{shot}/camera/exposure/keys/{attribute},
GET /v1/shots/{shot}/camera/film, PATCH /v1/shots/{shot}/camera/film,
PUT /v1/shots/{shot}/camera/film/keys/{attribute}, DELETE /v1/shots/{shot}/camera/film/keys/{attribute},
GET /v1/shots/{shot}/camera/grades, GET /v1/shots/{shot}/readout/exposure, GET /v1/shots/{shot}/meter,
POST /v1/shots/{shot}/long-exposure, GET /v1/shots/{shot}/long-exposure, PATCH /v1/shots/{shot}/long-exposure,
DELETE /v1/shots/{shot}/long-exposure, GET /v1/shots/{shot}/long-exposure/picture,
GET /v1/shots/{shot}/live,
GET /v1/session, POST /v1/session, DELETE /v1/session, GET /v1/keys, POST /v1/keys, DELETE /v1/keys/{key},
GET /livez, GET /readyz, GET /metrics, GET /version,
GET /v1/renders, POST /v1/renders, POST /v1/render-plans, GET /v1/renders/{render}, DELETE /v1/renders/{render},
GET /v1/renders/{render}/tasks, GET /v1/renders/{render}/frames/{frame}, POST /v1/renders/{render}/pause,
POST /v1/renders/{render}/resume, POST /v1/renders/{render}/cancel, POST /v1/renders/{render}/retry,
POST /v1/renders/{render}/accept, GET /v1/renders/{render}/frames/{frame}/thumbnail, GET /v1/renders/{render}/thumbnail,
GET /v1/renders/{render}/movie, GET /v1/renders/{render}/contact-sheet, GET /v1/renders/{render}/focus-report,
GET /v1/renders/{render}/focus-curve,
GET /v1/renders/{render}/frames/{frame}/log, GET /v1/renders/{render}/frames/{frame}/log/stream,
GET /v1/events,
GET /v1/webhooks, POST /v1/webhooks, DELETE /v1/webhooks/{webhook}, POST /v1/webhooks/{webhook}/test,
POST /v1/webhooks/{webhook}/enable
"""


def schema_of(content: dict) -> dict:
    """The schema of a body, references followed."""
    schema = content["schema"]
    return DOCUMENT["components"]["schemas"][schema["$ref"].split("/")[-1]] if "$ref" in schema else schema


def test_every_promised_call_is_there():
    assert {name for name, _ in CALLS} == {call.strip() for call in PROMISED.replace("\n", " ").split(",")}


@pytest.mark.parametrize(("name", "call"), CALLS, ids=[name for name, _ in CALLS])
def test_every_call_is_explained_by_example(name, call):
    assert call["description"]
    for parameter in call.get("parameters", ()):
        shown = parameter.get("examples") or parameter["schema"].get("examples") or parameter.get("example")
        assert shown, f"{name}: {parameter['name']}"
        assert parameter.get("description") or parameter["in"] == "header", f"{name}: {parameter['name']}"
    bodies = [call["requestBody"]["content"]] if "requestBody" in call else []
    bodies += [
        answer["content"] for status, answer in call["responses"].items() if status < "3" and "content" in answer
    ]
    for kind, content in ((kind, content) for body in bodies for kind, content in body.items()):
        if content.get("schema", {}).get("format") == "binary" or kind == "multipart/form-data":
            continue  # a picture, or a file that is sent: there is nothing to print
        assert "example" in content or "example" in schema_of(content), f"{name}: {kind}"


@pytest.mark.parametrize(("name", "call"), CALLS, ids=[name for name, _ in CALLS])
def test_every_refusal_has_the_one_shape(name, call):
    for status, answer in call["responses"].items():
        if status >= "4":
            assert answer["content"]["application/json"]["schema"]["$ref"].endswith("/Problem"), f"{name}: {status}"


def test_names_are_camel_case():
    for name, schema in DOCUMENT["components"]["schemas"].items():
        assert not [key for key in schema.get("properties", ()) if "_" in key], name


@pytest.mark.parametrize(
    ("model", "example"), [(FocusPoint, POINT_EXAMPLE), (FocusReport, REPORT_EXAMPLE), (Render, RENDER_EXAMPLE)]
)
def test_examples_are_true_to_their_models(model, example):
    assert model.model_validate(example).model_dump(by_alias=True, mode="json") == example


def test_the_document_is_the_same_every_time():
    environment = os.environ | {"PYTHONHASHSEED": "7"}
    command = [sys.executable, "-m", "service.http.openapi"]
    printed = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
    assert printed == openapi_text()
    assert json.loads(printed) == DOCUMENT


def test_the_page_is_built_against_this_document():
    """The page's TypeScript types come from this file; anew: python -m service.http.openapi > web/openapi.json."""
    kept = Path(__file__).parents[3] / "web" / "openapi.json"
    assert kept.read_text(encoding="utf-8") == openapi_text()
