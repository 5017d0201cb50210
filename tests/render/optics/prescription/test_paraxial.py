"""First-order optics against what the patents say of their lenses."""

from __future__ import annotations

import pytest

from render.optics.prescription.f_numbers import paraxial_f_number
from render.optics.prescription.paraxial import first_order, stop_index
from tests.render.kits.lenses import SIX_LENSES, KnownLens


@pytest.mark.parametrize("lens", SIX_LENSES, ids=lambda lens: lens.prescription.name)
def test_focal_length_and_back_focus_are_the_stated_ones(lens: KnownLens) -> None:
    first = first_order(lens.prescription)
    assert first.focal_length_mm == pytest.approx(lens.focal_length_mm, rel=1e-3)
    assert first.back_focal_mm == pytest.approx(lens.back_focal_mm, rel=1e-3)


# As computed by hand from published stop diameters; of the two Zeiss lenses from 24.86 and 26.64 mm for f/1.4.
@pytest.mark.parametrize(
    ("lens", "f_stop"),
    zip(SIX_LENSES, (2.03, 2.68, 3.95, 5.42, 1.4 * 24.86 / 24.292, 1.4 * 26.64 / 28.454), strict=True),
    ids=lambda value: value.prescription.name if isinstance(value, KnownLens) else f"f{value:.3g}",
)
def test_the_paraxial_pupil_has_the_computed_f_number(lens: KnownLens, f_stop: float) -> None:
    stop = lens.prescription.surfaces[stop_index(lens.prescription)]
    assert paraxial_f_number(lens.prescription, stop.semi_diameter_mm) == pytest.approx(f_stop, rel=2e-3)
