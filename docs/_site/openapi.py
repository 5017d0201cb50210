"""The REST reference, from web/openapi.json, which a test holds equal to what the service says of itself."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docs._site.markdown import anchor, table

Json = dict[str, Any]

ROUTES_INTRODUCTION = """A running service shows the same at `/docs`, with links that try the requests. Bodies and answers are
described in [REST models](models.md).

"""
MODELS_INTRODUCTION = """# REST models

JSON objects that the [routes](rest.md) take and return. `null` is an infinite distance, or one that
does not exist. A property with a star (*) is required in a request and always present in an answer.

"""


def routes_page(root: Path) -> str:
    """Every route by its tag, with its parameters, its body and its answers."""
    document = _document(root)
    text: str = "# REST routes\n\n" + document["info"]["description"] + "\n\n" + ROUTES_INTRODUCTION
    for tag, operations in _by_tag(document).items():
        text += f"## {tag[:1].upper()}{tag[1:]}\n\n"
        text += (
            table(("route", ""), ((_route_link(*operation), _title(operation[2])) for operation in operations)) + "\n"
        )
        text += "".join(_operation(*operation) for operation in operations)
    return text


def models_page(root: Path) -> str:
    """Every schema with its properties."""
    schemas = _document(root)["components"]["schemas"]
    return MODELS_INTRODUCTION + "".join(_model(name, schema) for name, schema in sorted(schemas.items()))


def _document(root: Path) -> Json:
    return json.loads((root / "web/openapi.json").read_text(encoding="utf-8"))  # type: ignore[no-any-return]


def _operations(document: Json) -> Iterator[tuple[str, str, Json]]:
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            yield method.upper(), path, operation


def _by_tag(document: Json) -> dict[str, list[tuple[str, str, Json]]]:
    tags: dict[str, list[tuple[str, str, Json]]] = {}
    for operation in _operations(document):
        tags.setdefault(operation[2].get("tags", ["other"])[0], []).append(operation)
    return dict(sorted(tags.items(), key=lambda item: item[0] == "system"))


def _title(operation: Json) -> str:
    return " ".join(_description(operation).split("\n\n")[0].split())


def _description(operation: Json) -> str:
    return str(operation.get("description") or operation.get("summary") or "")


def _route_link(method: str, path: str, operation: Json) -> str:
    return f"[`{method} {path}`](#{anchor(operation['operationId'])})"


def _operation(method: str, path: str, operation: Json) -> str:
    name = operation["operationId"]
    text = f"### `{method} {path}` {{ #{anchor(name)} data-toc-label='{name}' }}\n\n"
    text += _description(operation) + "\n\n"
    if parameters := operation.get("parameters"):
        rows = ((f"`{one['name']}`", one["in"], _value(one["schema"]), _meaning(one)) for one in parameters)
        text += table(("parameter", "in", "value", "meaning"), rows) + "\n"
    if body := operation.get("requestBody"):
        text += f"Body: {_content(body)}.\n\n"
    answers = (
        (f"`{status}`", _content(answer), answer.get("description", "").replace("Successful Response", ""))
        for status, answer in operation["responses"].items()
    )
    return text + table(("status", "content", "meaning"), answers) + "\n"


def _content(holder: Json) -> str:
    """Types of a body or an answer, with the media type where it is not JSON."""
    kinds = []
    for media, content in holder.get("content", {}).items():
        shown = _value(content.get("schema", {}))
        kinds.append(shown if media == "application/json" else f"`{media}`")
    return " or ".join(dict.fromkeys(kinds))


def _model(name: str, schema: Json) -> str:
    text = f"## {name} {{ #{anchor(name)} }}\n\n"
    if description := schema.get("description"):
        text += f"{description}\n\n"
    if properties := schema.get("properties"):
        required = schema.get("required", ())
        rows = (
            (f"`{key}`" + (" *" if key in required else ""), _value(one), _meaning(one))
            for key, one in properties.items()
        )
        text += table(("property", "value", "meaning"), rows)
    else:
        text += f"{_value(schema)}\n"
    return text + "\n"


def _meaning(holder: Json) -> str:
    schema = holder.get("schema", holder)
    text = str(holder.get("description") or schema.get("description", ""))
    default = schema.get("default")
    return text + (f" Default `{json.dumps(default)}`." if default not in (None, {}, [], "") else "")


def _value(schema: Json) -> str:
    """The type of a JSON schema in words."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f"[{name}](models.md#{anchor(name)})"
    for several in ("anyOf", "oneOf", "allOf"):
        if several in schema:
            return " or ".join(dict.fromkeys(_value(one) for one in schema[several]))
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    kind = schema.get("type", "any value")
    if kind == "array":
        return _array(schema)
    if kind == "object" and isinstance(schema.get("additionalProperties"), dict):
        return f"object of {_value(schema['additionalProperties'])}"
    return str(kind) + _limits(schema)


def _array(schema: Json) -> str:
    if items := schema.get("prefixItems"):
        return "[" + ", ".join(_value(one) for one in items) + "]"
    return "array of " + _value(schema.get("items", {}))


def _limits(schema: Json) -> str:
    low = schema.get("minimum", schema.get("exclusiveMinimum"))
    high = schema.get("maximum", schema.get("exclusiveMaximum"))
    if low is not None and high is not None:
        return f", {_number(low)} to {_number(high)}"
    if low is not None:
        return f", above {_number(low)}" if "exclusiveMinimum" in schema else f", {_number(low)} or more"
    if high is not None:
        return f", at most {_number(high)}"
    return ""


def _number(value: float) -> str:
    return f"{int(value):,}" if value == int(value) else f"{value:g}"
