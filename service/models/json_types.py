"""Takes the types of JSON for what they are: ``true`` is no number, ``"2"`` neither, and 1 is no truth value.

Pydantic by itself converts them into each other. Its strict mode does not, but refuses lists as tuples, and 2.0 as an integer,
which it is in JSON Schema (draft 2020-12, section 6.1.1 of the validation vocabulary).
"""

from __future__ import annotations

from typing import Any, cast

from pydantic_core import CoreSchema, PydanticCustomError, core_schema


def with_json_types(schema: CoreSchema) -> CoreSchema:
    """Return a validator whose numbers and truth values take nothing else; the JSON schema stays the same.

    Args:
        schema: any validator; references to other models are left alone.
    """
    return cast(CoreSchema, _walked(schema))


def _walked(part: Any) -> Any:
    match part:
        case {"type": "float" | "int"}:
            return core_schema.no_info_before_validator_function(_number, part)
        case {"type": "bool"}:
            return core_schema.no_info_before_validator_function(_truth_value, part)
        case {"type": "function-before", "function": {"function": known}} if known in (_number, _truth_value):
            return part
        case {"type": "literal" | "enum"}:
            return part
        case dict():
            return {key: value if key == "metadata" else _walked(value) for key, value in part.items()}
        case list():
            return [_walked(value) for value in part]
        case tuple():
            return tuple(_walked(value) for value in part)
    return part


def _number(value: object) -> object:
    if isinstance(value, bool | str | bytes):
        raise PydanticCustomError("number_expected", "Input should be a number")
    return value


def _truth_value(value: object) -> object:
    if isinstance(value, int | float | str | bytes) and not isinstance(value, bool):
        raise PydanticCustomError("truth_value_expected", "Input should be true or false")
    return value
