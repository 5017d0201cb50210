"""Orthographic cameras: what they show does not shrink with its distance."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdLux

from render.film import Grade
from render.frame import FrameRenderer
from render.model.arrays import FloatArray
from render.model.frame_settings import FrameSettings
from render.optics.view import PinholeView
from render.pictures.picture import make_picture
from render.shot import Shot
from render.stage import read_camera
from tests.render.kits.stages import add_mesh, new_stage, read
from usd_schemas import LensCamera, LensData, Seidel

WIDTH, HEIGHT = 200, 100


def export(stage: Usd.Stage, folder: Path) -> Shot:
    """A shot of a stage, through a file."""
    stage.Export(f"{folder}/ortho.usda")
    return Shot.open(f"{folder}/ortho.usda")


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
    np.testing.assert_allclose(pixels, expected, atol=0.006)


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


def blurred_square(first_px: int, diameter_px: float) -> FloatArray:
    """Closed form: coverage of a square of 40 pixels, its left side there, under discs of a diameter."""
    fine = 8
    square = np.zeros((HEIGHT * fine, WIDTH * fine))
    square[30 * fine : 70 * fine, first_px * fine : (first_px + 40) * fine] = 1
    x = (np.arange(WIDTH * fine) + 0.5) / fine
    y = (np.arange(HEIGHT * fine) + 0.5) / fine
    away = np.hypot(
        np.minimum(x, WIDTH - x), np.minimum(y, HEIGHT - y)[:, None]
    )  # around the corner, for the transform
    disc = (away <= diameter_px / 2).astype(np.float64)
    blurred = np.fft.irfft2(np.fft.rfft2(square) * np.fft.rfft2(disc / disc.sum()), square.shape)
    return blurred.reshape(HEIGHT, fine, WIDTH, fine).mean(axis=(1, 3))


@pytest.mark.gl
@pytest.mark.parametrize("engine", ["lens", "accumulation"])
@pytest.mark.parametrize("focus", [4.0, 25.0])
def test_blur_is_the_distance_from_the_focus_over_n(renderer: FrameRenderer, engine: str, focus: float) -> None:
    stage = ortho_stage(fStop=16.0, focusDistance=focus)
    settings = FrameSettings(WIDTH, HEIGHT, engine=engine, rays=400, shading="unlit", adaptive=False)
    color = renderer.render(read(stage), read_camera(stage, "/cam", 0, aspect=WIDTH / HEIGHT), settings).color
    px_per_m = 20
    blurs = [px_per_m * abs(depth - focus) / 16 for depth in (3, 30)]
    expected = blurred_square(40, blurs[0]) + blurred_square(120, blurs[1])
    assert np.abs(color[..., 3] - expected).max() < 0.12
    assert np.sqrt(((color[..., 3] - expected) ** 2).mean()) < 0.012


@pytest.mark.gl
def test_single_image_engines_blur_alike(renderer: FrameRenderer) -> None:
    stage = ortho_stage(fStop=16.0, focusDistance=12.0)
    camera = read_camera(stage, "/cam", 0, aspect=WIDTH / HEIGHT)

    def light(engine: str) -> FloatArray:
        settings = FrameSettings(WIDTH, HEIGHT, engine=engine, rays=400, shading="unlit", adaptive=False)
        return renderer.render(read(stage), camera, settings).color[..., :3]

    exact = light("accumulation")
    for engine in ("gather", "scatter", "flag", "linear", "importance"):
        assert np.sqrt(((light(engine) - exact) ** 2).mean()) < 0.02


@pytest.mark.gl
def test_lit_cards_are_as_bright_as_those_of_a_pinhole(renderer: FrameRenderer) -> None:
    stage = ortho_stage(fStop=16.0, focusDistance=12.0)
    UsdLux.DistantLight.Define(stage, "/sun").CreateIntensityAttr(20000.0)
    camera = read_camera(stage, "/cam", 0, aspect=2)
    sharp, blurred = (
        renderer.render(
            read(stage), camera, FrameSettings(WIDTH, HEIGHT, engine=engine, rays=64, adaptive=False)
        ).color[50, 60, :3]
        for engine in ("pinhole", "lens")
    )
    assert sharp.min() > 0.1
    assert blurred == pytest.approx(sharp, rel=2e-3)


@pytest.mark.gl
def test_what_moves_is_blurred_by_motion_and_focus(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = ortho_stage(fStop=16.0, focusDistance=30.0)
    card = UsdGeom.Xformable(stage.GetPrimAtPath("/at30")).AddTranslateOp()
    for time, x in ((0, -1.0), (1, 1.0)):
        card.Set(Gf.Vec3d(x, 0, 0), time)
    camera = UsdGeom.Camera(stage.GetPrimAtPath("/cam"))
    camera.CreateShutterOpenAttr(0.0)
    camera.CreateShutterCloseAttr(1.0)
    shot = export(stage, tmp_path)
    for motion_by in ("moments", "velocities"):
        settings = FrameSettings(WIDTH, HEIGHT, rays=64, motion=16, motion_by=motion_by, shading="unlit")
        color = make_picture(renderer, shot, "/cam", 0, settings, Grade()).frame.color
        assert color[50, 100:180, 3] == pytest.approx(np.interp(np.arange(80) + 0.5, (0, 40, 80), (0, 1, 0)), abs=0.07)


def test_a_lens_with_errors_is_replaced_and_said_so(tmp_path: Path) -> None:
    stage = ortho_stage(fStop=1.4, focusDistance=3.0)
    LensCamera(stage.GetPrimAtPath("/cam")).lens.author(LensData(model="seidel", seidel=Seidel(w040=2)))
    assert read_camera(stage, "/cam", 0).lens.model == "thin"
    assert "orthographic" in {finding.code for finding in export(stage, tmp_path).findings()}


def test_without_a_focus_distance_the_farthest_is_sharp() -> None:
    camera = read_camera(ortho_stage(fStop=4.0), "/cam", 0)
    assert camera.stated_focus_m == pytest.approx(30, rel=1e-2)


def test_a_stage_with_nothing_in_view_has_a_camera() -> None:
    stage = ortho_stage()
    for depth in (3, 30):
        stage.RemovePrim(f"/at{depth}")
    for clipping in (Gf.Vec2f(1, 100), Gf.Vec2f(1, float("inf"))):
        UsdGeom.Camera(stage.GetPrimAtPath("/cam")).GetClippingRangeAttr().Set(clipping)
        assert np.isfinite(read_camera(stage, "/cam", 0).focal_length_mm)


@pytest.mark.gl
@pytest.mark.parametrize("engine", ["pinhole", "lens"])
def test_a_hundred_thousandth_of_the_depth_is_told_apart(renderer: FrameRenderer, engine: str) -> None:
    stage = ortho_stage(fStop=16.0, focusDistance=3.0)
    step = 1e-5 * 27
    for name, depth in (("behind", 3 + step), ("before", 3 - step)):
        points = [(-2.5, -0.5, -depth), (-1.5, -0.5, -depth), (-1.5, 0.5, -depth), (-2.5, 0.5, -depth)]
        add_mesh(stage, f"/{name}", points).CreateDisplayColorAttr([(1, 0, 0) if name == "behind" else (0, 1, 0)])
    stage.GetPrimAtPath("/at3").GetAttribute("primvars:displayColor").Set([(0, 0, 1)])
    settings = FrameSettings(WIDTH, HEIGHT, engine=engine, rays=16, shading="unlit", adaptive=False)
    color = renderer.render(read(stage), read_camera(stage, "/cam", 0, aspect=2), settings).color
    assert (color[42:58, 52:68, :3].argmax(axis=-1) == 1).all()
    assert np.ptp(color[42:58, 52:68, :3], axis=(0, 1)).max() < 1e-3
    stage.RemovePrim("/before")
    color = renderer.render(read(stage), read_camera(stage, "/cam", 0, aspect=2), settings).color
    assert (color[42:58, 52:68, :3].argmax(axis=-1) == 2).all()
    assert np.ptp(color[42:58, 52:68, :3], axis=(0, 1)).max() < 1e-3


@pytest.mark.gl
def test_deep_samples_lie_at_the_depths_of_surfaces(renderer: FrameRenderer) -> None:
    stage = ortho_stage(fStop=16.0, focusDistance=12.0)
    points = [
        (-3, -1, -12),
        (-1, -1, -12),
        (-1, 1, -12),
        (-3, 1, -12),
        (1, -1, -24),
        (3, -1, -24),
        (3, 1, -24),
        (1, 1, -24),
    ]
    add_mesh(stage, "/both", points, (4, 4), range(8))
    camera = read_camera(stage, "/cam", 0, aspect=WIDTH / HEIGHT)
    settings = FrameSettings(WIDTH, HEIGHT, engine="lens", rays=64, shading="unlit", adaptive=False, deep=True)
    frame = renderer.render(read(stage), camera, settings)
    assert frame.deep is not None
    stated_m = frame.deep.depths_m[np.isfinite(frame.deep.depths_m)] - camera.set_back_m
    for depth in (3, 12, 24, 30):
        assert (np.abs(stated_m - depth) < 0.01).sum() > 300
    assert np.abs(stated_m[:, None] - [3, 12, 24, 30]).min(axis=1).max() < 0.01


def test_plates_of_other_cameras_are_in_its_depths_too() -> None:
    stage = ortho_stage(clippingRange=Gf.Vec2f(1, 1000))
    other = UsdGeom.Camera.Define(stage, "/other")
    other.AddTranslateOp().Set(Gf.Vec3d(0, 0, -60))
    other.CreateFocusDistanceAttr(40.0)
    plate = UsdGeom.BackPlateAPI.Apply(other.GetPrim(), "sky")
    for visibility, farthest in (("solo", 30), ("all", 100), ("mute", 30)):
        plate.CreatePlateVisibilityAttr(visibility)
        camera = read_camera(stage, "/cam", 0)
        assert camera.far_m - camera.set_back_m == pytest.approx(farthest, rel=2e-3)
