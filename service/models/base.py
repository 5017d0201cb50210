"""Base class and types of the models: camelCase names, no unknown fields, finite numbers."""

from __future__ import annotations

import base64
import binascii
import math
import re
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, GetCoreSchemaHandler, WithJsonSchema
from pydantic.alias_generators import to_camel
from pydantic.config import JsonDict
from pydantic_core import CoreSchema

from service.models.json_types import with_json_types

NAME_PATTERN = r"^[A-Za-z_][A-Za-z0-9_]*$"
PRIM_PATH_PATTERN = r"^/.*$"
MAX_POINT_NAME = 200
"""Length of a focus point's name in a shot, which may be another tool's."""


class Model(BaseModel):
    """Base of every model: camelCase outside, snake_case inside; NaN and unknown fields are refused.

    Attributes:
        is_text: whether its values come as text, as those of a query do; else a text is no number, and neither is ``true``.
    """

    is_text: ClassVar[bool] = False

    model_config = ConfigDict(
        alias_generator=to_camel,
        populate_by_name=True,
        extra="forbid",
        allow_inf_nan=False,
        from_attributes=True,
        frozen=True,
    )

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler, /) -> CoreSchema:
        """Return the validator of the model, which takes the types of JSON for what they are."""
        schema = handler(source)
        return schema if cls.is_text else with_json_types(schema)


def shown_as(example: JsonDict) -> ConfigDict:
    """Return a model configuration that adds an example to the OpenAPI document."""
    return ConfigDict(json_schema_extra={"example": example})


def _finite_or_none(value: object) -> object:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def plain_file_name(sent: str) -> str:
    """The last part of a file name, without what a path or a shell gives a meaning to.

    Args:
        sent: a name or a path, with slashes of either kind.
    """
    last = re.split(r"[/\\\\]", sent)[-1]
    return re.sub(r"[^\w.\- ]", "_", last).lstrip(".")[-120:]


def _name_of_file(sent: str) -> str:
    name = plain_file_name(sent)
    if not name:
        raise ValueError(f"a file's name is expected, got {sent[:80]!r}")
    return name


def _decode_base64(value: object) -> object:
    """Bytes of base64 text; bytes stay what they are. Raises `ValueError`: it is no base64."""
    if not isinstance(value, str):
        return value
    try:
        return base64.b64decode(value, validate=True)
    except binascii.Error as error:
        raise ValueError(f"a file's content is expected in base64: {error}") from error


# JSON has no infinity and no NaN: a distance that is infinite, or that does not exist, is null.
Distance = Annotated[float | None, BeforeValidator(_finite_or_none)]
PrimPath = Annotated[str, Field(pattern=PRIM_PATH_PATTERN, max_length=2000)]
PointName = Annotated[str, Field(pattern=NAME_PATTERN, max_length=100)]
FileName = Annotated[str, Field(min_length=1, max_length=1000), AfterValidator(_name_of_file)]
FileContent = Annotated[
    bytes,
    BeforeValidator(_decode_base64),
    WithJsonSchema({"type": "string", "format": "byte", "contentEncoding": "base64"}),
]
Vector3 = tuple[float, float, float]
Pair = Annotated[
    tuple[float, float],
    WithJsonSchema({"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}),
]
"""Two numbers of one kind, documented without `prefixItems`, which drafts of JSON Schema before 2020-12 call `items`."""

# Bounds of what is written to USD, so that no number overflows in later computations.
TimeCode = Annotated[float, Field(ge=-1e9, le=1e9)]
Index = Annotated[int, Field(ge=-1, le=2**31 - 1)]
Amount = Annotated[float, Field(ge=0, le=1e6)]
Length = Annotated[float, Field(ge=-1e9, le=1e9)]
Ratio = Annotated[float, Field(ge=0, le=1)]

KEYS_AT = (
    "USD time code of keys; without it, keys go and the values hold for all time. Words and lists hold for all time "
    "either way."
)


class Finding(Model):
    """A finding and its subject."""

    path: str = Field(description="File, prim or parameter.")
    detail: str = Field(description="One sentence.")


class Problem(Model):
    """Body of every error."""

    code: str = Field(description="Short stable word for programs.", examples=["shot_not_found"])
    detail: str = Field(description="One sentence for people.", examples=["There is no shot 'night'."])
    path: str | None = Field(default=None, description="File, prim or parameter concerned.", examples=["night"])
    errors: list[Finding] = Field(default=[], description="The single findings, where there are several.")
