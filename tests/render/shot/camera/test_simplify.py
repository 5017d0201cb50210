"""Dense keys become few that make nearly the same curve."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pxr import Ts, Usd, UsdGeom

from render.errors import SettingsError
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, write_shot
from usd_schemas import Key, Tangents

FRAMES = np.arange(1, 97)


@pytest.fixture
def shot(tmp_path):
    return Shot.open(write_shot(tmp_path / "shot.usda"))


def rack_m(time: float) -> float:
    """Distance of a rack by hand from 2.65 to 8.6 m, with the tremor of a hand, m."""
    share = np.clip((time - 30) / 28, 0, 1)
    w = 1 / 2.65 + (1 / 8.6 - 1 / 2.65) * share**2 * (3 - 2 * share)
    return float((1 + 0.004 * math.sin(1.7 * time)) / w)


def key_densely(shot: Shot, name: str, value) -> None:
    for time in FRAMES:
        shot.camera.set_key(CAMERA, name, Key(float(time), value(time), "linear"))


def test_a_recorded_rack_becomes_few_keys_that_usd_reads(shot, tmp_path):
    key_densely(shot, "focus_distance_m", rack_m)
    found = shot.camera.simplify(CAMERA, "focus_distance_m", 0.02)
    assert (found.before, found.after) == (96, len(shot.camera.keys(CAMERA, "focus_distance_m")))
    assert found.after <= 8
    assert 0.001 < found.off <= 0.02
    shot.stage.Export(str(tmp_path / "written.usda"))
    stage = Usd.Stage.Open(str(tmp_path / "written.usda"))
    distance = UsdGeom.Camera.Get(stage, CAMERA).GetFocusDistanceAttr()
    metres = np.array([distance.Get(float(time)) for time in FRAMES]) * UsdGeom.GetStageMetersPerUnit(stage)
    off = np.abs(metres / [rack_m(time) for time in FRAMES] - 1)
    assert off.max() == pytest.approx(found.off, abs=1e-5)


def test_it_is_one_step_of_undo(shot):
    key_densely(shot, "f_stop", lambda time: 2.8 + time / 50)
    shot.camera.simplify(CAMERA, "f_stop", 0.01)
    assert len(shot.camera.keys(CAMERA, "f_stop")) == 2
    assert shot.edits.history.undo_label == "simplify the f-number of cam"
    shot.edits.undo()
    assert len(shot.camera.keys(CAMERA, "f_stop")) == 96


def test_what_goes_through_zero_is_measured_by_its_span(shot):
    key_densely(shot, "tilt_deg", lambda time: 6 * math.sin(time / 15))
    found = shot.camera.simplify(CAMERA, "tilt_deg", 0.03)
    assert found.after < 12
    at = [shot.focus.settings(CAMERA, float(time))[1].tilt_deg for time in FRAMES]
    assert np.abs(np.array(at) - 6 * np.sin(FRAMES / 15)).max() <= 0.03 * 12


def test_a_smaller_tolerance_keeps_more_keys(shot):
    key_densely(shot, "focus_distance_m", rack_m)
    fine = shot.camera.simplify(CAMERA, "focus_distance_m", 0.0005)
    assert fine.after > 20
    assert fine.off <= 0.0005 + 1e-6


@pytest.mark.parametrize("tolerance", [0, 1, -0.1, 1e-300, math.nan, math.inf])
def test_a_tolerance_that_is_no_share_is_refused(shot, tolerance):
    key_densely(shot, "f_stop", lambda time: 2.8)
    with pytest.raises(SettingsError, match="share from 0\\.0001 to below 1"):
        shot.camera.simplify(CAMERA, "f_stop", tolerance)


def test_keys_of_which_there_are_no_fewer_stay(shot):
    tangents = Tangents(0.0, 2.0, 0.5, 4.0)
    for time, value in ((1, 4.0), (20, 8.0), (60, 3.0)):
        shot.camera.set_key(CAMERA, "f_stop", Key(time, value, "bezier", tangents))
    before = shot.camera.keys(CAMERA, "f_stop")
    found = shot.camera.simplify(CAMERA, "f_stop", 0.001)
    assert (found.before, found.after, found.off) == (3, 3, 0)
    assert shot.camera.keys(CAMERA, "f_stop") == before


def test_the_curve_goes_on_beyond_its_keys_as_before(shot):
    key_densely(shot, "f_stop", lambda time: 2.8 + time / 50)
    attribute = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("fStop")
    extrapolate(shot, attribute, Ts.ExtrapLinear)
    before = attribute.Get(120.0)
    shot.camera.simplify(CAMERA, "f_stop", 0.01)
    assert attribute.Get(120.0) == pytest.approx(before, rel=0.02)
    shot.camera.set_key(CAMERA, "f_stop", Key(50.0, 4.0, "linear"))
    extrapolate(shot, attribute, Ts.ExtrapLoopRepeat)
    with pytest.raises(SettingsError, match="has loops"):
        shot.camera.simplify(CAMERA, "f_stop", 0.01)


def extrapolate(shot, attribute, mode):
    spline = attribute.GetSpline()
    spline.SetPostExtrapolation(Ts.Extrapolation(mode))
    with shot.edits.transaction("go on"):
        attribute.SetSpline(spline)


def test_what_makes_no_curve_is_refused_with_the_reason(shot):
    with pytest.raises(SettingsError, match="has 0 keys"):
        shot.camera.simplify(CAMERA, "f_stop", 0.02)
    for time in (1, 5, 9):
        shot.camera.set_key(CAMERA, "f_stop", Key(time, 4.0, "held"))
    with pytest.raises(SettingsError, match="holds its value"):
        shot.camera.simplify(CAMERA, "f_stop", 0.02)
    for time in (1, 1e6, 2e6):
        shot.camera.set_key(CAMERA, "focal_length_mm", Key(time, 50.0, "linear"))
    with pytest.raises(SettingsError, match="more than 20,000 frames"):
        shot.camera.simplify(CAMERA, "focal_length_mm", 0.02)
    assert len(shot.camera.keys(CAMERA, "f_stop")) == 3
