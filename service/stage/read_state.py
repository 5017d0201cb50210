"""From a shot to the state of a camera that the answer to an edit has."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from render.errors import PullfocusError
from render.focus.files import curve_to_text
from render.shot import Shot
from service.models.curve import FocusCurve
from service.models.edits import CameraStateAfter, StateRequest
from service.stage.exposure import exposure_readout
from service.stage.read_cameras import readout_model
from service.stage.read_photography import read_exposure_settings, read_film_settings
from service.stage.read_points import point_list
from service.stage.read_solving import read_focus_settings
from service.stage.shots import curve_frames

Part = TypeVar("Part")


def read_state(shot: Shot, camera: str | None, request: StateRequest, max_curve_frames: int) -> CameraStateAfter:
    """Read the state of a camera. A part that cannot be read is None: the edit is made, and the part's own resource says why.

    Args:
        shot: the shot.
        camera: prim path; None for the default camera.
        request: the time, and whether the curve is wanted.
        max_curve_frames: frames of a focus curve.
    """
    time = request.time
    return CameraStateAfter(
        time=time,
        focus_points=_readable(lambda: point_list(shot, camera, time)),
        readout=_readable(lambda: readout_model(shot.focus.read(camera, time), time)),
        focus=_readable(lambda: read_focus_settings(shot, camera, time)),
        exposure=_readable(lambda: read_exposure_settings(shot, camera, time)),
        exposure_readout=_readable(lambda: exposure_readout(shot, camera, time)),
        film=_readable(lambda: read_film_settings(shot, camera, time)),
        curve=_readable(lambda: _curve(shot, camera, max_curve_frames)) if request.curve else None,
    )


def _curve(shot: Shot, camera: str | None, max_frames: int) -> FocusCurve:
    curve = shot.focus.curve(camera, curve_frames(shot, None, max_frames))
    return FocusCurve.model_validate_json(curve_to_text(curve, "json"))


def _readable(read: Callable[[], Part]) -> Part | None:
    try:
        return read()
    except PullfocusError:
        return None
