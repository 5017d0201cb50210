"""The polygons of one prim at one time: a mesh, an implicit shape, or a mesh that a skeleton bends."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Sized
from contextlib import contextmanager

import numpy as np
from pxr import Usd, UsdGeom, Vt

from render.model.arrays import FloatArray, IntArray, LongArray
from render.stage.findings import FindingLog
from render.stage.geometry.implicit import implicit_polygons, is_implicit, shape_varies
from render.stage.geometry.polygons import FARTHEST_POINT, BadGeometry, Polygons, Values, check_counts
from render.stage.geometry.primvars import as_rows
from render.stage.geometry.skinning import Skeletons
from render.stage.values import UNREADABLE, format_value, why_unreadable

_FACES = ("faceVertexCounts", "faceVertexIndices")
_MESH_ATTRIBUTES = ("points", *_FACES, "holeIndices", "normals", "primvars:normals")


def is_drawable(prim: Usd.Prim) -> bool:
    """Whether :func:`read_surface` can make polygons of this prim."""
    return is_implicit(prim) or prim.IsA(UsdGeom.Mesh)


def surface_varies(prim: Usd.Prim, skeletons: Skeletons) -> bool:
    """Whether the prim's polygons may change over time in its own space."""
    if is_implicit(prim):
        return shape_varies(prim)
    return _varies(prim, _MESH_ATTRIBUTES) or skeletons.bends(prim)


def read_surface(prim: Usd.Prim, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog) -> Polygons:
    """The polygons of a mesh or an implicit prim.

    Raises:
        BadGeometry: the values are of other types than the schema's, or are inconsistent; the message explains the fault.
    """
    with _translate_errors():
        return implicit_polygons(prim, time) if is_implicit(prim) else _mesh_polygons(prim, time, skeletons, log)


def mesh_faces(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[IntArray, IntArray]:
    """Corner counts of a mesh's faces, and the point index of each corner.

    Raises:
        BadGeometry: the arrays contradict each other, or are not integers.
    """
    mesh = UsdGeom.Mesh(prim)
    with _translate_errors():
        counts = _integers(mesh.GetFaceVertexCountsAttr(), time)
        corners = _integers(mesh.GetFaceVertexIndicesAttr(), time)
    check_counts(counts, corners)
    return counts, corners


def faces_vary(prim: Usd.Prim) -> bool:
    """Whether a mesh's faces may change over time."""
    return _varies(prim, _FACES)


def _varies(prim: Usd.Prim, names: Sequence[str]) -> bool:
    return any(attribute and attribute.ValueMightBeTimeVarying() for attribute in map(prim.GetAttribute, names))


def resting_points(prim: Usd.Prim, time: Usd.TimeCode) -> Vt.Vec3fArray:
    """The points of a mesh in its own space, before a skeleton bends them.

    Raises:
        BadGeometry: there are no points, or they are not valid.
    """
    attribute = UsdGeom.Mesh(prim).GetPointsAttr()
    with _translate_errors():
        value = attribute.Get(time)
        whole = isinstance(value, Vt.Vec3fArray) and len(value) > 0
        return value if whole else Vt.Vec3fArray.FromNumpy(_as_points(value))


def mesh_points(
    prim: Usd.Prim, resting: Vt.Vec3fArray, rows: LongArray, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog
) -> FloatArray:
    """Where some of a mesh's points are, in its own space, as `read_surface` has them all.

    Args:
        prim: a mesh.
        resting: its points, as `resting_points` gives them at the time.
        rows: ``(n,)`` which of them.
        time: when.
        skeletons: bend meshes.
        log: for findings.

    Returns:
        ``(n, 3)``.

    Raises:
        BadGeometry: the mesh does not have them, or they are not finite.
    """
    if not 0 <= rows.min() <= rows.max() < len(resting):
        raise BadGeometry(f"its face has the points {rows.min()} to {rows.max()}, and there are {len(resting)}")
    found = skeletons.bend_points(prim, resting, time, log, rows)
    if not (np.abs(found) <= FARTHEST_POINT).all():
        raise BadGeometry(f"a point of its face is not finite or out of range, {FARTHEST_POINT:g} units")
    return found


@contextmanager
def _translate_errors() -> Iterator[None]:
    """Raise the errors of reading a value of the wrong type as `BadGeometry`."""
    try:
        yield
    except BadGeometry:
        raise
    except UNREADABLE as problem:
        raise BadGeometry(why_unreadable(problem)) from problem


def _mesh_polygons(prim: Usd.Prim, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog) -> Polygons:
    mesh = UsdGeom.Mesh(prim)
    polygons = Polygons(
        points=_as_points(mesh.GetPointsAttr().Get(time)),
        counts=_integers(mesh.GetFaceVertexCountsAttr(), time),
        corners=_integers(mesh.GetFaceVertexIndicesAttr(), time),
        normals=_authored_normals(mesh, time),
        left_handed=mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded,
        smooth=_is_subdivided(mesh, time),
        holes=_integers(mesh.GetHoleIndicesAttr(), time),
    )
    _note_holes(prim, polygons, log)
    return skeletons.bend(prim, polygons, time, log)


def _note_holes(prim: Usd.Prim, polygons: Polygons, log: FindingLog) -> None:
    holes, count = polygons.holes, len(polygons.counts)
    if holes is not None and len(holes) and not 0 <= holes.min() <= holes.max() < count:
        path = prim.GetPath()
        message = f"holeIndices of {path} run from {holes.min()} to {holes.max()}, but there are {count} faces"
        log.add("bad_holes", path, f"{message}: those of faces alone are honoured")


def _as_points(value: object) -> FloatArray:
    """``(n, 3)`` the value of a mesh's points."""
    if value is None or (isinstance(value, Sized) and len(value) == 0):
        raise BadGeometry("it has no points at this time")
    points = np.array(value, np.float32)
    if points.ndim != 2 or points.shape[1] != 3:
        raise BadGeometry(f"its points must be a list of points, got {format_value(value)}")
    return points


def _integers(attribute: Usd.Attribute, time: Usd.TimeCode) -> IntArray:
    value = attribute.Get(time)
    if value is None:
        return np.zeros(0, np.int32)
    numbers = np.array(value)
    if numbers.ndim != 1 or (len(numbers) and numbers.dtype.kind != "i"):
        raise BadGeometry(f"its {attribute.GetName()} must be a list of whole numbers, got {format_value(value)}")
    return numbers.astype(np.int32)


def _is_subdivided(mesh: UsdGeom.Mesh, time: Usd.TimeCode) -> bool:
    return mesh.GetSubdivisionSchemeAttr().Get(time) in (UsdGeom.Tokens.catmullClark, UsdGeom.Tokens.loop)


def _authored_normals(mesh: UsdGeom.Mesh, time: Usd.TimeCode) -> Values | None:
    """Authored normals: ``primvars:normals``, else ``normals``, as UsdGeomPointBased prescribes."""
    primvar = UsdGeom.PrimvarsAPI(mesh.GetPrim()).GetPrimvar("normals")
    if primvar and primvar.HasAuthoredValue():
        rows = as_rows(primvar.Get(time), 3)
        indices = np.array(primvar.GetIndices(time) or [], np.int32) if primvar.IsIndexed() else None
        return None if rows is None or not len(rows) else Values(rows, str(primvar.GetInterpolation()), indices)
    rows = as_rows(mesh.GetNormalsAttr().Get(time), 3)
    return None if rows is None or not len(rows) else Values(rows, str(mesh.GetNormalsInterpolation()))
