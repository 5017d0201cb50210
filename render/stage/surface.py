"""The polygons of one prim at one time: a mesh, an implicit shape, or a mesh that a skeleton bends."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from render.stage.findings import FindingLog
from render.stage.implicit import implicit_polygons, is_implicit, shape_varies
from render.stage.polygons import BadGeometry, IntArray, Polygons, Values
from render.stage.primvars import as_rows
from render.stage.skinning import Skeletons
from render.stage.values import UNREADABLE, shown, why_unreadable

_MESH_ATTRIBUTES = ("points", "faceVertexCounts", "faceVertexIndices", "holeIndices", "normals", "primvars:normals")


def is_drawable(prim: Usd.Prim) -> bool:
    """Whether :func:`surface_of` can make polygons of this prim."""
    return is_implicit(prim) or prim.IsA(UsdGeom.Mesh)


def surface_varies(prim: Usd.Prim, skeletons: Skeletons) -> bool:
    """Whether the prim's polygons may change over time in its own space."""
    if is_implicit(prim):
        return shape_varies(prim)
    if any(prim.GetAttribute(name).ValueMightBeTimeVarying() for name in _MESH_ATTRIBUTES if prim.HasAttribute(name)):
        return True
    return skeletons.bends(prim)


def surface_of(prim: Usd.Prim, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog) -> Polygons:
    """The polygons of a mesh or an implicit prim.

    Raises:
        BadGeometry: the values are of other types than the schema's, or contradict themselves; the message says how.
    """
    try:
        return implicit_polygons(prim, time) if is_implicit(prim) else _mesh_polygons(prim, time, skeletons, log)
    except BadGeometry:
        raise
    except UNREADABLE as problem:
        raise BadGeometry(why_unreadable(problem)) from problem


def _mesh_polygons(prim: Usd.Prim, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog) -> Polygons:
    mesh = UsdGeom.Mesh(prim)
    polygons = Polygons(
        points=_points(mesh, time),
        counts=_integers(mesh.GetFaceVertexCountsAttr(), time),
        corners=_integers(mesh.GetFaceVertexIndicesAttr(), time),
        normals=_authored_normals(mesh, time),
        left_handed=mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded,
        smooth=_is_subdivided(mesh, time),
        holes=_integers(mesh.GetHoleIndicesAttr(), time),
    )
    return skeletons.bend(prim, polygons, time, log)


def _points(mesh: UsdGeom.Mesh, time: Usd.TimeCode) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
    value = mesh.GetPointsAttr().Get(time)
    if value is None or len(value) == 0:
        raise BadGeometry("it has no points at this time")
    points = np.array(value, np.float32)
    if points.ndim != 2 or points.shape[1] != 3:
        raise BadGeometry(f"its points must be a list of points, got {shown(value)}")
    return points


def _integers(attribute: Usd.Attribute, time: Usd.TimeCode) -> IntArray:
    value = attribute.Get(time)
    if value is None:
        return np.zeros(0, np.int32)
    numbers = np.array(value)
    if numbers.ndim != 1 or (len(numbers) and numbers.dtype.kind != "i"):
        raise BadGeometry(f"its {attribute.GetName()} must be a list of whole numbers, got {shown(value)}")
    return numbers.astype(np.int32)


def _is_subdivided(mesh: UsdGeom.Mesh, time: Usd.TimeCode) -> bool:
    return mesh.GetSubdivisionSchemeAttr().Get(time) in (UsdGeom.Tokens.catmullClark, UsdGeom.Tokens.loop)


def _authored_normals(mesh: UsdGeom.Mesh, time: Usd.TimeCode) -> Values | None:
    """``primvars:normals`` if it is there, else ``normals``, as UsdGeomPointBased prescribes."""
    primvar = UsdGeom.PrimvarsAPI(mesh.GetPrim()).GetPrimvar("normals")
    if primvar and primvar.HasAuthoredValue():
        rows = as_rows(primvar.Get(time), 3)
        indices = np.array(primvar.GetIndices(time) or [], np.int32) if primvar.IsIndexed() else None
        return None if rows is None or not len(rows) else Values(rows, str(primvar.GetInterpolation()), indices)
    rows = as_rows(mesh.GetNormalsAttr().Get(time), 3)
    return None if rows is None or not len(rows) else Values(rows, str(mesh.GetNormalsInterpolation()))
