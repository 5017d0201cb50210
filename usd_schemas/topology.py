"""A fingerprint of a mesh's topology, so that a focus point can tell whether its face still means the same."""

from __future__ import annotations

import hashlib

import numpy as np
from pxr import Sdf, Usd, UsdGeom, Vt

from usd_schemas.settings import FocusPoint


def topology_fingerprint(mesh: UsdGeom.Mesh, time: float | None = None) -> str:
    """Sixteen hexadecimal digits of the mesh's face counts and indices at a time; points may move, faces may not.

    Args:
        mesh: the mesh.
        time: USD time code; None for the first one at which the mesh says anything, which is what focus points keep.
    """
    code = Usd.TimeCode.EarliestTime() if time is None else Usd.TimeCode(time)
    digest = hashlib.sha256()
    for attribute in (mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()):
        authored = attribute.Get(code)
        values = np.asarray(authored if isinstance(authored, Vt.IntArray) else [], "<i4")
        digest.update(np.int64(len(values)).tobytes() + values.tobytes())
    return digest.hexdigest()[:16]


def topology_under(stage: Usd.Stage, point: FocusPoint) -> str:
    """The fingerprint of the mesh on whose faces a focus point is; empty where it is on no face of a mesh."""
    target = _target(stage, point)
    on_mesh = point.face >= 0 and target is not None and target.IsA(UsdGeom.Mesh)
    return topology_fingerprint(UsdGeom.Mesh(target)) if on_mesh else ""


def topology_change(stage: Usd.Stage, point: FocusPoint) -> str | None:
    """One sentence where the faces are no longer those on which a focus point was placed, so that its own may mean another place.

    A target that is gone or nowhere is another matter, and a point that was placed without a fingerprint has nothing to compare;
    nor does the place of a point that follows the bounds of a part depend on any face.
    """
    target = _target(stage, point)
    if not point.topology or point.face < 0 or point.part or target is None:
        return None
    placed = f"focus point {point.name} was placed on {target.GetPath()} with topology {point.topology}"
    if not target.IsA(UsdGeom.Mesh):
        return f"{placed}, which is now {target.GetTypeName() or 'a prim of no type'} and no mesh: place it again"
    found = topology_fingerprint(UsdGeom.Mesh(target))
    return (
        None
        if found == point.topology
        else f"{placed}, which is now {found}: look whether its face still is what was meant"
    )


def _target(stage: Usd.Stage, point: FocusPoint) -> Usd.Prim | None:
    """The prim that the point is on, if it is there and has a place."""
    path = point.target[-1] if point.target else ""
    prim = stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
    return prim if prim and prim.IsA(UsdGeom.Xformable) else None
