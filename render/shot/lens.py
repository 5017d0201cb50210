"""The lens of a camera, set in millimetres, metres and f-numbers."""

from __future__ import annotations

import math
from dataclasses import replace

from render.errors import SettingsError
from render.shot.curve import FAR_AWAY_M
from render.shot.edits import set_value
from usd_schemas import LensCamera
from usd_schemas.units import tenths_from_mm, units_from_metres


def author_lens(
    camera: LensCamera,
    time: float | None,
    *,
    f_stop: float | None = None,
    focal_length_mm: float | None = None,
    focus_distance_m: float | None = None,
) -> None:
    """Author those settings that are given, in the stage's edit target.

    Args:
        camera: the camera.
        time: USD time code of the keys; None drops the keys there are and holds the values for all time.
        f_stop: f-number; 0 is a pinhole.
        focal_length_mm: focal length.
        focus_distance_m: depth of the plane of focus; infinite is authored as 100 km, since tools disagree on what 0
            means and a curve through infinity has no middle.

    Raises:
        SettingsError: a value is out of range; nothing is authored then.
        SchemaError: the time is not finite.
    """
    stage, values = camera.prim.GetStage(), {}
    if f_stop is not None:
        _check("f-number", f_stop, math.isfinite(f_stop) and f_stop >= 0, "0 (a pinhole) or more")
        values["fStop"] = f_stop
    if focal_length_mm is not None:
        _check("focal length in mm", focal_length_mm, math.isfinite(focal_length_mm) and focal_length_mm > 0, "above 0")
        values["focalLength"] = tenths_from_mm(focal_length_mm, stage)
    if focus_distance_m is not None:
        _check("focus distance in m", focus_distance_m, focus_distance_m > 0, "above 0, or infinite")
        values["focusDistance"] = units_from_metres(min(focus_distance_m, FAR_AWAY_M), stage)
    for name, value in values.items():
        set_value(camera.prim.GetAttribute(name), value, time)


def set_focus_mode(camera: LensCamera, mode: str) -> None:
    """Author what decides the focus, unless the camera says it already, in the stage's edit target.

    Args:
        camera: the camera.
        mode: manual, points, tiltPlane or surface.

    Raises:
        SchemaError: it is none of these.
    """
    said = camera.focus.read()
    if mode != said.mode:
        camera.focus.author(replace(said, mode=mode))  # type: ignore[arg-type]


def _check(name: str, value: float, good: bool, expected: str) -> None:
    if not good:
        raise SettingsError(f"the {name} must be {expected}, but it is {value:g}", code="bad_lens_setting")
