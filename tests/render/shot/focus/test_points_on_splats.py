"""Focus points on Gaussian splats, which have no faces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, Vt

from render.errors import SettingsError
from render.shot import Shot
from tests.render.kits.moving_shots import write_moving
from usd_schemas import FocusPoint


def test_a_point_follows_the_origin_of_splats_and_not_a_face(tmp_path: Path) -> None:
    stage = Usd.Stage.Open(str(write_moving(tmp_path / "shot.usda")))
    cloud = stage.DefinePrim("/cloud", "ParticleField3DGaussianSplat")
    cloud.GetAttribute("positions").Set(Vt.Vec3fArray([Gf.Vec3f(0, 0, -2)]))
    stage.Save()
    shot = Shot.open(tmp_path / "shot.usda")
    with pytest.raises(SettingsError, match="which have no faces") as caught:
        shot.focus.add_point("/cam", "eye", FocusPoint(name="eye", target=("/cloud",), face=0))
    assert caught.value.code == "on_splats"
    point = FocusPoint(name="eye", target=("/cloud",), face=-1, offset=(0.0, 0.0, -3.0))
    assert shot.focus.add_point("/cam", "eye", point).face == -1
    assert np.isclose(shot.focus.read("/cam", 1.0).focus_distance_m, 3.0, atol=1e-3)
