"""Lenses with cylinders on the device against float64 rays."""

from __future__ import annotations

import numpy as np
import pytest

from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.lens import Across, Glass, Prescription, Surface
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import focus_lens
from render.optics.prescription.stop_rays import rays_from_film
from render.trace.surface_tracer import SurfaceTracer

pytestmark = pytest.mark.gl

GLASS = Glass(1.6, 60.0)
LENS = Prescription(
    (
        Surface(90.0, 4.0, GLASS, 14.0, across=Across(-150.0, 0.5)),
        Surface(0.0, 12.0, semi_diameter_mm=14.0, across=Across(-70.0, -1.2), aspheric=(2e-6,)),
        Surface(0.0, 6.0, semi_diameter_mm=5.0, is_stop=True),
        Surface(60.0, 5.0, GLASS, 14.0),
        Surface(-60.0, 0.0, semi_diameter_mm=14.0),
    ),
    f_stop=5.6,
    name="biconic",
)


def test_the_device_traces_cylinders_as_float64_does() -> None:
    graphics = GraphicsContext()
    graphics.make_current()
    try:
        tracer = SurfaceTracer(graphics.ctx, ProgramCache(graphics.ctx))
        lens = focus_lens(complete_prescription(LENS, image_height_mm=12.0), 4.0, 5.6)
        line = np.linspace(-10, 10, 5)
        films = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
        angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
        stops = np.concatenate([[[0.0, 0.0]], np.stack([np.cos(angle), np.sin(angle)], axis=1) * 0.97])
        film, stop = np.repeat(films, len(stops), axis=0), np.tile(stops, (len(films), 1))
        found = tracer.trace(lens, film, stop * lens.stop_radius_mm, (587.5618,))
    finally:
        graphics.close()
    true = rays_from_film(lens, film, stop)
    assert true.passed.mean() > 0.9
    both = true.passed & found.passed[0]
    assert (true.passed == found.passed[0]).mean() > 0.99
    np.testing.assert_allclose(found.slope[0][both], true.slope[both], atol=3e-6)
    np.testing.assert_allclose(found.pupil_mm[0][both], true.pupil_mm[both], atol=2e-4)
    np.testing.assert_allclose(found.front[0][both], true.front[both], atol=2e-4)
