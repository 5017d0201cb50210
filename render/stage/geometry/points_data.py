"""Values of prims that are based on points: places, widths, normals, whole numbers."""

from __future__ import annotations

from collections.abc import Sized

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.stage.findings import FindingLog
from render.stage.geometry.polygons import BadGeometry, Values
from render.stage.geometry.primvars import as_rows
from render.stage.values import format_value

DEFAULT_WIDTH = 1.0
"""Width of curves and points that have none, in units of the prim, as in Storm."""

_MOST_CHECKED = 4
"""Samples of velocities that are compared with those of the points."""


def read_points(prim: Usd.Prim, time: Usd.TimeCode) -> FloatArray:
    """``(n, 3)`` points of a prim.

    Raises:
        BadGeometry: there are none, or the value is no list of points.
    """
    return as_points(point_values(prim, time))


def point_values(prim: Usd.Prim, time: Usd.TimeCode) -> object:
    """Points of a prim as USD has them: between samples by their velocities and accelerations where it has these, as
    UsdGeomPointBased wants it, else between those of both samples.
    """
    based = UsdGeom.PointBased(prim)
    if has_velocities(prim) and not time.IsDefault():
        samples = [attribute.GetBracketingTimeSamples(time.GetValue()) for attribute in _moving(based)]
        if samples[0][:1] == samples[1][:1]:
            return based.ComputePointsAtTime(time, time)
    return based.GetPointsAttr().Get(time)


def has_velocities(prim: Usd.Prim) -> bool:
    """Whether a prim's points move between samples by velocities."""
    velocities = prim.GetAttribute("velocities")  # faster than by the schema: all prims are asked
    return bool(velocities and velocities.HasAuthoredValue())


def note_velocities(prim: Usd.Prim, log: FindingLog) -> None:
    """Note velocities that belong to no sample of the points."""
    if not has_velocities(prim):
        return
    points, velocities = _moving(UsdGeom.PointBased(prim))
    times, path = points.GetTimeSamples(), prim.GetPath()
    if times != velocities.GetTimeSamples():
        message = f"velocities of {path} are used where they have the times of samples of its points alone"
        log.add("bad_velocities", path, message)
    for time in times[:_MOST_CHECKED]:
        values = (attribute.Get(time) for attribute in (points, velocities))
        sizes = [len(value) if isinstance(value, Sized) else 0 for value in values]
        if sizes[0] != sizes[1]:
            message = (
                f"velocities of {path} are not used where there are not as many as points: {sizes[1]} for {sizes[0]}"
            )
            log.add("bad_velocities", path, message)
            return


def _moving(based: UsdGeom.PointBased) -> tuple[Usd.Attribute, Usd.Attribute]:
    return based.GetPointsAttr(), based.GetVelocitiesAttr()


def as_points(value: object) -> FloatArray:
    """``(n, 3)`` the value of a prim's points.

    Raises:
        BadGeometry: there are none, or the value is no list of points.
    """
    if value is None or (isinstance(value, Sized) and len(value) == 0):
        raise BadGeometry("it has no points at this time")
    points = np.array(value, np.float32)
    if points.ndim != 2 or points.shape[1] != 3:
        raise BadGeometry(f"its points must be a list of points, got {format_value(value)}")
    return points


def whole_numbers(attribute: Usd.Attribute, time: Usd.TimeCode) -> IntArray:
    """``(n,)`` an attribute's list of whole numbers; an empty one where it has no value.

    Raises:
        BadGeometry: it is no list of whole numbers.
    """
    value = attribute.Get(time)
    if value is None:
        return np.zeros(0, np.int32)
    numbers = np.array(value)
    if numbers.ndim != 1 or (len(numbers) and numbers.dtype.kind != "i"):
        raise BadGeometry(f"its {attribute.GetName()} must be a list of whole numbers, got {format_value(value)}")
    return numbers.astype(np.int32)


def real_numbers(attribute: Usd.Attribute, time: Usd.TimeCode) -> DoubleArray:
    """``(n,)`` an attribute's list of numbers; an empty one where it has no value, or none of single numbers."""
    rows = as_rows(attribute.Get(time), 1)
    return np.zeros(0) if rows is None else rows[:, 0].astype(np.float64)


def authored_normals(prim: Usd.Prim, time: Usd.TimeCode) -> Values | None:
    """Authored normals: ``primvars:normals``, else ``normals``, as UsdGeomPointBased prescribes; None without any."""
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("normals")
    if primvar and primvar.HasAuthoredValue():
        return _indexed(primvar, 3, time)
    points = UsdGeom.PointBased(prim)
    rows = as_rows(points.GetNormalsAttr().Get(time), 3)
    return None if rows is None or not len(rows) else Values(rows, str(points.GetNormalsInterpolation()))


def authored_widths(prim: Usd.Prim, time: Usd.TimeCode, log: FindingLog) -> Values:
    """Authored widths of curves or points: ``primvars:widths``, else ``widths``; `DEFAULT_WIDTH`, and a finding, without any.

    One width counts for all, whatever the interpolation, as in Storm.
    """
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("widths")
    found = _indexed(primvar, 1, time) if primvar and primvar.HasAuthoredValue() else None
    if found is not None:
        return found if len(found.values) > 1 else Values(found.values, "constant")
    holder = UsdGeom.Points(prim) if prim.IsA(UsdGeom.Points) else UsdGeom.Curves(prim)
    rows = as_rows(holder.GetWidthsAttr().Get(time), 1)
    if rows is not None and len(rows):
        return Values(rows, str(holder.GetWidthsInterpolation()) if len(rows) > 1 else "constant")
    path = prim.GetPath()
    log.add("no_widths", path, f"{path} has no widths: {DEFAULT_WIDTH:g} unit is used")
    return Values(np.array([[DEFAULT_WIDTH]], np.float32), "constant")


def _indexed(primvar: UsdGeom.Primvar, width: int, time: Usd.TimeCode) -> Values | None:
    rows = as_rows(primvar.Get(time), width)
    indices = np.array(primvar.GetIndices(time) or [], np.int32) if primvar.IsIndexed() else None
    return None if rows is None or not len(rows) else Values(rows, str(primvar.GetInterpolation()), indices)
