"""A zoom that is pulled in a shot: each frame's lens, its readouts, and what is found of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import UsdGeom

from render.optics.focus_law import focus_law
from render.optics.prescription.mounting import breathing_ratio, mount_lens
from render.optics.view import PinholeView
from render.shot import Shot
from render.shot.lens.lens_choice import choose_lens
from tests.render.kits.focus_shot import CAMERA, write_shot
from usd_schemas.units import tenths_from_mm


def zoom_shot(folder: Path, *, wide_mm: float = 75.0, long_mm: float = 190.0) -> Shot:
    """Shot whose zoom is pulled from frame 1 to frame 24, and a focus of 6 m."""
    shot = Shot.open(write_shot(folder / "shot.usda"))
    camera = UsdGeom.Camera(shot.stage.GetPrimAtPath(CAMERA))
    for frame, mm in ((1, wide_mm), (24, long_mm)):
        camera.GetFocalLengthAttr().Set(tenths_from_mm(mm, shot.stage), frame)
    camera.GetFocusDistanceAttr().Set(6.0)
    shot.camera.mount_lens(CAMERA, choose_lens("tele_zoom_70_200"))
    return shot


def test_each_frame_has_the_zoom_at_its_focal_length(tmp_path: Path) -> None:
    shot = zoom_shot(tmp_path)
    for frame, wanted_mm in ((1, 75.0), (12.5, 132.5), (24, 190.0)):
        camera = shot.camera_at(CAMERA, frame, 64, 36)
        assert camera.focal_length_mm == pytest.approx(wanted_mm, rel=1e-5)
        far = mount_lens(replace(camera, focus_distance_m=np.inf, f_stop=11.0))
        assert far.first.focal_length_mm == pytest.approx(
            wanted_mm, rel=2e-3
        )  # by its best focus, not the paraxial one
        assert far.prescription.surfaces[0].radius_mm == pytest.approx(311.919)  # the same glass in every frame


def test_readouts_follow_the_zoom(tmp_path: Path) -> None:
    shot = zoom_shot(tmp_path)
    short, long = (shot.focus.read(CAMERA, frame) for frame in (1, 24))
    # Depth of field falls with the square of the focal length.
    depths = [readout.far_m - readout.near_m for readout in (short, long)]
    assert depths[0] / depths[1] == pytest.approx((190 / 75) ** 2, rel=0.15)
    assert short.hyperfocal_m < long.hyperfocal_m


def test_the_focus_law_is_that_of_the_zoom_where_it_stands(tmp_path: Path) -> None:
    shot = zoom_shot(tmp_path)
    for frame in (1, 12, 24):
        camera = replace(shot.camera_at(CAMERA, frame, 64, 36), breathing=True)
        law, lens = focus_law(camera), mount_lens(camera)
        w = 1 / camera.focus_distance_m
        slope = np.interp(w, np.linspace(0, law.near_w[0], law.slopes_at_f1_mm_m.shape[1]), law.slopes_at_f1_mm_m[0])
        exact = lens.image_scale_mm * 2 * lens.entrance_pupil_radius_mm * lens.f_stop / 1000
        assert slope == pytest.approx(exact, rel=0.01)


def test_the_picture_breathes_by_the_group_that_focuses(tmp_path: Path) -> None:
    shot = zoom_shot(tmp_path)
    camera = replace(shot.camera_at(CAMERA, 12, 640, 360), breathing=True)
    far = replace(camera, focus_distance_m=np.inf)
    views = [PinholeView.from_camera(each, 640, 360).fx for each in (camera, far)]
    assert views[0] / views[1] == pytest.approx(breathing_ratio(camera))
    assert breathing_ratio(camera) > 1.02


def test_a_zoom_beyond_its_range_is_found_once(tmp_path: Path) -> None:
    shot = zoom_shot(tmp_path, wide_mm=50.0)
    for frame in (1, 2, 3, 24):
        camera = shot.camera_at(CAMERA, frame, 64, 36)
        assert mount_lens(camera).image_scale_mm > 0
    [found] = [finding for finding in shot.findings() if finding.code == "zoom_range"]
    assert "zooms from 72.09 to 194 mm: the nearer end of the range is drawn, scaled" in found.message
    assert not [each for each in zoom_shot(tmp_path / "within").findings() if each.code == "zoom_range"]
