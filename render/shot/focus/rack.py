"""Author a rack between two focus points, stretched to what the hand on the focus ring can do."""

from __future__ import annotations

import math
from dataclasses import replace

from pxr import Usd

from render.errors import SettingsError
from render.focus.racks import Rack
from render.focus.racks import rack as solve_rack
from render.optics.view import PinholeView
from render.shot.focus.ring import close_focus_depth_m, focus_ring
from render.stage import AnchorReader, read_camera
from usd_schemas import LensCamera, SchemaError
from usd_schemas.racks import WeightRack, author_rack, rack_contradictions

_ROUNDS = 8
"""Fixed-point steps until the end of the rack and the position of its point at that time agree."""


def pull_rack(stage: Usd.Stage, anchors: AnchorReader, camera_path: str, rack: WeightRack) -> tuple[WeightRack, Rack]:
    """Author a rack in the stage's edit target. It ends later than given where the hand cannot turn the ring that fast.

    The speed is bounded by focus:maxSpeed, lens:focusThrow and lens:closeFocus; without one of them it is unbounded.

    Args:
        stage: the stage.
        anchors: finds focus points on that stage.
        camera_path: of a camera.
        rack: the rack.

    Returns:
        The rack as authored, and what the lens does.

    Raises:
        SettingsError: the rack makes no sense or contradicts keys that are there, or a point is not in front of the
            camera; nothing is authored then.
        InputError: the target of a point is missing.
    """
    camera = LensCamera(stage.GetPrimAtPath(camera_path))
    try:
        problem = next(rack_contradictions(camera, rack), None)
        if problem is not None:
            raise SettingsError(problem, code="bad_rack", path=camera_path)
        lens = _stretch(stage, anchors, camera, rack)
        if lens.is_stretched:
            rack = replace(rack, end=lens.end_s * stage.GetTimeCodesPerSecond())
        author_rack(camera, rack)
    except SchemaError as error:
        raise SettingsError(str(error), code="bad_rack", path=camera_path) from error
    return rack, lens


def _stretch(stage: Usd.Stage, anchors: AnchorReader, camera: LensCamera, rack: WeightRack) -> Rack:
    """Solve the rack of the lens, as long as the hand needs."""
    per_second = stage.GetTimeCodesPerSecond()
    path = str(camera.prim.GetPath())
    view = read_camera(stage, path, rack.start)
    ring = focus_ring(view, camera.lens.read(rack.start).focus_throw)
    speed_rad_s = math.radians(camera.focus.read(rack.start).max_speed_deg_s)
    nearest_w = 1 / close_m if (close_m := close_focus_depth_m(view)) > 0 else math.inf
    start_w = min(_w(stage, anchors, camera, rack.from_point, rack.start), nearest_w)
    end = rack.end
    for _ in range(_ROUNDS):
        end_w = min(_w(stage, anchors, camera, rack.to_point, end), nearest_w)
        lens = solve_rack(
            rack.start / per_second,
            start_w,
            rack.end / per_second,
            end_w,
            rack.ease,
            ring=ring,
            max_speed_rad_s=speed_rad_s,
        )
        later = lens.end_s * per_second
        if abs(later - end) < 1e-6:
            break
        end = later
    return lens


def _w(stage: Usd.Stage, anchors: AnchorReader, camera: LensCamera, name: str, time: float) -> float:
    """Inverse depth of a focus point at a time.

    Raises:
        SettingsError: it is not in front of the camera.
    """
    path = str(camera.prim.GetPath())
    position_m = anchors.position(camera.focus_point(name).read(time), time)
    _, depths_m = PinholeView.from_camera(read_camera(stage, path, time), 1, 1).project(position_m[None])
    depth_m = float(depths_m[0])
    if not depth_m > 0:
        raise SettingsError(
            f"a rack needs focus points in front of the camera, but {name} is not at time {time:g}",
            code="bad_rack",
            path=path,
        )
    return 1 / depth_m
