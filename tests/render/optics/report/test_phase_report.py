"""The sheet of a lens with diffractive surfaces: its wavefront and its notes."""

from __future__ import annotations

import numpy as np
import pytest

from render.errors import SettingsError
from render.lab.reference.lens_rays import lens_rays
from render.model.camera import Camera
from render.model.lens import Lens, Prescription, Surface
from render.optics.glass import D_LINE_NM
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.mounting import mount_lens
from render.optics.report.data_sheet import data_sheet
from render.optics.report.glass_rays import GlassRays
from render.optics.report.lens_report import lens_report
from tests.render.kits.phases import ideal_phase

FOCAL_MM = 80.0


@pytest.fixture(scope="module")
def camera() -> Camera:
    """A plane plate that focuses light of the d line without aberration."""
    phase = ideal_phase(FOCAL_MM, nm=D_LINE_NM)
    surface = Surface(0.0, 0.0, semi_diameter_mm=10.0, is_stop=True, phase=phase)
    plate = complete_prescription(Prescription((surface,), f_stop=4.0, name="a zone plate"), image_height_mm=5.0)
    return Camera(np.eye(4), FOCAL_MM, 6.0, 4.0, f_stop=4.0, lens=Lens("prescription", "a zone plate", plate))


def test_the_wavefront_has_the_phase(camera: Camera) -> None:
    """Without it the paths would differ by r²/2f, 0.6 mm."""
    lens = mount_lens(camera)
    wave, red = (GlassRays(lens, 0.0, None).wavefront(0.0, wavelength) for wavelength in (D_LINE_NM, 650.0))
    assert wave is not None
    assert red is not None
    assert wave.fit_error_nm < 1.0
    departure = wave.diffraction(np.zeros(1), 40.0, 1)[0]
    assert abs(departure) == pytest.approx(1 - 4 / np.pi * 40.0 * 4.0 * D_LINE_NM * 1e-6, abs=0.02)
    assert abs(red.diffraction(np.zeros(1), 40.0, 1)[0]) < 0.1


def test_the_sheet_leaves_out_third_order_errors(camera: Camera) -> None:
    report = lens_report(camera)
    assert report.third_order is None
    assert any("the one order of its diffractive surfaces" in note for note in report.notes)
    assert [row for group in data_sheet(report) for row in group]


def test_the_reference_refuses_diffraction(camera: Camera) -> None:
    with pytest.raises(SettingsError, match="the ray-by-ray reference knows no lenses with diffractive surfaces"):
        lens_rays(camera, np.zeros((1, 2)), (0.1, 0.1))
