"""TetMesh as polygons: the faces of its surface."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from render.stage.geometry.points_data import authored_normals, read_points
from render.stage.geometry.polygons import BadGeometry, Polygons
from render.stage.geometry.primvars import as_rows

ATTRIBUTES = ("points", "tetVertexIndices", "surfaceFaceVertexIndices", "normals", "primvars:normals")
"""Attributes that the shape of tetrahedra follows, and may follow over time."""


def tetrahedra_polygons(prim: Usd.Prim, time: Usd.TimeCode) -> Polygons:
    """The surface of a TetMesh at a time, in its own space and units. Its faces are those authored, else computed by USD.

    Raises:
        BadGeometry: there are no points, or indices do not fit; the message explains the fault.
    """
    mesh = UsdGeom.TetMesh(prim)
    points = read_points(prim, time)
    faces = _triples(mesh.GetSurfaceFaceVertexIndicesAttr().Get(time), 3, "surfaceFaceVertexIndices", len(points))
    if not len(faces):
        _triples(mesh.GetTetVertexIndicesAttr().Get(time), 4, "tetVertexIndices", len(points))
        faces = _triples(UsdGeom.TetMesh.ComputeSurfaceFaces(mesh, time), 3, "surface", len(points))
    return Polygons(
        points=points,
        counts=np.full(len(faces), 3, np.int32),
        corners=faces.ravel(),
        normals=authored_normals(prim, time),
        left_handed=mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded,
        smooth=True,
    )


def _triples(value: object, width: int, name: str, points: int) -> np.ndarray[tuple[int, int], np.dtype[np.int32]]:
    rows = as_rows(value, width)
    if rows is None:
        return np.zeros((0, width), np.int32)
    if len(rows) and not 0 <= rows.min() <= rows.max() < points:
        raise BadGeometry(f"{name} run from {rows.min():g} to {rows.max():g}, but there are {points} points")
    return np.asarray(value, np.int32).reshape(-1, width)
