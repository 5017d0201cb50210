"""Splats that move while the shutter is open."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render.film import Grade
from render.frame import FrameRenderer
from render.lab.reference.metrics import psnr_db
from render.model.arrays import FloatArray
from render.pictures.picture import make_picture
from render.shot import Shot
from tests.render.kits.moving_shots import STILL, key_move, write_moving

pytestmark = pytest.mark.gl


def test_moving_splats_leave_a_trail_by_velocities_too(renderer: FrameRenderer, tmp_path: Path) -> None:
    """They are drawn moment by moment, whatever is asked for: half a frame is 50 pixels."""
    stage = Usd.Stage.Open(str(write_moving(tmp_path / "shot.usda")))
    stage.RemovePrim("/card")
    cloud = stage.DefinePrim("/cloud", "ParticleField3DGaussianSplat")
    cloud.GetAttribute("positions").Set(Vt.Vec3fArray([Gf.Vec3f(0, 0, -2)]))
    cloud.GetAttribute("scales").Set(Vt.Vec3fArray([Gf.Vec3f(0.02)]))
    key_move(UsdGeom.Xformable(cloud).AddTranslateOp(), Gf.Vec3d(-0.25, 0, 0), Gf.Vec3d(0.25, 0, 0))
    stage.Save()
    shot = Shot.open(tmp_path / "shot.usda")
    settings = replace(STILL, motion=16)
    trails = [
        make_picture(renderer, shot, "/cam", 1.0, replace(settings, motion_by=by), Grade()).frame.color[..., 3]
        for by in ("moments", "velocities")
    ]
    np.testing.assert_array_equal(*trails)
    lit = np.flatnonzero(trails[0].max(axis=0) > 0.03)
    assert lit[-1] - lit[0] == pytest.approx(50, abs=10)


def write_set(path: Path) -> Usd.Stage:
    """A shot of 200 splats at random, of no colour but grey, below an Xform."""
    stage = Usd.Stage.Open(str(write_moving(path)))
    stage.RemovePrim("/card")
    UsdGeom.Xform.Define(stage, "/set").AddTranslateOp().Set(Gf.Vec3d(0, 0, -2))
    random = np.random.default_rng(5)
    cloud = stage.DefinePrim("/set/cloud", "ParticleField3DGaussianSplat")
    places = random.uniform((-0.6, -0.4, -0.6), (0.6, 0.4, 0.6), (200, 3)).astype(np.float32)
    cloud.GetAttribute("positions").Set(Vt.Vec3fArray.FromNumpy(places))
    cloud.GetAttribute("scales").Set(Vt.Vec3fArray([Gf.Vec3f(0.02)] * 200))
    cloud.GetAttribute("opacities").Set(Vt.FloatArray([0.8] * 200))
    return stage


def picture(renderer: FrameRenderer, path: Path, time: float = 1.0, **settings: object) -> FloatArray:
    """Light of a frame, or of one moment of it."""
    changed = replace(STILL, rays=8, supersample=2, **settings)  # type: ignore[arg-type]
    return make_picture(renderer, Shot.open(path), "/cam", time, changed, Grade()).frame.color


def test_what_moves_above_a_cloud_blurs_it(renderer: FrameRenderer, tmp_path: Path) -> None:
    """The mean of still pictures of the moments: of a turn and a stretch above the cloud, and of splats that grow."""
    stage = write_set(tmp_path / "shot.usda")
    above = UsdGeom.Xformable(stage.GetPrimAtPath("/set"))
    key_move(above.AddRotateYOp(), 0.0, 30.0)
    key_move(above.AddScaleOp(), Gf.Vec3f(1), Gf.Vec3f(1.4, 0.7, 1))
    scales = stage.GetPrimAtPath("/set/cloud").GetAttribute("scales")
    for time, size in ((1.0, 0.01), (1.5, 0.04)):
        scales.Set(Vt.Vec3fArray([Gf.Vec3f(size)] * 200), time)
    stage.Save()
    moved = picture(renderer, tmp_path / "shot.usda", motion=4)
    moments = [picture(renderer, tmp_path / "shot.usda", 1 + 0.5 * (i + 0.5) / 4) for i in range(4)]
    assert psnr_db(moved, np.mean(moments, axis=0)) > 45
    assert psnr_db(moved, moments[0]) < 25


def test_a_camera_that_moves_past_still_splats_blurs_them(renderer: FrameRenderer, tmp_path: Path) -> None:
    """By velocities as by moments: near splats more than far ones."""
    stage = write_set(tmp_path / "shot.usda")
    key_move(UsdGeom.Xformable(stage.GetPrimAtPath("/cam")).AddTranslateOp(), Gf.Vec3d(0), Gf.Vec3d(0.1, 0, 0))
    stage.Save()
    by_moments, swept = (
        picture(renderer, tmp_path / "shot.usda", motion=8, motion_by=by) for by in ("moments", "velocities")
    )
    assert psnr_db(swept, by_moments) > 45
    assert psnr_db(swept, picture(renderer, tmp_path / "shot.usda", 1.25)) < 30
