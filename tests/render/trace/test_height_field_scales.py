"""Factors on the errors of a lens with height fields: each takes its own kind away, and leaves what the heights do alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.arrays import DoubleArray
from render.model.lens import AberrationScales, Glass, HeightField, Prescription, Surface
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import focus_lens
from render.trace.grid_table import make_grid_table
from render.trace.lens_table import GridTable
from render.trace.surface_tracer import SurfaceTracer

pytestmark = pytest.mark.gl

GLASS = Glass(1.5168, 64.17)
LENS = Prescription(  # the stop stands well before the glass: errors of every kind, distortion too
    (
        Surface(0.0, 8.0, semi_diameter_mm=7.0, is_stop=True),
        Surface(51.0, 6.0, GLASS, 13.0),
        Surface(-51.0, 0.0, semi_diameter_mm=13.0),
    ),
    f_stop=4.0,
    name="singlet behind its stop",
)
FOCUS_M, LAST_SLOPE = 3.0, 0.2
LINES_NM = (650.0, 475.0)
FIELDS, PUPIL_SIDE = 5, 24  # coarser than for pictures, which says the same
FLAT = HeightField()
MIDDLE, CORNER = FIELDS * FIELDS // 2, 0

Make = Callable[..., GridTable]


@pytest.fixture(scope="module")
def make() -> Iterator[Make]:
    """Makes tables of the lens with factors and, if asked for, heights; each once."""
    graphics = GraphicsContext()
    graphics.make_current()
    tracer = SurfaceTracer(graphics.ctx, ProgramCache(graphics.ctx))
    lens = focus_lens(complete_prescription(LENS, image_height_mm=12.0), FOCUS_M, 4.0)
    made: dict[tuple[int, AberrationScales], GridTable] = {}

    def table(heights: HeightField = FLAT, **factors: float) -> GridTable:
        scales = AberrationScales(**factors)
        key = id(heights), scales
        if key not in made:
            made[key] = make_grid_table(
                tracer,
                lens,
                heights,
                LAST_SLOPE,
                1 / FOCUS_M,
                LINES_NM,
                scales,
                fields_across=FIELDS,
                pupil_side=PUPIL_SIDE,
            )
        return made[key]

    yield table
    graphics.close()


def errors(table: GridTable) -> DoubleArray:
    """``(k, fields, side, side, 2)`` slope errors within the stop, nan elsewhere."""
    line = np.linspace(-1, 1, PUPIL_SIDE)
    on_disc = np.hypot(*np.meshgrid(line, line)) <= 1
    return np.where(on_disc[..., None], table.rays[..., :2].astype(np.float64), np.nan)


def even_part(error: DoubleArray) -> DoubleArray:
    """Return the even part of errors over the pupil: distortion and coma. The other errors are odd."""
    return (error + error[..., ::-1, ::-1, :]) / 2


def odd_part(error: DoubleArray) -> DoubleArray:
    return (error - error[..., ::-1, ::-1, :]) / 2


def size(error: DoubleArray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.nanmean(error**2)))


def test_without_shape_errors_all_rays_of_a_field_meet_in_a_point(make: Make) -> None:
    own = errors(make())
    none = errors(make(spherical=0, coma=0, astigmatism=0, field_curvature=0, distortion=0))
    assert size(none[0]) < 0.01 * size(own[0])
    assert size(none[1]) < 0.01 * size(own[1])


def test_coma_and_distortion_are_even_and_the_other_errors_odd(make: Make) -> None:
    own = errors(make())
    symmetric = errors(make(coma=0, distortion=0))
    assert size(even_part(symmetric)) < 0.01 * size(even_part(own))
    assert size(odd_part(symmetric) - odd_part(own)) < 0.001 * size(odd_part(own))
    rest = errors(make(spherical=0, astigmatism=0, field_curvature=0))
    assert size(odd_part(rest)) < 0.01 * size(odd_part(own))
    assert size(even_part(rest) - even_part(own)) < 0.001 * size(even_part(own))


def test_spherical_aberration_is_the_same_over_the_whole_field(make: Make) -> None:
    change = errors(make(spherical=3)) - errors(make())
    own = errors(make())[:, MIDDLE]
    assert size(change[:, MIDDLE] - 2 * own) < 0.01 * size(own)
    assert size(odd_part(change[:, CORNER]) - change[:, MIDDLE]) < 0.3 * size(change[:, MIDDLE])


def test_distortion_moves_a_field_as_a_whole_along_its_radius(make: Make) -> None:
    change = errors(make()) - errors(make(distortion=0))
    moved = np.nanmean(change[0], axis=(1, 2))
    assert size(change[0] - moved[:, None, None]) < 1e-3 * size(moved)
    x, y = moved[CORNER]
    assert x == pytest.approx(y, rel=1e-3)
    assert size(moved[CORNER]) > 1e-3
    assert size(moved[MIDDLE]) < 1e-3 * size(moved[CORNER])


def test_colour_errors_are_the_spread_of_the_wavelengths(make: Make) -> None:
    spread = errors(make())[0] - errors(make())[1]
    assert size(spread) > 1e-4
    none, double = errors(make(chromatic=0)), errors(make(chromatic=2))
    np.testing.assert_array_equal(none[0], none[1])
    assert size(double[0] - double[1] - 2 * spread) < 1e-3 * size(spread)


def test_without_vignetting_all_fields_have_the_light_of_the_middle(make: Make) -> None:
    def light(table: GridTable) -> DoubleArray:
        weight, clearance = np.moveaxis(table.light[0].astype(np.float64), -1, 0)
        within = ~np.isnan(errors(table)[0, ..., 0])
        return np.asarray(np.where((clearance <= 0) & within, weight, 0).sum((1, 2)) / within.sum((1, 2)))

    own, even = light(make()), light(make(vignetting=0))
    assert own[MIDDLE] == pytest.approx(1, rel=1e-4)
    assert own[CORNER] < 0.96  # cos⁴ at the least
    np.testing.assert_allclose(even, 1, rtol=1e-4)


def test_what_heights_do_stays_whatever_the_factors(make: Make) -> None:
    wedge = HeightField(front=np.tile(np.linspace(-0.05, 0.05, 16), (16, 1)))
    factors = {"spherical": 2.0, "coma": 0.0, "distortion": 3.0}
    wedged = errors(make(wedge)) - errors(make())
    assert size(wedged) > 1e-3
    scaled = errors(make(wedge, **factors)) - errors(make(**factors))
    assert size(scaled - wedged) < 1e-3 * size(wedged)
