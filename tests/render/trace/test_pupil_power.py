"""Spherical aberration drawn as power over the pupil: the rays go where the curve says, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.ray_by_ray import ray_by_ray_picture
from render.lab.reference.scenes import posts_before_wall, rectangle
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import Lens, SeidelErrors
from render.model.scene import Batch, Dome, Material, Scene
from render.optics.pupil_power import drawn_defocus, is_drawn, own_scales, relative_power
from render.trace.drawn_power import add_drawn_power
from render.trace.lens_fit import even_basis, odd_basis, pupil_nodes
from render.trace.lens_table import SLOPE_S, SLOPE_T, PolynomialTable
from render.trace.seidel_table import make_seidel_table
from tests.render.kits.lenses import DOUBLE_GAUSS

F_PX = 50 / 12.8 * 128
RADIUS_M = 0.0125  # 50 mm at f/2
RISING = (1.0, 1.02, 1.08, 1.2)
RINGED = (1.0, 1.15, 0.95, 1.1, 1.0, 1.2)
SETTINGS = FrameSettings(128, 96, rays=256)
HALF_SLOPE = 0.004
"""Half slope of the glowing square, which is 4 pixels wide."""


def thin(powers: tuple[float, ...], blend: float = 1.0, squeeze: float = 1.0) -> Lens:
    return Lens(pupil_power=powers, expressive_blend=blend, squeeze=squeeze)


def camera_with(lens: Lens, focus_distance_m: float = 4.0) -> Camera:
    return Camera(np.eye(4), 50.0, 12.8, 9.6, f_stop=2.0, focus_distance_m=focus_distance_m, near_m=0.1, lens=lens)


def glowing_point(depth_m: float) -> Scene:
    glow = Material(name="glow", base_color=(0, 0, 0), emissive=(3000.0, 3000.0, 3000.0))
    half_m = HALF_SLOPE * depth_m
    square = rectangle((0, 0, -depth_m), (half_m, 0, 0), (0, half_m, 0))
    return Scene((Batch(square, glow, np.eye(4)[None], double_sided=True),), (), Dome((0, 0, 0), np.eye(4)), ("/p",))


def spread_px(picture: FloatArray) -> tuple[float, float]:
    """Standard deviation of the light along x and y, less that of the square itself."""
    light = picture[..., 1].astype(np.float64)
    y, x = np.mgrid[: light.shape[0], : light.shape[1]] + 0.5
    means = [(axis * light).sum() / light.sum() for axis in (x, y)]
    x2, y2 = (((axis - mean) ** 2 * light).sum() / light.sum() for axis, mean in zip((x, y), means, strict=True))
    own = (F_PX * HALF_SLOPE) ** 2 / 3
    return float(np.sqrt(max(x2 - own, 0))), float(np.sqrt(max(y2 - own, 0)))


def expected_px(lens: Lens, away_w: float = 0.0, radius_m: float = RADIUS_M) -> float:
    """Return the spot size of a point ``away_w`` nearer than the focus of the pupil's centre, by the thin lens alone."""
    radius = np.sqrt((np.arange(20000) + 0.5) / 20000)  # even over the disc
    spot = F_PX * radius_m * radius * (away_w - drawn_defocus(lens, 50.0, radius))
    return float(np.sqrt((spot**2).mean() / 2))


@given(st.lists(st.floats(0.2, 3.0), min_size=2, max_size=12).map(tuple))
def test_the_curve_goes_through_what_is_drawn_and_never_beyond_it(powers: tuple[float, ...]) -> None:
    values = np.array(powers) / powers[0]
    steps = np.linspace(0, 1, len(powers))
    assert relative_power(powers, steps) == pytest.approx(values, rel=1e-9)
    fine = np.linspace(0, 1, 2001)
    index = np.minimum((fine * (len(powers) - 1)).astype(int), len(powers) - 2)
    curve = relative_power(powers, fine)
    assert (curve >= np.minimum(values[index], values[index + 1]) - 1e-9).all()
    assert (curve <= np.maximum(values[index], values[index + 1]) + 1e-9).all()


@pytest.mark.parametrize("powers", [RISING, RINGED])
def test_the_curve_is_smooth_and_level_at_the_centre(powers: tuple[float, ...]) -> None:
    radius = np.linspace(0, 1, 100001)
    slope = np.gradient(relative_power(powers, radius), radius)
    assert np.abs(np.diff(slope)).max() < 1e-2
    assert abs(slope[0]) < 1e-3


@pytest.mark.parametrize("lens", [thin(()), thin(RISING, blend=0.0), thin((1.0,)), thin((0.7, 0.7, 0.7))])
def test_an_even_power_changes_nothing(renderer: FrameRenderer, lens: Lens) -> None:
    assert not is_drawn(lens)
    scene, camera = posts_before_wall()
    settings = FrameSettings(96, 72, rays=16)
    drawn = renderer.render(scene, replace(camera, lens=lens), settings).color
    assert np.array_equal(drawn, renderer.render(scene, camera, settings).color)


def test_a_grid_of_even_power_is_the_thin_lens(renderer: FrameRenderer) -> None:
    """The way that drawn power takes, with next to none drawn, gives the picture of the way without it."""
    scene, camera = posts_before_wall()
    settings = FrameSettings(160, 120, rays=64)
    nearly = replace(camera, lens=thin((1.0, 1.0 + 1e-9)))
    plain = renderer.render(scene, camera, settings).color
    assert psnr_db(renderer.render(scene, nearly, settings).color, plain) > 55


@pytest.mark.parametrize("powers", [RISING, RINGED, (1.0, 0.8)])
@pytest.mark.parametrize("blend", [0.5, 1.0])
def test_a_point_in_focus_spreads_as_drawn(renderer: FrameRenderer, powers: tuple[float, ...], blend: float) -> None:
    lens = thin(powers, blend)
    picture = renderer.render(glowing_point(4.0), camera_with(lens), SETTINGS).color
    assert spread_px(picture) == pytest.approx((expected_px(lens),) * 2, rel=0.03, abs=0.1)


def test_more_power_at_the_edge_focuses_the_edge_nearer(renderer: FrameRenderer) -> None:
    """Where the centre of the pupil is out of focus, the edge may be in it."""
    lens = thin((1.0, 1.2))
    nearer, farther = (
        spread_px(renderer.render(glowing_point(1 / w), camera_with(lens, 1.0), SETTINGS).color)[0] for w in (3.0, 0.1)
    )
    assert nearer == pytest.approx(expected_px(lens, 2.0), rel=0.03, abs=0.1)
    assert farther == pytest.approx(expected_px(lens, -0.9), rel=0.03, abs=0.1)
    assert nearer < spread_px(renderer.render(glowing_point(1 / 3), camera_with(Lens(), 1.0), SETTINGS).color)[0]


def test_an_anamorphic_lens_squeezes_what_is_drawn(renderer: FrameRenderer) -> None:
    lens = thin(RISING, squeeze=2.0)
    across, down = spread_px(renderer.render(glowing_point(4.0), camera_with(lens), SETTINGS).color)
    assert down == pytest.approx(expected_px(lens), rel=0.03, abs=0.1)
    assert across == pytest.approx(down / 2, rel=0.03, abs=0.1)


@pytest.mark.parametrize(
    "lens",
    [
        thin(RINGED),
        Lens(
            "seidel",
            seidel=SeidelErrors(w040=9, w131=4, reference_f_stop=2.0),
            pupil_power=RISING,
            expressive_blend=0.7,
        ),
    ],
    ids=["thin", "seidel"],
)
def test_the_engine_agrees_with_every_ray_on_its_own(renderer: FrameRenderer, lens: Lens) -> None:
    scene, camera = posts_before_wall()
    camera = replace(camera, lens=lens, focal_length_mm=50.0, f_stop=2.0)
    camera = replace(camera, horizontal_aperture_mm=24.0, vertical_aperture_mm=18.0)
    slow = ray_by_ray_picture(scene, camera, width=80, height=60, rays=64)
    settings = FrameSettings(80, 60, rays=64, layers=8, supersample=4, shading="unlit", tiled=False)
    assert psnr_db(renderer.render(scene, camera, settings).color, slow) >= 40


def test_drawn_pupil_power_replaces_the_lenss_spherical_aberration() -> None:
    drawn = Lens("seidel", seidel=SeidelErrors(w040=9), pupil_power=RISING, expressive_blend=0.75)
    assert own_scales(drawn).spherical == 0.25
    assert own_scales(replace(drawn, pupil_power=())).spherical == 1
    assert own_scales(drawn).coma == 1


def test_a_table_of_polynomials_shows_three_bends() -> None:
    lens = thin(RISING)
    plain = make_seidel_table(
        SeidelErrors(),
        lens.scales,
        focal_length_mm=50.0,
        pupil_radius_m=RADIUS_M,
        last_slope=0.4,
        wavelengths_nm=(587.6,),
    )
    table = add_drawn_power(plain, lens, focal_length_mm=50.0, pupil_radius_m=RADIUS_M)
    assert isinstance(table, PolynomialTable)
    nodes = pupil_nodes(200)
    wanted = -nodes * RADIUS_M * drawn_defocus(lens, 50.0, np.hypot(*nodes.T))[:, None]
    row = table.rows[0, 20]
    tangential = even_basis(nodes, 7) @ row[SLOPE_T:SLOPE_S]
    sagittal = odd_basis(nodes, 7) @ row[SLOPE_S : SLOPE_S + 16]
    errors = np.hypot(tangential - wanted[:, 0], sagittal - wanted[:, 1])
    assert errors.max() < 0.02 * np.hypot(*wanted.T).max()
    assert table.slope_reach >= np.hypot(tangential, sagittal).max()


def test_real_glass_gets_what_is_drawn_in_place_of_its_own(renderer: FrameRenderer) -> None:
    camera = replace(camera_with(Lens("prescription", prescription=DOUBLE_GAUSS.prescription)), f_stop=2.8)
    drawn = replace(camera.lens, pupil_power=RISING, expressive_blend=1.0)
    corrected = replace(camera.lens, scales=replace(camera.lens.scales, spherical=0.0))
    spots = [
        spread_px(renderer.render(glowing_point(4.0), replace(camera, lens=lens), SETTINGS).color)[1]
        for lens in (corrected, drawn)
    ]
    wanted = expected_px(drawn, radius_m=0.05 / 5.6)
    assert np.sqrt(spots[1] ** 2 - spots[0] ** 2) == pytest.approx(wanted, rel=0.03)
