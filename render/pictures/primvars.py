"""Primvars of the stage as AOVs of a frame."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from pxr import Usd

from render.model.aovs import primvar_of
from render.stage.geometry.primvar_pictures import find_numeric, picture_primvar
from render.stage.opening import read_quietly

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameSettings
    from render.shot.shot import Shot


def check_primvars(shot: Shot, camera_path: str, time: float, settings: FrameSettings) -> None:
    """Check that prims which a camera has drawn at a time have the primvars that settings name; raises as `add_primvars`."""
    names = [primvar for name in settings.aovs if (primvar := primvar_of(name))]
    if names:
        paths = shot.scene_at(time, camera_path).prim_paths
        with read_quietly(shot.stage):
            for name in names:
                find_numeric(shot.stage, name, paths)


def add_primvars(shot: Shot, frame: Frame, settings: FrameSettings) -> Frame:
    """Return a frame with the primvars that the settings name, read where its pixels' chief rays meet surfaces.

    Args:
        shot: the shot.
        frame: a frame of its stage.
        settings: as it was rendered.

    Raises:
        SettingsError: no drawn prim has a primvar of that name with one to four numbers for each element.
    """
    names = [name for name in settings.aovs if primvar_of(name)]
    if not names or frame.points is None:
        return frame
    with read_quietly(shot.stage):
        time = Usd.TimeCode(frame.time)
        read = {n: picture_primvar(shot.stage, primvar_of(n), frame.prim_paths, frame.points, time) for n in names}
    return replace(frame, aovs={**frame.aovs, **read}, points=None)
