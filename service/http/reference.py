"""The page ``/docs``: the OpenAPI document as one page of HTML, without a script and with nothing from another origin."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

from fastapi import FastAPI
from fastapi.responses import HTMLResponse, Response

Json = dict[str, Any]

STYLE_PATH = "/docs/style.css"
STYLE_FILE = Path(__file__).with_name("reference.css")


def install_reference(app: FastAPI) -> None:
    """Serve the page at ``/docs``.

    Args:
        app: the application, which describes itself.
    """

    @cache
    def text() -> str:
        return reference_page(app.openapi())

    @app.get("/docs", include_in_schema=False)
    async def reference() -> HTMLResponse:
        return HTMLResponse(text())

    @app.get(STYLE_PATH, include_in_schema=False)
    async def style() -> Response:
        return Response(STYLE_FILE.read_text(encoding="utf-8"), media_type="text/css")


def reference_page(document: Json) -> str:
    """Return the page of an OpenAPI document."""
    info = document["info"]
    operations = [
        (method.upper(), path, operation)
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
    ]
    tags = list(dict.fromkeys(_tag(operation) for _, _, operation in operations))
    parts = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">',
        f'<title>{escape(info["title"])}: REST</title><link rel="stylesheet" href="{STYLE_PATH}"></head><body>',
        f"<header><h1>{escape(info['title'])} {escape(info['version'])}</h1>{_prose(info['description'])}",
        '<p><a href="/openapi.json">OpenAPI document</a> · <a href="#models">models</a></p></header>',
    ]
    for tag in tags:
        parts.append(f"<h2>{escape(tag.capitalize())}</h2>")
        parts += [_operation(*operation) for operation in operations if _tag(operation[2]) == tag]
    parts.append('<h2 id="models">Models</h2>')
    parts += [_model(name, schema) for name, schema in sorted(document["components"]["schemas"].items())]
    return "\n".join([*parts, "</body></html>\n"])


def _tag(operation: Json) -> str:
    return str(operation.get("tags", ["other"])[0])


def _operation(method: str, path: str, operation: Json) -> str:
    parameters = operation.get("parameters", [])
    rows = [
        (
            _code(one["name"]),
            one["in"] + ("" if one.get("required") else ", optional"),
            _kind(one["schema"]),
            _prose(_about(one)),
        )
        for one in parameters
    ]
    body = "".join(
        _content("Body", kind, content) for kind, content in operation.get("requestBody", {}).get("content", {}).items()
    )
    answers = [
        (_code(status), _prose(answer.get("description", "")), ", ".join(_bodies(answer)))
        for status, answer in operation["responses"].items()
    ]
    shown = _code(f"{method} {path}")
    return (
        f'<details id="{escape(operation["operationId"])}"><summary>{shown}</summary>{_prose(operation.get("description", ""))}'
        f"{_try_it(method, path, parameters)}{_table(('parameter', 'in', 'value', 'meaning'), rows)}{body}"
        f"{_table(('status', 'meaning', 'body'), answers)}</details>"
    )


def _try_it(method: str, path: str, parameters: Iterable[Json]) -> str:
    """Return a link that makes the request by example; empty where it is more than reading."""
    if method != "GET" or path.endswith("/live"):
        return ""
    needed = {one["name"]: _examples(one) for one in parameters if one.get("required")}
    if not all(needed.values()):
        return ""
    query = "&".join(
        f"{one['name']}={quote(str(_examples(one)[0]))}"
        for one in parameters
        if one.get("required") and one["in"] == "query"
    )
    address = re.sub(r"{(\w+)}", lambda match: quote(str(needed[match[1]][0]), safe=""), path) + (
        f"?{query}" if query else ""
    )
    return f'<p><a href="{escape(address)}">Try it</a>: {_code(address)}</p>'


def _examples(parameter: Json) -> list[Any]:
    return list(parameter["schema"].get("examples") or ([parameter["example"]] if "example" in parameter else []))


def _model(name: str, schema: Json) -> str:
    rows = [
        (
            _code(key) + (" *" if key in schema.get("required", ()) else ""),
            _kind(value),
            _prose(value.get("description", "")),
        )
        for key, value in schema.get("properties", {}).items()
    ]
    example = f"<pre>{escape(json.dumps(schema['example'], indent=2))}</pre>" if "example" in schema else ""
    return (
        f'<details id="{escape(name)}"><summary>{_code(name)}</summary>{_prose(schema.get("description", ""))}'
        f"{_table(('property', 'value', 'meaning'), rows)}{example}</details>"
    )


def _bodies(answer: Json) -> Iterator[str]:
    for kind, content in answer.get("content", {}).items():
        yield f"{_code(kind)} {_kind(content.get('schema', {}))}"


def _content(title: str, kind: str, content: Json) -> str:
    return f"<p>{title}: {_code(kind)} {_kind(content.get('schema', {}))}</p>"


def _kind(schema: Json) -> str:
    """Return the type of a value, with links to models."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f'<a href="#{escape(name)}">{escape(name)}</a>'
    for several in ("anyOf", "oneOf", "allOf"):
        if several in schema:
            return " or ".join(_kind(one) for one in schema[several])
    if "enum" in schema or "const" in schema:
        return " ".join(_code(json.dumps(value)) for value in schema.get("enum", [schema.get("const")]))
    if schema.get("type") == "array" and "items" in schema:
        return f"list of {_kind(schema['items'])}"
    return escape(str(schema.get("format") or schema.get("type") or ""))


def _about(parameter: Json) -> str:
    return str(parameter.get("description") or parameter["schema"].get("description") or "")


def _table(header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    if not rows:
        return ""
    head = "".join(f"<th>{word}</th>" for word in header)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _code(text: str) -> str:
    return f"<code>{escape(text)}</code>"


def _prose(text: str) -> str:
    """Return paragraphs; words in backticks are code."""
    paragraphs = (re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(part)) for part in text.split("\n\n") if part)
    return "".join(f"<p>{part}</p>" for part in paragraphs)
