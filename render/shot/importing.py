"""Focus curves that others made, put onto a camera of a shot: as a layer over it, or as an edit."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from pxr import Sdf, Usd

from render.focus import FocusCurve
from render.focus.files import CurveFinding, CurveFormat, Gaps, Rates, ReadCurve, read_curve, retimed
from render.shot.curve import FAR_AWAY_M
from render.shot.edits import schema_errors_as_settings
from render.shot.lens import set_focus_mode
from render.stage import frame_range, quiet_diagnostics
from usd_schemas import LensCamera, curves
from usd_schemas.units import tenths_from_mm, units_from_metres

DoubleArray = NDArray[np.float64]


def read_for_shot(
    stage: Usd.Stage,
    content: bytes | str,
    *,
    format: CurveFormat | None = None,
    gaps: Gaps = "refuse",
    first_frame: float | None = None,
) -> ReadCurve:
    """Read a focus curve in the time of a shot.

    A file that counts frames, time codes or seconds keeps these; one that ran by a clock of its own, such as timecode, begins
    where the shot does.

    Args:
        stage: the shot.
        content: of the file.
        format: which kind of file it is; None looks at it.
        gaps: whether rows that are missing or cannot be used are refused, held or interpolated.
        first_frame: time code where the file's first frame comes to lie; None as said above.

    Raises:
        InputError: the file cannot be read, or has gaps and these are refused.
        SettingsError: ``format`` or ``gaps`` is no known word.
    """
    rates = Rates(stage.GetFramesPerSecond(), stage.GetTimeCodesPerSecond())
    read = read_curve(content, rates, format=format, gaps=gaps)
    if first_frame is None and not read.on_shot_time:
        first_frame = frame_range(stage).start
        message = f"the file's clock is not the shot's: its first sample is put at time code {first_frame:g}"
        read = replace(read, findings=(*read.findings, CurveFinding("other_clock", "", message)))
    return retimed(read, rates, first_frame)


def camera_values(stage: Usd.Stage, curve: FocusCurve, said: Collection[str]) -> dict[str, DoubleArray]:
    """What a focus curve drives of a camera, by USD's names and in its units.

    Args:
        stage: the shot.
        curve: the curve.
        said: which of focus_distance_m, f_stop, focal_length_mm, tilt_rad and swing_rad are wanted.

    Returns:
        ``(n,)`` for each attribute. An infinite focus is 100 km, since a curve through infinity has no middle.
    """
    distance = units_from_metres(np.minimum(curve.focus_distance_m, FAR_AWAY_M), stage)
    values = {
        "focus_distance_m": ("focusDistance", distance),
        "f_stop": ("fStop", curve.f_stop),
        "focal_length_mm": ("focalLength", tenths_from_mm(curve.focal_length_mm, stage)),
        "tilt_rad": ("tiltShift:tilt", np.degrees(curve.tilt_rad)),
        "swing_rad": ("tiltShift:swing", np.degrees(curve.swing_rad)),
    }
    return dict(named for name, named in values.items() if name in said)


def imported_layer(stage: Usd.Stage, camera_path: str, read: ReadCurve, *, baked: bool) -> str:
    """A layer that gives a camera the curve of a file, to be sublayered over the shot by any tool.

    Args:
        stage: the shot; it is not changed.
        camera_path: of a camera.
        read: the curve, in the shot's time.
        baked: time samples, for tools that read no splines, in place of native splines.

    Returns:
        usda text.

    Raises:
        SettingsError: a value is beyond what the camera's attribute allows.
    """
    with schema_errors_as_settings(), quiet_diagnostics():
        values = _wanted(stage, camera_path, read)
        layer = curves.camera_layer(stage, camera_path, read.curve.time_codes, values, "samples" if baked else "spline")
        layer.comment = f"Focus of {camera_path}, from a file, by Pullfocus: sublayer this over the shot."
        if LensCamera(stage.GetPrimAtPath(camera_path)).focus.read().mode != "manual":
            spec = layer.GetPrimAtPath(camera_path)
            mode = Sdf.AttributeSpec(spec, "focus:mode", Sdf.ValueTypeNames.Token, Sdf.VariabilityUniform)
            mode.default = "manual"
        return str(layer.ExportToString())


def author_curve(camera: LensCamera, read: ReadCurve, *, baked: bool) -> None:
    """Give a camera the curve of a file, in the stage's edit target, and let it be focused by hand.

    Args:
        camera: the camera.
        read: the curve, in the shot's time.
        baked: time samples in place of native splines.

    Raises:
        SchemaError: a value is beyond what the camera's attribute allows.
    """
    stage, path = camera.prim.GetStage(), str(camera.prim.GetPath())
    values = _wanted(stage, path, read)
    if baked:
        curves.author_samples(stage, path, read.curve.time_codes, values)
    else:
        curves.author_splines(stage, path, read.curve.time_codes, values)
    set_focus_mode(camera, "manual")


def _wanted(stage: Usd.Stage, camera_path: str, read: ReadCurve) -> dict[str, DoubleArray]:
    """What a file drives of this camera: a lens that is never turned, and cannot be, is not told to stay straight."""
    values = camera_values(stage, read.curve, read.said)
    prim = stage.GetPrimAtPath(camera_path)
    for name in ("tiltShift:tilt", "tiltShift:swing"):
        if name in values and not values[name].any() and not prim.GetAttribute(name).HasAuthoredValue():
            del values[name]
    return values
