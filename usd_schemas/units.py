"""Converts USD's units; the only module that does.

A scene unit is ``metersPerUnit`` metres. UsdGeomCamera's focalLength, apertures and aperture offsets are tenths of a
scene unit; its focusDistance and clippingRange are scene units, as are positions. (With centimetres, USD's default,
tenths of a unit are millimetres.) Each function takes a number or a numpy array and returns the like.
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom

from usd_schemas.errors import SchemaError

Quantity = TypeVar("Quantity", float, NDArray[np.float64])


def metres_per_unit(stage: Usd.Stage) -> float:
    """Length of one scene unit in metres.

    Raises:
        SchemaError: the stage's metersPerUnit is not a positive, finite number.
    """
    value = float(UsdGeom.GetStageMetersPerUnit(stage))
    if not (math.isfinite(value) and value > 0):
        name = stage.GetRootLayer().identifier
        raise SchemaError(f"metersPerUnit of {name} must be a positive number, got {value}")
    return value


def metres_from_units(value: Quantity, stage: Usd.Stage) -> Quantity:
    """Scene units (positions, focusDistance, clippingRange) to metres."""
    return value * metres_per_unit(stage)


def units_from_metres(value: Quantity, stage: Usd.Stage) -> Quantity:
    """Metres to scene units."""
    return value / metres_per_unit(stage)


def mm_from_tenths(value: Quantity, stage: Usd.Stage) -> Quantity:
    """Tenths of a scene unit (focalLength, apertures and their offsets) to millimetres."""
    return value * (metres_per_unit(stage) * 100.0)


def tenths_from_mm(value: Quantity, stage: Usd.Stage) -> Quantity:
    """Millimetres to tenths of a scene unit."""
    return value / (metres_per_unit(stage) * 100.0)
