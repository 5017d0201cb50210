"""Pictures through lenses: what real glass must do to light, whatever the scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import SettingsError
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import spheres_over_checkerboard
from render.model.camera import Camera
from render.model.lens import AberrationScales, Glass, HeightField, IrisShape, Lens, Prescription, SeidelErrors, Surface
from render.optics.view import PinholeView
from render.trace.rays import make_ray_pattern
from tests.render.kits.lens_pictures import WHITE, camera_of, glowing_point, spot_size
from tests.render.kits.lenses import DOUBLE_GAUSS, PLANAR, SIX_LENSES, KnownLens

SMALL = FrameSettings(160, 120, rays=64)
BK7 = Glass(
    1.5168,
    64.17,
    (1.03961212, 0.231792344, 1.01046945),
    (0.00600069867, 0.0200179144, 103.560653),
    "BK7",
)
SINGLET = Prescription(
    (Surface(51.0, 6.0, BK7, 14.0), Surface(-51.0, 2.0, semi_diameter_mm=14.0), Surface(0.0, 0.0, is_stop=True)),
    f_stop=2.8,
    name="singlet",
)


@pytest.mark.parametrize("known", SIX_LENSES, ids=lambda known: known.prescription.name)
def test_white_stays_white_and_only_the_corners_darken(renderer: FrameRenderer, known: KnownLens) -> None:
    picture = renderer.render(WHITE, camera_of(known), SMALL).color
    middle = picture[59:61, 79:81, :3]
    np.testing.assert_allclose(middle, 1.0, atol=0.02)
    assert np.ptp(picture[..., :3], axis=-1).max() < 0.002  # neutral: the three wavelengths see the same white
    assert picture[..., :3].max() < 1.02
    assert picture[0, 0, 1] < picture[60, 80, 1]


def test_without_vignetting_a_white_field_is_white_to_the_corner(renderer: FrameRenderer) -> None:
    camera = camera_of(PLANAR)
    even = replace(camera, lens=replace(camera.lens, scales=AberrationScales(vignetting=0.0)))
    picture = renderer.render(WHITE, even, SMALL).color[..., :3]
    np.testing.assert_allclose(picture, 1.0, atol=0.002)


def test_both_ways_to_bound_a_footprint_give_the_same_picture(renderer: FrameRenderer) -> None:
    scene, camera = spheres_over_checkerboard()
    lens = Lens("prescription", prescription=DOUBLE_GAUSS.prescription)
    camera = replace(camera, focal_length_mm=50.0, f_stop=2.0, horizontal_aperture_mm=32.0, vertical_aperture_mm=24.0)
    view = PinholeView.from_camera(camera, 160, 120)
    renderer.render(scene, camera, SMALL)  # loads the scene
    for glass in (Lens(), lens):
        pictures = [
            renderer.device.tracer.picture(
                renderer.device.peeler,
                replace(camera, lens=glass),
                view,
                make_ray_pattern(32, IrisShape()),
                layers=4,
                supersample=2,
                bound_by_rays=by_rays,
            ).color
            for by_rays in (False, True)
        ]
        assert psnr_db(*pictures) > 50


def test_a_closed_down_singlet_is_a_thin_lens(renderer: FrameRenderer) -> None:
    """At f/22 the glass's errors are below a pixel near the axis: its picture is the thin lens's."""
    scene, camera = spheres_over_checkerboard()
    camera = replace(camera, focal_length_mm=50.0, horizontal_aperture_mm=20.0, vertical_aperture_mm=15.0, f_stop=22.0)
    scales = AberrationScales(distortion=0.0, field_curvature=0.0, astigmatism=0.0, chromatic=0.0, vignetting=0.0)
    glass = Lens("spherical", prescription=SINGLET, scales=scales)
    thin = renderer.render(scene, camera, SMALL).color
    assert psnr_db(renderer.render(scene, replace(camera, lens=glass), SMALL).color, thin) > 38


def test_flat_height_fields_change_nothing_and_bumps_do(renderer: FrameRenderer) -> None:
    scene, camera = spheres_over_checkerboard()
    camera = replace(camera, focal_length_mm=50.0, horizontal_aperture_mm=24.0, vertical_aperture_mm=18.0, f_stop=2.8)
    settings = replace(SMALL, wavelengths=1)
    sphere = renderer.render(scene, replace(camera, lens=Lens("spherical", prescription=SINGLET)), settings).color
    y, x = np.mgrid[-1:1:64j, -1:1:64j]
    wedge = 0.3 * x  # mm: a prism of 0.3 mm over 14 mm turns light by (n - 1)·0.3/14
    pictures = [
        renderer.render(
            scene,
            replace(camera, lens=Lens("heightField", prescription=SINGLET, height_field=HeightField(front=heights))),
            settings,
        ).color
        for heights in (np.zeros((8, 8)), wedge, 0.03 * np.sin(9 * x) * np.sin(9 * y))
    ]
    assert psnr_db(pictures[0], sphere) > 37
    turned_px = 0.5168 * 0.3 / 14 * 50 / 24 * 160
    shifted = spot_size(
        renderer.render(glowing_point(0, 0, 4.0), replace(camera, lens=pictures_lens(wedge)), settings).color
    )
    straight = spot_size(
        renderer.render(glowing_point(0, 0, 4.0), replace(camera, lens=pictures_lens(0 * x)), settings).color
    )
    assert abs(shifted[0] - straight[0]) == pytest.approx(turned_px, rel=0.06)
    assert psnr_db(pictures[2], sphere) < 35


def pictures_lens(front: np.ndarray) -> Lens:
    return Lens("heightField", prescription=SINGLET, height_field=HeightField(front=front))


def test_seidel_errors_of_zero_are_the_thin_lens(renderer: FrameRenderer) -> None:
    scene, camera = spheres_over_checkerboard()
    thin = renderer.render(scene, camera, SMALL).color
    seidel = renderer.render(scene, replace(camera, lens=Lens("seidel", seidel=SeidelErrors())), SMALL).color
    assert psnr_db(seidel, thin) > 60


def test_coma_flares_away_from_the_axis_or_toward_it_by_its_sign(renderer: FrameRenderer) -> None:
    scene = glowing_point(0.3, 0.0, 5.0)
    camera = Camera(np.eye(4), 50.0, 36.0, 27.0, f_stop=2.8, focus_distance_m=5.0, near_m=0.1)
    settings = FrameSettings(400, 300, rays=100, supersample=4)
    centres = []
    for coma in (0.0, 60.0, -60.0):
        lens = Lens("seidel", seidel=SeidelErrors(w131=coma, reference_f_stop=2.8, reference_height_mm=15.0))
        centres.append(spot_size(renderer.render(scene, replace(camera, lens=lens), settings).color)[0])
    error = 587.5618e-9 * 60 / (50 / 5600) * 50 / 36 * 400  # px: W131·λ/E times f in pixels
    # the mean of (3x² + y²) over the disc is 1; what a pixel sees further out is shown further in
    assert centres[1] < centres[0] - 0.8 * error
    assert (centres[2] - centres[1]) / 2 == pytest.approx(error, rel=0.05)


def test_lateral_colour_puts_blue_outside_red(renderer: FrameRenderer) -> None:
    camera = Camera(np.eye(4), 50.0, 36.0, 27.0, f_stop=8.0, focus_distance_m=5.0, near_m=0.1)
    lens = Lens("seidel", seidel=SeidelErrors(lateral_color_mm=0.5, reference_height_mm=15.0))
    picture = renderer.render(
        glowing_point(0.3, 0, 5.0), replace(camera, lens=lens), FrameSettings(400, 300, rays=64)
    ).color
    red, green, blue = (spot_size(picture, channel)[0] for channel in range(3))
    assert red < green < blue
    assert blue - red == pytest.approx(0.5 / 36 * 400, rel=0.1)
    neutral = replace(lens, scales=AberrationScales(chromatic=0.0))
    picture = renderer.render(
        glowing_point(0.3, 0, 5.0), replace(camera, lens=neutral), FrameSettings(400, 300, rays=64)
    ).color
    assert spot_size(picture, 0)[0] == pytest.approx(spot_size(picture, 2)[0], abs=0.01)


def test_bokeh_is_round_in_the_middle_and_a_cats_eye_in_the_corner(renderer: FrameRenderer) -> None:
    camera = camera_of(DOUBLE_GAUSS, focus_distance_m=1.5)
    settings = FrameSettings(480, 360, rays=64)
    middle = spot_size(renderer.render(glowing_point(0.0, 0.0, 40.0, 0.08), camera, settings).color)
    edge = spot_size(renderer.render(glowing_point(0.28, 0.0, 40.0, 0.08), camera, settings).color)
    assert middle[2] == pytest.approx(middle[3], rel=0.02)
    assert edge[2] < 0.8 * edge[3]  # tangentially narrower: rims cut it from both sides


def test_anamorphic_bokeh_is_high_and_narrow(renderer: FrameRenderer) -> None:
    camera = Camera(np.eye(4), 50.0, 36.0, 27.0, f_stop=1.4, focus_distance_m=1.5, near_m=0.1, lens=Lens(squeeze=2.0))
    light = spot_size(renderer.render(glowing_point(0, 0, 40.0, 0.05), camera, FrameSettings(640, 480, rays=256)).color)
    assert light[3] / light[2] == pytest.approx(2.0, rel=0.03)


def test_an_iris_shapes_the_bokeh_through_glass_too(renderer: FrameRenderer) -> None:
    camera = camera_of(DOUBLE_GAUSS, focus_distance_m=1.5, f_stop=4.0)
    half = np.zeros((32, 32))
    half[:, 16:] = 1.0
    settings = FrameSettings(320, 240, rays=256)
    scene = glowing_point(0, 0, 40.0, 0.05)
    whole = spot_size(renderer.render(scene, camera, settings).color)
    cut = renderer.render(scene, replace(camera, iris=IrisShape(mask=half)), settings).color
    assert (
        spot_size(cut)[0] - whole[0] > 0.7 * whole[2]
    )  # behind the focus the bokeh stands as the iris does: its right half
    assert spot_size(cut)[3] == pytest.approx(whole[3], rel=0.05)
    assert cut[..., 1].sum() == pytest.approx(renderer.render(scene, camera, settings).color[..., 1].sum(), rel=0.03)


def test_measurements_come_through_the_same_lens(renderer: FrameRenderer) -> None:
    """A barrel-shaped lens shows more of the world: what a pixel shows, its AOVs and a click on it agree."""
    scene, camera = spheres_over_checkerboard()
    lens = Lens("seidel", seidel=SeidelErrors(w311=400.0, w220=-30.0, reference_f_stop=1.4, reference_height_mm=15.0))
    camera = replace(camera, lens=lens, f_stop=1.4)
    settings = FrameSettings(160, 120, rays=8, aovs=("color", "depth", "prim_id", "focus_depth", "coc", "albedo"))
    frame = renderer.render(scene, camera, settings)
    straight = renderer.render(scene, replace(camera, lens=Lens()), settings)
    assert not np.array_equal(frame.aovs["prim_id"], straight.aovs["prim_id"])
    agreeing = 0
    places = [(20, 100), (80, 60), (130, 90), (40, 70), (140, 30), (100, 110)]
    for x, y in places:
        pick = renderer.pick(scene, camera, 160, 120, x + 0.5, y + 0.5)
        here = int(frame.aovs["prim_id"][y, x])
        agreeing += (pick.prim_path if pick else None) == (scene.prim_paths[here - 1] if here else None)
    assert agreeing >= len(places) - 1  # one may stand on an edge
    sharp = frame.aovs["focus_depth"]
    assert sharp[60, 80] == pytest.approx(4.0, rel=0.01)
    assert sharp[2, 2] > sharp[60, 80] * 1.02  # negative W220: the rays of the edge meet farther away
    assert frame.aovs["albedo"].shape == (120, 160, 3)
    assert frame.aovs["albedo"].max() <= 1.0


def test_the_accumulation_buffer_refuses_what_it_cannot_show(renderer: FrameRenderer) -> None:
    with pytest.raises(SettingsError, match="thin lens alone"):
        renderer.render(WHITE, camera_of(PLANAR), replace(SMALL, engine="accumulation"))
