"""Keys of a camera's place: told, taken away, moved in time, and given back to the shot."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Ts, UsdGeom

from render.errors import CameraError, NotFoundError, SettingsError
from render.shot import Shot
from render.shot.camera import place_keys
from render.shot.camera.placing import CameraPlace
from render.stage import read_camera
from tests.render.kits.focus_shot import CAMERA, FRAMES, open_rigged

HERE = CameraPlace((1.5, 2.0, 6.0), (0.6, -0.3, -1.0), (0.1, 1.0, 0.0))
THERE = CameraPlace((-1.0, 0.5, 3.0), (0.0, 0.0, -2.0), (0.0, 3.0, 0.0))


def slide(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    """Move at sparse frames, with one that is blocked."""
    move = camera.GetOrderedXformOps()[0]
    for time, x in ((1, 0.0), (9, 2.0), (20, 4.0)):
        move.Set(Gf.Vec3d(x, 1, 10), time)


def rig_of_several(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    """Slide, turn about a pivot that is shared by two operations, and be at other frames for each."""
    slide(camera, world)
    pivot = camera.AddTranslateOp(opSuffix="pivot")
    pivot.Set(Gf.Vec3d(0, 0, 1), 9)
    pivot.Set(Gf.Vec3d(0, 0, 2), 12)
    turn = camera.AddRotateXYZOp()
    for time, angle in ((9, 10.0), (15, 40.0)):
        turn.Set(Gf.Vec3f(0, angle, 0), time)
    camera.AddTranslateOp(opSuffix="pivot", isInverseOp=True)


def ride(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    """Move, turn, scale unevenly and mirror the parent, too."""
    slide(camera, world)
    move, rotate = world.AddTranslateOp(), world.AddRotateZOp()
    for time in (2, 24):
        move.Set(Gf.Vec3d(time, 0, 0), time)
        rotate.Set(2.0 * time, time)
    world.AddScaleOp().Set(Gf.Vec3f(-2, 3, 0.5))


def turn_by_spline(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    spline = Ts.Spline("double")
    for time, angle in ((9.0, 0.0), (12.0, 90.0), (20.0, 30.0)):
        knot = Ts.Knot("double")
        knot.SetTime(time)
        knot.SetValue(angle)
        knot.SetNextInterpolation(Ts.InterpLinear)
        spline.SetKnot(knot)
    camera.AddRotateYOp(UsdGeom.XformOp.PrecisionDouble).GetAttr().SetSpline(spline)


def open_shot(tmp_path: Path, rig=None) -> Shot:
    tmp_path.mkdir(exist_ok=True)
    return open_rigged(tmp_path / "shot.usda", rig)


def frames_of(shot: Shot, times=FRAMES) -> np.ndarray:
    return np.array([read_camera(shot.stage, CAMERA, time).world_from_camera for time in times])


def own_x(shot: Shot, *times: float) -> list[float]:
    camera = UsdGeom.Camera(shot.stage.GetPrimAtPath(CAMERA))
    return [camera.GetLocalTransformation(time).ExtractTranslation()[0] for time in times]


@pytest.mark.parametrize(
    ("rig", "times"),
    [
        (None, []),
        (slide, [1, 9, 20]),
        (rig_of_several, [1, 9, 12, 15, 20]),
        (ride, [1, 9, 20]),
        (turn_by_spline, [9, 12, 20]),
    ],
)
def test_keys_are_taken_away_one_by_one_and_given_back(tmp_path, rig, times):
    shot = open_shot(tmp_path, rig)
    before = frames_of(shot)
    assert (shot.camera.place_keys(CAMERA), shot.camera.is_placed(CAMERA)) == (times, False)
    for number, time in enumerate(times, 1):
        shot.camera.remove_place_key(CAMERA, time)
        assert (shot.camera.place_keys(CAMERA), shot.camera.is_placed(CAMERA)) == (times[number:], True)
    if not times:
        return
    local = UsdGeom.Camera(shot.stage.GetPrimAtPath(CAMERA)).GetLocalTransformation
    assert local(1) == local(24)  # the last key of each operation holds, and none of the shot is back
    assert not np.allclose(frames_of(shot), before)
    shot.camera.give_back_place(CAMERA)
    assert frames_of(shot) == pytest.approx(before)
    assert (shot.camera.place_keys(CAMERA), shot.edits.state()) == (times, "")
    for _ in range(len(times) + 1):
        shot.edits.undo()
    assert frames_of(shot) == pytest.approx(before)


def test_a_way_goes_straight_where_a_key_was(tmp_path):
    shot = open_shot(tmp_path, ride)
    shot.camera.remove_place_key(CAMERA, 9)
    assert own_x(shot, 1, 9, 20) == pytest.approx([0, 4 * 8 / 19, 4])
    shot.edits.undo()
    assert own_x(shot, 9) == [2]


def test_keys_of_the_edits_go_without_those_of_the_shot(tmp_path):
    shot = open_shot(tmp_path)
    camera = UsdGeom.Camera(shot.stage.GetPrimAtPath(CAMERA))
    for place, time in ((HERE, 5), (THERE, 15)):
        shot.camera.move(CAMERA, place, time, is_keyed=True)
    assert (shot.camera.place_keys(CAMERA), shot.camera.is_placed(CAMERA)) == ([5, 15], True)
    here = frames_of(shot, [5])[0]
    shot.camera.remove_place_key(CAMERA, 15)
    assert frames_of(shot, [1, 15, 24]) == pytest.approx(np.array([here] * 3))
    shot.camera.remove_place_key(CAMERA, 5)
    assert shot.camera.place_keys(CAMERA) == []
    assert frames_of(shot, [1, 24]) == pytest.approx(np.array([here] * 2))
    assert [str(op.GetOpName()) for op in camera.GetOrderedXformOps()] == ["xformOp:transform"]


def test_a_blocked_sample_is_no_key_and_stays(tmp_path):
    def blocked(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
        slide(camera, world)
        camera.GetOrderedXformOps()[0].GetAttr().Set(Sdf.ValueBlock(), 15)

    shot = open_shot(tmp_path, blocked)
    assert shot.camera.place_keys(CAMERA) == [1, 9, 20]
    shot.camera.remove_place_key(CAMERA, 1)
    attribute = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("xformOp:translate")
    assert (attribute.GetTimeSamples(), attribute.Get(16)) == ([9, 15, 20], None)


def test_keys_are_moved_all_at_once(tmp_path):
    shot = open_shot(tmp_path, slide)
    shot.camera.move_place_keys(CAMERA, {1: 9, 9: 1})
    assert own_x(shot, 1, 9, 20) == [2, 0, 4]
    shot.camera.move_place_keys(CAMERA, {1: 9.5, 9: 20})  # the key at 20 is replaced
    assert shot.camera.place_keys(CAMERA) == [9.5, 20]
    assert own_x(shot, 1, 9.5, 20, 24) == [2, 2, 0, 0]
    shot.edits.undo()
    shot.edits.undo()
    assert own_x(shot, 1, 9, 20) == [0, 2, 4]


def test_a_key_moves_what_is_keyed_there_alone(tmp_path):
    shot = open_shot(tmp_path, rig_of_several)
    shot.camera.move_place_keys(CAMERA, {9: 10, 15: 18})
    prim = shot.stage.GetPrimAtPath(CAMERA)
    times = {
        name: prim.GetAttribute(f"xformOp:{name}").GetTimeSamples()
        for name in ("translate", "translate:pivot", "rotateXYZ")
    }
    assert times == {"translate": [1, 10, 20], "translate:pivot": [10, 12], "rotateXYZ": [10, 18]}


def test_keys_of_edited_operations_are_of_the_edits(tmp_path):
    shot = open_shot(tmp_path, rig_of_several)
    assert shot.camera.edited_place_keys(CAMERA) == set()
    shot.camera.remove_place_key(CAMERA, 15)
    assert shot.camera.edited_place_keys(CAMERA) == {9}
    shot.camera.move(CAMERA, HERE, 5, is_keyed=True)
    assert shot.camera.edited_place_keys(CAMERA) == set(shot.camera.place_keys(CAMERA)) >= {5}
    splined = open_shot(tmp_path / "spline", turn_by_spline)
    splined.camera.remove_place_key(CAMERA, 9)
    assert splined.camera.edited_place_keys(CAMERA) == {12, 20}


def test_knots_keep_their_values_where_they_are_moved(tmp_path):
    shot = open_shot(tmp_path, turn_by_spline)
    shot.camera.move_place_keys(CAMERA, {12: 16, 20: 10})
    attribute = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("xformOp:rotateY")
    assert [attribute.Get(time) for time in (9, 10, 13, 16, 24)] == pytest.approx([0, 30, 60, 90, 90])


@pytest.mark.parametrize("time", [2, 9.0001, 1e6])
def test_keys_that_are_not_there_are_refused(tmp_path, time):
    shot = open_shot(tmp_path, slide)
    with pytest.raises(NotFoundError, match=r"its keys are: 1, 9, 20"):
        shot.camera.remove_place_key(CAMERA, time)
    with pytest.raises(NotFoundError):
        shot.camera.move_place_keys(CAMERA, {1: 3, time: 4})
    assert shot.edits.state() == ""


def test_times_that_cannot_be_are_refused(tmp_path):
    shot = open_shot(tmp_path, slide)
    for moves in ({1: math.inf}, {1: math.nan}, {1: 5, 9: 5}):
        with pytest.raises(SettingsError):
            shot.camera.move_place_keys(CAMERA, moves)
    with pytest.raises(SettingsError):
        shot.camera.remove_place_key(CAMERA, math.nan)
    assert shot.edits.state() == ""


def test_too_many_samples_are_told_in_part_and_not_edited(tmp_path, monkeypatch):
    shot = open_shot(tmp_path, slide)
    monkeypatch.setattr(place_keys, "MAX_SAMPLES", 2)
    assert shot.camera.place_keys(CAMERA) == [1, 9]
    with pytest.raises(CameraError, match="more than 2 samples"):
        shot.camera.remove_place_key(CAMERA, 1)


def test_a_place_is_given_back_only_where_there_is_another(tmp_path):
    shot = open_shot(tmp_path, slide)
    with pytest.raises(NotFoundError, match="no edit places it"):
        shot.camera.give_back_place(CAMERA)
    copy = shot.camera.duplicate(CAMERA)
    with pytest.raises(CameraError) as refused:
        shot.camera.give_back_place(copy)
    assert refused.value.code == "no_place"
    shot.camera.set(CAMERA, f_stop=4)
    shot.camera.move(CAMERA, HERE, 1)
    shot.camera.give_back_place(CAMERA)
    assert own_x(shot, 1, 9) == [0, 2]
    assert "fStop = 4" in shot.edits.state()
