"""A camera's curves as USD: native splines that an artist can edit, or baked samples for tools that read no splines.

Never both on one attribute in one layer, since samples hide the spline: writing the one removes the other. Any single float
or double of a camera can have one: focusDistance, fStop, focalLength, tiltShift:tilt and so on.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from pxr import Sdf, Ts, Usd, UsdGeom

from usd_schemas.applying import apply
from usd_schemas.channels import Channel, checked_channels
from usd_schemas.curve_fit import Knots, fit_knots
from usd_schemas.errors import SchemaError

EXACT = 5e-7
"""Relative distance between curve and sample below which both are the same in single precision's six digits."""


def author_splines(
    target: Usd.Stage | Sdf.Layer,
    camera_path: str,
    times: ArrayLike,
    values: Mapping[str, ArrayLike],
    tolerances: Mapping[str, ArrayLike] | None = None,
) -> dict[str, Ts.Spline]:
    """Author attributes of a camera as native splines with few knots, in place of what samples or splines were there.

    Args:
        target: a stage, whose edit target takes them, or a layer, where they become an `over` of the camera.
        camera_path: the camera.
        times: ``(n,)`` time codes, increasing.
        values: ``(n,)`` for each attribute, by its USD name, in its own unit; such as focusDistance in scene units.
        tolerances: how far a curve may be from its samples, in its own unit, by name: one for all or ``(n,)``. The ends are
            exact, and 0 meets every sample. An attribute that is not named keeps to `EXACT`.

    Returns:
        The splines by name.

    Raises:
        SchemaError: there is no such camera or attribute, the samples make no curve, or a value is not allowed; nothing is
            authored then.
    """
    channels = checked_channels(times, values)
    allowed = tolerances or {}
    splines = {
        c.name: spline_from_knots(
            fit_knots(c.times, c.values, _tolerance(c, allowed.get(c.name))),
            "double" if c.type == "double" else "float",
        )
        for c in channels
    }
    for channel, attribute in _attributes(target, camera_path, channels):
        _clear(attribute, "timeSamples")
        attribute.SetSpline(splines[channel.name])
    return splines


def author_samples(
    target: Usd.Stage | Sdf.Layer, camera_path: str, times: ArrayLike, values: Mapping[str, ArrayLike]
) -> None:
    """Author attributes of a camera as time samples, one for each time, in place of what samples or splines were there.

    Args:
        target: a stage, whose edit target takes them, or a layer, where they become an `over` of the camera.
        camera_path: the camera.
        times: ``(n,)`` time codes, increasing.
        values: as `author_splines`.

    Raises:
        SchemaError: as `author_splines`.
    """
    for channel, attribute in _attributes(target, camera_path, checked_channels(times, values)):
        _clear(attribute, "timeSamples")
        _clear(attribute, "spline")
        for time, value in zip(channel.times.tolist(), channel.values.tolist(), strict=True):
            if isinstance(attribute, Usd.Attribute):
                attribute.Set(value, time)
            else:
                attribute.layer.SetTimeSample(attribute.path, time, value)


def camera_layer(
    stage: Usd.Stage,
    camera_path: str,
    times: ArrayLike,
    values: Mapping[str, ArrayLike],
    form: Literal["spline", "samples"] = "spline",
    tolerances: Mapping[str, ArrayLike] | None = None,
) -> Sdf.Layer:
    """A layer with nothing but curves of a camera, to be sublayered over the stage's own.

    Args:
        stage: the shot; its time-code rate, units and up axis are noted in the layer, so that USD does not retime it.
        camera_path: the camera.
        times: ``(n,)`` time codes, increasing.
        values: as `author_splines`.
        form: native splines or baked samples.
        tolerances: of the splines; as `author_splines`.

    Returns:
        An anonymous layer.

    Raises:
        SchemaError: as `author_splines`.
    """
    _camera(stage, camera_path)
    layer = Sdf.Layer.CreateAnonymous("focus.usda")
    layer.timeCodesPerSecond = stage.GetTimeCodesPerSecond()
    layer.framesPerSecond = stage.GetFramesPerSecond()
    root = layer.pseudoRoot
    root.SetInfo("metersPerUnit", UsdGeom.GetStageMetersPerUnit(stage))
    root.SetInfo("upAxis", UsdGeom.GetStageUpAxis(stage))
    if form == "spline":
        author_splines(layer, camera_path, times, values, tolerances)
    else:
        author_samples(layer, camera_path, times, values)
    t = np.asarray(times, np.float64)
    layer.startTimeCode, layer.endTimeCode = float(t[0]), float(t[-1])
    return layer


def spline_from_knots(knots: Knots, value_type: Literal["float", "double"]) -> Ts.Spline:
    """A piecewise cubic curve as a native spline.

    Handles reach a third of the way to the next knot, which makes a Bezier segment the Hermite cubic itself (time is
    then linear in the curve's parameter). Values are rounded to the type.
    """
    spline = Ts.Spline(value_type)
    third = np.diff(knots.times) / 3.0
    reach_in, reach_out = np.concatenate([[0.0], third]), np.concatenate([third, [0.0]])
    for time, value, slope, before, after in zip(
        knots.times, knots.values, knots.slopes, reach_in, reach_out, strict=True
    ):
        spline.SetKnot(
            Ts.Knot(
                typeName=value_type,
                time=float(time),
                value=float(value),
                nextInterp=Ts.InterpCurve,
                preTanSlope=float(slope),
                preTanWidth=float(before),
                postTanSlope=float(slope),
                postTanWidth=float(after),
            )
        )
    return spline


def _tolerance(channel: Channel, tolerance: ArrayLike | None) -> np.ndarray:
    given = EXACT * np.abs(channel.values) if tolerance is None else np.asarray(tolerance, np.float64)
    if not (np.isfinite(given).all() and (given >= 0).all()):
        raise SchemaError(f"the tolerance of a curve of {channel.name} must be 0 or more, got {given.min():g}")
    if given.shape not in ((), channel.values.shape):
        raise SchemaError(f"the tolerance of a curve of {channel.name} must be one number or {len(channel.values)}")
    return np.broadcast_to(given, channel.values.shape)


def _camera(stage: Usd.Stage, camera_path: str) -> Usd.Prim:
    camera = UsdGeom.Camera.Get(stage, camera_path) if Sdf.Path.IsValidPathString(camera_path) else None
    if not camera:
        raise SchemaError(f"a camera's curves need a camera, and there is none at {camera_path!r}")
    return camera.GetPrim()


def _attributes(
    target: Usd.Stage | Sdf.Layer, camera_path: str, channels: list[Channel]
) -> list[tuple[Channel, Usd.Attribute | Sdf.AttributeSpec]]:
    """Each channel with what it is authored on; the schemas that the channels need are applied there."""
    schemas = sorted({c.schema for c in channels} - {""})
    if isinstance(target, Sdf.Layer):
        spec = _over(target, camera_path)
        _apply_in_layer(spec, schemas)
        return [(c, spec.attributes.get(c.name) or Sdf.AttributeSpec(spec, c.name, c.type)) for c in channels]
    prim = _camera(target, camera_path)
    for schema in schemas:
        apply(prim, schema)
    return [(c, prim.GetAttribute(c.name)) for c in channels]


def _clear(attribute: Usd.Attribute | Sdf.AttributeSpec, field: str) -> None:
    """Remove a field of an attribute in a layer, or in the stage's edit target."""
    if isinstance(attribute, Usd.Attribute):
        attribute = attribute.GetStage().GetEditTarget().GetAttributeSpecForScenePath(attribute.GetPath())
    if attribute is not None:
        attribute.ClearInfo(field)


def _over(layer: Sdf.Layer, camera_path: str) -> Sdf.PrimSpec:
    """The spec of the camera in a layer, made as an `over` where there is none."""
    path = Sdf.Path(camera_path) if Sdf.Path.IsValidPathString(camera_path) else Sdf.Path.emptyPath
    if not (path.IsPrimPath() and path.IsAbsolutePath()):
        raise SchemaError(f"a camera's curves need the absolute path of a camera, got {camera_path!r}")
    return Sdf.CreatePrimInLayer(layer, path)


def _apply_in_layer(spec: Sdf.PrimSpec, schemas: list[str]) -> None:
    """Apply schemas as `Usd.Prim.ApplyAPI` would, where there is no stage: prepended to what is applied."""
    listed = spec.GetInfo("apiSchemas") if spec.HasInfo("apiSchemas") else Sdf.TokenListOp()
    absent = [schema for schema in schemas if schema not in (*listed.prependedItems, *listed.explicitItems)]
    if not absent:
        return
    if listed.isExplicit:
        listed.explicitItems = [*absent, *listed.explicitItems]
    else:
        listed.prependedItems = [*absent, *listed.prependedItems]
    spec.SetInfo("apiSchemas", listed)
