"""Lenses with diffractive surfaces on the device, and their pictures, against float64 rays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.camera import Camera
from render.model.lens import Across, Glass, Lens, Prescription, Surface
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import focus_lens
from render.optics.prescription.stop_rays import rays_from_film
from render.trace.surface_tracer import SurfaceTracer
from tests.render.kits.lens_pictures import glowing_point, spot_size

pytestmark = pytest.mark.gl

GLASS = Glass(1.6, 60.0)
WAVELENGTHS_NM = (450.0, 587.5618, 650.0)


def _lens(*phases: tuple[float, ...]) -> Prescription:
    surfaces = (
        Surface(80.0, 5.0, GLASS, 14.0, phase=phases[0]),
        Surface(-300.0, 6.0, semi_diameter_mm=14.0),
        Surface(0.0, 6.0, semi_diameter_mm=6.0, is_stop=True, phase=phases[1]),
        Surface(300.0, 5.0, GLASS, 14.0, odd=(1e-6,)),
        Surface(-60.0, 0.0, semi_diameter_mm=14.0),
    )
    return complete_prescription(Prescription(surfaces, name="diffractive"), image_height_mm=12.0)


HYBRID = _lens((-14.0, 0.01), (-20.0,))


def test_the_device_diffracts_as_float64_does() -> None:
    graphics = GraphicsContext()
    graphics.make_current()
    try:
        tracer = SurfaceTracer(graphics.ctx, ProgramCache(graphics.ctx))
        bent = replace(HYBRID, surfaces=(*HYBRID.surfaces[:4], replace(HYBRID.surfaces[4], across=Across(-66.0, 0.3))))
        for prescription in (HYBRID, bent):
            lens = focus_lens(prescription, 4.0, prescription.f_stop)
            line = np.linspace(-9, 9, 4)
            films = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
            stops = np.stack(np.meshgrid(*2 * [np.linspace(-0.6, 0.6, 5)]), axis=-1).reshape(-1, 2)
            film, stop = np.repeat(films, len(stops), axis=0), np.tile(stops, (len(films), 1))
            found = tracer.trace(lens, film, stop * lens.stop_radius_mm, WAVELENGTHS_NM)
            for k, wavelength in enumerate(WAVELENGTHS_NM):
                true = rays_from_film(lens, film, stop, wavelength)
                assert (true.passed & found.passed[k]).mean() > 0.9
                both = true.passed & found.passed[k]
                np.testing.assert_allclose(found.slope[k][both], true.slope[both], atol=5e-6)
                np.testing.assert_allclose(found.pupil_mm[k][both], true.pupil_mm[both], atol=5e-4)
    finally:
        graphics.close()


def test_a_picture_has_the_colour_errors_of_diffraction(renderer: FrameRenderer) -> None:
    """Diffraction focuses red light nearest: the spots of the channels are in the other order than those of glass."""

    def widths(prescription: Prescription) -> list[float]:
        lens = Lens("prescription", "diffractive", prescription)
        camera = Camera(np.eye(4), 50.0, 6.0, 4.0, f_stop=2.8, focus_distance_m=2.0, near_m=0.1, lens=lens)
        settings = FrameSettings(180, 120, rays=256, wavelengths=3)
        color = renderer.render(glowing_point(0.0, 0.0, 40.0, 0.02), camera, settings).color
        return [spot_size(np.repeat(color[..., i : i + 1], 4, axis=-1))[2] for i in (0, 2)]

    (red, blue), (red_of_glass, blue_of_glass) = widths(_lens((-12.0,), ())), widths(_lens((), ()))
    assert red_of_glass < blue_of_glass
    assert red > 1.1 * blue
