"""Focus settings are set and keyed on the camera, in any unit of the stage, as native splines that others read."""

import math

import pytest

from render.errors import CameraError, NotFoundError, SettingsError
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, FAR, NEAR, Units, write_shot
from usd_schemas import FocusPoint, Key, Tangents
from usd_schemas.racks import WeightRack


@pytest.fixture
def shot(tmp_path):
    return Shot.open(write_shot(tmp_path / "shot.usda"))


def attribute(shot, name):
    return shot.stage.GetPrimAtPath(CAMERA).GetAttribute(name)


def test_settings_are_authored_by_their_schemas(shot):
    shot.focus.set(CAMERA, mode="tiltPlane", lag_s=0.5, tilt_deg=-6.0, driven_by_points=False, max_angle_deg=20.0)
    focus, tilt = shot.focus.settings(CAMERA, 1)
    assert (focus.mode, focus.lag_s) == ("tiltPlane", 0.5)
    assert (tilt.tilt_deg, tilt.driven_by_points, tilt.max_angle_deg) == (-6, False, 20)
    assert {"FocusAPI", "TiltShiftAPI"} <= set(shot.stage.GetPrimAtPath(CAMERA).GetAppliedSchemas())
    assert shot.edits.history.undo_label == "set mode, lag, tilt, driven by points, max angle of cam"
    shot.edits.undo()
    assert shot.focus.settings(CAMERA, 1)[0].mode == "manual"


def test_settings_are_keyed_and_unkeyed(shot):
    shot.focus.set(CAMERA, expressive=0.0, mode="surface", time=1)
    shot.focus.set(CAMERA, expressive=1.0, time=11)
    assert [shot.focus.settings(CAMERA, t)[0].expressive for t in (1, 6, 11)] == [0, 0.5, 1]
    assert shot.focus.settings(CAMERA, 6)[0].mode == "surface"
    assert [key.time for key in shot.camera.keys(CAMERA, "expressive")] == [1, 11]
    shot.focus.set(CAMERA, expressive=0.25)
    assert shot.camera.keys(CAMERA, "expressive") == []
    assert shot.focus.settings(CAMERA, 6)[0].expressive == 0.25


@pytest.mark.parametrize("metres", [1.0, 0.01, 0.0254])
def test_keys_of_the_lens_are_splines_in_the_units_of_the_stage(tmp_path, metres):
    shot = Shot.open(write_shot(tmp_path / "shot.usda", Units(metres=metres)))
    tangents = Tangents(in_slope=0.1, in_width=2, out_slope=0.2, out_width=3)
    shot.camera.set_key(CAMERA, "focus_distance_m", Key(1, 3.0, "bezier", tangents))
    shot.camera.set_key(CAMERA, "focus_distance_m", Key(11, 6.0, "linear"))
    shot.camera.set_key(CAMERA, "focal_length_mm", Key(1, 35.0, "held"))
    spline = attribute(shot, "focusDistance").GetSpline()
    assert spline.Eval(11) == pytest.approx(6 / metres)
    first, last = shot.camera.keys(CAMERA, "focus_distance_m")
    assert (first.value, first.tangents.out_slope) == (pytest.approx(3), pytest.approx(0.2))
    assert (first.tangents.out_width, last.interpolation) == (pytest.approx(3), "linear")
    assert shot.focus.read(CAMERA, 1).focal_length_mm == pytest.approx(35)
    assert shot.focus.read(CAMERA, 11).focus_distance_m == pytest.approx(6)


def test_a_key_of_the_distance_is_a_hand_on_the_ring(shot):
    shot.focus.add_point(CAMERA, "hero", FocusPoint("hero", target=(NEAR,)))
    assert shot.focus.settings(CAMERA, 1)[0].mode == "points"
    shot.camera.set_key(CAMERA, "focus_distance_m", Key(1, 5.0, "auto"))
    assert shot.focus.read(CAMERA, 1).focus_distance_m == pytest.approx(5)


def test_the_last_key_leaves_its_value_and_a_missing_one_is_named(shot):
    shot.camera.set_key(CAMERA, "f_stop", Key(4, 8.0, "linear"))
    with pytest.raises(NotFoundError, match="its keys are: 4"):
        shot.camera.remove_key(CAMERA, "f_stop", 5)
    shot.camera.remove_key(CAMERA, "f_stop", 4)
    assert shot.camera.keys(CAMERA, "f_stop") == []
    assert shot.focus.read(CAMERA, 20).f_stop == 8


@pytest.mark.parametrize(
    ("name", "value", "problem"),
    [
        ("f_stop", -1.0, "the f-number must be 0 (a pinhole) or more, but it is -1"),
        ("f_stop", math.inf, "the f-number must be 0 (a pinhole) or more, but it is inf"),
        ("focal_length_mm", 0.0, "the focal length in mm must be above 0, but it is 0"),
        ("focal_length_mm", math.inf, "the focal length in mm must be above 0, but it is inf"),
        ("focus_distance_m", 0.0, "the focus distance in m must be above 0, or infinite, but it is 0"),
        ("focus_distance_m", math.nan, "the focus distance in m must be above 0, or infinite, but it is nan"),
    ],
)
def test_numbers_outside_the_declared_limits_of_a_lens_are_refused(shot, name, value, problem):
    with pytest.raises(SettingsError) as refused:
        shot.camera.set_key(CAMERA, name, Key(1, value, "linear"))
    assert (str(refused.value), refused.value.code) == (problem, "bad_lens_setting")
    assert shot.camera.keys(CAMERA, name) == []


def test_impossible_settings_are_reported_and_change_nothing(shot):
    before = shot.edits.export()
    attempts = [
        lambda: shot.focus.set(CAMERA, mode="by feel"),
        lambda: shot.focus.set(CAMERA, colour="red"),
        lambda: shot.focus.set(CAMERA, lag_s=0.5, expressive=2.0),
        lambda: shot.focus.set(CAMERA, tilt_deg=90.0),
        lambda: shot.focus.set(CAMERA, lag_s=float("nan")),
        lambda: shot.focus.set(CAMERA, lag_s=1.0, time=float("inf")),
        lambda: shot.camera.set_key(CAMERA, "mode", Key(1, "points", "held")),
        lambda: shot.camera.set_key(CAMERA, "focal_length_mm", Key(1, -5.0, "linear")),
        lambda: shot.camera.set_key(CAMERA, "colour", Key(1, 1.0, "linear")),
        lambda: shot.camera.keys(CAMERA, "colour"),
    ]
    for attempt in attempts:
        with pytest.raises(SettingsError):
            attempt()
        assert shot.edits.export() == before
    with pytest.raises(CameraError):
        shot.focus.set(NEAR, lag_s=1.0)


def test_a_rack_is_one_edit(shot):
    for name, target in (("near", NEAR), ("far", FAR)):
        shot.focus.add_point(CAMERA, name, FocusPoint(name, target=(target,)))
    before = shot.edits.export()
    shot.focus.update_point(CAMERA, "far", weight=0.0)
    shot.focus.rack(CAMERA, WeightRack("near", "far", 1, 5))
    assert shot.edits.history.undo_label == "rack from near to far"
    assert [key.value for key in shot.focus.keys(CAMERA, "far", "weight")] == [0, 1]
    with pytest.raises(SettingsError, match="contradicts"):
        shot.focus.rack(CAMERA, WeightRack("near", "far", -2, 3))
    with pytest.raises(NotFoundError):
        shot.focus.rack(CAMERA, WeightRack("near", "nobody", 6, 8))
    shot.edits.undo()
    shot.edits.undo()
    assert shot.edits.export() == before
