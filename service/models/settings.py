"""Derives models of settings from their declarations in `usd_schemas.settings`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin

from pydantic import Field, create_model
from pydantic.config import JsonDict, JsonValue

from service.models.base import Model
from usd_schemas.settings import Asset
from usd_schemas.settings.setting import Bounds, Resource, Setting
from usd_schemas.settings.tables import POINT_SETTINGS, SETTINGS, rest_settings

Kind = TypeVar("Kind", bound=Model)


def with_settings(resource: Resource) -> Callable[[type[Kind]], type[Kind]]:
    """Give a model a field for each setting of a resource that it does not have itself."""

    def fields() -> Mapping[str, Any]:
        return {
            item.field_name: (_read_type(item.type), Field(description=item.rest_doc))
            for item in rest_settings(resource)
        }

    return lambda model: _with_fields(model, fields())


def with_edits(resource: Resource) -> Callable[[type[Kind]], type[Kind]]:
    """Give a model an optional field for each setting of a resource that can be set, within the declared bounds."""

    def fields() -> Mapping[str, Any]:
        return {
            item.field_name: (_edit_type(item) | None, Field(default=None, description=item.rest_doc))
            for item in rest_settings(resource)
            if not item.read_only
        }

    return lambda model: _with_fields(model, fields())


def with_values(resource: Resource) -> Callable[[type[Kind]], type[Kind]]:
    """Give a model a field for each setting of a resource that can be set, at its default where it is left out."""

    def fields() -> Mapping[str, Any]:
        return {
            item.field_name: (_edit_type(item), Field(default=item.default, description=item.rest_doc))
            for item in rest_settings(resource)
            if not item.read_only
        }

    return lambda model: _with_fields(model, fields())


def keyed_names(*resources: Resource) -> tuple[str, ...]:
    """REST's names of the settings of some resources that take keys."""
    return tuple(item.camel_name for name in resources for item in rest_settings(name) if item.rest_keyable)


def example_of(resource: Resource, values: JsonDict) -> JsonDict:
    """An example of a resource's settings: their defaults, with ``values`` in place of some and beside them."""
    defaults = {item.camel_name: _as_json(item.default) for item in rest_settings(resource)}
    return defaults | values


def edit_field(name: str) -> Any:
    """A field of an edit for a number, by its name in Python: optional, with the bounds and the documentation declared."""
    item = SETTINGS[name]
    return Field(default=None, description=item.rest_doc, **_limits(item.sent))


def point_field(name: str) -> Any:
    """A field of a focus point, by its name in Python, with the declared default and documentation, and a number's bounds."""
    item = POINT_SETTINGS[name]
    limits = _limits(item.sent) if item.type in (float, int) else {}
    return Field(default=item.default, description=item.rest_doc, **limits)


def _edit_type(item: Setting) -> Any:
    """The type of a value that REST sets, with the bounds that the setting declares."""
    return _bounded(item.type, item.sent)


def _with_fields(model: type[Kind], fields: Mapping[str, Any]) -> type[Kind]:
    new = {name: field for name, field in fields.items() if name not in model.model_fields}
    return create_model(model.__name__, __base__=model, __module__=model.__module__, __doc__=model.__doc__, **new)


def _read_type(hint: Any) -> Any:
    return str if hint is Asset else hint


def _bounded(hint: Any, bounds: Bounds) -> Any:
    """A type with bounds on each of its numbers, and on how long a word or a list is."""
    if hint in (float, int):
        return Annotated[hint, Field(**_limits(bounds))]
    if hint is str:
        return Annotated[str, Field(max_length=bounds.length)]
    if get_origin(hint) is tuple:
        kinds = get_args(hint)
        if kinds[-1] is ...:
            return Annotated[tuple[_bounded(kinds[0], bounds), ...], Field(max_length=bounds.length)]  # type: ignore[misc]
        return tuple[tuple(_bounded(kind, bounds) for kind in kinds)]  # type: ignore[misc]
    if hint is bool or get_origin(hint) is Literal:
        return hint
    raise TypeError(f"REST has no values of type {hint}")


def _limits(bounds: Bounds) -> dict[str, Any]:
    return {"gt" if bounds.above else "ge": bounds.least, "le": bounds.most}


def _as_json(value: Any) -> JsonValue:
    if isinstance(value, tuple):
        return [_as_json(part) for part in value]
    return value.path if isinstance(value, Asset) else value
