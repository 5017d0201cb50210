"""Clip planes of cameras: what lies behind one is not drawn, in any engine, and hides nothing."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render.errors import CameraError
from render.frame import FrameRenderer
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.shot import Shot
from render.shot.focus.visibility import visible_shares
from render.stage.camera.cameras import read_camera
from tests.render.kits.stages import add_mesh, new_stage, read

SIZE = (64, 48)


def walls(*depths: float, metres_per_unit: float = 1.0) -> Usd.Stage:
    """A stage with large squares across the view axis of a camera ``/cam`` at the origin, at depths in stage units."""
    stage = new_stage(metres_per_unit)
    for i, depth in enumerate(depths):
        size = 5 * depth
        add_mesh(stage, f"/wall{i}", [(x * size, y * size, -depth) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 1e6))
    return stage


def cut(stage: Usd.Stage, *planes: tuple[float, float, float, float]) -> Camera:
    """The camera of a stage with clip planes."""
    attribute = UsdGeom.Camera(stage.GetPrimAtPath("/cam")).CreateClippingPlanesAttr()
    attribute.Set(Vt.Vec4fArray([Gf.Vec4f(*plane) for plane in planes]))
    return read_camera(stage, "/cam", 0.0)


def picture(renderer: FrameRenderer, stage: Usd.Stage, camera: Camera, engine: str = "pinhole") -> FloatArray:
    settings = FrameSettings(*SIZE, engine=engine, rays=4, supersample=1, shading="unlit", aovs=("color", "depth"))
    frame = renderer.render(read(stage), camera, settings)
    return np.concatenate([frame.color, frame.aovs["depth"][..., None]], axis=2)


def test_planes_are_in_camera_space_and_metres() -> None:
    camera = cut(walls(4, metres_per_unit=0.01), (1, 0, 0, 0.5), (0, 0, -1, -300))
    np.testing.assert_allclose(camera.clip_planes, [(1, 0, 0, 0.005), (0, 0, -1, -3)], rtol=1e-6)


def test_planes_follow_the_scale_of_the_prim() -> None:
    stage = walls(4)
    UsdGeom.XformCommonAPI(stage.GetPrimAtPath("/cam")).SetScale(Gf.Vec3f(2, 2, 2))
    np.testing.assert_allclose(cut(stage, (0, 0, -1, -3)).clip_planes, [(0, 0, -1, -6)], rtol=1e-6)


@pytest.mark.gl
@pytest.mark.parametrize("engine", ["pinhole", "lens", "accumulation", "flag"])
def test_what_a_plane_cuts_off_is_not_drawn(renderer: FrameRenderer, engine: str) -> None:
    stage = walls(4)
    alpha = picture(renderer, stage, cut(stage, (1, 0, 0, 0)), engine)[..., 3]
    assert (alpha[:, :31] == 0).all()
    assert (alpha[:, 33:] == 1).all()


@pytest.mark.gl
def test_what_was_hidden_by_what_is_cut_off_is_seen(renderer: FrameRenderer) -> None:
    stage = walls(2, 4, 8)
    farther_than = cut(stage, (0, 0, -1, -3))
    np.testing.assert_allclose(picture(renderer, stage, farther_than)[..., 4], 4, rtol=1e-6)
    nearer_than = cut(stage, (0, 0, -1, -3), (0, 0, 1, 3.5))
    assert np.isinf(picture(renderer, stage, nearer_than)[..., 4]).all()


@pytest.mark.gl
def test_a_plane_cuts_a_closed_surface_open(renderer: FrameRenderer) -> None:
    """A ball without its nearer half shows the inside of the farther one."""
    stage = walls()
    UsdGeom.Xformable(UsdGeom.Sphere.Define(stage, "/ball")).AddTranslateOp().Set(Gf.Vec3d(0, 0, -6))
    depth = picture(renderer, stage, cut(stage, (0, 0, -1, -6)))[24, 32, 4]
    assert depth == pytest.approx(7, abs=0.01)


@pytest.mark.gl
def test_every_plane_up_to_the_eighth_cuts(renderer: FrameRenderer) -> None:
    stage = walls(4)
    turns = np.arange(8) * np.pi / 4
    octagon = cut(stage, *((float(np.cos(turn)), float(np.sin(turn)), 0.0, 0.5) for turn in turns))
    covered = picture(renderer, stage, octagon)[..., 3].sum()
    pixels = (50 / 20.955 * SIZE[0] / 4) * (50 / 15.2908 * SIZE[1] / 4)  # in a square metre of the wall
    assert covered == pytest.approx(8 * np.tan(np.pi / 8) * 0.25 * pixels, rel=0.02)


def test_cut_off_surfaces_hide_no_focus_point() -> None:
    stage = walls(2, 4)
    point = np.array([[0.0, 0.0, -4.0]])
    assert visible_shares(read(stage), cut(stage), point).tolist() == [0]
    assert visible_shares(read(stage), cut(stage, (0, 0, -1, -3)), point).tolist() == [1]
    assert visible_shares(read(stage), cut(stage, (0, 0, -1, -5)), point).tolist() == [0]


def test_more_planes_than_eight_are_a_finding(tmp_path: object) -> None:
    stage = walls(4)
    camera = cut(stage, *[(1.0, 0.0, 0.0, 0.1 * i) for i in range(9)])
    assert len(camera.clip_planes) == 8
    stage.Export(f"{tmp_path}/walls.usda")
    (finding,) = Shot.open(f"{tmp_path}/walls.usda").findings()
    assert finding.path == "/cam.clippingPlanes"
    assert "9" in finding.message


def test_planes_that_are_no_numbers_are_an_error() -> None:
    stage = walls(4)
    with pytest.raises(CameraError, match="clippingPlanes of camera /cam must be four finite numbers"):
        cut(stage, (float("nan"), 0, 0, 1))
