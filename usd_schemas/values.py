"""One attribute at a time: USD values to plain Python and back, checked against what the schema allows."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd

from usd_schemas.errors import SchemaError
from usd_schemas.settings import Asset

Time = float | None

_ANIMATED_BY = (
    Usd.ResolveInfoSourceTimeSamples,
    Usd.ResolveInfoSourceValueClips,
    Usd.ResolveInfoSourceSpline,
)


def time_code(time: Time) -> Usd.TimeCode:
    """USD's time code for a time, or the default time for None.

    Raises:
        SchemaError: the time is not a finite number.
    """
    if time is None:
        return Usd.TimeCode.Default()
    if not math.isfinite(time):
        raise SchemaError(f"a time code must be a finite number, got {time}")
    return Usd.TimeCode(float(time))


def is_animated(attribute: Usd.Attribute) -> bool:
    """Whether the attribute's value comes from keys: time samples, a spline or value clips."""
    return attribute.GetResolveInfo(Usd.TimeCode.EarliestTime()).GetSource() in _ANIMATED_BY


def read_value(attribute: Usd.Attribute, time: Time = None) -> Any:
    """The attribute's value at a time as plain Python: tuples for vectors and arrays, `Asset` for files.

    None and NaN are the default time.

    None where there is no value, or where some layer has one of another type than the schema's: USD hands that out as it
    is, and the rule "AuthoredTypes" names it. A uniform attribute has one value for all times: keys authored on it are
    ignored.
    """
    value = _plain(attribute.Get(_reading_code(attribute, time)))
    return value if value is not None and _fits(attribute.GetTypeName(), value) else None


def _reading_code(attribute: Usd.Attribute, time: Time) -> Usd.TimeCode:
    has_one_value = attribute.GetVariability() == Sdf.VariabilityUniform
    return time_code(None if time is None or math.isnan(time) or has_one_value else time)


def misfit(attribute: Usd.Attribute, time: Time = None) -> str:
    """The type of a value that `read_value` passes over because it is another than the schema's; empty where it is not."""
    value = attribute.Get(_reading_code(attribute, time))
    if value is None or _fits(attribute.GetTypeName(), _plain(value)):
        return ""
    return str(Sdf.GetValueTypeNameForValue(value)) or type(value).__name__


def usd_value(attribute: Usd.Attribute, value: Any) -> Any:
    """Return a plain Python value as USD wants it for this attribute.

    Raises:
        SchemaError: it is of the wrong kind or shape, not finite, beyond the schema's hard limits, or not one of the
            allowed tokens.
    """
    kind = attribute.GetTypeName()
    convert = _SCALARS[str(kind.scalarType)]
    try:
        if kind.isArray:
            converted = [convert(item) for item in value]
            if isinstance(value, str):
                raise TypeError
        else:
            converted = convert(value)
    except (TypeError, ValueError):
        raise SchemaError(f"{attribute.GetPath()} is of type {kind}, got {value!r}") from None
    _check_allowed(attribute, converted)
    return converted


def stored_value(attribute: Usd.Attribute, value: Any) -> Any:
    """The plain value as the attribute gives it back: floats of single precision are rounded."""
    return _plain(usd_value(attribute, value))


def _plain(value: Any) -> Any:
    if isinstance(value, Sdf.AssetPath):
        return Asset(value.path, value.resolvedPath)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    return tuple(_plain(item) for item in value)


def _fits(kind: Sdf.ValueTypeName, value: Any) -> bool:
    """Whether a plain value is of a type, but for its precision."""
    scalar = str(kind.scalarType)
    if kind.isArray:
        return isinstance(value, tuple) and all(_is_scalar(scalar, item) for item in value)
    return _is_scalar(scalar, value)


def _is_scalar(scalar: str, value: Any) -> bool:
    size = _SIZES.get(scalar)
    if size is not None:
        return isinstance(value, tuple) and len(value) == size and all(isinstance(item, int | float) for item in value)
    return isinstance(value, _PLAIN.get(scalar, object))


def _check_allowed(attribute: Usd.Attribute, value: Any) -> None:
    tokens = attribute.GetMetadata("allowedTokens")
    if tokens and value not in tokens:
        raise SchemaError(f"{attribute.GetPath()} must be one of {', '.join(tokens)}, got {value!r}")
    problem = limit_problem(attribute, value)
    if problem:
        raise SchemaError(f"{attribute.GetPath()} {problem}")


def limit_problem(attribute: Usd.Attribute, value: Any) -> str:
    """Describe how a number breaks the attribute's hard limits ("must be at least 0, got -1"); empty where it does not."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    hard = attribute.GetHardLimits()
    least, most = hard.GetMinimum(), hard.GetMaximum()
    if least is not None and value < least:
        return f"must be at least {least:g}, got {value:g}"
    if most is not None and value > most:
        return f"must be at most {most:g}, got {value:g}"
    return ""


def _switch(value: Any) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise TypeError
    return bool(value)


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError
    return int(value)


def _double(value: Any) -> float:
    if isinstance(value, bool | str) or not math.isfinite(float(value)):
        raise TypeError
    return float(value)


def _single(value: Any) -> float:
    with np.errstate(over="ignore"):  # what single precision cannot hold is infinite
        return _double(np.float32(_double(value)))


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError
    return str(value)


def _asset(value: Any) -> Sdf.AssetPath:
    return Sdf.AssetPath(value.path if isinstance(value, Asset) else _text(value))


def _vector(kind: type, number: Callable[[Any], float], size: int) -> Callable[[Any], Any]:
    def convert(value: Any) -> Any:
        items = [number(item) for item in value]
        if len(items) != size:
            raise ValueError
        return kind(*items)

    return convert


_PLAIN = {"bool": bool, "int": int, "double": float, "float": float, "token": str, "string": str, "asset": Asset}
_SIZES = {"int2": 2, "float2": 2, "double2": 2, "double3": 3, "color3d": 3}

_SCALARS: dict[str, Callable[[Any], Any]] = {
    "bool": _switch,
    "int": _whole,
    "double": _double,
    "float": _single,
    "token": _text,
    "string": _text,
    "asset": _asset,
    "int2": _vector(Gf.Vec2i, _whole, 2),
    "float2": _vector(Gf.Vec2f, _single, 2),
    "double2": _vector(Gf.Vec2d, _double, 2),
    "double3": _vector(Gf.Vec3d, _double, 3),
    "color3d": _vector(Gf.Vec3d, _double, 3),
}
