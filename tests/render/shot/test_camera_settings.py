"""How the focus is found is set and keyed on the camera, in any unit of the stage, as native splines that others read."""

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
    shot.set_focus(CAMERA, mode="tiltPlane", lag=0.5, tilt=-6.0, from_focus_points=False, max_angle=20.0)
    focus, tilt = shot.focus_settings(CAMERA, 1)
    assert (focus.mode, focus.lag) == ("tiltPlane", 0.5)
    assert (tilt.tilt, tilt.from_focus_points, tilt.max_angle) == (-6, False, 20)
    assert {"FocusAPI", "TiltShiftAPI"} <= set(shot.stage.GetPrimAtPath(CAMERA).GetAppliedSchemas())
    assert shot.history.undo_label == "set mode, lag, tilt, from focus points, max angle of cam"
    shot.undo()
    assert shot.focus_settings(CAMERA, 1)[0].mode == "manual"


def test_settings_are_keyed_and_unkeyed(shot):
    shot.set_focus(CAMERA, expressive=0.0, mode="surface", time=1)
    shot.set_focus(CAMERA, expressive=1.0, time=11)
    assert [shot.focus_settings(CAMERA, t)[0].expressive for t in (1, 6, 11)] == [0, 0.5, 1]
    assert shot.focus_settings(CAMERA, 6)[0].mode == "surface"
    assert [key.time for key in shot.camera_keys(CAMERA, "expressive")] == [1, 11]
    shot.set_focus(CAMERA, expressive=0.25)
    assert shot.camera_keys(CAMERA, "expressive") == []
    assert shot.focus_settings(CAMERA, 6)[0].expressive == 0.25


@pytest.mark.parametrize("metres", [1.0, 0.01, 0.0254])
def test_keys_of_the_lens_are_splines_in_the_units_of_the_stage(tmp_path, metres):
    shot = Shot.open(write_shot(tmp_path / "shot.usda", Units(metres=metres)))
    tangents = Tangents(in_slope=0.1, in_width=2, out_slope=0.2, out_width=3)
    shot.set_camera_key(CAMERA, "focus_distance_m", Key(1, 3.0, "bezier", tangents))
    shot.set_camera_key(CAMERA, "focus_distance_m", Key(11, 6.0, "linear"))
    shot.set_camera_key(CAMERA, "focal_length_mm", Key(1, 35.0, "held"))
    spline = attribute(shot, "focusDistance").GetSpline()
    assert spline.Eval(11) == pytest.approx(6 / metres)
    first, last = shot.camera_keys(CAMERA, "focus_distance_m")
    assert (first.value, first.tangents.out_slope) == (pytest.approx(3), pytest.approx(0.2))
    assert (first.tangents.out_width, last.interpolation) == (pytest.approx(3), "linear")
    assert shot.readout(CAMERA, 1).focal_length_mm == pytest.approx(35)
    assert shot.readout(CAMERA, 11).focus_distance_m == pytest.approx(6)


def test_a_key_of_the_distance_is_a_hand_on_the_ring(shot):
    shot.add_focus_point(CAMERA, "hero", FocusPoint("hero", target=(NEAR,)))
    assert shot.focus_settings(CAMERA, 1)[0].mode == "points"
    shot.set_camera_key(CAMERA, "focus_distance_m", Key(1, 5.0, "auto"))
    assert shot.readout(CAMERA, 1).focus_distance_m == pytest.approx(5)


def test_the_last_key_leaves_its_value_and_a_missing_one_is_named(shot):
    shot.set_camera_key(CAMERA, "f_stop", Key(4, 8.0, "linear"))
    with pytest.raises(NotFoundError, match="its keys are: 4"):
        shot.remove_camera_key(CAMERA, "f_stop", 5)
    shot.remove_camera_key(CAMERA, "f_stop", 4)
    assert shot.camera_keys(CAMERA, "f_stop") == []
    assert shot.readout(CAMERA, 20).f_stop == 8


def test_what_cannot_be_set_is_told_and_changes_nothing(shot):
    before = shot.export_edits()
    attempts = [
        lambda: shot.set_focus(CAMERA, mode="by feel"),
        lambda: shot.set_focus(CAMERA, colour="red"),
        lambda: shot.set_focus(CAMERA, lag=0.5, expressive=2.0),
        lambda: shot.set_focus(CAMERA, tilt=90.0),
        lambda: shot.set_focus(CAMERA, lag=float("nan")),
        lambda: shot.set_focus(CAMERA, lag=1.0, time=float("inf")),
        lambda: shot.set_camera_key(CAMERA, "mode", Key(1, "points", "held")),
        lambda: shot.set_camera_key(CAMERA, "focal_length_mm", Key(1, -5.0, "linear")),
        lambda: shot.set_camera_key(CAMERA, "colour", Key(1, 1.0, "linear")),
        lambda: shot.camera_keys(CAMERA, "colour"),
    ]
    for attempt in attempts:
        with pytest.raises(SettingsError):
            attempt()
        assert shot.export_edits() == before
    with pytest.raises(CameraError):
        shot.set_focus(NEAR, lag=1.0)


def test_a_rack_is_one_edit(shot):
    for name, target in (("near", NEAR), ("far", FAR)):
        shot.add_focus_point(CAMERA, name, FocusPoint(name, target=(target,)))
    before = shot.export_edits()
    shot.update_focus_point(CAMERA, "far", weight=0.0)
    shot.rack(CAMERA, WeightRack("near", "far", 1, 5))
    assert shot.history.undo_label == "rack from near to far"
    assert [key.value for key in shot.keys(CAMERA, "far", "weight")] == [0, 1]
    with pytest.raises(SettingsError, match="contradicts"):
        shot.rack(CAMERA, WeightRack("near", "far", -2, 3))
    with pytest.raises(NotFoundError):
        shot.rack(CAMERA, WeightRack("near", "nobody", 6, 8))
    shot.undo()
    shot.undo()
    assert shot.export_edits() == before
