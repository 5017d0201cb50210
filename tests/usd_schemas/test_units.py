"""USD's units against metres and millimetres."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pxr import Usd, UsdGeom

from usd_schemas import SchemaError
from usd_schemas.units import metres_from_units, metres_per_unit, mm_from_tenths, tenths_from_mm, units_from_metres

SCALES = st.sampled_from([0.001, 0.01, 0.0254, 0.1, 0.3048, 1.0, 1000.0]) | st.floats(1e-6, 1e6)
LENGTHS = st.just(0.0) | st.floats(1e-9, 1e6) | st.floats(-1e6, -1e-9)


def stage_with(scale: float) -> Usd.Stage:
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, scale)
    return stage


def test_in_centimetres_tenths_of_a_unit_are_millimetres() -> None:
    stage = Usd.Stage.CreateInMemory()
    assert metres_per_unit(stage) == 0.01
    assert mm_from_tenths(50.0, stage) == 50.0
    assert metres_from_units(250.0, stage) == 2.5


def test_in_metres_a_50_mm_lens_is_half_a_tenth() -> None:
    assert mm_from_tenths(0.5, stage_with(1.0)) == 50.0
    assert tenths_from_mm(50.0, stage_with(1.0)) == 0.5


@given(scale=SCALES, length=LENGTHS)
def test_there_and_back_is_the_same_length(scale: float, length: float) -> None:
    stage = stage_with(scale)
    assert math.isclose(units_from_metres(metres_from_units(length, stage), stage), length, rel_tol=1e-12)
    assert math.isclose(tenths_from_mm(mm_from_tenths(length, stage), stage), length, rel_tol=1e-12)


@given(scale=SCALES, length=LENGTHS)
def test_both_ways_of_writing_a_length_agree(scale: float, length: float) -> None:
    """A length in scene units, and the same in tenths of them, is the same number of metres."""
    stage = stage_with(scale)
    assert math.isclose(mm_from_tenths(length * 10, stage) / 1000, metres_from_units(length, stage), rel_tol=1e-12)


def test_arrays_are_converted_whole() -> None:
    np.testing.assert_allclose(metres_from_units(np.array([1.0, 2.5]), stage_with(0.1)), [0.1, 0.25])


@pytest.mark.parametrize("scale", [0.0, -1.0, float("nan"), float("inf")])
def test_a_scale_that_is_none_is_refused(scale: float) -> None:
    with pytest.raises(SchemaError, match="metersPerUnit"):
        metres_per_unit(stage_with(scale))
