"""First-order optics against what the patents say of their lenses."""

from __future__ import annotations

import pytest

from render.optics.prescription.paraxial import first_order, stop_index
from tests.render.kits.lenses import SIX_LENSES, KnownLens


@pytest.mark.parametrize("lens", SIX_LENSES, ids=lambda lens: lens.prescription.name)
def test_focal_length_and_back_focus_are_the_stated_ones(lens: KnownLens) -> None:
    first = first_order(lens.prescription)
    assert first.focal_length_mm == pytest.approx(lens.focal_length_mm, rel=1e-3)
    assert first.back_focal_mm == pytest.approx(lens.back_focal_mm, rel=1e-3)


@pytest.mark.parametrize("lens", SIX_LENSES, ids=lambda lens: lens.prescription.name)
def test_the_stop_gives_the_stated_f_number(lens: KnownLens) -> None:
    first = first_order(lens.prescription)
    stop = lens.prescription.surfaces[stop_index(lens.prescription)]
    pupil_mm = 2 * stop.semi_diameter_mm * first.entrance_pupil_magnification
    assert first.focal_length_mm / pupil_mm == pytest.approx(lens.f_stop, rel=2e-3)
