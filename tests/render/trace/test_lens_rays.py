"""Rays that the device traces through lenses, and the tables fitted to them, against the independent float64 tracer."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.lab.reference.lens_tracer import trace as trace_slowly
from render.model.arrays import DoubleArray
from render.model.lens import AberrationScales, Glass, HeightField, Prescription, Surface
from render.optics.glass import D_LINE_NM
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import FocusedLens, focus_lens
from render.optics.prescription.stop_rays import rays_from_film
from render.trace.lens_fit import FULL, even_basis, odd_basis, slope_errors
from render.trace.lens_table import PUPIL_S, PUPIL_T, SLOPE_T, WEIGHT, PolynomialTable
from render.trace.prescription_table import FILM_ERROR_MM, make_prescription_table
from render.trace.surface_tracer import SurfaceTracer
from tests.render.kits.lenses import DISTAGON, DOUBLE_GAUSS, FISHEYE, PLANAR, SIX_LENSES, TELEPHOTO, WIDE, KnownLens

LINES_NM = (650.0, D_LINE_NM, 475.0)
FOCUS_M = 3.0


@pytest.fixture(scope="module")
def tracer() -> Iterator[SurfaceTracer]:
    graphics = GraphicsContext()
    graphics.make_current()
    yield SurfaceTracer(graphics.ctx, ProgramCache(graphics.ctx))
    graphics.close()


def lens_of(known: KnownLens) -> FocusedLens:
    return focus_lens(complete_prescription(known.prescription, image_height_mm=known.field_mm), FOCUS_M, known.f_stop)


def some_rays(known: KnownLens, lens: FocusedLens, seed: int = 0) -> tuple[DoubleArray, DoubleArray]:
    """Film and stop points over two thirds of the field and all of the stop."""
    rng = np.random.default_rng(seed)
    radius, angle = np.sqrt(rng.random(400)) * lens.stop_radius_mm, 2 * np.pi * rng.random(400)
    film = rng.uniform(-0.47, 0.47, (400, 2)) * known.field_mm
    return film, np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


@pytest.mark.parametrize("known", SIX_LENSES, ids=lambda known: known.prescription.name)
def test_rays_arrive_on_the_film_where_the_float64_tracer_has_them(tracer: SurfaceTracer, known: KnownLens) -> None:
    """The ray that leaves the lens is sent back through it by the reference: it must land where it came from, to 1e-4 mm."""
    lens = lens_of(known)
    film, stop = some_rays(known, lens)
    traced = tracer.trace(lens, film, stop, LINES_NM)
    for part, wavelength in enumerate(LINES_NM):
        is_open = traced.passed[part] & (traced.front[part] <= 0) & (traced.rear[part] <= 0)
        assert is_open.sum() > 100
        slope, pupil = traced.slope[part][is_open], traced.pupil_mm[part][is_open]
        origins = np.column_stack([pupil, np.full(len(pupil), lens.entrance_pupil_mm)])
        back = 200.0  # mm toward the scene: before all glass
        origins[:, :2] += slope * back
        origins[:, 2] -= back
        directions = np.column_stack([-slope, np.ones(len(slope))])
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        landed = trace_slowly(
            lens.prescription.surfaces, lens.vertices_mm, wavelength, origins, directions, toward="film", clip=False
        ).at(lens.film_mm)
        np.testing.assert_allclose(landed, film[is_open], atol=1e-4)


def test_rays_meet_heights_up_to_the_rim_whatever_side_is_low(tracer: SurfaceTracer) -> None:
    """A wedge on the front surface: it stands higher at its thick rim than at the thin one, where the slab is measured."""
    surfaces = (
        Surface(30.0, 6.0, Glass(1.5), 8.4),
        Surface(-200.0, 2.0, semi_diameter_mm=8.4),
        Surface(0, 0, is_stop=True),
    )
    lens = focus_lens(complete_prescription(Prescription(surfaces, f_stop=3.2)), FOCUS_M, 3.2)
    wedge = np.tile(np.linspace(0.2, -0.2, 65), (65, 1))
    stop = np.stack([np.linspace(-1, 1, 81), np.zeros(81)], axis=1) * lens.stop_radius_mm
    film = np.zeros_like(stop)
    traced = tracer.trace(lens, film, stop, (D_LINE_NM,), HeightField(front=wedge))
    is_open = traced.passed[0] & (traced.front[0] <= 0)
    assert is_open.sum() > 70
    slope, pupil = traced.slope[0][is_open], traced.pupil_mm[0][is_open]
    origins = np.column_stack([pupil - slope * -50.0, np.full(len(pupil), lens.entrance_pupil_mm - 50.0)])
    directions = np.column_stack([-slope, np.ones(len(slope))])
    landed = trace_slowly(
        lens.prescription.surfaces,
        lens.vertices_mm,
        D_LINE_NM,
        origins,
        directions / np.linalg.norm(directions, axis=1, keepdims=True),
        toward="film",
        clip=False,
        heights=[wedge, None, None],
    ).at(lens.film_mm)
    np.testing.assert_allclose(landed, film[is_open], atol=2e-3)


def test_rays_pass_the_stop_where_they_were_aimed(tracer: SurfaceTracer) -> None:
    lens = lens_of(DOUBLE_GAUSS)
    film, stop = some_rays(DOUBLE_GAUSS, lens)
    traced = tracer.trace(lens, film, stop, (D_LINE_NM,))
    rear = lens.prescription.surfaces[lens.stop + 1 :]
    # from the stop point, the reference must find the film point: aim by the slope between them is unknown, so go from the scene
    slope, pupil = traced.slope[0], traced.pupil_mm[0]
    origins = np.column_stack([pupil + 200 * slope, np.full(len(pupil), lens.entrance_pupil_mm - 200)])
    directions = np.column_stack([-slope, np.ones(len(slope))])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    front = lens.prescription.surfaces[: lens.stop]
    at_stop = trace_slowly(
        front, lens.vertices_mm[: lens.stop], D_LINE_NM, origins, directions, toward="film", clip=False
    ).at(float(lens.vertices_mm[lens.stop]))
    assert len(rear) + len(front) + 1 == len(lens.prescription.surfaces)
    np.testing.assert_allclose(at_stop, stop, atol=2e-4)


@pytest.mark.parametrize("known", SIX_LENSES, ids=lambda known: known.prescription.name)
def test_the_rim_of_the_iris_is_that_of_the_f_numbers_beam(tracer: SurfaceTracer, known: KnownLens) -> None:
    """On the device and in float64, the ray by the iris's rim enters at ``f / (2·N)``, but for spherical aberration's tilt."""
    f_stop = 1.5 * known.f_stop
    lens = focus_lens(complete_prescription(known.prescription), np.inf, f_stop)
    film, rim = np.zeros((1, 2)), np.array([[0.0, lens.stop_radius_mm]])
    on_device = np.abs(tracer.trace(lens, film, rim, (D_LINE_NM,)).pupil_mm[0, 0, 1])
    in_float64 = np.abs(rays_from_film(lens, film, rim / lens.stop_radius_mm).pupil_mm[0, 1])
    assert on_device == pytest.approx(in_float64, rel=1e-4)
    assert on_device == pytest.approx(lens.first.focal_length_mm / (2 * f_stop), rel=5e-3)
    assert on_device == pytest.approx(lens.entrance_pupil_radius_mm, rel=5e-3)


@pytest.mark.parametrize("known", SIX_LENSES, ids=lambda known: known.prescription.name)
def test_the_fitted_table_holds_the_rays_between_its_nodes(tracer: SurfaceTracer, known: KnownLens) -> None:
    """Wide open, the error on the film is that which the table states: at most 4 µm, of pixels of 19 µm (36 mm over 1920)."""
    lens = lens_of(known)
    last_slope, focus_w = 0.75 * known.field_mm / lens.image_scale_mm, 1 / FOCUS_M
    table = make_prescription_table(tracer, lens, last_slope, focus_w, (D_LINE_NM,), AberrationScales())
    rng = np.random.default_rng(1)
    errors_um, pupil_errors_mm = [], []
    for height in rng.uniform(0, last_slope, 12):
        row = row_at(table, height)
        disc = rng.uniform(-1, 1, (200, 2))
        disc = disc[np.hypot(*disc.T) < 1]
        stop = np.stack([row[79] + row[80] * disc[:, 0], row[81] * disc[:, 1]], axis=1) * lens.stop_radius_mm
        film = np.tile([-height * lens.image_scale_mm, 0.0], (len(disc), 1))
        traced = tracer.trace(lens, film, stop, (D_LINE_NM,))
        is_open = traced.passed[0] & (traced.front[0] <= 0) & (traced.rear[0] <= 0)
        is_open &= np.hypot(*stop.T) <= lens.stop_radius_mm
        slope = slope_errors(row[None], disc, table.slope_degree)[0]
        pupil = np.stack(
            [even_basis(disc, 5) @ row[PUPIL_T:PUPIL_S], odd_basis(disc, 5) @ row[PUPIL_S : PUPIL_S + 9]], axis=1
        )
        expected = traced.slope[0] + traced.pupil_mm[0] / 1000 * focus_w - [height, 0.0]
        errors_um.append(np.hypot(*(slope - expected)[is_open].T).max(initial=0) * lens.image_scale_mm * 1000)
        pupil_errors_mm.append(np.abs(pupil * 1000 - traced.pupil_mm[0])[is_open].max(initial=0))
    stretch = 2.2 if known is FISHEYE else 1.2  # slope in object space per slope of the ideal lens
    assert np.max(errors_um) < 1.4 * 1000 * FILM_ERROR_MM * stretch
    assert 0 < table.film_error_mm <= FILM_ERROR_MM
    if known in (DISTAGON, PLANAR):
        assert table.slope_degree > FULL.slope
    assert np.max(pupil_errors_mm) < 2e-3 * lens.entrance_pupil_radius_mm


@pytest.mark.parametrize("known", [WIDE, TELEPHOTO], ids=lambda known: known.prescription.name)
def test_the_corner_darkens_by_the_fourth_power_of_the_cosine(tracer: SurfaceTracer, known: KnownLens) -> None:
    """A tiny stop, nothing clipped: light falls as cos⁴ of the ray's angle at the film times the pupil's own change (Reiss
    1945); and whatever the lens, as the cos⁴ law of its object side times the stretch of its image."""
    lens = focus_lens(complete_prescription(known.prescription, image_height_mm=known.field_mm), np.inf, 64.0)
    last_slope = 0.9 * known.field_mm / lens.image_scale_mm
    table = make_prescription_table(tracer, lens, last_slope, 0.0, (D_LINE_NM,), AberrationScales())
    heights = np.linspace(0, last_slope, table.rows.shape[1])
    slope = heights + table.rows[0, :, SLOPE_T]
    # étendue: film area x projected solid angle = projected pupil area x object solid angle; the pupil's area from its rays
    pupil_area = np.array([row[PUPIL_T + 1] * row[PUPIL_S] for row in table.rows[0].astype(np.float64)])
    object_side = pupil_area / pupil_area[0] * (1 + slope**2) ** -2
    stretch = np.gradient(slope, heights) * np.where(heights > 0, slope / np.maximum(heights, 1e-12), 1.0)
    expected = object_side * stretch
    np.testing.assert_allclose(table.rows[0, 1:-1, WEIGHT], expected[1:-1], rtol=0.01)


def row_at(table: PolynomialTable, height: float) -> DoubleArray:
    at = height / table.last_slope * (table.rows.shape[1] - 1)
    index = min(int(at), table.rows.shape[1] - 2)
    rows = table.rows[0].astype(np.float64)
    return np.asarray(rows[index] + (at - index) * (rows[index + 1] - rows[index]))
