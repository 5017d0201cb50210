"""Splats that move while the shutter is open."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render.film import Grade
from render.frame import FrameRenderer
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
