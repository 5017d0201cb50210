"""Sizes of the tables of lenses without rotational symmetry, in closed form."""

from __future__ import annotations

import pytest

from render.trace.grid_table import CYLINDER_PUPIL_SIDE, POLYGON_PUPIL_SIDE, PUPIL_SIDE, QUARTER_FIELDS, fit_pupil_side

QUARTER = QUARTER_FIELDS[0] * QUARTER_FIELDS[1]
WHOLE = (2 * QUARTER_FIELDS[0] - 1) * (2 * QUARTER_FIELDS[1] - 1)


@pytest.mark.parametrize(
    ("side", "fields"), [(POLYGON_PUPIL_SIDE, QUARTER), (PUPIL_SIDE, WHOLE), (CYLINDER_PUPIL_SIDE, WHOLE)]
)
def test_rays_of_all_wavelengths_fit_into_a_buffer(side: int, fields: int) -> None:
    """Up to 64, and the d line from which colour errors are counted; as fine as can be, to a step of 2."""
    for wavelengths in range(1, 66):
        got = fit_pupil_side(side, fields, wavelengths)
        assert fields * got**2 * wavelengths * 32 <= 2_005_401_600
        assert got == side or fields * (got + 2) ** 2 * wavelengths * 32 > 2_005_401_600
        assert got % 2 == 0
    assert fit_pupil_side(side, fields, 58) == side
    assert fit_pupil_side(side, fields, 64) >= min(side, 90)
