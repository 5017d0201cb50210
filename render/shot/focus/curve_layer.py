"""Focus curves as what drives a camera in USD: a layer over the shot, or specs in the stage's edit target."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

import numpy as np
from pxr import Sdf, Usd

from render.errors import SettingsError
from render.focus.curve import FAR_AWAY_M, FocusCurve
from render.model.arrays import DoubleArray
from render.shot.camera.attributes import set_focus_mode
from render.shot.edits.edit_layer import schema_errors_as_settings
from render.stage import quiet_diagnostics
from usd_schemas import LensCamera, curves
from usd_schemas.units import tenths_from_mm, units_from_metres

DRIVEN = frozenset({"focus_distance_m", "f_stop", "focal_length_mm", "tilt_rad", "swing_rad", "coc_limit_mm"})
"""The columns of a focus curve that drive a camera."""

_ANGLES = ("tiltShift:tilt", "tiltShift:swing")


def curve_layer(
    stage: Usd.Stage,
    camera_path: str,
    curve: FocusCurve,
    columns: Collection[str] = DRIVEN,
    *,
    baked: bool,
    comment: str,
    tolerance: float = curves.EXACT,
) -> str:
    """A layer that gives a camera a focus curve, to be sublayered over the shot by any tool.

    It sets ``focus:mode`` to manual where the points set the distance or the tilt, so that a tool which knows the schemas takes
    the curve and does not solve once more. A surface through points stays one, as no curve of a camera says it.

    Args:
        stage: the shot; it is not changed.
        camera_path: of a camera.
        curve: the curve, in the shot's time.
        columns: which of `DRIVEN` are wanted.
        baked: time samples, for tools that read no splines, in place of native splines.
        comment: of the layer.
        tolerance: how far splines may be from the frames, relative to the value; more makes fewer knots.

    Returns:
        usda text.

    Raises:
        SettingsError: a value is beyond what the camera's attribute allows, or the tolerance is no share.
    """
    with schema_errors_as_settings(), quiet_diagnostics():
        values = _wanted(stage, camera_path, curve, columns)
        tolerances = {name: checked_tolerance(tolerance) * np.abs(column) for name, column in values.items()}
        form: Literal["spline", "samples"] = "samples" if baked else "spline"
        layer = curves.camera_layer(stage, camera_path, curve.time_codes, values, form, tolerances)
        layer.comment = comment
        if LensCamera(stage.GetPrimAtPath(camera_path)).focus.read().mode in ("points", "tiltPlane"):
            spec = layer.GetPrimAtPath(camera_path)
            mode = Sdf.AttributeSpec(spec, "focus:mode", Sdf.ValueTypeNames.Token, Sdf.VariabilityUniform)
            mode.default = "manual"
        return str(layer.ExportToString())


def checked_tolerance(tolerance: float) -> float:
    """A share by which a spline may be off.

    Raises:
        SettingsError: it is none.
    """
    if not 0 <= tolerance < 1:
        raise SettingsError(f"the tolerance of a focus layer must be a share from 0 to below 1, got {tolerance:g}")
    return tolerance


def author_curve(camera: LensCamera, curve: FocusCurve, columns: Collection[str] = DRIVEN, *, baked: bool) -> None:
    """Give a camera a focus curve in the stage's edit target, and let it be focused by hand.

    Args:
        camera: the camera.
        curve: the curve, in the shot's time.
        columns: which of `DRIVEN` are wanted.
        baked: time samples in place of native splines.

    Raises:
        SchemaError: a value is beyond what the camera's attribute allows.
    """
    stage, path = camera.prim.GetStage(), str(camera.prim.GetPath())
    values = _wanted(stage, path, curve, columns)
    if baked:
        curves.author_samples(stage, path, curve.time_codes, values)
    else:
        curves.author_splines(stage, path, curve.time_codes, values)
    set_focus_mode(camera, "manual")


def _wanted(stage: Usd.Stage, camera_path: str, curve: FocusCurve, columns: Collection[str]) -> dict[str, DoubleArray]:
    """``(n,)`` for each attribute by USD's name, in its unit. An infinite focus is 100 km: through infinity goes no curve.

    A lens that is never turned, and cannot be, is not told to stay straight.
    """
    distance = units_from_metres(np.minimum(curve.focus_distance_m, FAR_AWAY_M), stage)
    named = {
        "focus_distance_m": ("focusDistance", distance),
        "f_stop": ("fStop", curve.f_stop),
        "focal_length_mm": ("focalLength", tenths_from_mm(curve.focal_length_mm, stage)),
        "tilt_rad": ("tiltShift:tilt", _degrees(curve.tilt_rad)),
        "swing_rad": ("tiltShift:swing", _degrees(curve.swing_rad)),
        "coc_limit_mm": ("focus:circleOfConfusion", curve.coc_limit_mm),
    }
    values = dict(named[column] for column in named if column in columns)
    prim = stage.GetPrimAtPath(camera_path)
    for name in _ANGLES:
        if name in values and not values[name].any() and not prim.GetAttribute(name).HasAuthoredValue():
            del values[name]
    return values


def _degrees(angles_rad: DoubleArray) -> DoubleArray:
    """Angles without the last digits, by which radians there and back would pass an attribute's limits."""
    return np.asarray(np.degrees(angles_rad).round(12))
