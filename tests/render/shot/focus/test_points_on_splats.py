"""Focus points on Gaussian splats: a click gives the splat at which they hide half, and a point follows it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render.errors import NotFoundError, StageError
from render.frame import FrameRenderer, Pick
from render.shot import Shot
from render.stage import anchor_position
from tests.render.kits.moving_shots import write_moving
from tests.render.kits.stages import instancer, new_stage
from usd_schemas import FocusPoint

WIDTH, HEIGHT = 240, 120
PLACES = [(0.5, 0.25, -5.0), (0.0, 0.0, -1.0), (0.0, 0.1, -2.0), (0.0, -0.1, -3.0)]


def add_cloud(stage: Usd.Stage, path: str = "/set/cloud") -> Usd.Prim:
    """A splat beside, one that is not drawn, and two behind each other of which the first hides more than half."""
    cloud = stage.DefinePrim(path, "ParticleField3DGaussianSplat")
    cloud.GetAttribute("positions").Set(Vt.Vec3fArray([Gf.Vec3f(*place) for place in PLACES]))
    cloud.GetAttribute("scales").Set(Vt.Vec3fArray([Gf.Vec3f(0.3)] * 4))
    cloud.GetAttribute("opacities").Set(Vt.FloatArray([0.9, 0.0, 0.8, 0.9]))
    return cloud


def click(renderer: FrameRenderer, shot: Shot, time: float = 1.0) -> Pick:
    camera = shot.camera_at("/cam", time, WIDTH, HEIGHT)
    picked = renderer.pick(shot.scene_at(time, "/cam"), camera, WIDTH, HEIGHT, WIDTH / 2, HEIGHT / 2)
    assert picked is not None
    return picked


@pytest.mark.gl
def test_a_click_on_splats_focuses_on_them(renderer: FrameRenderer, tmp_path: Path) -> None:
    """And the point follows what moves above the cloud."""
    stage = Usd.Stage.Open(str(write_moving(tmp_path / "shot.usda")))
    stage.RemovePrim("/card")
    moves = UsdGeom.Xform.Define(stage, "/set").AddTranslateOp()
    add_cloud(stage)
    for frame, z in ((1, 0.0), (3, -2.0)):
        moves.Set(Gf.Vec3d(0, 0, z), frame)
    stage.Save()
    shot = Shot.open(tmp_path / "shot.usda")
    picked = click(renderer, shot)
    assert (picked.prim_path, picked.face, picked.instance) == ("/set/cloud", 2, -1)
    assert shot.focus.add_point("/cam", "eye", picked).face == 2
    assert shot.focus.read("/cam", 1.0).focus_distance_m == pytest.approx(picked.depth_m, rel=1e-6)
    assert shot.focus.read("/cam", 3.0).focus_distance_m == pytest.approx(4.0, rel=1e-6)


@pytest.mark.gl
def test_a_click_on_an_instance_follows_that_instance(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = Usd.Stage.Open(str(write_moving(tmp_path / "shot.usda")))
    stage.RemovePrim("/card")
    add_cloud(stage, "/many/proto/cloud")
    many = instancer(stage, "/many", ["/many/proto"], [0, 0])
    many.CreatePositionsAttr([Gf.Vec3f(9, 0, 0), Gf.Vec3f(0, 0, -1)])
    many.CreateIdsAttr([40, 70])
    stage.Save()
    shot = Shot.open(tmp_path / "shot.usda")
    picked = click(renderer, shot)
    assert (picked.prim_path, picked.prototype_path) == ("/many", "/many/proto/cloud")
    assert (picked.face, picked.instance) == (2, 70)
    shot.focus.add_point("/cam", "eye", picked)
    assert shot.focus.read("/cam", 1.0).focus_distance_m == pytest.approx(3.0, rel=1e-6)


def test_a_point_is_in_the_middle_of_its_splat_at_each_time() -> None:
    stage = new_stage()
    positions = add_cloud(stage, "/cloud").GetAttribute("positions")
    positions.Set(Vt.Vec3fArray([Gf.Vec3f(*place) for place in PLACES]), 0)
    positions.Set(Vt.Vec3fArray([Gf.Vec3f(1, 2, 3)] * 4), 10)
    point = FocusPoint("p", target=("/cloud",), face=3, offset=(0.0, 0.5, 0.0))
    np.testing.assert_allclose(anchor_position(stage, point, 0), [0, 0.4, -3], rtol=1e-6)
    np.testing.assert_allclose(anchor_position(stage, point, 10), [1, 2.5, 3], rtol=1e-6)
    np.testing.assert_allclose(anchor_position(stage, replace(point, face=-1), 10), [0, 0.5, 0])


def test_splats_that_are_not_there_are_an_error() -> None:
    stage = new_stage()
    cloud = add_cloud(stage, "/cloud")
    point = FocusPoint("p", target=("/cloud",), face=4)
    with pytest.raises(NotFoundError, match="on splat 4, which /cloud does not have"):
        anchor_position(stage, point, 0)
    cloud.GetAttribute("positions").Set(Vt.Vec3fArray([Gf.Vec3f(float("nan"))] * 5))
    with pytest.raises(StageError, match="not finite"):
        anchor_position(stage, point, 0)
    cloud.GetAttribute("positions").Clear()
    with pytest.raises(StageError, match="no positions"):
        anchor_position(stage, point, 0)
