"""Keys over time on one attribute, in the stage's edit target.

Numbers (double, float) are keyed in a native ``Ts.Spline``; everything else in time samples, where vectors and arrays
are joined by straight lines and switches, whole numbers and tokens hold until the next key. An attribute never has both
in the layer that is edited: samples would hide the spline. Keys that live in a weaker layer are copied on the first edit,
since a layer's keys replace those of weaker ones as a whole.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, get_args

from pxr import Sdf, Ts, Usd

from usd_schemas.errors import SchemaError
from usd_schemas.values import is_animated, read_value, time_code, usd_value

Interpolation = Literal["linear", "held", "bezier", "auto"]
INTERPOLATIONS: tuple[str, ...] = get_args(Interpolation)

_TS_INTERPOLATION = {
    "linear": Ts.InterpLinear,
    "held": Ts.InterpHeld,
    "bezier": Ts.InterpCurve,
    "auto": Ts.InterpCurve,
}


@dataclass(frozen=True)
class Tangents:
    """The handles of a Bezier key.

    Attributes:
        in_slope: of the handle before the key, in the attribute's unit for each time code.
        in_width: how far it reaches back, in time codes; 0 becomes a third of the way to the key before.
        out_slope: of the handle after the key.
        out_width: how far it reaches on; 0 becomes a third of the way to the key after.
    """

    in_slope: float = 0.0
    in_width: float = 0.0
    out_slope: float = 0.0
    out_width: float = 0.0


@dataclass(frozen=True)
class Key:
    """A value at a time.

    Attributes:
        time: USD time code.
        value: number, switch, text or tuple of numbers.
        interpolation: how the value goes on to the next key. "auto" has eased tangents that follow its neighbours and
            never overshoot; "bezier" keeps the tangents that it was given.
        tangents: of a bezier key, else None.
    """

    time: float
    value: Any
    interpolation: Interpolation
    tangents: Tangents | None = None


def takes_spline(attribute: Usd.Attribute) -> bool:
    """Whether the attribute is keyed by a spline: a single double, float or half."""
    return bool(Ts.Spline.IsSupportedValueType(attribute.GetTypeName().type))


def keys(attribute: Usd.Attribute) -> list[Key]:
    """The attribute's keys in order of time, from whichever layer wins; empty where it has none.

    A time sample that blocks the value is not a key.
    """
    if attribute.HasSpline():
        return [_key(knot) for knot in attribute.GetSpline().GetKnots().values()]
    joined: Interpolation = "linear" if _interpolates(attribute) else "held"
    samples = [(time, read_value(attribute, time)) for time in attribute.GetTimeSamples()]
    return [Key(time, value, joined) for time, value in samples if value is not None]


def set_key(
    attribute: Usd.Attribute,
    time: float,
    value: Any,
    interpolation: Interpolation = "linear",
    tangents: Tangents | None = None,
) -> None:
    """Set, or replace, the key at a time.

    Args:
        attribute: what to key; on a stage whose edit target takes the key.
        time: USD time code.
        value: in the attribute's own unit.
        interpolation: how the value goes on to the next key. What cannot be interpolated holds, and takes "linear" or
            "held" alike.
        tangents: of a bezier key; None gives it those that an auto key would have now.

    Raises:
        SchemaError: the attribute is uniform, the value is not allowed, or the interpolation does not suit its type.
    """
    if interpolation not in INTERPOLATIONS:
        expected = ", ".join(INTERPOLATIONS)
        raise SchemaError(f"the interpolation of a key must be one of {expected}, got {interpolation!r}")
    if attribute.GetVariability() == Sdf.VariabilityUniform:
        raise SchemaError(f"{attribute.GetPath()} is uniform: it has one value for all times and takes no keys")
    code = time_code(time)
    converted = usd_value(attribute, value)
    if takes_spline(attribute):
        spline = _editable_spline(attribute)
        spline.SetKnot(_knot(spline, code.GetValue(), converted, interpolation))
        if interpolation == "bezier":
            spline.SetKnot(_with_tangents(spline.GetKnot(code.GetValue()), tangents))
        _reach_neighbours(spline)
        author_spline(attribute, spline)
        return
    if interpolation not in ("linear", "held") or (interpolation == "held" and _interpolates(attribute)):
        allowed = "linear" if _interpolates(attribute) else "held"
        raise SchemaError(
            f"{attribute.GetPath()} of type {attribute.GetTypeName()} takes {allowed} keys alone, got {interpolation}"
        )
    _own_samples(attribute)
    attribute.Set(converted, code)


def remove_key(attribute: Usd.Attribute, time: float) -> None:
    """Remove the key at a time; after the last one its value stays for all times.

    Raises:
        SchemaError: there is no key at that time.
    """
    existing = keys(attribute)
    found = [key for key in existing if key.time == time]
    if not found:
        times = ", ".join(f"{key.time:g}" for key in existing) or "none"
        raise SchemaError(f"{attribute.GetPath()} has no key at time {time:g}; its keys are at: {times}")
    if len(existing) == 1:
        attribute.Clear()
        attribute.Set(usd_value(attribute, found[0].value))
    elif takes_spline(attribute):
        spline = _editable_spline(attribute)
        spline.RemoveKnot(time)
        author_spline(attribute, spline)
    else:
        _own_samples(attribute)
        attribute.ClearAtTime(time_code(time))


def following_interpolation(attribute: Usd.Attribute, time: float) -> Interpolation:
    """The interpolation that a new key at a time should have: that of the key there or before it, else of the first."""
    existing = keys(attribute)
    before = [key for key in existing if key.time <= time]
    return before[-1].interpolation if before else existing[0].interpolation if existing else "linear"


def _interpolates(attribute: Usd.Attribute) -> bool:
    """Whether USD joins the attribute's time samples by straight lines."""
    return str(attribute.GetTypeName().scalarType) not in ("bool", "int", "int2", "token", "string", "asset")


def _key(knot: Ts.Knot) -> Key:
    following = knot.GetNextInterpolation()
    if following == Ts.InterpLinear:
        return Key(knot.GetTime(), knot.GetValue(), "linear")
    if following != Ts.InterpCurve:
        return Key(knot.GetTime(), knot.GetValue(), "held")
    if knot.GetPostTanAlgorithm() == Ts.TangentAlgorithmAutoEase:
        return Key(knot.GetTime(), knot.GetValue(), "auto")
    tangents = Tangents(knot.GetPreTanSlope(), knot.GetPreTanWidth(), knot.GetPostTanSlope(), knot.GetPostTanWidth())
    return Key(knot.GetTime(), knot.GetValue(), "bezier", tangents)


def _editable_spline(attribute: Usd.Attribute) -> Ts.Spline:
    """A copy of the spline that wins, or the winning time samples as straight lines, or an empty spline."""
    if attribute.HasSpline():
        return attribute.GetSpline()
    spline = Ts.Spline(_type_name(attribute))
    for key in keys(attribute):
        spline.SetKnot(_knot(spline, key.time, key.value, "linear"))
    return spline


def _type_name(attribute: Usd.Attribute) -> str:
    return str(attribute.GetTypeName())


def copy_values(source: Usd.Attribute, goal: Usd.Attribute) -> None:
    """Copy how an attribute changes over time, if it does, to one of the same type."""
    if source.HasSpline():
        author_spline(goal, source.GetSpline())
        return
    for time in source.GetTimeSamples():
        value = source.Get(time)
        goal.Set(Sdf.ValueBlock() if value is None else value, time)


def author_spline(attribute: Usd.Attribute, spline: Ts.Spline) -> None:
    """Author a spline in the edit target, in place of any time samples there."""
    target = attribute.GetStage().GetEditTarget()
    spec = target.GetAttributeSpecForScenePath(attribute.GetPath())
    if spec is not None and spec.HasInfo("timeSamples"):
        spec.ClearInfo("timeSamples")
    attribute.SetSpline(spline)


def _own_samples(attribute: Usd.Attribute) -> None:
    """Copy the time samples of a weaker layer into the edit target, unless it has some of its own."""
    target = attribute.GetStage().GetEditTarget()
    spec = target.GetAttributeSpecForScenePath(attribute.GetPath())
    if not is_animated(attribute) or (spec is not None and spec.HasInfo("timeSamples")):
        return
    for time, value in [(time, attribute.Get(time)) for time in attribute.GetTimeSamples()]:
        attribute.Set(value, time)


def _knot(spline: Ts.Spline, time: float, value: float, interpolation: Interpolation) -> Ts.Knot:
    knot = Ts.Knot(
        typeName=spline.GetValueTypeName(), time=time, value=value, nextInterp=_TS_INTERPOLATION[interpolation]
    )
    if interpolation == "auto" or interpolation == "bezier":
        # USD's own algorithm; a knot without it is read by older versions of USD as well.
        knot.SetPreTanAlgorithm(Ts.TangentAlgorithmAutoEase)
        knot.SetPostTanAlgorithm(Ts.TangentAlgorithmAutoEase)
    return knot


def _with_tangents(knot: Ts.Knot, tangents: Tangents | None) -> Ts.Knot:
    """Freeze the tangents of a knot, as they are or as given."""
    knot.SetPreTanAlgorithm(Ts.TangentAlgorithmNone)
    knot.SetPostTanAlgorithm(Ts.TangentAlgorithmNone)
    if tangents is not None:
        knot.SetPreTanSlope(tangents.in_slope)
        knot.SetPreTanWidth(tangents.in_width)
        knot.SetPostTanSlope(tangents.out_slope)
        knot.SetPostTanWidth(tangents.out_width)
    return knot


def _reach_neighbours(spline: Ts.Spline) -> None:
    """Give a level handle, a third of the way, to each end of a curved segment that has none.

    A knot has none where it is straight or held itself, or was set before there was a neighbour.
    """
    for before, after in pairwise(list(spline.GetKnots().values())):
        if before.GetNextInterpolation() != Ts.InterpCurve:
            continue
        third = (after.GetTime() - before.GetTime()) / 3.0
        if before.GetPostTanAlgorithm() != Ts.TangentAlgorithmAutoEase and before.GetPostTanWidth() == 0:
            before.SetPostTanWidth(third)
            spline.SetKnot(before)
        if after.GetPreTanAlgorithm() != Ts.TangentAlgorithmAutoEase and after.GetPreTanWidth() == 0:
            after.SetPreTanWidth(third)
            spline.SetKnot(after)
