"""A camera from above: its frame, the cut through what it holds sharp, the paths of its points, and points that are moved."""

import math

import numpy as np
import pytest
from pxr import Gf, UsdGeom

from render.errors import NotFoundError, SettingsError, StageError
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, FAR, FRAMES, NEAR, Units, write_shot
from usd_schemas import FocusPoint

CENTRE = {"face": 0, "fan_triangle": 0, "barycentric": (0.5, 0.0, 0.5)}
HALF_WIDTH = 36 / 50 / 2
"""Slope of the right edge of the picture."""
METRES = Units()


def open_shot(tmp_path, units=METRES) -> Shot:
    shot = Shot.open(write_shot(tmp_path / "shot.usda", units))
    for name, path in (("near", NEAR), ("far", FAR)):
        shot.focus.add_point(CAMERA, name, FocusPoint(name, target=(path,), **CENTRE))
    return shot


def positions(shot, frame):
    return {placed.point.name: np.array(placed.position_m) for placed in shot.focus.points(CAMERA, frame)}


@pytest.mark.parametrize("units", [METRES, Units(metres=0.01, up="Z")], ids=["m", "cm, z up"])
def test_a_camera_is_where_it_stands_and_looks(tmp_path, units):
    plan = open_shot(tmp_path, units).plan.read(CAMERA, 1)
    assert plan.position_m == pytest.approx((0, 1, 10), abs=1e-5)
    assert plan.right == pytest.approx((1, 0, 0), abs=1e-6)
    assert plan.ahead == pytest.approx((0, 0, -1), abs=1e-6)
    assert (plan.slopes[0], plan.slopes[-1]) == pytest.approx((-HALF_WIDTH, HALF_WIDTH))
    assert (plan.set_back_m, plan.gate_mm) == pytest.approx((0, 36))


def test_depths_in_the_plan_are_those_of_the_readouts(tmp_path):
    shot = open_shot(tmp_path)
    camera = UsdGeom.Xformable(shot.stage.GetPrimAtPath(CAMERA))
    camera.AddRotateXYZOp().Set(Gf.Vec3f(-20, 15, 10))
    plan = shot.plan.read(CAMERA, 3)
    for placed in shot.focus.points(CAMERA, 3):
        way = np.array(placed.position_m) - plan.position_m
        assert way @ plan.ahead == pytest.approx(placed.depth_m, rel=1e-9)


def test_a_plane_of_focus_is_cut_level(tmp_path):
    shot = open_shot(tmp_path)
    shot.focus.set(CAMERA, mode="manual", swing_deg=2.0)
    plan, readout = shot.plan.read(CAMERA, 1), shot.focus.read(CAMERA, 1)
    assert 1 / plan.axis_w == pytest.approx((readout.near_m, 3, readout.far_m))
    assert 1 / plan.w[np.flatnonzero(plan.slopes == 0)[0]] == pytest.approx(1 / plan.axis_w)
    # a thin lens swung by an angle: w changes with the slope by the angle's tangent over the focal length (Scheimpflug)
    rise = np.gradient(plan.w[:, 1], plan.slopes)
    assert abs(rise) == pytest.approx(np.full_like(rise, math.tan(math.radians(2)) / 0.05), rel=0.05)
    at = shot.focus.read_at(CAMERA, 1, (1.0, 0.5), 5)
    assert 1 / plan.w[-1, 1] == pytest.approx(at.focus_distance_m)


def test_a_pinhole_is_sharp_from_its_pupil_on(tmp_path):
    shot = open_shot(tmp_path)
    shot.camera.set(CAMERA, f_stop=0.0)
    plan = shot.plan.read(CAMERA, 1)
    assert np.isposinf(plan.w[:, 0]).all()
    assert np.isneginf(plan.w[:, 2]).all()
    assert np.isneginf(plan.axis_w[2])


def test_paths_go_where_the_points_go(tmp_path):
    shot = open_shot(tmp_path)
    paths = shot.plan.paths(CAMERA, list(FRAMES))
    assert paths.names == ("near", "far")
    assert paths.camera_m == pytest.approx(np.tile([0.0, 1.0, 10.0], (len(FRAMES), 1)))
    for row, frame in enumerate(FRAMES):
        there = positions(shot, frame)
        assert paths.points_m[row] == pytest.approx(np.array([there["near"], there["far"]]))


def test_a_framing_camera_stands_still_without_points(tmp_path):
    shot = Shot.open(write_shot(tmp_path / "bare.usda", camera=False))
    plan, paths = shot.plan.read(None, 1), shot.plan.paths(None, [1, 2])
    assert plan.camera == ""
    assert paths.names == ()
    assert paths.camera_m == pytest.approx(np.tile(plan.position_m, (2, 1)))


@pytest.mark.parametrize("part", ["", "/World"])
def test_a_point_is_moved_to_a_place_and_follows_from_there(tmp_path, part):
    shot = open_shot(tmp_path, Units(metres=0.01, up="Z"))
    if part:
        shot.focus.follow_part(CAMERA, "near", part, 1)
    else:
        assert positions(shot, 9)["near"] - positions(shot, 5)["near"] == pytest.approx((1, 0, 0), abs=1e-5)
    before = positions(shot, 9)["near"] - positions(shot, 5)["near"]
    moved = shot.plan.move_point(CAMERA, "near", 5, (0.3, 1.25, 4.0))
    assert (moved.target, moved.part) == ((NEAR,), part)
    assert positions(shot, 5)["near"] == pytest.approx((0.3, 1.25, 4.0), abs=1e-5)
    assert positions(shot, 9)["near"] - positions(shot, 5)["near"] == pytest.approx(before, abs=1e-5)
    shot.edits.undo()
    assert positions(shot, 5)["near"] != pytest.approx((0.3, 1.25, 4.0), abs=1e-2)


def test_moves_that_cannot_be_are_refused(tmp_path):
    shot = open_shot(tmp_path)
    before = shot.edits.history
    with pytest.raises(SettingsError, match="three finite numbers"):
        shot.plan.move_point(CAMERA, "near", 1, (0.0, math.nan, 0.0))
    with pytest.raises(SettingsError, match="cannot be moved that far"):
        shot.plan.move_point(CAMERA, "near", 1, (1e12, 0.0, 0.0))
    with pytest.raises(NotFoundError, match="nobody"):
        shot.plan.move_point(CAMERA, "nobody", 1, (0.0, 0.0, 0.0))
    shot.stage.GetPrimAtPath(NEAR).GetAttribute("xformOp:translate").Block()
    UsdGeom.Xformable(shot.stage.GetPrimAtPath(NEAR)).AddScaleOp().Set(Gf.Vec3f(0, 1, 1))
    with pytest.raises(StageError, match="cannot be moved on /World/near, whose transform is flat"):
        shot.plan.move_point(CAMERA, "near", 1, (0.0, 0.0, 0.0))
    shot.stage.GetPrimAtPath(NEAR).SetActive(False)
    with pytest.raises(NotFoundError, match="deactivated"):
        shot.plan.move_point(CAMERA, "near", 1, (0.0, 0.0, 0.0))
    assert shot.edits.history == before
