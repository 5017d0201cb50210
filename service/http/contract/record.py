"""The record of the contract: the part of the OpenAPI document that clients rely on, as it was last accepted."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from service.http.contract.kinds import Json
from service.http.contract.operations import MESSAGES
from service.http.contract.schemas import Finding

RECORD = Path(__file__).with_name("v1.json")
"""The record of version 1."""
COMMAND = "python -m service.http.contract"
_PROMISED = ("paths", "components", "security", "servers", MESSAGES)
_PROSE = ("title", "summary", "description", "example", "examples", "externalDocs", "tags", "links")
_BY_NAME = ("properties", "patternProperties", "schemas", "securitySchemes", "paths", "responses", "content", "headers")
"""Members whose own members have names of the API, which may be those of prose, too."""
_VALUES = ("default", "enum", "const", "required")
_MOST_SHOWN = 5


def contract_of(document: Json) -> Json:
    """Return the part of an OpenAPI document that clients rely on: no prose, and no version."""
    return {member: _without_prose(document[member], member) for member in _PROMISED if member in document}


def contract_text(document: Json) -> str:
    """Return the contract of an OpenAPI document as the record has it."""
    return json.dumps(contract_of(document), indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def report(breaks: Mapping[Finding, Sequence[str]]) -> str:
    """Return breaking changes as text, one a line, and the two ways on.

    Args:
        breaks: as `breaking_changes` returns them.
    """
    lines = [f"- {finding}. Concerns {_some(operations)}." for finding, operations in sorted(breaks.items())]
    return "\n".join(
        [
            "Clients of API v1 break by these changes:",
            *lines,
            "Keep the old form beside the new one, so that clients go on working. To break them on purpose, run",
            f"`{COMMAND} --accept`, and name the break in the subject of the commit.",
        ]
    )


def _some(operations: Sequence[str]) -> str:
    shown = ", ".join(operations[:_MOST_SHOWN])
    more = len(operations) - _MOST_SHOWN
    return f"{shown} and {more} more" if more > 0 else shown


def _without_prose(node: Any, member: str = "") -> Any:
    if member in _VALUES:
        return node
    if isinstance(node, list):
        return [_without_prose(one) for one in node]
    if not isinstance(node, dict):
        return node
    if member in _BY_NAME:
        return {name: _without_prose(one) for name, one in node.items()}
    return {name: _without_prose(one, name) for name, one in node.items() if name not in _PROSE}
