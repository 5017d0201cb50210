"""Focus of orthographic cameras: points, readouts and curves count depths from the camera prim, and a cone blurs evenly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from render.errors import SettingsError
from render.frame import FrameRenderer
from render.model.frame_settings import FrameSettings
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, FAR, NEAR, Units, write_shot
from usd_schemas import FocusPoint, library_body

CENTRE = {"face": 0, "fan_triangle": 0, "barycentric": (0.5, 0.0, 0.5)}
WIDTH_M, HEIGHT_M, F_STOP, FOCUS_M = 4.0, 2.25, 2.0, 3.0
METRES = Units()
LIMIT_MM = 1000 * np.hypot(WIDTH_M, HEIGHT_M) / 1500


def ortho_shot(folder: Path, units: Units = METRES) -> Shot:
    """The shot of two cards, its camera orthographic, 4 m wide, at f/2 and focused at 3 m."""
    path = write_shot(folder / "shot.usda", units)
    stage = Usd.Stage.Open(str(path))
    camera = UsdGeom.Camera(stage.GetPrimAtPath(CAMERA))
    camera.CreateProjectionAttr("orthographic")
    camera.GetHorizontalApertureAttr().Set(10 * WIDTH_M / units.metres)
    camera.GetVerticalApertureAttr().Set(10 * HEIGHT_M / units.metres)
    stage.Save()
    return Shot.open(path)


def far_depth_m(frame: float) -> float:
    return 10 - 2 * (frame - 1) / 23


@pytest.mark.parametrize("units", [METRES, Units(0.01, "Z", 48.0)])
def test_the_sharp_depths_are_those_of_a_cone(tmp_path: Path, units: Units) -> None:
    shot = ortho_shot(tmp_path, units)
    readout = shot.focus.read(CAMERA, 1)
    assert readout.focus_distance_m == pytest.approx(FOCUS_M, abs=1e-6)
    assert (readout.f_stop, readout.focal_length_mm) == pytest.approx((F_STOP, 50.0))
    assert readout.coc_limit_mm == pytest.approx(LIMIT_MM, rel=0.1)
    reach_m = F_STOP * readout.coc_limit_mm / 1000
    assert (readout.near_m, readout.far_m) == pytest.approx((FOCUS_M - reach_m, FOCUS_M + reach_m), rel=1e-4)
    assert readout.hyperfocal_m == np.inf
    for depth_m in (1.0, FOCUS_M, 10.0):
        at = shot.focus.read_at(CAMERA, 1, (0.3, 0.6), depth_m)
        assert at.coc_mm == pytest.approx(1000 * abs(depth_m - FOCUS_M) / F_STOP, rel=2e-3, abs=1e-3)
        assert (at.depth_m, at.focus_distance_m) == pytest.approx((depth_m, FOCUS_M))


def test_points_focus_an_orthographic_camera_by_depth(tmp_path: Path) -> None:
    shot = ortho_shot(tmp_path)
    shot.focus.add_point(CAMERA, "far", FocusPoint("far", target=(FAR,), **CENTRE))
    for frame in (1, 8, 24):
        assert shot.focus.read(CAMERA, frame).focus_distance_m == pytest.approx(far_depth_m(frame), rel=1e-5)
        (placed,) = shot.focus.points(CAMERA, frame)
        assert placed.depth_m == pytest.approx(far_depth_m(frame), rel=1e-5)
        assert placed.coc_mm == pytest.approx(0, abs=1e-2)
        assert placed.screen == pytest.approx((0.5 - 1 / WIDTH_M, 0.5), abs=1e-3)
    curve = shot.focus.curve(CAMERA, [1, 8, 24])
    assert curve.focus_distance_m == pytest.approx([far_depth_m(frame) for frame in (1, 8, 24)], rel=1e-5)
    assert curve.points[0].depth_m == pytest.approx(curve.focus_distance_m, rel=1e-5)


def test_two_points_share_the_depth_between_them(tmp_path: Path) -> None:
    shot = ortho_shot(tmp_path)
    for name, card in (("near", NEAR), ("far", FAR)):
        shot.focus.add_point(CAMERA, name, FocusPoint(name, target=(card,), **CENTRE))
    assert shot.focus.read(CAMERA, 1).focus_distance_m == pytest.approx((4 + 10) / 2, rel=1e-3)


def test_smoothed_focus_follows_what_moves(tmp_path: Path) -> None:
    shot = ortho_shot(tmp_path)
    shot.focus.add_point(CAMERA, "far", FocusPoint("far", target=(FAR,), **CENTRE))
    shot.focus.set(CAMERA, lag_s=0.05)
    lagging = shot.focus.curve(CAMERA, list(range(1, 25))).focus_distance_m
    exact = np.array([far_depth_m(frame) for frame in range(1, 25)])
    a_frame_m = 2 / 23
    assert (lagging >= exact - 1e-6).all()
    assert lagging[-1] - exact[-1] == pytest.approx(0.05 * 24 * a_frame_m, rel=0.3)
    assert (np.diff(lagging) < 1e-9).all()


def test_a_tilted_lens_tilts_the_plane_by_its_sine(tmp_path: Path) -> None:
    shot = ortho_shot(tmp_path)
    shot.focus.set(CAMERA, tilt_deg=-20.0, mode="tiltPlane", driven_by_points=False)
    below, above = (shot.focus.read_at(CAMERA, 1, (0.5, y), FOCUS_M).focus_distance_m for y in (1.0, 0.0))
    assert above - below == pytest.approx(np.sin(np.radians(20)) * HEIGHT_M, rel=2e-3)


@pytest.mark.gl
def test_a_click_gives_the_depth_from_the_camera(tmp_path: Path, renderer: FrameRenderer) -> None:
    shot = ortho_shot(tmp_path)
    camera = shot.camera_at(CAMERA, 1, 160, 90)
    pick = renderer.pick(shot.scene_at(1), camera, 160, 90, 80, 45)
    assert pick is not None
    assert pick.depth_m == pytest.approx(4.0, rel=1e-5)
    frame = renderer.render(
        shot.scene_at(1),
        camera,
        FrameSettings(160, 90, engine="lens", rays=8, aovs=("depth", "coc", "defocus", "Peye")),
    )
    assert frame.aovs["depth"][45, 80] == pytest.approx(4.0, rel=1e-3)
    assert frame.aovs["Peye"][45, 80] == pytest.approx((0.0125, -0.0125, -4.0), abs=1e-3)
    assert frame.aovs["coc"][45, 80] == pytest.approx((4 - FOCUS_M) / (2 * F_STOP) * 160 / WIDTH_M, rel=2e-3)
    assert frame.aovs["defocus"][45, 80] == pytest.approx(1 / 4 - 1 / FOCUS_M, abs=1e-4)


def test_no_body_fits_an_orthographic_camera(tmp_path: Path) -> None:
    shot = ortho_shot(tmp_path)
    with pytest.raises(SettingsError, match="is orthographic: its film is as large as what it sees"):
        shot.camera.mount_body(CAMERA, library_body("super16"))
    assert shot.camera_at(CAMERA, 1, 160, 90).horizontal_aperture_mm == pytest.approx(1000 * WIDTH_M)
