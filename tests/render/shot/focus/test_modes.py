"""The focus modes on a stage: tilted planes, surfaces through points, points that come, go and hide, hands that follow."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

from render.errors import CameraError
from render.focus.tilt import hinge_m, tilt_and_swing
from render.frame import FrameRenderer, FrameSettings
from render.shot import Shot
from tests.render.kits.table_shot import CAMERA, ON_TABLE, TABLE, on_table, write_table
from usd_schemas import FocusPoint, LensCamera, LensData, SplitDiopter, TiltShiftData

WIDTH, HEIGHT = 480, 320
SETTINGS = FrameSettings(WIDTH, HEIGHT, rays=16, aovs=("color", "depth", "coc", "focus_depth", "prim_id"))


@pytest.fixture
def shot(tmp_path: Path) -> Shot:
    return Shot.open(write_table(tmp_path / "table.usda"))


def with_table_points(shot: Shot, mode: str) -> None:
    for name, place in ON_TABLE.items():
        shot.focus.add_point(CAMERA, name, on_table(name, place))
    shot.focus.set(CAMERA, mode=mode)


def test_a_tilted_lens_holds_a_whole_table(shot: Shot, renderer: FrameRenderer) -> None:
    with_table_points(shot, "tiltPlane")
    camera = shot.camera_at(CAMERA, 1, WIDTH, HEIGHT)
    assert camera.focal_surface is not None
    aovs = renderer.render(shot.scene_at(1), camera, SETTINGS).aovs
    path = renderer.render(shot.scene_at(1), camera, SETTINGS).prim_paths
    table = aovs["prim_id"] == path.index(TABLE) + 1
    assert table.mean() > 0.5
    assert np.abs(aovs["coc"][table]).max() < 0.1  # px
    upright = np.abs(renderer.render(shot.scene_at(1), upright_camera(shot), SETTINGS).aovs["coc"][table])
    assert upright.max() > 30 * 0.1


def upright_camera(shot: Shot):  # type: ignore[no-untyped-def]
    shot.focus.set(CAMERA, mode="points")
    return shot.camera_at(CAMERA, 1, WIDTH, HEIGHT)


def test_the_curve_has_the_angles_that_give_the_plane_back_by_hand(shot: Shot) -> None:
    """Merklinger's hinge rule: the plane passes f / sin(tilt) from the lens, as the table does: at the lens's height."""
    with_table_points(shot, "tiltPlane")
    curve = shot.focus.curve(CAMERA, [1.0])
    camera = shot.camera_at(CAMERA, 1, WIDTH, HEIGHT)
    assert camera.focal_surface is not None
    plane = camera.focal_surface.plane
    assert (curve.tilt_rad[0], curve.swing_rad[0]) == pytest.approx(tilt_and_swing(plane, 40.0))
    height_along_film_m = 0.7 / math.cos(math.radians(18))
    assert hinge_m(plane) == pytest.approx(height_along_film_m, rel=1e-6)
    assert math.sin(-curve.tilt_rad[0]) == pytest.approx(0.04 / height_along_film_m, rel=1e-6)
    shot.focus.set(
        CAMERA, mode="manual", tilt_deg=math.degrees(curve.tilt_rad[0]), swing_deg=math.degrees(curve.swing_rad[0])
    )
    shot.camera.set(CAMERA, focus_distance_m=float(curve.focus_distance_m[0]))
    by_hand = shot.camera_at(CAMERA, 1, WIDTH, HEIGHT).focal_surface
    assert by_hand is not None
    plane_terms = (by_hand.plane.w0, by_hand.plane.slope_x, by_hand.plane.slope_y)
    assert plane_terms == pytest.approx((plane.w0, plane.slope_x, plane.slope_y), rel=1e-5, abs=1e-7)


@pytest.mark.parametrize(
    ("name", "angle", "reach"),
    [
        ("tilt", 500.0, "-89 to 89"),
        ("tilt", math.nan, "-89 to 89"),
        ("swing", -90.0, "-89 to 89"),
        ("maxAngle", 1e30, "0 to 89"),
        ("maxAngle", -1.0, "0 to 89"),
    ],
)
def test_a_lens_is_not_turned_away_from_its_film(shot: Shot, name: str, angle: float, reach: str) -> None:
    LensCamera(shot.stage.GetPrimAtPath(CAMERA)).tilt_shift.author(TiltShiftData())
    shot.stage.GetPrimAtPath(CAMERA).GetAttribute(f"tiltShift:{name}").Set(angle)
    with pytest.raises(CameraError, match=re.escape(f"from {reach} degrees, got {angle:g}")):
        shot.camera_at(CAMERA, 1, WIDTH, HEIGHT)


def test_a_lens_that_cannot_tilt_so_far_says_so(shot: Shot) -> None:
    with_table_points(shot, "tiltPlane")
    shot.focus.set(CAMERA, max_angle_deg=2.0)
    curve = shot.focus.curve(CAMERA, [1.0])
    assert math.degrees(math.hypot(curve.tilt_rad[0], curve.swing_rad[0])) == pytest.approx(2.0, rel=1e-3)
    assert curve.limited[0]
    assert "tilts by 2 degrees at most" in shot.focus.read(CAMERA, 1).note


def test_a_plane_that_meets_the_axis_behind_the_camera_is_along_it(shot: Shot) -> None:
    for name, place in {"near": (0.0, 0.0, 0.5), "left": (-0.5, -1.3, -2.5), "right": (0.5, -1.3, -2.5)}.items():
        shot.focus.add_point(CAMERA, name, on_table(name, place))
    shot.focus.set(CAMERA, mode="tiltPlane", max_angle_deg=60.0, off_screen="keep")
    readout = shot.focus.read(CAMERA, 1)
    assert readout.focus_distance_m == math.inf
    assert "behind the camera" in readout.note


@pytest.mark.parametrize(("marked_mm", "nearest_m"), [(0.0, 0.0), (2100.0, 0.0), (5000.0, 4.9597)])
def test_a_tilted_lens_focuses_no_nearer_than_it_is_marked(shot: Shot, marked_mm: float, nearest_m: float) -> None:
    """Upright it would focus nearer than tilted, so that only the last mark is beyond it."""
    with_table_points(shot, "tiltPlane")
    with Usd.EditContext(shot.stage, shot.edits.layer):
        LensCamera(shot.stage.GetPrimAtPath(CAMERA)).lens.author(LensData(close_focus=marked_mm))
    readout, curve = shot.focus.read(CAMERA, 1), shot.focus.curve(CAMERA, [1.0])
    wanted_m = 0.7 / math.sin(math.radians(18))  # where the view axis meets the table
    assert readout.focus_distance_m == pytest.approx(nearest_m or wanted_m, rel=1e-4)
    assert ("focuses no nearer than" in readout.reason) == bool(nearest_m)
    assert bool(curve.limited[0]) == bool(nearest_m)


def test_a_surface_has_near_and_far_sharp_and_the_middle_soft(shot: Shot, renderer: FrameRenderer) -> None:
    shot.focus.add_point(CAMERA, "near", on_table("near", (0.0, 0.0, 0.5)))
    shot.focus.add_point(CAMERA, "far", on_table("far", (0.0, 0.0, -2.2)))
    shot.focus.add_point(CAMERA, "middle", on_table("middle", (0.0, 0.0, -0.3), kind="soft", blur=0.4))
    shot.focus.set(CAMERA, mode="surface")
    placed = {point.point.name: point for point in shot.focus.points(CAMERA, 1)}
    assert placed["near"].coc_mm == pytest.approx(0, abs=1e-6)
    assert placed["far"].coc_mm == pytest.approx(0, abs=1e-6)
    assert placed["middle"].coc_mm == pytest.approx(0.4, rel=1e-3)
    camera = shot.camera_at(CAMERA, 1, WIDTH, HEIGHT)
    aovs = renderer.render(shot.scene_at(1), camera, SETTINGS).aovs
    for point in placed.values():
        assert point.screen is not None
        x, y = int(point.screen[0] * WIDTH), int(point.screen[1] * HEIGHT)
        radius_mm = abs(aovs["coc"][y, x]) * 36 / WIDTH
        assert 2 * radius_mm == pytest.approx(point.coc_mm, abs=0.02)  # the pixel's middle is not the point's place


def test_half_physical_is_half_way(shot: Shot) -> None:
    shot.focus.add_point(CAMERA, "near", on_table("near", (0.0, 0.0, 0.5)))
    shot.focus.add_point(CAMERA, "far", on_table("far", (0.0, 0.0, -2.2)))
    cocs = {}
    for blend in (0.0, 0.5, 1.0):
        shot.focus.set(CAMERA, mode="surface", expressive=blend)
        cocs[blend] = shot.focus.points(CAMERA, 1)[0].coc_mm
    shot.focus.set(CAMERA, mode="points")
    assert cocs[0.0] == pytest.approx(shot.focus.points(CAMERA, 1)[0].coc_mm)
    assert cocs[0.5] == pytest.approx(cocs[0.0] / 2)
    assert cocs[1.0] == pytest.approx(0, abs=1e-9)


def test_a_point_that_is_switched_off_goes_softly(shot: Shot) -> None:
    shot.focus.add_point(CAMERA, "near", on_table("near", (0.0, 0.0, 0.5)))
    shot.focus.add_point(CAMERA, "far", on_table("far", (0.0, 0.0, -2.2)))
    for name, before in (("near", True), ("far", False)):
        shot.focus.set_key(CAMERA, name, "enabled", 1, before)
        shot.focus.set_key(CAMERA, name, "enabled", 12, not before)
    frames = list(range(1, 25))
    hard = 1 / shot.focus.curve(CAMERA, frames).focus_distance_m
    shot.focus.set(CAMERA, smoothing_s=0.5)
    soft = 1 / shot.focus.curve(CAMERA, frames).focus_distance_m
    assert soft[[0, -1]] == pytest.approx(hard[[0, -1]])
    assert np.abs(np.diff(hard)).max() == pytest.approx(abs(hard[-1] - hard[0]))
    assert np.abs(np.diff(soft)).max() < 2.1 / (0.5 * 24) * abs(hard[-1] - hard[0])
    assert (np.diff(soft) <= 1e-12).all()  # and never the other way


def test_a_frame_has_the_same_focus_whichever_is_looked_at_first(shot: Shot) -> None:
    shot.focus.add_point(CAMERA, "near", on_table("near", (0.0, 0.0, 0.5)))
    shot.focus.add_point(CAMERA, "far", on_table("far", (0.0, 0.0, -2.2)))
    for name, before in (("near", 1.0), ("far", 0.0)):
        shot.focus.set_key(CAMERA, name, "weight", 6, before)
        shot.focus.set_key(CAMERA, name, "weight", 12, 1 - before)
    shot.focus.set(CAMERA, lag_s=0.3)
    curve = shot.focus.curve(CAMERA, list(range(1, 25)))
    assert shot.focus.read(CAMERA, 14).focus_distance_m == pytest.approx(curve.focus_distance_m[13])
    assert "on the way" in shot.focus.read(CAMERA, 10).reason
    late, wanted = curve.focus_distance_m[9], curve.focus_distance_m[-1]
    assert late < wanted
    shot.focus.set(CAMERA, lag_s=0.0)
    assert (
        shot.focus.read(CAMERA, 10).focus_distance_m > late
    )  # what was worked out before an edit is not used after it


@pytest.mark.parametrize(("policy", "counts"), [("keep", True), ("ignore", False), ("fade", False)])
def test_points_behind_others_count_as_the_camera_says(shot: Shot, policy: str, counts: bool) -> None:
    wall = UsdGeom.Cube.Define(shot.stage, "/World/wall")
    wall.AddTranslateOp().Set(Gf.Vec3d(0, 0.0, -1.2))
    wall.AddScaleOp().Set(Gf.Vec3f(0.6, 0.4, 0.05))
    shot.focus.add_point(CAMERA, "near", on_table("near", (0.0, 0.0, 0.5)))
    shot.focus.add_point(CAMERA, "far", on_table("far", (0.0, 0.0, -1.7)))
    shot.focus.set(CAMERA, occluded=policy)
    states = {point.point.name: point.state for point in shot.focus.points(CAMERA, 1)}
    assert states == {"near": "used", "far": "used" if counts else "hidden"}


def test_a_split_diopter_has_its_side_focused_elsewhere(shot: Shot, renderer: FrameRenderer) -> None:
    camera = LensCamera(shot.stage.GetPrimAtPath(CAMERA))
    with Usd.EditContext(shot.stage, shot.edits.layer):
        half = SplitDiopter(count=1, offset1=0.0, width1=0.1, focus_distance1=1.2)
        camera.lens.author(LensData(split_diopter=half))
    picture = shot.camera_at(CAMERA, 1, WIDTH, HEIGHT)
    sharp = renderer.render(shot.scene_at(1), picture, SETTINGS).aovs["focus_depth"]
    assert sharp[:, : WIDTH // 2 - 20] == pytest.approx(1.8, rel=1e-4)
    assert sharp[:, WIDTH // 2 + 20 :] == pytest.approx(1.2, rel=1e-4)


def test_drawn_curvature_of_field_bends_the_plane(shot: Shot) -> None:
    flat = shot.camera_at(CAMERA, 1, WIDTH, HEIGHT)
    assert flat.focal_surface is None
    shot.focus.set(CAMERA, field_offsets=((0.5, 0.5, 0.0), (0.0, 0.5, 0.5), (1.0, 0.5, 0.5)))
    bent = shot.camera_at(CAMERA, 1, WIDTH, HEIGHT).focal_surface
    assert bent is not None
    assert bent.bends is not None
    v_mm = 1 / (1 / 40 - 1 / 1800)  # film that comes half a millimetre nearer is focused farther away
    assert bent.bends.values[1, 0] == pytest.approx(1000 * (1 / v_mm - 1 / (v_mm - 0.5)), rel=1e-4)
    shot.focus.set(CAMERA, expressive=0.0)
    physical = shot.camera_at(CAMERA, 1, WIDTH, HEIGHT).focal_surface
    assert physical is not None
    assert physical.bends is not None
    assert physical.bends.values == pytest.approx(0, abs=1e-12)


def test_a_hand_follows_each_point_of_a_surface_too(shot: Shot) -> None:
    """A point that moves away is followed late, and one that rests is held."""
    ball = UsdGeom.Sphere.Define(shot.stage, "/World/runner")
    moves = ball.AddTranslateOp()
    moves.Set(Gf.Vec3d(0.1, 0.04, 0.3), 1)
    moves.Set(Gf.Vec3d(0.1, 0.04, -2.0), 12)
    shot.focus.add_point(CAMERA, "still", on_table("still", (-0.3, 0.0, -1.0)))
    shot.focus.add_point(CAMERA, "runner", FocusPoint("runner", target=("/World/runner",)))
    shot.focus.set(CAMERA, mode="surface")
    assert [point.coc_mm for point in shot.focus.points(CAMERA, 8)] == pytest.approx([0, 0], abs=1e-9)
    shot.focus.set(CAMERA, lag_s=0.25)
    still, runner = (point.coc_mm for point in shot.focus.points(CAMERA, 8))
    assert still == pytest.approx(0, abs=1e-9)
    assert runner > 0.05
    assert shot.focus.points(CAMERA, 24)[1].coc_mm < 0.3 * runner


def test_a_readout_is_of_one_plane(shot: Shot) -> None:
    """Where a surface bends from it, near and far limit still enclose the distance that is told; what bends is told by place."""
    shot.focus.add_point(CAMERA, "near", on_table("near", (0.0, 0.0, 0.5)))
    shot.focus.add_point(CAMERA, "far", on_table("far", (0.0, 0.0, -2.2)))
    shot.focus.set(CAMERA, mode="surface")
    readout = shot.focus.read(CAMERA, 1)
    assert readout.near_m < readout.focus_distance_m < readout.far_m


def test_points_set_the_stop_that_holds_them(shot: Shot) -> None:
    """A focus puller's split: both ends of the row at the limit of the circle of confusion, and no wider an f-number does it."""
    shot.focus.add_point(CAMERA, "near", on_table("near", (0.0, 0.0, 0.5)))
    shot.focus.add_point(CAMERA, "far", on_table("far", (0.0, 0.0, -2.2)))
    shot.focus.set(CAMERA, solve_stop=True, circle_of_confusion_mm=0.03)
    cocs = [point.coc_mm for point in shot.focus.points(CAMERA, 1)]
    assert cocs == pytest.approx([0.03, 0.03], rel=1e-6)
    readout = shot.focus.read(CAMERA, 1)
    near, far = (point.depth_m for point in shot.focus.points(CAMERA, 1))
    assert readout.f_stop == pytest.approx(40**2 / 1000 * (1 / near - 1 / far) / (2 * 0.03), rel=1e-6)
    assert (readout.near_m, readout.far_m) == pytest.approx((near, far), rel=1e-6)
    with Usd.EditContext(shot.stage, shot.edits.layer):
        LensCamera(shot.stage.GetPrimAtPath(CAMERA)).lens.author(LensData(f_stop_range=(1.4, 8.0)))
    assert shot.focus.read(CAMERA, 1).f_stop == 8.0
    assert shot.focus.curve(CAMERA, [1.0]).limited[0]
