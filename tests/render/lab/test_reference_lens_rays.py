"""The rays of the reference's lenses: they lead back where they came from, and err as optics says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import SettingsError
from render.lab.reference.lens_rays import SceneRays, lens_rays
from render.lab.reference.lens_tracer import TracedRays, trace
from render.lab.reference.ray_by_ray import ray_by_ray_picture
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import AIR, AberrationScales, Glass, HeightField, Lens, Prescription, SeidelErrors, Surface
from render.model.scene import Dome, Scene
from render.optics.glass import D_LINE_NM
from render.optics.prescription.mounting import mount_lens
from render.optics.sampling import lens_samples
from tests.render.kits.lenses import DOUBLE_GAUSS, FISHEYE, PLANAR, WIDE, KnownLens

CAMERA = Camera(np.eye(4), 50, 36, 24, f_stop=2.0, focus_distance_m=3.0)
_CROWN = Glass(1.517, 64.2)
BICONVEX = Prescription(
    (Surface(52, 2.0, _CROWN, 8), Surface(0, 2.0, _CROWN, 7, is_stop=True), Surface(-52, 0, AIR, 8)), name="biconvex"
)
SINGLET = replace(CAMERA, lens=Lens("spherical", prescription=BICONVEX))


def prescribed(known: KnownLens, f_stop: float) -> Camera:
    """A camera with the lens at its own focal length."""
    lens = Lens("prescription", prescription=known.prescription)
    side = known.field_mm * np.sqrt(2)
    return Camera(np.eye(4), known.focal_length_mm, side, side, f_stop=f_stop, focus_distance_m=2.0, lens=lens)


def field(camera: Camera, count: int = 13) -> DoubleArray:
    """``(n, n, 2)`` ideal slopes over the whole film."""
    across = np.linspace(-0.5, 0.5, count) * camera.horizontal_aperture_mm / camera.focal_length_mm
    up = np.linspace(0.5, -0.5, count) * camera.vertical_aperture_mm / camera.focal_length_mm
    return np.stack(np.meshgrid(across, up), -1)


def rays_of(camera: Camera, pupil: tuple[float, float], ideal: DoubleArray, nm: float = D_LINE_NM) -> SceneRays:
    corner = float(np.abs(ideal[..., 0]).max()) + 1e-3, float(np.abs(ideal[..., 1]).max()) + 1e-3
    return lens_rays(camera, np.array([pupil]), corner).rays(0, ideal, nm)


def back_to(camera: Camera, rays: SceneRays, nm: float, last: int | None = None) -> TracedRays:
    """Rays from the scene through the mounted lens toward the film, up to a surface."""
    lens = mount_lens(camera)
    slopes, offsets = (part[rays.weights > 0] for part in (rays.slopes, rays.offsets))
    starts = np.concatenate([1000 * offsets + 100 * slopes, np.full((len(slopes), 1), lens.entrance_pupil_mm - 100)], 1)
    headings = np.concatenate([-slopes, np.ones((len(slopes), 1))], 1)
    headings /= np.linalg.norm(headings, axis=1, keepdims=True)
    surfaces = lens.prescription.surfaces[:last]
    return trace(surfaces, lens.vertices_mm[:last], nm, starts, headings, toward="film", clip=False)


@pytest.mark.parametrize(
    ("known", "f_stop", "pupil"),
    [
        (DOUBLE_GAUSS, 2.1, (0.6, -0.5)),
        (PLANAR, 1.41, (0.0, 0.7)),
        (WIDE, 2.7, (-0.9, 0.1)),
        (FISHEYE, 4.0, (0.3, 0.8)),
    ],
    ids=lambda value: value.prescription.name if isinstance(value, KnownLens) else "",
)
def test_a_ray_leads_from_its_film_point_through_its_stop_point(
    known: KnownLens, f_stop: float, pupil: tuple[float, float]
) -> None:
    """Whatever the aiming does: light on that ray from the scene lands where the pixel is, upside down, by way of the sample."""
    camera = prescribed(known, f_stop)
    lens, ideal = mount_lens(camera), field(camera)
    for nm in (475.0, 650.0):
        rays = rays_of(camera, pupil, ideal, nm)
        is_open = rays.weights > 0
        assert is_open.mean() > 0.3
        stop = back_to(camera, rays, nm, lens.stop + 1).at(float(lens.vertices_mm[lens.stop]))
        np.testing.assert_allclose(
            stop, np.tile(pupil, (len(stop), 1)) * lens.stop_radius_mm, atol=1.1e-4 * lens.stop_radius_mm
        )
        film = back_to(camera, rays, nm).at(lens.film_mm)
        np.testing.assert_allclose(film, -ideal[is_open] * lens.image_scale_mm, atol=1e-8)


def test_blocked_rays_are_those_that_a_rim_blocks() -> None:
    camera = prescribed(DOUBLE_GAUSS, 2.1)
    ideal = field(camera, 25)
    rays = rays_of(camera, (0.0, 0.9), ideal)
    assert np.isnan(rays.slopes[rays.weights == 0]).all()
    assert 0.05 < (rays.weights == 0).mean() < 0.9
    lens = mount_lens(camera)
    back = back_to(camera, rays, D_LINE_NM)
    assert not back.beyond_rim.any()
    assert (rays.weights > 0)[12, 12]  # the middle of the picture
    assert lens.f_stop == pytest.approx(2.1)


def test_in_focus_the_rays_of_a_pixel_meet() -> None:
    """In the plane of focus, near the axis, the spot of a real lens is small against that of another depth."""
    camera = prescribed(DOUBLE_GAUSS, 4.0)
    ideal = field(camera, 9)[2:7, 2:7] * 0.3
    samples = lens_samples(32, camera.iris, tiled=False).pupil[0]
    lens = lens_rays(camera, samples, (0.2, 0.2))
    rays = [lens.rays(i, ideal, D_LINE_NM) for i in range(len(samples))]
    spread = {}
    for depth in (2.0, 2.5):
        met = np.array([r.offsets + depth * r.slopes for r in rays])
        spread[depth] = float(np.sqrt(((met - met.mean(0)) ** 2).sum(-1).mean()))
    assert spread[2.0] < 3e-4  # m
    assert spread[2.5] > 4 * spread[2.0]


def test_the_picture_keeps_its_framing() -> None:
    """The chief ray of a pixel is the pinhole's but for distortion, focused near or far."""
    for distance in (1.0, 20.0):
        camera = replace(prescribed(DOUBLE_GAUSS, 4.0), focus_distance_m=distance)
        ideal = field(camera)[4:9, 4:9]
        rays = rays_of(camera, (0.0, 0.0), ideal)
        np.testing.assert_allclose(rays.slopes, ideal, atol=0.01 * np.abs(ideal).max())
        assert np.abs(rays.offsets).max() < 1e-4


def test_light_falls_with_the_fourth_power_of_the_cosine() -> None:
    """A thin glass with the stop inside, stopped down: nothing but the law is left, once; on the axis it is 1."""
    camera = replace(SINGLET, f_stop=16.0, focus_distance_m=0.0)
    ideal = field(camera)
    rays = rays_of(camera, (0.0, 0.0), ideal)
    cosine = 1 / np.sqrt(1 + (ideal**2).sum(-1))
    np.testing.assert_allclose(rays.weights, cosine**4, rtol=0.015)
    assert cosine.min() ** 4 < 0.75
    assert rays.weights[6, 6] == pytest.approx(1, abs=2e-3)


def test_a_white_field_is_white_in_the_middle_and_coloured_nowhere() -> None:
    scene = Scene(dome=Dome((1, 1, 1), np.eye(4)))
    picture = ray_by_ray_picture(scene, replace(SINGLET, f_stop=4.0), width=9, height=7, rays=16)
    np.testing.assert_allclose(picture[3, 4, :3], 1, atol=0.01)
    np.testing.assert_allclose(picture[..., :3] / picture[..., 1:2], 1, atol=0.01)
    assert picture[..., 3].max() == 0


def test_blue_is_bent_more_than_red() -> None:
    """A simple lens, focused at the d line, is sharp in blue for what is nearer and in red for what is farther away."""
    depth = {}
    for nm in (475.0, D_LINE_NM, 650.0):
        rays = rays_of(replace(SINGLET, f_stop=16.0), (0.7, 0.0), np.zeros((1, 1, 2)), nm)
        depth[nm] = float(-rays.offsets[0, 0, 0] / rays.slopes[0, 0, 0])
    assert depth[475.0] < depth[D_LINE_NM] < depth[650.0]
    assert depth[D_LINE_NM] == pytest.approx(3.0, rel=0.02)


def wavefront(errors: SeidelErrors, u: DoubleArray, eta: DoubleArray) -> float:
    """W in wavelengths, as `SeidelErrors` writes it, φ counted from the image point's direction."""
    rho, height = float(np.hypot(*u)), float(np.hypot(*eta))
    cosine = float(u @ eta) / (rho * height)
    terms = (
        errors.w040 * rho**4, errors.w131 * height * rho**3 * cosine, errors.w222 * (height * rho * cosine) ** 2,
        errors.w220 * (height * rho) ** 2, errors.w311 * height**3 * rho * cosine,
    )  # fmt: skip
    return sum(terms)


def test_seidel_rays_are_normal_to_the_wavefront() -> None:
    """The slope of a ray is off by the wavefront's derivative on the pupil, taken numerically, for each error and together."""
    kinds = ("w040", "w131", "w222", "w220", "w311")
    camera = replace(CAMERA, f_stop=2.0)
    ideal, point = np.array([[[0.11, -0.07]]]), np.array([0.4, 0.7])
    plain = rays_of(camera, tuple(point), ideal).slopes[0, 0]
    for errors in [SeidelErrors(**{kind: 7.0}) for kind in kinds] + [
        SeidelErrors(3, -2, 5, 4, -6, reference_height_mm=18)
    ]:
        reference_mm = 50 / (2 * errors.reference_f_stop)
        u = point * (50 / (2 * 2.0)) / reference_mm
        eta = -ideal[0, 0] * 50 / errors.reference_height_mm
        step = 1e-5
        ends = [[wavefront(errors, u + s * step * axis, eta) for s in (1, -1)] for axis in np.eye(2)]
        derivative = np.array([(a - b) / (2 * step) for a, b in ends]) * D_LINE_NM * 1e-6 / reference_mm
        found = rays_of(replace(camera, lens=Lens("seidel", seidel=errors)), tuple(point), ideal, 562.5).slopes[0, 0]
        np.testing.assert_allclose(found - plain, -derivative, rtol=1e-6)


def test_the_signs_of_seidels_errors() -> None:
    """Spherical aberration focuses the pupil's edge short, field curvature the field's, distortion is barrel-shaped; colours
    as `SeidelErrors` says them."""

    def depth_and_slope(errors: SeidelErrors, ideal: tuple[float, float], nm: float) -> tuple[float, float]:
        camera = replace(CAMERA, lens=Lens("seidel", seidel=errors))
        rays, chief = (rays_of(camera, point, np.array([[ideal]]), nm) for point in ((0.0, 1.0), (0.0, 0.0)))
        apart = rays.slopes[0, 0, 1] - chief.slopes[0, 0, 1]
        return float(-rays.offsets[0, 0, 1] / apart), float(chief.slopes[0, 0, 0])

    axis, corner = (0.0, 0.0), (0.3, 0.0)
    assert depth_and_slope(SeidelErrors(w040=5), axis, 562.5)[0] < 3.0
    assert depth_and_slope(SeidelErrors(w220=5), corner, 562.5)[0] < 3.0
    assert depth_and_slope(SeidelErrors(w311=5), corner, 562.5)[1] > 0.3  # the pixel sees farther out: barrel
    blue_long = SeidelErrors(axial_color_mm=0.2)
    assert depth_and_slope(blue_long, axis, 475.0)[0] > 3.0 > depth_and_slope(blue_long, axis, 650.0)[0]
    blue_large = SeidelErrors(lateral_color_mm=0.2)
    assert depth_and_slope(blue_large, corner, 475.0)[1] < 0.3 < depth_and_slope(blue_large, corner, 650.0)[1]


def test_axial_colour_is_as_long_as_it_says() -> None:
    """Blue and red focus 0.2 mm apart behind the lens: by f²·(1/d_red − 1/d_blue), for an object far off."""
    camera = replace(CAMERA, lens=Lens("seidel", seidel=SeidelErrors(axial_color_mm=0.2)))
    near = {}
    for nm in (475.0, 650.0):
        rays = rays_of(camera, (0.0, 0.5), np.zeros((1, 1, 2)), nm)
        near[nm] = -rays.slopes[0, 0, 1] / (1000 * rays.offsets[0, 0, 1])
    assert 50**2 * (near[650.0] - near[475.0]) == pytest.approx(0.2, rel=1e-6)


def test_a_height_map_on_a_lens_moves_the_picture_as_a_prism_does() -> None:
    """A wedge on the front, thicker toward +x, turns all rays by (n − 1)·angle: the picture shows what lies that much aside."""
    angle, side = 0.002, 65
    line = (np.arange(side) + 0.5) / side * 2 - 1
    lens = Lens(
        "heightField", prescription=BICONVEX, height_field=HeightField(front=np.tile(-angle * 8 * line, (side, 1)))
    )
    camera = replace(SINGLET, lens=lens, f_stop=8.0, focus_distance_m=0.0)
    plain = rays_of(replace(SINGLET, f_stop=8.0, focus_distance_m=0.0), (0.0, 0.0), np.zeros((1, 1, 2)))
    wedged = rays_of(camera, (0.0, 0.0), np.zeros((1, 1, 2)))
    scale = 50 / mount_lens(camera).first.focal_length_mm
    assert scale == pytest.approx(1)
    turned = wedged.slopes[0, 0] - plain.slopes[0, 0]
    assert abs(turned[0]) == pytest.approx(0.517 * angle, rel=0.05)
    assert turned[1] == pytest.approx(0, abs=1e-9)


def test_squeeze_narrows_the_pupil_and_its_errors() -> None:
    camera = replace(CAMERA, lens=Lens("thin", squeeze=2.0))
    lens = lens_rays(camera, np.array([[0.5, 0.5]]), (0.4, 0.4))
    rays = lens.rays(0, np.zeros((1, 1, 2)), D_LINE_NM)
    assert rays.offsets[0, 0, 1] == pytest.approx(2 * rays.offsets[0, 0, 0])
    assert rays.slopes[0, 0, 1] == pytest.approx(2 * rays.slopes[0, 0, 0])


def test_scaled_aberrations_of_real_glass_are_refused() -> None:
    scaled = replace(SINGLET, lens=replace(SINGLET.lens, scales=AberrationScales(coma=0.5)))
    with pytest.raises(SettingsError, match="as they are"):
        lens_rays(scaled, np.zeros((1, 2)), (0.4, 0.4))
