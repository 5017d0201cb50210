"""A focus point follows a part from where it is, without a jump, and goes back to its surface as it was."""

import numpy as np
import pytest
from pxr import Gf, UsdGeom

from render.errors import NotFoundError, SettingsError, StageError
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, FAR, FRAMES, NEAR, open_bare, write_shot
from usd_schemas import FocusPoint
from usd_schemas.export import export_portable

CENTRE = {"face": 0, "fan_triangle": 0, "barycentric": (0.5, 0.0, 0.5)}
ON_FAR = FocusPoint("far", target=(FAR,), **CENTRE)
ON_NEAR = {"target": (NEAR,), **CENTRE}


@pytest.fixture
def shot(tmp_path):
    shot = Shot.open(write_shot(tmp_path / "shot.usda"))
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    return shot


def position(shot, frame):
    (placed,) = shot.focus.points(CAMERA, frame)
    assert placed.problem == ""
    return placed.position_m


def in_world_bounds(frame, place):
    """Where a place in the bounds of both cards is: the near one widens them, the far one comes."""
    t = frame - 1
    least, most = np.array([-1.5, 0, 2 * t / 23]), np.array([0.5 + 0.25 * t, 2, 6])
    return least + np.array(place) * (most - least)


@pytest.mark.parametrize("start", [1, 9])
def test_a_point_stays_where_it_is_and_follows_from_there(shot, start):
    before = position(shot, start)
    after = shot.focus.follow_part(CAMERA, "far", "/World", start)
    assert (after.part, after.target, after.face) == ("/World", (FAR,), 0)
    assert after.bounds_point == pytest.approx((0.5 / (2 + 0.25 * (start - 1)), 0.5, 0), abs=1e-6)
    assert position(shot, start) == pytest.approx(before, abs=1e-6)
    for frame in FRAMES:
        expected = in_world_bounds(frame, after.bounds_point)
        assert position(shot, frame) == pytest.approx(tuple(expected), abs=1e-5)
        assert shot.focus.read(CAMERA, frame).focus_distance_m == pytest.approx(10 - expected[2], rel=1e-5)


def test_back_on_its_surface_a_point_is_as_it_was(shot):
    before = [position(shot, frame) for frame in FRAMES]
    point = shot.focus.points(CAMERA, 1)[0].point
    shot.focus.follow_part(CAMERA, "far", "/World", 5)
    back = shot.focus.follow_part(CAMERA, "far", None, 5)
    assert (back.part, back.target, back.face, back.barycentric) == ("", point.target, point.face, point.barycentric)
    assert [position(shot, frame) for frame in FRAMES] == before


def test_following_is_one_step_of_undo(shot):
    shot.focus.follow_part(CAMERA, "far", "/World", 5)
    assert shot.edits.history.undo_label == "let focus point far follow /World"
    shot.edits.undo()
    assert shot.focus.points(CAMERA, 5)[0].point.part == ""
    shot.edits.redo()
    assert shot.focus.points(CAMERA, 5)[0].point.part == "/World"
    shot.focus.follow_part(CAMERA, "far", None, 5)
    assert shot.edits.history.undo_label == "let focus point far follow its surface"


def test_from_one_part_to_another_without_a_jump(shot):
    shot.focus.follow_part(CAMERA, "far", "/World", 1)
    before = position(shot, 12)
    shot.focus.follow_part(CAMERA, "far", FAR, 12)
    assert position(shot, 12) == pytest.approx(before, abs=1e-6)


def test_a_point_that_moves_within_its_part_keeps_it(shot):
    shot.focus.follow_part(CAMERA, "far", "/World", 1)
    moved = shot.focus.move_point(CAMERA, "far", 7, **ON_NEAR)
    assert (moved.part, moved.target) == ("/World", (NEAR,))
    assert position(shot, 7) == pytest.approx((1.5, 1, 6), abs=1e-6)
    shot.focus.follow_part(CAMERA, "far", NEAR, 7)
    elsewhere = shot.focus.move_point(CAMERA, "far", 9, target=(FAR,), **CENTRE)
    assert (elsewhere.part, elsewhere.target) == ("", (FAR,))
    assert position(shot, 9) == pytest.approx((-1, 1, 16 / 23), abs=1e-6)


@pytest.mark.parametrize(
    ("part", "error", "says"),
    [
        ("/World/gone", NotFoundError, "focus point far follows the bounds of /World/gone, which is not there"),
        ("/World/none", NotFoundError, "/World/none, which has none at time 5"),
        ("far", SettingsError, "by its absolute path, got 'far'"),
        ("/World/far.points", SettingsError, "by its absolute path, got '/World/far.points'"),
        ("/", SettingsError, "by its absolute path, got '/'"),
        (NEAR, SettingsError, "far is out of reach of the bounds of /World/near: follow a part that it is on"),
        ("/World/flat", StageError, "cannot follow the bounds of /World/flat, whose transform is flat at time 5"),
    ],
)
def test_what_cannot_be_followed_is_named_and_nothing_changes(shot, part, error, says):
    UsdGeom.Xform.Define(shot.stage, "/World/none")
    UsdGeom.Cube.Define(shot.stage, "/World/flat").AddScaleOp().Set(Gf.Vec3f(1, 1, 0))
    layer = shot.edits.layer.ExportToString()
    with pytest.raises(error, match=says):
        shot.focus.follow_part(CAMERA, "far", part, 5)
    assert shot.edits.layer.ExportToString() == layer


def test_a_part_that_goes_gives_the_focus_back(shot):
    shot.focus.follow_part(CAMERA, "far", FAR, 1)
    shot.stage.GetPrimAtPath(FAR).SetActive(False)
    (placed,) = shot.focus.points(CAMERA, 3)
    assert placed.problem == "focus point far follows the bounds of /World/far, which is deactivated"
    assert shot.focus.read(CAMERA, 3).source == "camera"


def test_another_part_takes_the_place_of_a_lost_one(shot):
    frame = UsdGeom.Cube.Define(shot.stage, "/World/frame")
    frame.CreateSizeAttr(100.0)
    before = position(shot, 3)
    shot.focus.follow_part(CAMERA, "far", "/World/frame", 3)
    frame.GetPrim().SetActive(False)
    assert shot.focus.follow_part(CAMERA, "far", "/World", 3).part == "/World"
    assert position(shot, 3) == pytest.approx(before, abs=1e-5)


def test_a_renamed_point_follows_on_and_others_can_read_it(shot, tmp_path):
    followed = shot.focus.follow_part(CAMERA, "far", "/World", 5)
    shot.focus.rename_point(CAMERA, "far", "pair")
    assert position(shot, 20) == pytest.approx(tuple(in_world_bounds(20, followed.bounds_point)), abs=1e-5)
    exported = open_bare(export_portable(shot.stage, tmp_path / "out.usda"))
    camera = exported.GetPrimAtPath(CAMERA)
    (part,) = camera.GetRelationship("focusPoint:pair:part").GetTargets()
    assert str(part) == "/World"
    assert tuple(camera.GetAttribute("focusPoint:pair:boundsPoint").Get()) == followed.bounds_point
    assert not camera.HasProperty("focusPoint:far:part")
