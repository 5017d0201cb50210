"""Lenses with terms of odd powers, and of Forbes's polynomials, on the device against float64 rays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.lens import Across, Glass, Prescription, Surface
from render.optics.lens_files.forbes import ForbesTerms, qcon_terms
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import focus_lens
from render.optics.prescription.stop_rays import rays_from_film
from render.trace.surface_tracer import SurfaceTracer

pytestmark = pytest.mark.gl

GLASS = Glass(1.6, 60.0)
LENS = Prescription(
    (
        Surface(60.0, 4.0, GLASS, 12.0, aspheric=(-1e-6,), odd=(-2e-5, 3e-8)),
        Surface(0.0, 12.0, semi_diameter_mm=12.0, odd=(1e-5, 0.0, -1e-10)),
        Surface(0.0, 6.0, semi_diameter_mm=5.0, is_stop=True),
        Surface(60.0, 5.0, GLASS, 14.0),
        Surface(-60.0, 0.0, semi_diameter_mm=14.0),
    ),
    f_stop=5.6,
    name="odd",
)
FORBES = qcon_terms(ForbesTerms("Qcon", (0.05, -0.02, 0.006, -2e-3, 1e-3, -5e-4, 2e-4, -1e-4, 5e-5), 12.0))
QCON = replace(LENS.surfaces[0], odd=(), aspheric=tuple(FORBES.values()))
CYLINDER = replace(LENS.surfaces[0], across=Across(90.0, 0.5))


@pytest.mark.parametrize("front", [LENS.surfaces[0], CYLINDER, QCON], ids=["odd", "biconic", "qcon"])
def test_the_device_traces_odd_powers_as_float64_does(front: Surface) -> None:
    lens = replace(LENS, surfaces=(front, *LENS.surfaces[1:]))
    focused = focus_lens(complete_prescription(lens, image_height_mm=12.0), 4.0, 5.6)
    line = np.linspace(-10, 10, 5)
    films = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    stops = np.concatenate([[[0.0, 0.0]], np.stack([np.cos(angle), np.sin(angle)], axis=1) * 0.97])
    film, stop = np.repeat(films, len(stops), axis=0), np.tile(stops, (len(films), 1))
    graphics = GraphicsContext()
    graphics.make_current()
    try:
        tracer = SurfaceTracer(graphics.ctx, ProgramCache(graphics.ctx))
        found = tracer.trace(focused, film, stop * focused.stop_radius_mm, (587.5618,))
    finally:
        graphics.close()
    true = rays_from_film(focused, film, stop)
    both = true.passed & found.passed[0]
    assert both.mean() > 0.9
    np.testing.assert_allclose(found.slope[0][both], true.slope[both], atol=3e-6)
    np.testing.assert_allclose(found.pupil_mm[0][both], true.pupil_mm[both], atol=2e-4)
    np.testing.assert_allclose(found.front[0][both], true.front[both], atol=2e-4)
