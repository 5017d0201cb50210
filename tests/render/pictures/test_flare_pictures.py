"""Flare in pictures: what is bright enough for it, how strong it is, and that it is off by default."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.lens import Glass, IrisShape, Lens, Prescription, Surface
from render.model.scene import Batch, Dome, Light, Material, Scene
from render.pictures.bright_sources import BRIGHT, MOST, find_bright_sources
from render.pictures.flare import add_flare
from render.shot import Shot
from render.shot.lens.lens_choice import choose_lens
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot

N = 1.5
SINGLET = Prescription(
    (
        Surface(0.0, 1.0, semi_diameter_mm=8.0, is_stop=True),
        Surface(50.0, 4.0, Glass(N), 12.0),
        Surface(-50.0, 0.0, semi_diameter_mm=12.0),
    ),
    name="a singlet",
)
DARK = Dome((0.0, 0.0, 0.0), np.eye(4))
SMALL = FrameSettings(120, 80, rays=16)


def camera(lens: Lens, f_stop: float = 22.0, gate_mm: tuple[float, float] = (36.0, 24.0), **more: object) -> Camera:
    return Camera(
        np.eye(4),
        50.0,
        *gate_mm,
        f_stop=f_stop,
        focus_distance_m=5.0,
        near_m=0.1,
        lens=lens,
        **more,  # type: ignore[arg-type]
    )


def glow(x: float, y: float, half_m: float = 0.02, radiance: float = 3000.0, depth_m: float = 5.0) -> Batch:
    """A bright square at slopes from the axis."""
    square = rectangle((x * depth_m, y * depth_m, -depth_m), (half_m, 0, 0), (0, half_m, 0))
    material = Material(name="glow", base_color=(0, 0, 0), emissive=(radiance,) * 3)
    return Batch(square, material, np.eye(4)[None], double_sided=True)


def dark_wall(x: float, y: float, depth_m: float, half_m: float) -> Batch:
    wall = rectangle((x * depth_m, y * depth_m, -depth_m), (half_m, 0, 0), (0, half_m, 0))
    return Batch(wall, Material(name="wall", base_color=(0, 0, 0)), np.eye(4)[None], double_sided=True)


def lamp(x: float, y: float, depth_m: float = 5.0, radius_m: float = 0.05, **more: object) -> Light:
    pose = np.eye(4)
    pose[:3, 3] = x * depth_m, y * depth_m, -depth_m
    return Light("sphere", (400.0, 300.0, 200.0), pose, radius_m=radius_m, **more)  # type: ignore[arg-type]


def drawn(
    renderer: FrameRenderer, scene: Scene, looks: Camera, settings: FrameSettings
) -> tuple[FloatArray, FloatArray]:
    """A picture without flare and the same with it."""
    plain = renderer.render(scene, looks, settings)
    return plain.color[..., :3], add_flare(renderer, scene, looks, settings, plain).color[..., :3]


def sums(picture: FloatArray) -> DoubleArray:
    return np.asarray(picture.sum(axis=(0, 1), dtype=np.float64))


@pytest.mark.gl
def test_a_ghost_in_a_picture_has_the_product_of_the_reflectances(renderer: FrameRenderer) -> None:
    scene = Scene((glow(0.0, 0.0, 0.12),), (), DARK, ("/glow",))
    settings = FrameSettings(160, 160, rays=64, supersample=4)
    looks = camera(Lens("prescription", SINGLET.name, SINGLET, ghosts=1.0), gate_mm=(60.0, 60.0))
    plain, with_ghosts = drawn(renderer, scene, looks, settings)
    assert sums(with_ghosts - plain) / sums(plain) == pytest.approx(((N - 1) / (N + 1)) ** 4, rel=0.05)
    tenfold = replace(looks, lens=replace(looks.lens, ghosts=10.0))
    assert sums(drawn(renderer, scene, tenfold, settings)[1] - plain) == pytest.approx(
        10 * sums(with_ghosts - plain), rel=1e-3
    )


@pytest.mark.gl
def test_a_stars_light_is_its_sources_and_lies_across_the_blades(renderer: FrameRenderer) -> None:
    scene = Scene((glow(0.0, 0.0, 0.02, 1e5),), (), DARK, ("/glow",))
    looks = camera(Lens(star=1.0), 32.0, iris=IrisShape(blades=4))
    plain, starred = drawn(renderer, scene, looks, SMALL)
    assert sums(plain).min() > 1e4
    assert sums(starred) == pytest.approx(sums(plain), rel=0.02)
    away = np.arange(10, 30)
    across = starred[40 - away, 60 + away].sum() + starred[40 + away, 60 - away].sum()
    between = starred[40, 60 + away].sum() + starred[40, 60 - away].sum()
    assert across > 20 * between
    assert across > 0


@pytest.mark.gl
def test_flare_is_off_by_default_and_never_through_a_pinhole(renderer: FrameRenderer) -> None:
    scene = Scene((glow(0.0, 0.0),), (), DARK, ("/glow",))
    glass, both = Lens("prescription", SINGLET.name, SINGLET), {"ghosts": 1.0, "star": 1.0}
    frame = renderer.render(scene, camera(glass), SMALL)
    flaring = camera(replace(glass, **both))  # type: ignore[arg-type]
    assert add_flare(renderer, scene, camera(glass), SMALL, frame) is frame
    assert add_flare(renderer, scene, flaring, replace(SMALL, engine="pinhole"), frame) is frame
    assert add_flare(renderer, scene, replace(flaring, f_stop=0.0), SMALL, frame) is frame
    assert add_flare(renderer, scene, camera(Lens(ghosts=1.0)), SMALL, frame) is frame  # a thin lens reflects nothing
    assert add_flare(renderer, scene, flaring, SMALL, frame).color is not frame.color


@pytest.mark.gl
def test_a_highlights_light_is_its_radiance_times_its_area(renderer: FrameRenderer) -> None:
    scene = Scene((glow(0.2, -0.1, 0.05),), (), DARK, ("/glow",))
    sources = find_bright_sources(renderer, scene, camera(Lens()), SMALL)
    light = sum(source.irradiance for source in sources)
    cosine4 = 1 / (1 + 0.2**2 + 0.1**2) ** 2
    assert light == pytest.approx(3000 * (0.1 / 5) ** 2 * cosine4, rel=0.05)
    strongest = sources[0]
    assert strongest.slope == pytest.approx((0.2, -0.1), abs=0.01)
    assert strongest.depth_m == pytest.approx(5.0, rel=0.02)
    assert not find_bright_sources(
        renderer, Scene((glow(0, 0, 1.0, BRIGHT * 0.4),), (), DARK, ("/g",)), camera(Lens()), SMALL
    )
    bright_film = camera(Lens(), exposure_scale=10.0)
    assert find_bright_sources(renderer, Scene((glow(0, 0, 1.0, BRIGHT * 0.4),), (), DARK, ("/g",)), bright_film, SMALL)


@pytest.mark.gl
def test_a_light_that_no_geometry_hides_shines_on_the_lens(renderer: FrameRenderer) -> None:
    looks = camera(Lens())

    def of(*lights: Light, batches: tuple[Batch, ...] = ()) -> list[DoubleArray]:
        sources = find_bright_sources(renderer, Scene(batches, lights, DARK, ("/it",)), looks, SMALL)
        return [source.irradiance for source in sources]

    (alone,) = of(lamp(0.2, 0.1))
    distance_m = 5 * np.sqrt(1 + 0.2**2 + 0.1**2)
    assert alone == pytest.approx(
        np.array([400, 300, 200]) * np.pi * (0.05 / distance_m) ** 2 * 5 / distance_m, rel=1e-6
    )
    assert not of(lamp(0.2, 0.1), batches=(dark_wall(0.2, 0.1, 2.0, 0.1),))
    assert of(lamp(0.2, 0.1), batches=(dark_wall(0.2, 0.1, 9.0, 0.1),))
    assert of(lamp(0.5, 0.0))  # beside the picture
    assert not of(lamp(0.7, 0.0))  # where a lens hood shades it
    assert not of(replace(lamp(0.0, 0.0), pose=np.eye(4)))  # at the lens itself
    assert not of(lamp(0.0, 0.0, radius_m=0.5))  # too wide to be a point
    sun = Light("distant", (3.0, 3.0, 3.0), np.diag([-1.0, 1.0, -1.0, 1.0]), angle_rad=0.009)
    assert of(sun)[0] == pytest.approx(3.0)
    assert not of(replace(sun, pose=np.eye(4)))  # behind the camera


@pytest.mark.gl
def test_a_lamp_that_glows_and_its_light_are_one_source(renderer: FrameRenderer) -> None:
    looks, bulb = camera(Lens()), lamp(0.1, 0.0, radius_m=0.01)
    light = find_bright_sources(renderer, Scene((), (bulb,), DARK, ("/it",)), looks, SMALL)[0].irradiance
    for radiance, is_light in ((20.0, True), (2e4, False)):
        scene = Scene((glow(0.1, 0.0, 0.01, radiance, 4.99),), (bulb,), DARK, ("/it",))
        together = sum(source.irradiance for source in find_bright_sources(renderer, scene, looks, SMALL))
        assert (together == pytest.approx(light)) == is_light
        assert (together >= light).all()


@pytest.mark.gl
def test_no_more_than_some_sources_count_and_the_last_ones_fade(renderer: FrameRenderer) -> None:
    places = [(x, y) for x in np.linspace(-0.3, 0.3, 7) for y in np.linspace(-0.2, 0.2, 4)]
    lamps = tuple(replace(lamp(x, y), radiance=(100.0 + i,) * 3) for i, (x, y) in enumerate(places))
    sources = find_bright_sources(renderer, Scene((), lamps, DARK, ("/it",)), camera(Lens()), SMALL)
    assert 0 < len(sources) <= MOST
    whole = find_bright_sources(renderer, Scene((), lamps[-1:], DARK, ("/it",)), camera(Lens()), SMALL)[0].irradiance
    assert sources[-1].irradiance.max() < 0.3 * whole.max()


def test_strengths_are_read_and_keyed(tmp_path: Path) -> None:
    shot = Shot.open(write_shot(tmp_path / "shot.usda", CAMERA, SQUARE))
    path = shot.default_camera().path
    assert shot.camera_at(path, 1, 8, 8).lens.ghosts == shot.camera_at(path, 1, 8, 8).lens.star == 0
    shot.exposure.set(path, flare_ghosts=0.5)
    shot.exposure.set(path, flare_star=1.0, time=1)
    shot.exposure.set(path, flare_star=3.0, time=5)
    lenses = [shot.camera_at(path, time, 8, 8).lens for time in (1, 3, 5)]
    assert [lens.ghosts for lens in lenses] == [0.5] * 3
    assert [lens.star for lens in lenses] == pytest.approx([1.0, 2.0, 3.0])


def test_ghosts_of_a_lens_without_surfaces_are_reported(tmp_path: Path) -> None:
    shot = Shot.open(write_shot(tmp_path / "shot.usda", CAMERA, SQUARE))
    path = shot.default_camera().path
    shot.exposure.set(path, flare_ghosts=1.0, flare_star=1.0)
    (finding,) = shot.findings()
    assert (finding.code, finding.path) == ("no_ghosts", path)
    assert "thin lens has no surfaces" in finding.message
    shot.camera.mount_lens(path, choose_lens("double_gauss_50"))
    assert not [finding for finding in shot.findings() if finding.code == "no_ghosts"]


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


@pytest.mark.gl
def test_record_takes_flare_and_star(command: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "shot.usda", CAMERA, SQUARE)

    def recorded(*options: object) -> FloatArray:
        ended = command("record", shot, tmp_path / "out.exr", *small("--lens", "double_gauss_50", *options))
        assert ended.status == 0, ended.err
        return np.asarray(oiio.ImageBuf(str(tmp_path / "out.exr")).get_pixels(oiio.FLOAT), np.float32)

    plain = recorded()
    assert (recorded("--star", "0", "--flare", "0") == plain).all()
    assert (recorded("--stop", "16", "--star", "9") != recorded("--stop", "16")).any()
    for wrong in (["--flare", "-1"], ["--star", "nan"]):
        ended = command("record", shot, tmp_path / "out.exr", *small(*wrong))
        assert ended.status == 2
        assert f"{wrong[0]} takes a factor of 0 or more" in ended.err
