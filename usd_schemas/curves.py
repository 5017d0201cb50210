"""Focus curves as USD: a native spline that an artist can edit, or baked samples for tools that read no splines.

Never both on one attribute in one layer, since samples hide the spline: writing the one removes the other.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from pxr import Sdf, Ts, Usd, UsdGeom

from usd_schemas.curve_fit import Knots, checked_samples, fit_knots
from usd_schemas.errors import SchemaError

FOCUS_DISTANCE = "focusDistance"
FOCUS_TOLERANCE = 1e-3
"""How far a fitted focus distance may be from a sample, relative to the sample."""


def author_focus_spline(
    target: Usd.Stage | Sdf.Layer,
    camera_path: str,
    times: ArrayLike,
    focus_distance: ArrayLike,
    tolerance: float = FOCUS_TOLERANCE,
) -> Ts.Spline:
    """Author focusDistance as a native spline with few knots.

    Args:
        target: a stage, whose edit target takes it, or a layer, where it becomes an `over` of the camera.
        camera_path: the camera.
        times: ``(n,)`` time codes, increasing.
        focus_distance: ``(n,)`` in scene units, positive.
        tolerance: how far the curve may be from each sample, relative to it; the ends are exact. 0 meets every sample.

    Returns:
        The spline.

    Raises:
        SchemaError: the samples make no curve, a distance is not positive, or there is no such camera.
    """
    t, distance = _checked_focus(times, focus_distance)
    if not (np.isfinite(tolerance) and tolerance >= 0):
        raise SchemaError(f"the tolerance of a focus curve must be 0 or more, got {tolerance}")
    spline = spline_from_knots(fit_knots(t, distance, tolerance * distance), "float")
    if isinstance(target, Usd.Stage):
        attribute = _stage_attribute(target, camera_path)
        _clear_in_edit_target(attribute, "timeSamples")
        attribute.SetSpline(spline)
    else:
        spec = _layer_attribute(target, camera_path)
        spec.ClearInfo("timeSamples")
        spec.SetSpline(spline)
    return spline


def author_focus_samples(
    target: Usd.Stage | Sdf.Layer, camera_path: str, times: ArrayLike, focus_distance: ArrayLike
) -> None:
    """Author focusDistance as time samples, one for each time, in place of what samples or spline were there.

    Args:
        target: a stage, whose edit target takes them, or a layer, where they become an `over` of the camera.
        camera_path: the camera.
        times: ``(n,)`` time codes, increasing.
        focus_distance: ``(n,)`` in scene units, positive.

    Raises:
        SchemaError: as `author_focus_spline`.
    """
    t, distance = _checked_focus(times, focus_distance)
    if isinstance(target, Usd.Stage):
        attribute = _stage_attribute(target, camera_path)
        _clear_in_edit_target(attribute, "timeSamples")
        _clear_in_edit_target(attribute, "spline")
        for time, value in zip(t, distance, strict=True):
            attribute.Set(float(value), float(time))
    else:
        spec = _layer_attribute(target, camera_path)
        spec.ClearInfo("timeSamples")
        spec.ClearInfo("spline")
        for time, value in zip(t, distance, strict=True):
            target.SetTimeSample(spec.path, float(time), float(value))


def focus_layer(
    stage: Usd.Stage,
    camera_path: str,
    times: ArrayLike,
    focus_distance: ArrayLike,
    form: Literal["spline", "samples"] = "spline",
    tolerance: float = FOCUS_TOLERANCE,
) -> Sdf.Layer:
    """A layer with nothing but the camera's focus curve, to be sublayered over the stage's own.

    Args:
        stage: the shot; its time-code rate, units and up axis are noted in the layer, so that USD does not retime it.
        camera_path: the camera.
        times: ``(n,)`` time codes, increasing.
        focus_distance: ``(n,)`` in scene units, positive.
        form: native spline or baked samples.
        tolerance: of the spline; see `author_focus_spline`.

    Returns:
        An anonymous layer.

    Raises:
        SchemaError: as `author_focus_spline`.
    """
    _stage_attribute(stage, camera_path)
    layer = Sdf.Layer.CreateAnonymous("focus.usda")
    layer.timeCodesPerSecond = stage.GetTimeCodesPerSecond()
    layer.framesPerSecond = stage.GetFramesPerSecond()
    root = layer.pseudoRoot
    root.SetInfo("metersPerUnit", UsdGeom.GetStageMetersPerUnit(stage))
    root.SetInfo("upAxis", UsdGeom.GetStageUpAxis(stage))
    if form == "spline":
        author_focus_spline(layer, camera_path, times, focus_distance, tolerance)
    else:
        author_focus_samples(layer, camera_path, times, focus_distance)
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


def _checked_focus(times: ArrayLike, focus_distance: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    t, distance = checked_samples(times, focus_distance)
    bad = np.flatnonzero(distance <= 0)
    if len(bad):
        raise SchemaError(f"a focus distance must be positive, got {distance[bad[0]]:g} at time {t[bad[0]]:g}")
    return t, distance


def _stage_attribute(stage: Usd.Stage, camera_path: str) -> Usd.Attribute:
    camera = UsdGeom.Camera.Get(stage, camera_path) if Sdf.Path.IsValidPathString(camera_path) else None
    if not camera:
        raise SchemaError(f"the focus curve needs a camera, and there is none at {camera_path!r}")
    return camera.GetFocusDistanceAttr()


def _clear_in_edit_target(attribute: Usd.Attribute, field: str) -> None:
    spec = attribute.GetStage().GetEditTarget().GetAttributeSpecForScenePath(attribute.GetPath())
    if spec is not None:
        spec.ClearInfo(field)


def _layer_attribute(layer: Sdf.Layer, camera_path: str) -> Sdf.AttributeSpec:
    """The focusDistance spec of the camera in a layer, made as an `over` where there is none."""
    path = Sdf.Path(camera_path) if Sdf.Path.IsValidPathString(camera_path) else Sdf.Path.emptyPath
    if not (path.IsPrimPath() and path.IsAbsolutePath()):
        raise SchemaError(f"the focus curve needs the absolute path of a camera, got {camera_path!r}")
    prim = Sdf.CreatePrimInLayer(layer, path)
    existing = prim.attributes.get(FOCUS_DISTANCE)
    return existing or Sdf.AttributeSpec(prim, FOCUS_DISTANCE, Sdf.ValueTypeNames.Float)
