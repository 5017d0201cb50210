"""Binds frozen dataclasses to USD properties: reads them at a time, and authors what changed."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import fields, replace
from typing import Any, TypeVar

from pxr import Sdf, Usd

from usd_schemas.errors import SchemaError
from usd_schemas.keys import following_interpolation, set_key, takes_spline
from usd_schemas.values import Time, is_animated, read_value, stored_value, usd_value

Data = TypeVar("Data")


def property_names(kind: type) -> Iterator[str]:
    """Names of the USD properties that a dataclass stands for, without any instance's prefix."""
    for item in fields(kind):
        if "group" in item.metadata:
            yield from property_names(item.metadata["group"])
        elif "usd" in item.metadata:
            yield item.metadata["usd"]


def property_values(data: Any) -> Iterator[tuple[str, Any]]:
    """Name and value of each USD property that a dataclass says, without any instance's prefix."""
    for item in fields(data):
        value = getattr(data, item.name)
        if "group" in item.metadata:
            yield from property_values(value)
        elif "usd" in item.metadata:
            yield item.metadata["usd"], value


def read(kind: type[Data], prim: Usd.Prim, time: Time = None, prefix: str = "", **given: Any) -> Data:
    """Read a dataclass from a prim that has its schema applied.

    Args:
        kind: the dataclass.
        prim: the camera.
        time: USD time code, None for the default time.
        prefix: what stands before each property's name.
        given: fields that are not attributes.
    """
    values: dict[str, Any] = dict(given)
    for item in fields(kind):  # type: ignore[arg-type]
        if "group" in item.metadata:
            values[item.name] = read(item.metadata["group"], prim, time, prefix)
        elif "usd" in item.metadata:
            value = read_value(prim.GetAttribute(prefix + item.metadata["usd"]), time)
            values[item.name] = item.default if value is None else value
    return kind(**values)


def read_over(
    kind: type[Data], prim: Usd.Prim, times: Sequence[float], prefix: str = "", **given: Any
) -> tuple[Data, ...]:
    """Read a dataclass at some times: what is not animated once for all of them.

    Args:
        kind: the dataclass.
        prim: the camera.
        times: USD time codes.
        prefix: what stands before each property's name.
        given: fields that are not attributes.
    """
    if not times:
        return ()
    first = read(kind, prim, times[0], prefix, **given)
    attributes = {name: prim.GetAttribute(prefix + name) for name in property_names(kind)}
    animated = {name for name, attribute in attributes.items() if attribute and is_animated(attribute)}
    if not animated:
        return (first,) * len(times)
    return (first, *(_reread(first, animated, prim, time, prefix) for time in times[1:]))


def _reread(data: Data, names: Collection[str], prim: Usd.Prim, time: Time, prefix: str) -> Data:
    """A dataclass with some of its properties, and all of its groups that have such, read at another time."""
    values: dict[str, Any] = {}
    for item in fields(data):  # type: ignore[arg-type]
        if "group" in item.metadata:
            group = item.metadata["group"]
            if not set(names).isdisjoint(property_names(group)):
                values[item.name] = read(group, prim, time, prefix)
        elif item.metadata.get("usd") in names:
            value = read_value(prim.GetAttribute(prefix + item.metadata["usd"]), time)
            values[item.name] = item.default if value is None else value
    return replace(data, **values)  # type: ignore[type-var]


def author(data: Any, prim: Usd.Prim, time: Time = None, prefix: str = "") -> None:
    """Author those fields of a dataclass that differ from what the prim says at the time.

    Without a time the value is authored as the attribute's default; with one, and unless the property is uniform, as a
    key. What the prim says already is left alone, so that an edit pins nothing that it does not mean.

    Raises:
        SchemaError: a value is not allowed; or it differs from an attribute that has keys and no time is given. Nothing
            is authored then.
    """
    for attribute, value, keyed_at in list(_changes(data, prim, time, prefix)):
        if keyed_at is None:
            attribute.Set(usd_value(attribute, value))
        else:
            style = following_interpolation(attribute, keyed_at) if takes_spline(attribute) else "linear"
            set_key(attribute, keyed_at, value, style)


def _changes(data: Any, prim: Usd.Prim, time: Time, prefix: str) -> Iterator[tuple[Usd.Attribute, Any, Time]]:
    """Yield what to author, checked: attribute, value, and the time of the key or None for a default."""
    for item in fields(data):
        value = getattr(data, item.name)
        if "group" in item.metadata:
            yield from _changes(value, prim, time, prefix)
        elif "usd" in item.metadata:
            attribute = prim.GetAttribute(prefix + item.metadata["usd"])
            keyed_at = None if attribute.GetVariability() == Sdf.VariabilityUniform else time
            current = _read_or_default(attribute, keyed_at, item.default)
            # A value that the prim has already is not checked: another tool may have written one that is not allowed.
            if value != current and stored_value(attribute, value) != current:
                _refuse_hidden(attribute, value, keyed_at)
                yield attribute, value, keyed_at


def _read_or_default(attribute: Usd.Attribute, time: Time, fallback: Any) -> Any:
    value = read_value(attribute, time)
    return fallback if value is None else value


def _refuse_hidden(attribute: Usd.Attribute, value: Any, keyed_at: Time) -> None:
    """Raise where a default would not be seen, because keys hide it."""
    if keyed_at is None and is_animated(attribute):
        raise SchemaError(
            f"{attribute.GetPath()} has keys: expected the time at which it shall be {value!r}, or its keys to be "
            "removed first"
        )


def allowed(data: Data, prim: Usd.Prim, prefix: str = "") -> Data:
    """Return a dataclass with the defaults of its fields in place of values that are not allowed."""
    refused: dict[str, Any] = {}
    for item in fields(data):  # type: ignore[arg-type]
        if "usd" in item.metadata:
            try:
                usd_value(prim.GetAttribute(prefix + item.metadata["usd"]), getattr(data, item.name))
            except SchemaError:
                refused[item.name] = item.default
    return replace(data, **refused)  # type: ignore[type-var]


def author_all(data: Any, prim: Usd.Prim, prefix: str = "") -> None:
    """Author every attribute of a dataclass as a default, over keys and values of weaker layers.

    Raises:
        SchemaError: a value is not allowed; nothing is authored then.
    """
    pairs = [
        (prim.GetAttribute(prefix + item.metadata["usd"]), getattr(data, item.name))
        for item in fields(data)
        if "usd" in item.metadata
    ]
    for attribute, value in [(attribute, usd_value(attribute, value)) for attribute, value in pairs]:
        attribute.Clear()
        attribute.Set(value)


def author_for_all_time(attribute: Usd.Attribute, value: Any) -> None:
    """Author a value over the keys and values of weaker layers, unless the attribute has it already.

    Raises:
        SchemaError: the value is not allowed; nothing is authored then.
    """
    current = read_value(attribute)
    if is_animated(attribute) or current is None or stored_value(attribute, value) != current:
        checked = usd_value(attribute, value)
        attribute.Clear()
        attribute.Set(checked)


def has_opinion(attribute: Usd.Attribute) -> bool:
    """Whether an attribute has keys, or an authored value other than its fallback."""
    if not attribute or not attribute.HasAuthoredValue():
        return False
    if is_animated(attribute):
        return True
    fallback = attribute.GetFallbackValue() if attribute.HasFallbackValue() else Sdf.AssetPath()
    return bool(attribute.Get() != fallback)
