"""Illumination and bokeh of the sheet against dense rays of the independent float64 tracer, which knows no pupil."""

from __future__ import annotations

import numpy as np
import pytest

from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.mounting import mount_lens
from render.optics.report.field import relative_light
from render.optics.report.film_rays import FilmRays
from render.optics.report.lens_report import film_rays
from render.shot.lens.lens_alone import lens_alone
from tests.render.kits.exact_rays import exact_light, grid, trace
from usd_schemas import library_lenses

GATE = (36.0, 24.0)
CORNER_MM = float(np.hypot(*GATE)) / 2
_WITHOUT_SURFACES = ("pinhole", "thin", "seidel", "dataSheet")
_CYLINDERS = "anamorphic_75_2x"  # heights are measured toward the corner: test_cylinder_report
LENSES = [
    entry.name for entry in library_lenses() if entry.lens.model not in _WITHOUT_SURFACES and entry.name != _CYLINDERS
]
STEEP = ("hologon_15", "fisheye_10", "canon_fisheye_15")
"""Lenses that see more than 45 degrees off the axis: the tracer here begins on planes and misses some of their rays."""
SMALL = ("petzval_50",)
"""Lenses whose image circle ends before the gate's edge."""


def glass(name: str, focus_m: float | None = None) -> tuple[FocusedLens, FilmRays]:
    camera = lens_alone(name).set_to(None, focus_m, GATE)
    return mount_lens(camera), film_rays(camera)


@pytest.mark.parametrize("name", [name for name in LENSES if name != "hologon_15"])
def test_illumination_is_what_dense_exact_rays_say(name: str) -> None:
    """Within 0.6 % of the axis at four heights; polynomials through the pupil were off by up to 13 %."""
    lens, rays = glass(name)
    heights = np.array([0.25, 0.5, 0.75, 1.0]) * min(CORNER_MM, 0.98 * rays.last_height_mm)
    exact = np.array([exact_light(lens, float(height)) for height in (0.0, *heights)])
    np.testing.assert_allclose(relative_light(rays, heights), exact[1:] / exact[0], atol=6e-3)


@pytest.mark.parametrize("name", [name for name in LENSES if name not in (*STEEP, *SMALL)])
def test_bokeh_is_what_dense_exact_rays_say(name: str) -> None:
    """The area of the beam from infinity, and the extent of its light on the film, at the gate's right edge."""
    lens, rays = glass(name, 3.0)
    place = np.array([[GATE[0] / 2, 0.0]])
    found = rays.distant_beams(place, 160, D_LINE_NM).beams
    landing = found.landing_mm[0][found.open[0]]
    slope = float(rays.seen(np.array([GATE[0] / 2]))[0])
    front, reach = float(lens.vertices_mm[0]), 1.5 * lens.prescription.surfaces[0].semi_diameter_mm
    box = np.array([[-reach, -reach], [reach, reach]])
    for _ in range(2):
        points, step = grid(box)
        heading = np.tile([-slope, 0.0, 1.0], (len(points), 1))
        start = np.column_stack([points, np.full(len(points), front)]) - 60.0 * heading  # before all glass
        traced = trace(lens, start, heading, "film")
        box = np.array([points[traced.passes].min(axis=0) - 2 * step, points[traced.passes].max(axis=0) + 2 * step])
    exact = -traced.at(lens.film_mm)[traced.passes]
    axis = rays.distant_beams(np.zeros((1, 2)), 160, D_LINE_NM).beams
    cos4 = (1 + slope**2) ** -2.0
    area = float(found.light[0][found.open[0]].sum() / 160**2)
    on_axis = float(axis.light[0][axis.open[0]].sum() / 160**2)
    unit = on_axis / (np.pi * (exact_axis_radius(lens)) ** 2)  # area in slopes over area on the film, on the axis
    stretch = slope_stretch(rays) / unit_stretch(rays)
    assert area / unit == pytest.approx(traced.passes.sum() * step.prod() * cos4 * stretch, rel=0.01)
    np.testing.assert_allclose(landing.std(axis=0), exact.std(axis=0), rtol=0.01)
    np.testing.assert_allclose(landing.mean(axis=0), exact.mean(axis=0), atol=0.01 * float(exact.std(axis=0).max()))


def exact_axis_radius(lens: FocusedLens) -> float:
    """Half the width of the beam from infinity on the axis."""
    points = np.column_stack(
        [np.linspace(0, 1.5 * lens.prescription.surfaces[0].semi_diameter_mm, 4001), np.zeros(4001)]
    )
    heading = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    traced = trace(lens, np.column_stack([points, np.full(len(points), lens.vertices_mm[0] - 60.0)]), heading, "film")
    return float(points[traced.passes, 0].max())


def slope_stretch(rays: FilmRays) -> float:
    """Area in slopes over area on the film at the gate's right edge, from differences."""
    heights = GATE[0] / 2 + np.array([-0.5, 0.0, 0.5])
    low, middle, high = rays.seen(heights)
    return float(middle / heights[1] * (high - low))


def unit_stretch(rays: FilmRays) -> float:
    return float(rays.seen(np.array([0.5]))[0] / 0.5) ** 2
