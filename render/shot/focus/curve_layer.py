"""Focus curves written to USD: as a layer over the shot, or in the stage's edit target."""

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
    """Write a layer that gives a camera a focus curve, to be sublayered over the shot by any tool.

    It sets ``focus:mode`` to manual where the points set the distance or the tilt, so that a tool which knows the schemas takes
    the curve and does not solve again. A surface through points stays one, as no curve of a camera can describe it.

    Args:
        stage: the shot; it is not changed.
        camera_path: of a camera.
        curve: the curve, in the shot's time.
        columns: which of `DRIVEN` to write.
        baked: time samples, for tools that read no splines, in place of native splines.
        comment: of the layer.
        tolerance: how far splines may be from the frames, relative to the value; more makes fewer knots.

    Returns:
        usda text.

    Raises:
        SettingsError: a value is beyond what the camera's attribute allows, or the tolerance is not from 0 to
            below 1.
    """
    with schema_errors_as_settings(), quiet_diagnostics():
        values = _usd_columns(stage, camera_path, curve, columns)
        tolerances = {name: check_tolerance(tolerance) * np.abs(column) for name, column in values.items()}
        form: Literal["spline", "samples"] = "samples" if baked else "spline"
        layer = curves.camera_layer(stage, camera_path, curve.time_codes, values, form, tolerances)
        layer.comment = comment
        if LensCamera(stage.GetPrimAtPath(camera_path)).focus.read().mode in ("points", "tiltPlane"):
            spec = layer.GetPrimAtPath(camera_path)
            mode = Sdf.AttributeSpec(spec, "focus:mode", Sdf.ValueTypeNames.Token, Sdf.VariabilityUniform)
            mode.default = "manual"
        return str(layer.ExportToString())


def check_tolerance(tolerance: float) -> float:
    """Return the relative tolerance of a spline.

    Raises:
        SettingsError: it is not from 0 to below 1.
    """
    if not 0 <= tolerance < 1:
        raise SettingsError(f"the tolerance of a focus layer must be a share from 0 to below 1, got {tolerance:g}")
    return tolerance


def author_curve(camera: LensCamera, curve: FocusCurve, columns: Collection[str] = DRIVEN, *, baked: bool) -> None:
    """Author a focus curve of a camera in the stage's edit target, and set its focus mode to manual.

    Args:
        camera: the camera.
        curve: the curve, in the shot's time.
        columns: which of `DRIVEN` to write.
        baked: time samples in place of native splines.

    Raises:
        SchemaError: a value is beyond what the camera's attribute allows.
    """
    stage, path = camera.prim.GetStage(), str(camera.prim.GetPath())
    values = _usd_columns(stage, path, curve, columns)
    if baked:
        curves.author_samples(stage, path, curve.time_codes, values)
    else:
        curves.author_splines(stage, path, curve.time_codes, values)
    set_focus_mode(camera, "manual")


def _usd_columns(
    stage: Usd.Stage, camera_path: str, curve: FocusCurve, columns: Collection[str]
) -> dict[str, DoubleArray]:
    """Columns ``(n,)`` by USD attribute, in its unit. An infinite focus becomes 100 km, as no curve passes through infinity.

    Tilt and swing are left out where they are 0 throughout and the camera does not author them.
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
    """Degrees, rounded so that the way to radians and back stays within an attribute's limits."""
    return np.asarray(np.degrees(angles_rad).round(12))
