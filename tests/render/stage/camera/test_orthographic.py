"""Orthographic cameras: what they show does not shrink with its distance."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

from render.frame import FrameRenderer
from render.model.arrays import FloatArray
from render.model.frame_settings import FrameSettings
from render.optics.view import PinholeView
from render.shot import Shot
from render.stage import read_camera
from tests.render.kits.stages import add_mesh, new_stage, read

WIDTH, HEIGHT = 200, 100


def ortho_stage(metres_per_unit: float = 1.0, up: str = "Y", **attributes: object) -> Usd.Stage:
    """Squares of two units at depths 3 and 30, side by side, before an orthographic camera that sees 10 by 5 units."""
    stage = new_stage(metres_per_unit, up)
    for x, depth in ((-3, 3), (1, 30)):
        add_mesh(stage, f"/at{depth}", [(x, -1, -depth), (x + 2, -1, -depth), (x + 2, 1, -depth), (x, 1, -depth)])
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.CreateProjectionAttr("orthographic")
    camera.CreateHorizontalApertureAttr(100)
    camera.CreateVerticalApertureAttr(50)
    camera.CreateClippingRangeAttr(Gf.Vec2f(1, 100))
    for name, value in attributes.items():
        camera.GetPrim().GetAttribute(name).Set(value)
    return stage


def picture(renderer: FrameRenderer, stage: Usd.Stage, engine: str = "pinhole") -> FloatArray:
    """Coverage."""
    settings = FrameSettings(WIDTH, HEIGHT, engine=engine, rays=1, supersample=1, shading="unlit", adaptive=False)
    color = renderer.render(read(stage), read_camera(stage, "/cam", 0, aspect=WIDTH / HEIGHT), settings).color
    return color[..., 3]


@pytest.mark.parametrize(("unit", "up"), [(1.0, "Y"), (0.01, "Y"), (0.01, "Z")])
def test_points_stay_in_place_at_every_depth(unit: float, up: str) -> None:
    stage = ortho_stage(unit, up)
    view = PinholeView.from_camera(read_camera(stage, "/cam", 0), WIDTH, HEIGHT)
    world = np.eye(4) if up == "Y" else np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    points = np.array([(x, y, -depth, 1) for x in (-5, 0, 2.5) for y in (-2.5, 1) for depth in (3, 12, 30)]) @ world.T
    pixels, _ = view.project(points[:, :3] * unit)
    expected = [(100 + 20 * x, 50 - 20 * y) for x in (-5, 0, 2.5) for y in (-2.5, 1) for _ in range(3)]
    np.testing.assert_allclose(pixels, expected, atol=0.06)


@pytest.mark.gl
@pytest.mark.parametrize("engine", ["pinhole", "lens", "accumulation"])
def test_near_and_far_things_have_one_size(renderer: FrameRenderer, engine: str) -> None:
    alpha = picture(renderer, ortho_stage(), engine)
    for first in (40, 120):
        assert (alpha[32:68, first + 2 : first + 38] == 1).all()
    assert alpha.sum() == pytest.approx(2 * 40 * 40, rel=0.06)


@pytest.mark.gl
def test_offsets_clipping_and_clip_planes_hold(renderer: FrameRenderer) -> None:
    moved = picture(renderer, ortho_stage(horizontalApertureOffset=10.0))
    assert (moved[32:68, 22:58] == 1).all()
    near_cut = picture(renderer, ortho_stage(clippingRange=Gf.Vec2f(10, 100)))
    assert near_cut[:, :100].max() == 0
    assert near_cut[50, 140] == 1
    far_cut = picture(renderer, ortho_stage(clippingRange=Gf.Vec2f(1, 20)))
    assert far_cut[:, 100:].max() == 0
    assert far_cut[50, 60] == 1
    behind = picture(renderer, ortho_stage(clippingRange=Gf.Vec2f(-50, 100)))
    assert behind[50, 60] == behind[50, 140] == 1
    planes = picture(renderer, ortho_stage(clippingPlanes=[Gf.Vec4f(0, 0, -1, -10)]))
    assert (planes[50, 60], planes[50, 140]) == (0, 1)


def test_all_is_sharp_and_said_so(tmp_path: object) -> None:
    stage = ortho_stage(fStop=1.4, focusDistance=3.0)
    assert read_camera(stage, "/cam", 0).f_stop == 0
    stage.Export(f"{tmp_path}/ortho.usda")
    assert "orthographic" in {finding.code for finding in Shot.open(f"{tmp_path}/ortho.usda").findings()}


def test_a_stage_with_nothing_in_view_has_a_camera() -> None:
    stage = ortho_stage()
    for depth in (3, 30):
        stage.RemovePrim(f"/at{depth}")
    for clipping in (Gf.Vec2f(1, 100), Gf.Vec2f(1, float("inf"))):
        UsdGeom.Camera(stage.GetPrimAtPath("/cam")).GetClippingRangeAttr().Set(clipping)
        assert np.isfinite(read_camera(stage, "/cam", 0).focal_length_mm)
