"""Cameras that are moved: where they stand afterwards, at the time and at others, below parents that move, scale and shear."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Ts, Usd, UsdGeom

from render.errors import CameraError, PullfocusError, SettingsError
from render.shot import Shot
from render.shot.camera import placing
from render.shot.camera.placing import CameraPlace
from render.stage import read_camera
from tests.render.kits.focus_shot import CAMERA, FRAMES, Units, open_rigged, write_shot

METRES = Units()
AHEAD, UP = (0.6, -0.3, -1.0), (0.1, 1.0, 0.0)
PLACE = CameraPlace((1.5, 2.0, 6.0), AHEAD, UP)
OTHER = CameraPlace((-1.0, 0.5, 3.0), (0.0, 0.0, -2.0), (0.0, 3.0, 0.0))


def open_shot(tmp_path: Path, units: Units = METRES, rig=None) -> Shot:
    """Open the shot with its camera below `/World`, changed by ``rig(camera, world)``."""
    return open_rigged(tmp_path / "shot.usda", rig, units)


def frames_of(shot: Shot, times=FRAMES) -> np.ndarray:
    return np.array([read_camera(shot.stage, CAMERA, time).world_from_camera for time in times])


def assert_at(shot: Shot, place: CameraPlace, time: float) -> None:
    camera = read_camera(shot.stage, CAMERA, time).world_from_camera
    ahead, up = (np.array(vector) / np.linalg.norm(vector) for vector in (place.ahead, place.up))
    right = np.cross(ahead, up)
    assert camera[:3, 3] == pytest.approx(place.position_m, abs=1e-6)
    assert -camera[:3, 2] == pytest.approx(ahead, abs=1e-7)
    assert camera[:3, 0] == pytest.approx(right / np.linalg.norm(right), abs=1e-7)


def slide(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    for time, x in ((1, 0.0), (24, 4.6)):
        camera.GetOrderedXformOps()[0].Set(Gf.Vec3d(x, 1, 10), time)


def turn(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    slide(camera, world)
    op = camera.AddRotateYOp()
    for time, angle in ((1, 0.0), (24, 120.0)):
        op.Set(angle, time)


def turn_by_spline(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    spline = Ts.Spline("double")
    for time, angle in ((6.0, 0.0), (12.0, 90.0)):
        knot = Ts.Knot("double")
        knot.SetTime(time)
        knot.SetValue(angle)
        knot.SetNextInterpolation(Ts.InterpLinear)
        spline.SetKnot(knot)
    camera.AddRotateYOp(UsdGeom.XformOp.PrecisionDouble).GetAttr().SetSpline(spline)


def ride(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    """Let the parent move, turn, scale unevenly and mirror."""
    move, rotate = world.AddTranslateOp(), world.AddRotateZOp()
    for time in (1, 24):
        move.Set(Gf.Vec3d(time, 0, 0), time)
        rotate.Set(2.0 * time, time)
    world.AddScaleOp().Set(Gf.Vec3f(-2, 3, 0.5))


def reset(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    ride(camera, world)
    camera.SetResetXformStack(True)


def shear_own(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    camera.AddRotateXYZOp().Set(Gf.Vec3f(10, 20, 30))
    camera.AddScaleOp().Set(Gf.Vec3f(-100, 50, 25))


RIGS = [None, slide, turn, turn_by_spline, ride, reset, shear_own]


@pytest.mark.parametrize("units", [METRES, Units(metres=0.01, up="Z")], ids=["m", "cm, z up"])
@pytest.mark.parametrize("is_keyed", [False, True], ids=["all", "key"])
@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: getattr(rig, "__name__", "still"))
def test_a_camera_stands_where_it_was_placed(tmp_path, rig, is_keyed, units):
    shot = open_shot(tmp_path, units, rig)
    before = frames_of(shot)
    shot.camera.move(CAMERA, PLACE, 7, is_keyed=is_keyed)
    assert_at(shot, PLACE, 7)
    order = UsdGeom.Xformable(shot.stage.GetPrimAtPath(CAMERA)).GetXformOpOrderAttr().Get()
    assert list(order) == [*(["!resetXformStack!"] if rig is reset else []), "xformOp:transform"]
    shot.camera.move(CAMERA, OTHER, 12, is_keyed=is_keyed)
    assert_at(shot, OTHER, 12)
    shot.edits.undo()
    assert_at(shot, PLACE, 7)
    shot.edits.undo()
    assert frames_of(shot) == pytest.approx(before)


@pytest.mark.parametrize("rig", [turn, turn_by_spline])
def test_a_key_leaves_other_frames_as_they_are(tmp_path, rig):
    shot = open_shot(tmp_path, rig=rig)
    before = frames_of(shot)
    shot.camera.move(CAMERA, PLACE, 7, is_keyed=True)
    others = [at for at, frame in enumerate(FRAMES) if frame != 7]
    assert frames_of(shot)[others] == pytest.approx(before[others], abs=1e-9)
    assert np.abs(frames_of(shot)[6] - before[6]).max() > 1


def test_keys_of_a_straight_way_stay_the_only_ones(tmp_path):
    shot = open_shot(tmp_path, rig=slide)
    before = frames_of(shot, (1, 24))
    shot.camera.move(CAMERA, OTHER, 12, is_keyed=True)
    attribute = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("xformOp:transform")
    assert attribute.GetTimeSamples() == [1, 12, 24]
    assert frames_of(shot, (1, 24)) == pytest.approx(before)
    halfway = (before[0, :3, 3] + OTHER.position_m) / 2
    assert frames_of(shot, [6.5])[0, :3, 3] == pytest.approx(halfway, abs=1e-9)


def test_a_still_camera_goes_straight_between_its_keys(tmp_path):
    shot = open_shot(tmp_path)
    shot.camera.move(CAMERA, PLACE, 4, is_keyed=True)
    assert_at(shot, PLACE, 20)
    shot.camera.move(CAMERA, OTHER, 12, is_keyed=True)
    assert_at(shot, PLACE, 1)
    middle = (np.array(PLACE.position_m) + OTHER.position_m) / 2
    assert frames_of(shot, [8])[0, :3, 3] == pytest.approx(middle)


def test_a_whole_way_is_moved_rigidly(tmp_path):
    shot = open_shot(tmp_path, rig=turn)
    before = frames_of(shot)
    shot.camera.move(CAMERA, PLACE, 7)
    after = frames_of(shot)
    assert_at(shot, PLACE, 7)
    ways = [np.linalg.inv(way[6]) @ way for way in (before, after)]
    assert ways[1] == pytest.approx(ways[0], abs=1e-9)


def test_a_placed_camera_moves_with_its_parent(tmp_path):
    shot = open_shot(tmp_path, rig=ride)
    shot.camera.move(CAMERA, PLACE, 7)
    world = UsdGeom.Xformable(shot.stage.GetPrimAtPath("/World"))
    seen = [
        world.GetLocalTransformation(time).GetInverse().Transform(Gf.Vec3d(*frame[:3, 3]))
        for time, frame in zip(FRAMES, frames_of(shot), strict=True)
    ]
    assert seen == [pytest.approx(seen[0], abs=1e-6)] * len(seen)


def test_what_is_below_a_camera_keeps_its_size(tmp_path):
    shot = open_shot(tmp_path, rig=shear_own)
    lamp = UsdGeom.Xform.Define(shot.stage, f"{CAMERA}/lamp")

    def gram() -> np.ndarray:
        axes = np.array(lamp.ComputeLocalToWorldTransform(1))[:3, :3]
        return axes @ axes.T

    before = gram()
    shot.camera.move(CAMERA, PLACE, 1)
    assert gram() == pytest.approx(before, rel=1e-9, abs=1e-6)


def flat_own(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    camera.AddScaleOp().Set(Gf.Vec3f(0, 1, 1))


def huge(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    world.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(1e300, 1e300, 1e300))


@pytest.mark.parametrize("rig", [flat_own, huge])
def test_a_camera_without_a_usable_size_gets_one(tmp_path, rig):
    shot = open_shot(tmp_path, rig=rig)
    shot.camera.move(CAMERA, PLACE, 1)
    assert_at(shot, PLACE, 1)


@pytest.mark.parametrize(
    ("place", "time"),
    [
        (CameraPlace((math.nan, 0, 0), AHEAD, UP), 1),
        (CameraPlace((1e10, 0, 0), AHEAD, UP), 1),
        (CameraPlace((0, 0, 0), (0, 0, 0), UP), 1),
        (CameraPlace((0, 0, 0), (0, math.inf, 0), UP), 1),
        (CameraPlace((0, 0, 0), (0, 5, 0), (0, 1, 0)), 1),
        (CameraPlace((0, 0, 0), (0, 5, 0), (0, -1e-9, 0)), 1),
        (PLACE, math.inf),
    ],
)
def test_places_that_cannot_be_are_refused(tmp_path, place, time):
    shot = open_shot(tmp_path)
    history = shot.edits.history
    with pytest.raises(SettingsError):
        shot.camera.move(CAMERA, place, time)
    assert shot.edits.history == history


def flat(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    world.AddScaleOp().Set(Gf.Vec3f(1, 0, 1))


def not_finite(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    world.AddTranslateOp().Set(Gf.Vec3d(math.nan, 0, 0))


def other_type(camera: UsdGeom.Camera, world: UsdGeom.Xformable) -> None:
    camera.GetPrim().CreateAttribute("xformOp:transform", Sdf.ValueTypeNames.Float)


@pytest.mark.parametrize("rig", [flat, not_finite, other_type])
@pytest.mark.parametrize("is_keyed", [False, True], ids=["all", "key"])
def test_transforms_that_no_camera_can_follow_are_refused(tmp_path, rig, is_keyed):
    shot = open_shot(tmp_path, rig=rig)
    with pytest.raises(PullfocusError, match=r"World|camera"):
        shot.camera.move(CAMERA, PLACE, 1, is_keyed=is_keyed)
    assert shot.edits.state() == ""


def test_ways_with_too_many_samples_are_refused(tmp_path, monkeypatch):
    shot = open_shot(tmp_path, rig=turn)
    monkeypatch.setattr(placing, "MAX_SAMPLES", 20)
    with pytest.raises(CameraError, match="more than 20 samples"):
        shot.camera.move(CAMERA, PLACE, 1)


def test_a_camera_that_is_not_there_or_shared_is_refused(tmp_path):
    path = write_shot(tmp_path / "shot.usda")
    stage = Usd.Stage.Open(str(path))
    for name in ("one", "two"):
        prim = stage.DefinePrim(f"/{name}")
        prim.GetReferences().AddInternalReference("/World")
        prim.SetInstanceable(True)
    stage.Save()
    shot = Shot.open(path)
    with pytest.raises(CameraError, match="lies in an instance"):
        shot.camera.move("/one/cam", PLACE, 1)
    with pytest.raises(CameraError, match="there is no camera"):
        shot.camera.move("/World/near", PLACE, 1)
