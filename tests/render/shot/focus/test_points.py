"""Focus points drive the lens: what was clicked stays sharp, whatever moves and however the stage measures."""

import json
import math

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd

from render.errors import CameraError, SettingsError
from render.focus.files import curve_to_json
from render.optics.view import PinholeView
from render.shot import Shot
from render.shot.focus import inputs
from render.shot.inspection import inspect_shot
from tests.render.kits.focus_shot import CAMERA, FAR, FRAMES, NEAR, Units, open_bare, write_shot
from usd_schemas import FocusData, FocusPoint, LensCamera, LensData
from usd_schemas.units import metres_from_units

CENTRE = {"face": 0, "fan_triangle": 0, "barycentric": (0.5, 0.0, 0.5)}
ON_NEAR = FocusPoint("near", target=(NEAR,), **CENTRE)
ON_FAR = FocusPoint("far", target=(FAR,), **CENTRE)
SLOPE_MM_M = 50 * 50 / 2 / 1000
LAST_FRAME_IN_PICTURE = 6  # the near card's centre leaves the picture, 1.44 m wide to either side, after this


@pytest.fixture
def shot(tmp_path):
    return Shot.open(write_shot(tmp_path / "shot.usda"))


def far_depth_m(frame):
    return 10 - 2 * (frame - 1) / 23


@pytest.mark.parametrize(
    "units", [Units(), Units(0.01), Units(0.01, "Z", 48.0), Units(0.0254, "Z", 25.0), Units(1000.0, "Y", 24.0)]
)
def test_one_point_focuses_what_was_clicked_in_any_units(tmp_path, units):
    shot = Shot.open(write_shot(tmp_path / "shot.usda", units))
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    step = units.per_second / 24
    for frame in (1, 8, 24):
        camera = shot.camera_at(CAMERA, frame * step, 960, 540)
        assert camera.focus_distance_m == pytest.approx(far_depth_m(frame), rel=1e-5)
        assert (camera.focal_length_mm, camera.f_stop) == pytest.approx((50.0, 2.0), rel=1e-6)
        (placed,) = shot.focus.points(CAMERA, frame * step)
        assert placed.position_m == pytest.approx((-1, 1, 2 * (frame - 1) / 23), abs=1e-4)
        assert (placed.state, placed.share, placed.visible_in_frame) == ("used", 1.0, True)
        assert placed.coc_mm == pytest.approx(0.0, abs=1e-6)


def test_points_stand_where_the_renderer_draws_them(shot):
    shot.focus.add_point(CAMERA, "near", ON_NEAR)
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    for width, height in ((960, 540), (640, 640), (300, 900)):
        camera = shot.camera_at(CAMERA, 3, width, height)
        placed = shot.focus.points(CAMERA, 3, aspect=width / height)
        pixels, depths = PinholeView.from_camera(camera, width, height).project(
            np.array([point.position_m for point in placed])
        )
        assert np.array([p.screen for p in placed]) * (width, height) == pytest.approx(pixels, abs=1e-6)
        assert [p.depth_m for p in placed] == pytest.approx(depths.tolist())


def test_a_point_in_the_centre_of_the_picture(shot):
    shot.focus.add_point(CAMERA, "near", ON_NEAR)
    (placed,) = shot.focus.points(CAMERA, 1)
    assert placed.screen == pytest.approx((0.5, 0.5))
    assert placed.depth_m == pytest.approx(4.0)


def test_a_point_that_leaves_the_picture_gives_focus_back(shot):
    shot.focus.add_point(CAMERA, "near", ON_NEAR)
    inside, outside = (shot.focus.read(CAMERA, LAST_FRAME_IN_PICTURE + i) for i in (0, 1))
    assert inside.focus_distance_m == pytest.approx(4.0)
    assert (outside.focus_distance_m, outside.source) == (pytest.approx(3.0), "camera")
    assert "near (outside frame)" in outside.reason
    (placed,) = shot.focus.points(CAMERA, LAST_FRAME_IN_PICTURE + 1)
    assert (placed.state, placed.visible_in_frame) == ("outside_frame", False)
    assert placed.screen[0] > 1


def test_the_focus_does_not_depend_on_the_shape_of_the_picture(shot):
    shot.focus.add_point(CAMERA, "near", ON_NEAR)
    for frame in FRAMES:
        focuses = {
            shot.camera_at(CAMERA, frame, *size).focus_distance_m for size in ((960, 540), (90, 900), (2000, 10))
        }
        assert len(focuses) == 1


def test_points_outside_the_picture_can_be_kept(shot):
    shot.focus.add_point(CAMERA, "near", ON_NEAR)
    with Usd.EditContext(shot.stage, shot.edits.layer):
        shot.stage.GetPrimAtPath(CAMERA).GetAttribute("focus:offScreen").Set("keep")
    assert shot.focus.read(CAMERA, 24).focus_distance_m == pytest.approx(4.0)


def test_a_rack_by_keyed_weights_passes_evenly_in_blur(shot):
    shot.focus.add_point(CAMERA, "near", ON_NEAR)
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    for name, start, end in (("near", 1.0, 0.0), ("far", 0.0, 1.0)):
        shot.focus.set_key(CAMERA, name, "weight", 1, start)
        shot.focus.set_key(CAMERA, name, "weight", 5, end)
    curve = shot.focus.curve(CAMERA, range(1, 7))
    t = np.clip((np.arange(1, 7) - 1) / 4, 0, 1)
    expected_w = (1 - t) / 4 + t / far_depth_m(np.arange(1, 7))
    assert 1 / curve.focus_distance_m == pytest.approx(expected_w, rel=1e-5)
    near, far = curve.points
    assert near.share == pytest.approx(1 - t, abs=1e-6)
    assert far.states[0] == "zero_weight"
    assert curve.sharp_points(0) == ("near",)
    assert curve.sharp_points(4) == ("far",)
    assert near.coc_mm[4] == pytest.approx(SLOPE_MM_M * abs(1 / 4 - 1 / far_depth_m(5)), rel=1e-4)


def test_enabling_is_keyed_and_holds(shot):
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    shot.focus.set_key(CAMERA, "far", "enabled", 1, False)
    shot.focus.set_key(CAMERA, "far", "enabled", 10, True)
    curve = shot.focus.curve(CAMERA, [1, 9, 10, 24])
    assert curve.points[0].states == ("disabled", "disabled", "used", "used")
    assert curve.sources == ("camera", "camera", "points", "points")
    assert [key.value for key in shot.focus.keys(CAMERA, "far", "enabled")] == [False, True]
    shot.focus.remove_key(CAMERA, "far", "enabled", 1)
    assert shot.focus.read(CAMERA, 1).source == "points"


def test_a_change_at_a_time_is_a_key_only_where_there_are_keys(shot):
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    shot.focus.set_key(CAMERA, "far", "weight", 1, 1.0)
    changed = shot.focus.update_point(CAMERA, "far", time=9, weight=0.25, kind="soft", blur=0.1)
    assert (changed.weight, changed.kind, changed.blur) == (0.25, "soft", 0.1)
    assert [key.time for key in shot.focus.keys(CAMERA, "far", "weight")] == [1, 9]
    assert shot.focus.keys(CAMERA, "far", "blur") == []
    with pytest.raises(SettingsError, match="time"):
        shot.focus.update_point(CAMERA, "far", weight=0.5)


def test_a_soft_point_gets_the_blur_it_asks_for(shot):
    shot.focus.add_point(CAMERA, "far", FocusPoint("far", target=(FAR,), kind="soft", blur=0.05, **CENTRE))
    (placed,) = shot.focus.points(CAMERA, 1)
    assert placed.coc_mm == pytest.approx(0.05, rel=1e-6)
    assert shot.focus.read(CAMERA, 1).focus_distance_m < 10, "on the side of the camera's own 3 m"


def test_soft_by_a_distance_is_in_scene_units(tmp_path):
    shot = Shot.open(write_shot(tmp_path / "shot.usda", Units(0.01)))
    point = FocusPoint("far", target=(FAR,), kind="soft", surface_offset=50.0, **CENTRE)
    shot.focus.add_point(CAMERA, "far", point)
    assert shot.focus.read(CAMERA, 1).focus_distance_m == pytest.approx(10.5, rel=1e-5)


def test_the_first_point_takes_the_focus_and_the_hand_takes_it_back(shot):
    assert shot.focus.read(CAMERA, 1).focus_mode == "manual"
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    assert shot.focus.read(CAMERA, 1).focus_mode == "points"
    shot.camera.set(CAMERA, focus_distance_m=2.5)
    by_hand = shot.focus.read(CAMERA, 1)
    assert (by_hand.focus_mode, by_hand.focus_distance_m) == ("manual", pytest.approx(2.5))
    assert "by hand" in " ".join(f.message for f in shot.findings())
    shot.camera.set(CAMERA, focus_mode="points")
    assert shot.focus.read(CAMERA, 1).focus_distance_m == pytest.approx(10.0)


def test_curvature_of_field_is_not_traced_for_a_focus_by_hand(shot, monkeypatch):
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    calls = []
    monkeypatch.setattr(inputs, "field_shifts_w", lambda camera, slopes, w: calls.append(len(w)) or np.zeros(len(w)))
    shot.focus.set(CAMERA, mode="manual")
    assert shot.camera_at(CAMERA, 1, 960, 540).focus_distance_m == pytest.approx(3.0)
    assert calls == []
    shot.focus.set(CAMERA, mode="points")
    assert shot.camera_at(CAMERA, 1, 960, 540).focus_distance_m == pytest.approx(10.0)
    assert calls == [1]


def test_points_on_a_camera_whose_mode_is_not_authored_wait(tmp_path):
    path = write_shot(tmp_path / "shot.usda")
    stage = open_bare(path)
    LensCamera(stage.GetPrimAtPath(CAMERA)).add_focus_point("far", ON_FAR)
    stage.GetRootLayer().Export(str(path.with_name("with_point.usda")))
    shot = Shot.open(path.with_name("with_point.usda"))
    readout = shot.focus.read(CAMERA, 1)
    assert (readout.focus_distance_m, readout.source) == (pytest.approx(3.0), "camera")
    assert "manual" in readout.reason
    assert [p.state for p in shot.focus.points(CAMERA, 1)] == ["by_hand"]


def test_a_point_whose_target_is_gone_is_lost_and_the_others_go_on(shot):
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    shot.focus.add_point(CAMERA, "gone", FocusPoint("gone", target=("/World/gone",), **CENTRE))
    assert shot.focus.read(CAMERA, 1).focus_distance_m == pytest.approx(10.0)
    _, gone = shot.focus.points(CAMERA, 1)
    assert (gone.state, gone.position_m, gone.screen, gone.visible_in_frame) == ("lost", None, None, False)
    assert math.isnan(gone.depth_m)
    assert "/World/gone" in gone.problem
    json.loads(curve_to_json(shot.focus.curve(CAMERA, [1])))


def test_infinity_by_hand_is_very_far_in_the_file(shot):
    shot.camera.set(CAMERA, focus_distance_m=math.inf)
    readout = shot.focus.read(CAMERA, 1)
    assert readout.focus_distance_m >= 1e5
    assert readout.far_m == math.inf
    assert readout.near_m == pytest.approx(readout.hyperfocal_m, rel=1e-3)


def test_the_limit_of_sharpness_is_the_gates_or_the_cameras_own(shot):
    readout = shot.focus.read(CAMERA, 1)
    assert readout.coc_limit_mm == pytest.approx(math.hypot(36, 20.25) / 1500, rel=1e-6)
    assert SLOPE_MM_M * (1 / readout.near_m - 1 / 3) == pytest.approx(readout.coc_limit_mm, rel=1e-5)
    camera = LensCamera(shot.stage.GetPrimAtPath(CAMERA))
    with Usd.EditContext(shot.stage, shot.edits.layer):
        camera.focus.author(type(camera.focus.read())(circle_of_confusion_mm=0.05))
    assert shot.focus.read(CAMERA, 1).coc_limit_mm == 0.05


@pytest.mark.parametrize("baked", [False, True])
@pytest.mark.parametrize("units", [Units(), Units(0.01, "Z", 48.0)])
def test_the_focus_layer_gives_any_usd_tool_the_solved_focus(tmp_path, units, baked):
    path = write_shot(tmp_path / "shot.usda", units)
    shot = Shot.open(path)
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    frames = (np.linspace(FRAMES[0], FRAMES[-1], 1000) * units.per_second / 24).tolist()
    text = shot.focus.layer(CAMERA, frames, baked)
    assert ("spline" in text) is not baked
    assert ("timeSamples" in text) is baked
    layer = Sdf.Layer.CreateAnonymous("focus.usda")
    layer.ImportFromString(text)
    root = Sdf.Layer.CreateAnonymous("over.usda")
    root.timeCodesPerSecond = units.per_second
    root.subLayerPaths = [layer.identifier, str(path)]
    stage = Usd.Stage.Open(root)
    attribute = stage.GetPrimAtPath(CAMERA).GetAttribute("focusDistance")
    distances_m = [metres_from_units(attribute.Get(time), shot.stage) for time in frames]
    ours_m = shot.focus.curve(CAMERA, frames).focus_distance_m
    assert distances_m == pytest.approx(ours_m, rel=1e-6)
    assert ours_m[0] == pytest.approx(far_depth_m(FRAMES[0]))
    assert stage.GetPrimAtPath(CAMERA).GetAttribute("fStop").Get(frames[500]) == pytest.approx(2.0)
    assert stage.GetPrimAtPath(CAMERA).GetAttribute("focus:mode").Get() == "manual"
    assert shot.edits.export().count("focusDistance") == 0, "the shot itself is not changed"


def test_a_looser_spline_has_fewer_knots(shot):
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    shot.focus.add_point(CAMERA, "near", ON_NEAR)
    for frame, weight in ((2, 0.0), (6, 1.0), (12, 0.1)):
        shot.focus.set_key(CAMERA, "near", "weight", frame, weight, "auto")
    knots = {}
    for tolerance in (1e-6, 1e-2):
        layer = Sdf.Layer.CreateAnonymous("focus.usda")
        layer.ImportFromString(shot.focus.layer(CAMERA, list(FRAMES), tolerance=tolerance))
        stage = Usd.Stage.Open(layer)
        attribute = stage.GetPrimAtPath(CAMERA).GetAttribute("focusDistance")
        knots[tolerance] = len(attribute.GetSpline().GetKnots())
    assert knots[1e-2] < knots[1e-6]
    with pytest.raises(SettingsError, match="tolerance"):
        shot.focus.layer(CAMERA, list(FRAMES), tolerance=-1.0)


@pytest.mark.parametrize("frames", [[], [3, 2, 1], [1, math.nan], [1, 1], range(10**9)])
def test_frames_that_make_no_curve_are_refused(shot, frames):
    with pytest.raises(SettingsError, match="frames"):
        shot.focus.curve(CAMERA, frames)


@pytest.mark.parametrize("time", [math.inf, -math.inf])
def test_a_time_is_not_infinite(shot, time):
    for attempt in (
        lambda: shot.scene_at(time),
        lambda: shot.camera_at(CAMERA, time, 16, 9),
        lambda: shot.focus.read(CAMERA, time),
        lambda: shot.focus.points(CAMERA, time),
    ):
        with pytest.raises(SettingsError, match="time"):
            attempt()


@pytest.mark.parametrize("size", [(0, 9), (16, 0), (-1, 9)])
def test_a_picture_has_pixels(shot, size):
    with pytest.raises(SettingsError, match="picture"):
        shot.camera_at(CAMERA, 1, *size)


def test_without_a_camera_a_frame_can_be_made_but_no_focus_pulled(tmp_path):
    shot = Shot.open(write_shot(tmp_path / "shot.usda", camera=False))
    assert shot.cameras() == []
    camera = shot.camera_at(None, 1, 300, 100)
    assert camera.horizontal_aperture_mm / camera.vertical_aperture_mm == pytest.approx(3.0)
    readout = shot.focus.read(None, 1)
    assert (readout.camera, readout.f_stop, readout.near_m, readout.far_m) == ("", 0.0, 0.0, math.inf)
    assert shot.focus.points(None, 1, aspect=3.0) == []
    for attempt in (
        lambda: shot.focus.curve(None, [1]),
        lambda: shot.focus.add_point(None, "far", ON_FAR),
        lambda: shot.camera.set(None, f_stop=2.0),
    ):
        with pytest.raises(CameraError, match="no camera") as caught:
            attempt()
        assert caught.value.code == "no_camera"


def test_the_only_camera_is_the_default_one(shot):
    assert shot.default_camera().path == CAMERA
    shot.focus.add_point(None, "far", ON_FAR)
    assert shot.camera_at(None, 1, 16, 9).path == CAMERA
    assert shot.focus.read(None, 1).camera == CAMERA


def test_camera_settings_without_effect_are_reported(shot):
    camera = LensCamera(shot.stage.GetPrimAtPath(CAMERA))
    with Usd.EditContext(shot.stage, shot.edits.layer):
        camera.lens.author(LensData(entrance_pupil_offset=9.0))
        camera.focus.author(FocusData(mode="points", smoothing_s=0.5, near_priority=1.0))
    messages = {finding.path: finding.message for finding in shot.findings()}
    assert "lens:entrancePupilOffset" in messages[f"{CAMERA}.lens:entrancePupilOffset"]
    assert not any("focus:" in path for path in messages)


def test_keys_that_contradict_each_other_are_reported(shot):
    """By whoever renders it, not by inspection alone, and once."""
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    shot.focus.set_key(CAMERA, "far", "weight", 1, 1.0)
    shot.focus.set_key(CAMERA, "far", "weight", 5, 0.0)
    (found,) = [finding for finding in shot.findings() if finding.code == "contradictory_keys"]
    assert "no focus point counts at 5" in found.message
    inspection = inspect_shot(shot)
    messages = [note.message for note in (*inspection.notes, *inspection.validation)]
    assert messages.count(found.message) == 1


def test_a_point_without_a_face_is_at_the_origin_of_its_target(shot):
    shot.focus.add_point(CAMERA, "far", FocusPoint("far", target=(FAR,), offset=(0.0, 0.5, 0.0)))
    (placed,) = shot.focus.points(CAMERA, 1)
    assert placed.position_m == pytest.approx((-1.0, 0.5, 0.0))


def test_edits_saved_at_another_rate_keep_their_seconds(tmp_path):
    slow = Shot.open(write_shot(tmp_path / "slow.usda", Units(per_second=24.0)))
    slow.focus.add_point(CAMERA, "far", ON_FAR)
    slow.focus.set_key(CAMERA, "far", "weight", 10, 0.5)
    slow.edits.save(tmp_path / "edits.usda")
    fast = Shot.open(write_shot(tmp_path / "fast.usda", Units(per_second=48.0)), edits=tmp_path / "edits.usda")
    assert [key.time for key in fast.focus.keys(CAMERA, "far", "weight")] == [20]
    fast.focus.set_key(CAMERA, "far", "weight", 40, 1.0)
    assert [key.time for key in fast.focus.keys(CAMERA, "far", "weight")] == [20, 40]
    fast.focus.remove_key(CAMERA, "far", "weight", 40)
    assert [key.time for key in fast.focus.keys(CAMERA, "far", "weight")] == [20]


def test_pulling_focus_leaves_the_scene_alone(shot):
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    before = shot.scene_at(1)
    shot.focus.set_key(CAMERA, "far", "weight", 1, 0.5)
    shot.camera.set(CAMERA, f_stop=4.0)
    text = shot.edits.export()
    shot.focus.update_point(CAMERA, "far", blur=0.1, kind="soft")
    shot.edits.replace(text)
    after = shot.scene_at(1)
    assert all(a is b for a, b in zip(before.batches, after.batches, strict=True))


@pytest.mark.parametrize(("attribute", "value"), [("weight", math.nan), ("weight", -1.0), ("blur", -0.1)])
def test_impossible_numbers_of_a_point_are_named_until_corrected(shot, attribute, value):
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    with Usd.EditContext(shot.stage, shot.edits.layer):
        shot.stage.GetPrimAtPath(CAMERA).GetAttribute(f"focusPoint:far:{attribute}").Set(value)
    for attempt in (
        lambda: shot.focus.read(CAMERA, 1),
        lambda: shot.camera_at(CAMERA, 1, 16, 9),
        lambda: shot.focus.curve(CAMERA, [1, 2]),
    ):
        attempt()
        (finding,) = (finding for finding in shot.findings() if finding.code == "bad_focus_point")
        assert attribute in finding.message
        assert "'far'" in finding.message
    shot.focus.update_point(CAMERA, "far", **{attribute: 0.5})
    assert shot.focus.read(CAMERA, 1).focus_distance_m == pytest.approx(10.0)
    assert "bad_focus_point" not in [finding.code for finding in shot.findings()]


def test_a_point_whose_place_is_not_finite_is_lost(shot):
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    with Usd.EditContext(shot.stage, shot.edits.layer):
        shot.stage.GetPrimAtPath(CAMERA).GetAttribute("focusPoint:far:offset").Set(Gf.Vec3d(math.nan, 0, 0))
    (placed,) = shot.focus.points(CAMERA, 1)
    assert (placed.state, placed.position_m) == ("lost", None)
    assert "finite" in placed.problem
    assert shot.focus.read(CAMERA, 1).source == "camera"


def test_a_lost_point_is_a_finding_until_it_is_mended(shot):
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    shot.focus.update_point(CAMERA, "far", target=("/World/Gone",))
    shot.focus.read(CAMERA, 1)
    assert [finding.code for finding in shot.findings()].count("lost_focus_point") == 1
    shot.focus.remove_point(CAMERA, "far")
    shot.focus.read(CAMERA, 1)
    assert "lost_focus_point" not in [finding.code for finding in shot.findings()]
