"""The independent tracer: against what optics proves in general, and against ray-optics, a public package, ray by ray."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from rayoptics.elem.profiles import EvenPolynomial, Spherical
from rayoptics.elem.surface import Surface as PublicSurface
from rayoptics.raytr.raytrace import trace_raw
from rayoptics.raytr.traceerror import TraceError

from render.errors import InputError
from render.lab.reference.lens_tracer import OPEN, refract, trace
from render.model.arrays import DoubleArray
from render.model.lens import AIR, Glass, Prescription, Surface
from render.optics.glass import D_LINE_NM, refractive_index
from tests.render.kits.lenses import DOUBLE_GAUSS, FISHEYE, SIX_LENSES, WIDE, KnownLens


def vertices(prescription: Prescription) -> DoubleArray:
    return np.concatenate([[0.0], np.cumsum([surface.thickness_mm for surface in prescription.surfaces[:-1]])])


def parallel_rays(heights_mm: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Rays along the axis, in the y-z plane."""
    origins = np.stack([np.zeros_like(heights_mm), heights_mm, np.full_like(heights_mm, -1.0)], 1)
    return origins, np.tile([0.0, 0.0, 1.0], (len(heights_mm), 1))


def rays_through_the_stop(known: KnownLens, count: int = 200) -> tuple[DoubleArray, DoubleArray]:
    """Skew rays from all over the field through all of the stop, on their way to the film: ``(n, 3)`` origins and directions.

    They are found from the stop outward, at the d line; what a rim blocks is left out.
    """
    surfaces, placed, rng = known.prescription.surfaces, vertices(known.prescription), np.random.default_rng(1)
    stop = next(i for i, surface in enumerate(surfaces) if surface.is_stop)
    radius = surfaces[stop].semi_diameter_mm * np.sqrt(rng.uniform(0, 1, 20000))
    turn = rng.uniform(0, 2 * np.pi, 20000)
    origins = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(20000, placed[stop])], 1)
    directions = np.concatenate([0.8 * rng.uniform(-1, 1, (20000, 2)) ** 3, np.ones((20000, 1))], 1)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    back = trace(surfaces[stop:], placed[stop:], D_LINE_NM, origins, directions, toward="film")
    front = trace(surfaces[:stop], placed[:stop], D_LINE_NM, origins, -directions, toward="scene")
    through = np.flatnonzero(back.passes & front.passes)[:count]
    return front.positions[through] + 10 * front.directions[through], -front.directions[through]


def publicly_traced(
    prescription: Prescription, film_mm: float, wavelength_nm: float, origins: DoubleArray, directions: DoubleArray
) -> DoubleArray:
    """``(n, 2)`` on the film by ray-optics, NaN where it finds no way through; it has no rims here."""
    turn, surfaces, placed = np.eye(3), prescription.surfaces, [*vertices(prescription), film_mm]
    index = 1.0
    path = []
    for surface, gap in zip(surfaces, np.diff(placed), strict=True):
        path.append([public_surface(surface), None, (turn, np.array([0.0, 0, gap])), None, 1.0])
        path[-1][3] = refractive_index(surface.glass, wavelength_nm)
    start = [PublicSurface(interact_mode="dummy"), None, (turn, np.zeros(3)), index, 1.0]
    path = [start, *path, [PublicSurface(interact_mode="dummy"), None, None, 1.0, 1.0]]
    found = np.full((len(origins), 2), np.nan)
    for i, (origin, direction) in enumerate(zip(origins, directions, strict=True)):
        try:
            ray, _, _ = trace_raw(iter(path), origin, direction, wavelength_nm)
        except TraceError:
            continue
        found[i] = ray[-1][0][:2]
    return found


def public_surface(surface: Surface) -> PublicSurface:
    if not surface.aspheric:
        assert surface.conic == 0
        return PublicSurface(profile=Spherical(r=surface.radius_mm))
    coefficients = [0.0, *surface.aspheric] + [0.0] * (9 - len(surface.aspheric))
    profile = EvenPolynomial(r=surface.radius_mm, cc=surface.conic, coefs=coefficients)
    profile.update()
    return PublicSurface(profile=profile)


@pytest.mark.parametrize("wavelength_nm", [475.0, D_LINE_NM, 650.0])
@pytest.mark.parametrize("known", SIX_LENSES, ids=lambda known: known.prescription.name)
def test_a_public_package_finds_the_same_rays_on_the_film(known: KnownLens, wavelength_nm: float) -> None:
    """Each of the six lenses, dispersing where its glasses are known, rays from the whole field: the same to rounding."""
    origins, directions = rays_through_the_stop(known)
    placed = vertices(known.prescription)
    film = float(placed[-1]) + known.back_focal_mm
    ours = trace(known.prescription.surfaces, placed, wavelength_nm, origins, directions, toward="film")
    theirs = publicly_traced(known.prescription, film, wavelength_nm, origins, directions)
    landed = ours.at(film)[ours.passes]
    assert len(landed) > 0.9 * len(origins) > 100
    assert np.hypot(*landed.T).max() > 0.7 * known.field_mm
    assert np.abs(landed - theirs[ours.passes]).max() < 1e-9  # mm


@pytest.mark.parametrize("known", [DOUBLE_GAUSS, WIDE, FISHEYE], ids=lambda known: known.prescription.name)
def test_light_goes_back_the_way_it_came(known: KnownLens) -> None:
    surfaces, placed = known.prescription.surfaces, vertices(known.prescription)
    origins, directions = rays_through_the_stop(known)
    there = trace(surfaces, placed, D_LINE_NM, origins, directions, toward="film")
    back = trace(surfaces, placed, D_LINE_NM, there.positions, -there.directions, toward="scene")
    assert there.passes.all()
    assert back.passes.all()
    np.testing.assert_allclose(back.directions, -directions, atol=1e-12)
    before = origins[:, :2] + (back.positions[:, 2:] - origins[:, 2:]) * directions[:, :2] / directions[:, 2:]
    np.testing.assert_allclose(back.positions[:, :2], before, atol=1e-10)


@given(
    st.floats(0.2, np.pi - 0.2),
    st.floats(0, 2 * np.pi),
    st.floats(0, np.pi / 2),
    st.floats(1.0, 2.0),
    st.floats(1.0, 2.0),
)
@example(1.0, 2.5, 1.5707963267948963, 1.0, 1.0)  # grazes the surface: rounding decides whether it passes
def test_refraction_obeys_snells_law(tilt: float, turn: float, incidence: float, n_in: float, n_out: float) -> None:
    """n·sin θ stays, the ray stays in the plane of incidence and on its side; beyond the critical angle nothing passes."""
    normal = np.array([[np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)]])
    side = np.cross(normal, [[0.3, -0.4, 0.1]])
    side /= np.linalg.norm(side)
    ray = np.cos(incidence) * normal + np.sin(incidence) * side
    columns, reflected = refract(ray.T, normal.T, n_in / n_out)
    bent = columns.T
    beyond_critical = n_in * np.sin(incidence) - n_out
    assert reflected[0] == (beyond_critical > 0) or abs(beyond_critical) < 1e-12
    if not reflected[0]:
        assert np.linalg.norm(bent) == pytest.approx(1, abs=1e-12)
        assert n_out * float((bent * side).sum()) == pytest.approx(n_in * np.sin(incidence), abs=1e-12)
        assert (bent * normal).sum() >= -1e-12
        assert float((bent * np.cross(normal, side)).sum()) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("radius_mm", [25.0, -25.0])
def test_one_sphere_is_met_where_geometry_says(radius_mm: float) -> None:
    """The distance from the sphere's centre is its radius, on the side of the vertex, also for steep rays."""
    slopes = np.linspace(-1.5, 1.5, 31)
    origins = np.tile([0.0, 3.0, 4.0 * np.sign(radius_mm)], (31, 1)) - 20 * np.stack(
        [0 * slopes, slopes, 0 * slopes + 1], 1
    )
    directions = np.stack([0 * slopes, slopes, np.ones(31)], 1) / np.hypot(1, slopes)[:, None]
    glass = Surface(radius_mm, 0, Glass(1.5), semi_diameter_mm=20)
    rays = trace([glass], np.zeros(1), D_LINE_NM, origins, directions, toward="film", clip=False)
    hit = np.abs(rays.positions[:, 1]) < 20
    assert hit.sum() > 15
    centre = np.array([0, 0, radius_mm])
    np.testing.assert_allclose(np.linalg.norm(rays.positions - centre, axis=1)[hit], 25, rtol=1e-12)
    assert (np.abs(rays.positions[hit, 2]) < 25).all()


def test_an_ellipsoid_focuses_parallel_light_in_one_point() -> None:
    """Descartes 1637: with K = −1/n² the sphere's aberration is gone, however wide the beam (Welford 1986, section 4.6)."""
    n, radius = 1.5, 20.0
    surface = Surface(radius, 0, Glass(n), semi_diameter_mm=14, conic=-1 / n**2)
    origins, directions = parallel_rays(np.linspace(-13.9, 13.9, 57))
    rays = trace([surface], np.zeros(1), D_LINE_NM, origins, directions, toward="film")
    assert rays.passes.all()
    assert np.abs(rays.at(n * radius / (n - 1))).max() < 1e-11


def test_aspheric_terms_are_those_of_the_series() -> None:
    """A parabola is a sphere of its radius with the difference of the two written as a series in r⁴, r⁶, ..."""
    radius = 40.0
    series = (-1 / (8 * radius**3), -1 / (16 * radius**5), -5 / (128 * radius**7), -7 / (256 * radius**9))
    origins, directions = parallel_rays(np.linspace(-4, 4, 33))
    parabola = Surface(radius, 0, Glass(1.6), semi_diameter_mm=5, conic=-1)
    written = Surface(radius, 0, Glass(1.6), semi_diameter_mm=5, aspheric=series)
    found = [
        trace([s], np.zeros(1), D_LINE_NM, origins, directions, toward="film").at(100) for s in (parabola, written)
    ]
    np.testing.assert_allclose(found[0], found[1], atol=1e-10)
    assert np.abs(found[0]).max() > 0.1


def test_spherical_aberration_grows_with_the_cube_of_the_height() -> None:
    surface = Surface(20.0, 0, Glass(1.5), semi_diameter_mm=10)
    origins, directions = parallel_rays(np.array([0.25, 0.5, 1.0]))
    off = trace([surface], np.zeros(1), D_LINE_NM, origins, directions, toward="film").at(60.0)[:, 1]
    np.testing.assert_allclose(off[1:] / off[:-1], 8, rtol=0.02)


def test_rays_are_blocked_by_the_surface_that_blocks_them() -> None:
    """Front rim, closed iris, total reflection: each is told by its number, and the ray stands where it was stopped."""
    slab = (
        Surface(0, 10, Glass(1.5), 10),
        Surface(0, 5, AIR, 4, is_stop=True),
        Surface(-6, 3, Glass(1.5), 5.9),
        Surface(0, 1),
    )
    placed = np.array([0.0, 10, 15, 18])
    origins, directions = parallel_rays(np.array([0.0, 3.9, 4.1, 9.9, 10.1]))
    rays = trace(slab, placed, D_LINE_NM, origins, directions, toward="film")
    assert rays.blocked_at.tolist() == [OPEN, OPEN, 1, 1, 0]
    np.testing.assert_allclose(rays.positions[2:, 2], [10, 10, 0])
    assert np.isnan(rays.at(30.0)[2:]).all()
    closed = [replace(s, semi_diameter_mm=3.0) if s.is_stop else s for s in slab]
    assert trace(closed, placed, D_LINE_NM, origins, directions, toward="film").blocked_at.tolist() == [
        OPEN,
        1,
        1,
        1,
        0,
    ]
    steep = Surface(-6, 0, AIR, 5.9)  # a ball's back, met from inside: sin θ = 5/6 > 1/1.5
    origins, directions = parallel_rays(np.array([3.0, 5.0]))
    glass = trace([steep], np.zeros(1), D_LINE_NM, origins, directions, toward="film", medium=Glass(1.5))
    assert glass.blocked_at.tolist() == [OPEN, 0]


def test_glass_disperses() -> None:
    """A prism's worth of glass: blue is bent more than red, by the indices' ratio for a small angle."""
    crown = Glass(1.6, 40)
    surface = Surface(50, 0, crown, 20)
    origins, directions = parallel_rays(np.array([1.0]))
    slope = {
        nm: trace([surface], np.zeros(1), nm, origins, directions, toward="film").directions[0, 1]
        for nm in (475.0, 650.0)
    }
    n = {nm: refractive_index(crown, nm) for nm in slope}
    assert slope[475.0] < slope[650.0] < 0
    assert slope[475.0] / slope[650.0] == pytest.approx((1 - 1 / n[475.0]) / (1 - 1 / n[650.0]), rel=1e-3)


def test_a_height_map_of_a_paraboloid_is_the_paraboloid() -> None:
    """A plane with the map r²/2R is the surface with radius R and K = −1, as far as the texels are fine."""
    half, side, radius = 10.0, 512, 60.0
    line = ((np.arange(side) + 0.5) / side * 2 - 1) * half
    heights = (line[None, :] ** 2 + line[:, None] ** 2) / (2 * radius)
    mapped = Surface(0, 0, Glass(1.5), half)
    smooth = Surface(radius, 0, Glass(1.5), half, conic=-1)
    rng = np.random.default_rng(2)
    origins = np.concatenate([rng.uniform(-6, 6, (200, 2)), np.full((200, 1), -1.0)], 1)
    directions = np.concatenate([rng.uniform(-0.2, 0.2, (200, 2)), np.ones((200, 1))], 1)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    film = 3 * radius
    found = trace([mapped], np.zeros(1), D_LINE_NM, origins, directions, toward="film", heights=[heights]).at(film)
    wanted = trace([smooth], np.zeros(1), D_LINE_NM, origins, directions, toward="film").at(film)
    np.testing.assert_allclose(found, wanted, atol=2e-4)


def test_a_height_maps_first_row_is_the_top_and_first_column_minus_x() -> None:
    """Glass that grows thicker to one side is a prism: it bends rays to its base."""
    ramp = np.linspace(-0.5, 0.5, 65)
    prism = Surface(0, 0, AIR, 10)
    bent = {}
    for name, heights in (("x", np.tile(ramp, (65, 1))), ("y", np.tile(ramp[:, None], (1, 65)))):
        origins, directions = parallel_rays(np.zeros(1))
        rays = trace(
            [prism], np.zeros(1), D_LINE_NM, origins, directions, toward="film", medium=Glass(1.5), heights=[heights]
        )
        bent[name] = rays.directions[0]
    assert bent["x"][0] > 0  # thicker at +x
    assert bent["x"][1] == pytest.approx(0)
    assert bent["y"][1] < 0  # thicker at the bottom
    assert bent["y"][0] == pytest.approx(0)


def test_a_height_map_needs_a_clear_diameter() -> None:
    origins, directions = parallel_rays(np.zeros(1))
    with pytest.raises(InputError, match="surface 1 has a height map"):
        trace([Surface(0, 0)], np.zeros(1), D_LINE_NM, origins, directions, toward="film", heights=[np.zeros((2, 2))])
