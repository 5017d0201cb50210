"""Properties of a camera that a spline can drive over time, and the values that they may have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from pxr import Sdf, Ts, Usd

from usd_schemas.curve_fit import Doubles, checked_samples
from usd_schemas.errors import SchemaError
from usd_schemas.registration import LENS_CAMERA, SINGLE_APPLY

_POSITIVE = ("focusDistance", "focalLength")
_NOT_NEGATIVE = ("fStop",)


@dataclass(frozen=True, eq=False)
class Channel:
    """One attribute of a camera over time.

    Attributes:
        name: of the attribute, such as "focusDistance" or "tiltShift:tilt".
        type: of the attribute, a single float or double.
        schema: which of our schemas it belongs to, empty for UsdGeomCamera's own.
        times: ``(n,)`` rising time codes.
        values: ``(n,)`` in the attribute's own unit.
    """

    name: str
    type: Sdf.ValueTypeName
    schema: str
    times: Doubles
    values: Doubles


def checked_channels(times: ArrayLike, values: Mapping[str, ArrayLike]) -> list[Channel]:
    """The channels that attributes' values over time make.

    Args:
        times: ``(n,)`` rising time codes.
        values: ``(n,)`` for each attribute, by its USD name, in its own unit.

    Raises:
        SchemaError: a camera has no such attribute or it takes no spline, its values make no curve, or one is beyond what the
            attribute allows.
    """
    if not values:
        raise SchemaError("a camera's curves need at least one attribute")
    return [_checked(name, times, samples) for name, samples in values.items()]


def _checked(name: str, times: ArrayLike, values: ArrayLike) -> Channel:
    definition = Usd.SchemaRegistry().FindConcretePrimDefinition(LENS_CAMERA)
    attribute = definition.GetAttributeDefinition(name)
    if not attribute or not Ts.Spline.IsSupportedValueType(attribute.GetTypeName().type):
        raise SchemaError(f"a camera has no attribute {name!r} that takes a spline, a single float or double")
    t, v = checked_samples(times, values)
    _check_range(name, definition.GetPropertyMetadata(name, "limits") or {}, t, v)
    return Channel(name, attribute.GetTypeName(), _schema_of(name), t, v)


def _check_range(name: str, limits: Mapping[str, Mapping[str, float]], t: Doubles, v: Doubles) -> None:
    hard = limits.get("hard", {})
    least = 0.0 if name in (*_POSITIVE, *_NOT_NEGATIVE) else hard.get("minimum", -np.inf)
    bad = np.flatnonzero((v < least) | (v > hard.get("maximum", np.inf)) | ((v <= 0) & (name in _POSITIVE)))
    if not len(bad):
        return
    got = f"got {v[bad[0]]:g} at time {t[bad[0]]:g}"
    if name in _POSITIVE:
        raise SchemaError(f"{name} must be positive, {got}")
    most = f" and at most {hard['maximum']:g}" if "maximum" in hard else ""
    raise SchemaError(f"{name} must be at least {least:g}{most}, {got}")


def _schema_of(name: str) -> str:
    registry = Usd.SchemaRegistry()
    owners = (s for s in SINGLE_APPLY if name in registry.FindAppliedAPIPrimDefinition(s).GetPropertyNames())
    return next(owners, "")
