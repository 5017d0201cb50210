"""Primvars of a prim, inherited ones too, as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import FloatArray
from render.stage.geometry.polygons import Values


@dataclass(frozen=True, eq=False)
class FoundPrimvar:
    """A primvar that a prim has or inherits.

    Attributes:
        primvar: the UsdGeom.Primvar, which may sit on an ancestor.
        inherited: whether it does.
    """

    primvar: UsdGeom.Primvar
    inherited: bool

    def varies(self) -> bool:
        """Whether its value may change over time."""
        return bool(self.primvar.ValueMightBeTimeVarying())

    def read(self, time: Usd.TimeCode, width: int) -> Values | None:
        """Values at a time with ``width`` components, or None for another width."""
        values = as_rows(self.primvar.Get(time), width)
        if values is None:
            return None
        if int(self.primvar.GetElementSize()) != 1:
            return None
        interpolation = str(self.primvar.GetInterpolation())
        indices = np.asarray(self.primvar.GetIndices(time) or [], np.int32) if self.primvar.IsIndexed() else None
        return Values(values, interpolation, indices)


def find_primvar(prim: Usd.Prim, name: str) -> FoundPrimvar | None:
    """The primvar of that name on a prim or, if constant, on an ancestor; None where nothing is authored."""
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    if not primvar or not primvar.HasAuthoredValue():
        return None
    return FoundPrimvar(primvar, primvar.GetAttr().GetPrim() != prim)


def as_rows(value: object, width: int) -> FloatArray | None:
    """A USD scalar, vector or array value as ``(m, width)`` float32, or None if it has another width or no numbers."""
    if value is None or isinstance(value, str):
        return None
    try:
        # Values beyond single precision become infinite, and are left out with other infinite values.
        with np.errstate(over="ignore"):
            array = np.array(value, np.float32)
    except (TypeError, ValueError):
        return None
    if array.ndim == 0:
        array = array.reshape(1, 1)
    elif array.ndim == 1:
        # One vector (color3f) or an array of numbers (float[]).
        array = array.reshape(1, -1) if len(array) == width and not _is_array(value) else array.reshape(-1, 1)
    if array.ndim != 2 or array.shape[1] != width:
        return None
    return array


def _is_array(value: object) -> bool:
    return type(value).__module__.startswith("pxr.Vt") or isinstance(value, list)
