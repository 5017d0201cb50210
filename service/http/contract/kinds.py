"""Alternatives of a JSON schema: what is left of it when references, unions and parts are followed."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Json = Mapping[str, Any]
Schema = Json | bool

COMPOSED = ("$ref", "anyOf", "oneOf", "allOf")
"""Keywords that are followed."""
CONTRADICTIONS = "allOf"
"""Keyword of a kind that keeps what its parts contradict each other in, so that a change of it is seen."""


@dataclass(frozen=True)
class Kind:
    """One alternative of a schema, without references and unions.

    Attributes:
        schema: its keywords.
        component: name of the component that it is, if any.
    """

    schema: Json
    component: str = ""

    @property
    def type(self) -> str | None:
        """The type of JSON; None for any."""
        return self.schema.get("type")

    @property
    def name(self) -> str:
        """The name for people."""
        return self.component or self.type or "anything"

    def with_part(self, other: Kind) -> Kind:
        """Return the kind of what is of both kinds."""
        ours, theirs = self.schema, other.schema
        merged, contradictions = _merge(theirs, ours)
        if "properties" in ours and "properties" in theirs:
            merged["properties"], further = _merge(theirs["properties"], ours["properties"])
            contradictions |= further
        if "required" in merged:
            merged["required"] = sorted({*theirs.get("required", ()), *ours.get("required", ())})
        if contradictions:
            merged[CONTRADICTIONS] = {**merged.get(CONTRADICTIONS, {}), **contradictions}
        return Kind(merged, self.component or other.component)


def _merge(theirs: Json, ours: Json) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the members of both, and those of which there are two values; ours is taken then."""
    names = (ours.keys() & theirs.keys()) - {"properties", "required", CONTRADICTIONS}
    return {**theirs, **ours}, {name: [theirs[name], ours[name]] for name in names if ours[name] != theirs[name]}


def kinds_of(schema: Schema, components: Mapping[str, Schema]) -> list[Kind]:
    """Return the alternatives of a schema, references followed.

    Args:
        schema: of a document.
        components: schemas of the document, by name.
    """
    if isinstance(schema, bool):
        return [Kind({})] if schema else []
    kinds = [Kind({keyword: value for keyword, value in schema.items() if keyword not in (*COMPOSED, "default")})]
    if isinstance(types := schema.get("type"), list):
        kinds = [Kind({**kinds[0].schema, "type": one}) for one in types]
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        parts = [Kind(kind.schema, kind.component or name) for kind in kinds_of(components[name], components)]
        kinds = _with_parts(kinds, parts)
    for several in ("anyOf", "oneOf"):
        if several in schema:
            kinds = _with_parts(kinds, [kind for one in schema[several] for kind in kinds_of(one, components)])
    for one in schema.get("allOf", ()):
        kinds = _with_parts(kinds, kinds_of(one, components))
    return kinds


def _with_parts(kinds: Sequence[Kind], parts: Sequence[Kind]) -> list[Kind]:
    return [kind.with_part(part) for kind in kinds for part in parts]


def has_type(inner: Kind, outer: Kind) -> bool:
    """Whether each value of one kind has the type of another.

    Args:
        inner: the kind of the values.
        outer: the other one.
    """
    return outer.type in (None, inner.type) or (inner.type == "integer" and outer.type == "number")


def has_other_tag(one: Kind, other: Kind) -> bool:
    """Whether two objects are told apart by a property with one value, as by their ``type``.

    Args:
        one: a kind.
        other: another one.
    """
    ours, theirs = _tags(one), _tags(other)
    return any(ours[name] != theirs[name] for name in ours.keys() & theirs.keys())


def _tags(kind: Kind) -> dict[str, object]:
    properties: Mapping[str, Schema] = kind.schema.get("properties", {})
    return {name: one["const"] for name, one in properties.items() if not isinstance(one, bool) and "const" in one}


def values_of(schema: Json) -> list[str] | None:
    """Return the values of a choice as JSON; None where a schema is none.

    Args:
        schema: without references and unions.
    """
    values = [schema["const"]] if "const" in schema else schema.get("enum")
    return None if values is None else [json.dumps(value, ensure_ascii=False) for value in values]
