"""Lenses with openings and obscurations on the device, and their pictures, against float64 rays and closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import Across, Glass, Lens, Outline, Prescription, Surface
from render.model.scene import Dome, Scene
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import focus_lens
from render.optics.prescription.outlines import polygon, spider, without_outlines
from render.optics.prescription.stop_rays import rays_from_film
from render.optics.report.film_cone import film_cone
from render.trace.surface_tracer import SurfaceTracer
from tests.render.kits.lens_pictures import glowing_point, spot_size

pytestmark = pytest.mark.gl

GLASS = Glass(1.6, 60.0)
WHITE = Scene((), (), Dome((1.0, 1.0, 1.0), np.eye(4)), ())
STOP_MM = 6.0
CIRCLE = Outline("ellipse", (3.0, 3.0))


def outlined(opening: Outline | None = None, obscuration: Outline | None = None, *, at: int = 2) -> Prescription:
    """A symmetric lens with outlines on one of its surfaces; 2 is the stop."""
    surfaces = [
        Surface(60.0, 5.0, GLASS, 14.0),
        Surface(-300.0, 6.0, semi_diameter_mm=14.0),
        Surface(0.0, 6.0, semi_diameter_mm=STOP_MM, is_stop=True),
        Surface(300.0, 5.0, GLASS, 14.0),
        Surface(-60.0, 0.0, semi_diameter_mm=14.0),
    ]
    surfaces[at] = replace(surfaces[at], opening=opening, obscuration=obscuration)
    return complete_prescription(Prescription(tuple(surfaces), name="outlined"), image_height_mm=14.0)


def with_cylinder(lens: Prescription) -> Prescription:
    return replace(lens, surfaces=(*lens.surfaces[:4], replace(lens.surfaces[4], across=Across(-66.0, 0.3))))


@pytest.mark.parametrize(
    "prescription",
    [
        outlined(obscuration=Outline("ellipse", (3.0, 2.0))),
        outlined(Outline("rectangle", (5.0, 3.0), (0.5, 0.25)), at=0),
        outlined(Outline("ellipse", (9.0, 7.0), (0.0, 1.0)), Outline("rectangle", (1.5, 2.5), (1.0, -2.0)), at=4),
        with_cylinder(outlined(Outline("rectangle", (4.0, 3.0)), CIRCLE)),
        outlined(polygon([(-4.0, -3.0), (5.0, -3.0), (0.0, 5.0)]), spider(0.5, 3, 9.0), at=0),
        with_cylinder(outlined(obscuration=spider(1.0, 4, 7.0))),
    ],
)
def test_the_device_stops_rays_as_float64_does(prescription: Prescription) -> None:
    graphics = GraphicsContext()
    graphics.make_current()
    try:
        tracer = SurfaceTracer(graphics.ctx, ProgramCache(graphics.ctx))
        lens = focus_lens(prescription, 4.0, prescription.f_stop)
        line = np.linspace(-9, 9, 4)
        films = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
        stops = np.stack(np.meshgrid(*2 * [np.linspace(-0.7, 0.7, 9)]), axis=-1).reshape(-1, 2)
        film, stop = np.repeat(films, len(stops), axis=0), np.tile(stops, (len(films), 1))
        found = tracer.trace(lens, film, stop * lens.stop_radius_mm, (587.5618,))
    finally:
        graphics.close()
    true = rays_from_film(lens, film, stop)
    both = true.passed & found.passed[0]
    assert both.mean() > 0.9
    np.testing.assert_allclose(found.front[0][both], true.front[both], atol=1e-3)
    np.testing.assert_allclose(found.rear[0][both], true.rear[both], atol=1e-3)
    is_open = np.maximum(true.front, true.rear)[both] <= 0
    assert 0.1 < is_open.mean() < 0.95


def camera(prescription: Prescription, focus_m: float = 2.0, gate_mm: tuple[float, float] = (24.0, 16.0)) -> Camera:
    lens = Lens("prescription", "outlined", prescription)
    return Camera(
        np.eye(4), 50.0, *gate_mm, f_stop=prescription.f_stop, focus_distance_m=focus_m, near_m=0.1, lens=lens
    )


def centre(renderer: FrameRenderer, prescription: Prescription) -> float:
    """Brightness of a white scene in the middle of the picture."""
    picture: FloatArray = renderer.render(WHITE, camera(prescription), FrameSettings(24, 16, rays=1024)).color
    return float(picture[6:10, 10:14, 1].mean())


@pytest.mark.parametrize(
    ("opening", "obscuration", "area"),
    [
        (None, None, np.pi * STOP_MM**2),
        (None, CIRCLE, np.pi * (STOP_MM**2 - 9)),
        (Outline("rectangle", (4.0, 3.0)), None, 48.0),
        (Outline("ellipse", (5.0, 2.0)), None, 10 * np.pi),
        (None, Outline("rectangle", (1.0, 2.0), (2.0, -1.0)), np.pi * STOP_MM**2 - 8),
    ],
)
def test_a_picture_is_as_bright_as_the_area_left_open(
    renderer: FrameRenderer, opening: Outline | None, obscuration: Outline | None, area: float
) -> None:
    prescription = outlined(opening, obscuration)
    assert centre(renderer, prescription) == pytest.approx(area / (np.pi * STOP_MM**2), rel=0.015)


@pytest.mark.parametrize(
    ("opening", "obscuration"), [(polygon([(-4.0, -3.0), (5.0, -3.0), (0.0, 4.0)]), None), (None, spider(1.0, 4, 7.0))]
)
def test_a_polygon_leaves_the_light_of_float64_rays(
    renderer: FrameRenderer, opening: Outline | None, obscuration: Outline | None
) -> None:
    lens = focus_lens(outlined(opening, obscuration), 2.0, outlined().f_stop)
    plain = replace(lens, prescription=without_outlines(lens.prescription))
    own, whole = (film_cone(each, np.zeros(2), side=201) for each in (lens, plain))
    assert own is not None
    assert whole is not None
    assert centre(renderer, lens.prescription) == pytest.approx(own.light / whole.light, rel=0.015)


def bokeh(renderer: FrameRenderer, prescription: Prescription, x: float = 0.0, y: float = 0.0) -> FloatArray:
    """A far light out of focus."""
    settings, seen = FrameSettings(180, 120, rays=512, wavelengths=1), camera(prescription, 0.5, (6.0, 4.0))
    return renderer.render(glowing_point(x, y, 40.0, 0.02), seen, settings).color[..., 1]


def test_a_ring_makes_a_doughnut(renderer: FrameRenderer) -> None:
    plain, ring = (bokeh(renderer, outlined(obscuration=each)) for each in (None, CIRCLE))
    y, x = np.mgrid[:120, :180]
    radius = np.hypot(x - 89.5, y - 59.5)
    outer = np.sqrt((plain > 0.3 * plain.max()).sum() / np.pi)
    hole, band = radius < 0.35 * outer, (radius > 0.6 * outer) & (radius < 0.9 * outer)
    assert ring[hole].max() < 0.02 * plain[hole].mean()
    assert ring[band].mean() == pytest.approx(plain[band].mean(), rel=0.06)  # it is focused for its own rays
    assert ring.sum() / plain.sum() == pytest.approx(0.75, abs=0.04)


def test_bokeh_has_the_shape_of_an_opening(renderer: FrameRenderer) -> None:
    """Standard deviations of a rectangle are its widths over √12; spherical aberration bends that by a few per cent."""
    rectangle, plain = (bokeh(renderer, outlined(each)) for each in (Outline("rectangle", (4.0, 2.0)), None))
    _, _, across, upright = spot_size(np.repeat(rectangle[..., None], 4, axis=-1))
    _, _, disc, _ = spot_size(np.repeat(plain[..., None], 4, axis=-1))
    assert across / upright == pytest.approx(2.0, rel=0.03)
    assert across / disc == pytest.approx((8 / np.sqrt(12)) / (STOP_MM / 2), rel=0.05)


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.02, 0.01), (-0.02, 0.01)])
def test_bokeh_of_an_opening_beside_the_axis(renderer: FrameRenderer, place: tuple[float, float]) -> None:
    """A light beyond the plane of focus shows the opening upright."""
    right = bokeh(renderer, outlined(Outline("ellipse", (2.0, 2.0), (3.0, -2.0))), *place)
    whole = bokeh(renderer, outlined(), *place)
    (x, y, *_), (x0, y0, width, _) = (spot_size(np.repeat(each[..., None], 4, axis=-1)) for each in (right, whole))
    radius = 2 * width
    assert (x - x0) / radius == pytest.approx(3.0 / STOP_MM, abs=0.03)
    assert (y - y0) / radius == pytest.approx(2.0 / STOP_MM, abs=0.03)
