"""Which material is on which faces: bindings by inheritance, purpose, collection and geom subset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom, UsdShade

from render.model.arrays import IntArray
from render.stage.findings import FindingLog
from render.stage.render_settings import stage_settings

PURPOSES = (UsdShade.Tokens.preview, UsdShade.Tokens.allPurpose, UsdShade.Tokens.full)
"""Purposes of bindings, first to last, where the stage asks for none. The first two are Storm's and usdrecord's; the last
gives a material where there would be none."""


@dataclass(frozen=True, eq=False)
class BoundPart:
    """The faces of a prim that wear one material.

    Attributes:
        material: path of the material prim, which may not exist; empty where nothing is bound.
        faces: ``(n,)`` int32 authored face indices, or None for all that no other part has.
    """

    material: str
    faces: IntArray | None = None


def binding_purposes(stage: Usd.Stage, log: FindingLog) -> tuple[str, ...]:
    """Purposes of bindings in the order in which they are tried.

    They are ``materialBindingPurposes`` of the stage's own render settings, or `PURPOSES` where these author none, or no list of
    tokens.

    Args:
        stage: the stage.
        log: notes a value of another type.
    """
    settings = stage_settings(stage)
    return (settings.binding_purposes(log) if settings else None) or PURPOSES


def bound_parts(prim: Usd.Prim, purposes: Sequence[str], time: Usd.TimeCode, log: FindingLog) -> list[BoundPart]:
    """The parts of a prim by material; the part of all other faces comes last.

    Subsets are those of the ``materialBind`` family, as in UsdShade. Where two contain a face the first one wins.

    Args:
        prim: the surface.
        purposes: as `binding_purposes` gives them.
        time: when.
        log: notes subsets that cannot be used.
    """
    parts: list[BoundPart] = []
    subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets() if prim.IsA(UsdGeom.Mesh) else []
    count = face_count(prim, time) if subsets else 0
    for subset in subsets:
        if subset.GetElementTypeAttr().Get() != UsdGeom.Tokens.face:
            path = subset.GetPath()
            log.add("subset_ignored", path, f"geom subset {path} is not made of faces and is not honoured")
            continue
        parts.append(BoundPart(bound_material(subset.GetPrim(), purposes), subset_faces(subset, count, time, log)))
    parts.append(BoundPart(bound_material(prim, purposes)))
    return parts


def subset_faces(subset: UsdGeom.Subset, count: int, time: Usd.TimeCode, log: FindingLog) -> IntArray:
    """Indices ``(n,)`` int32 of a subset of faces as they are authored, which may be beyond the faces that there are.

    Args:
        subset: the subset.
        count: faces of its mesh (`face_count`).
        time: when.
        log: notes indices of no face.
    """
    indices = np.array(subset.GetIndicesAttr().Get(time) or [], np.int32)
    if len(indices) and not 0 <= indices.min() <= indices.max() < count:
        path = subset.GetPath()
        message = (
            f"indices of geom subset {path} run from {indices.min()} to {indices.max()}, but there are {count} faces"
        )
        log.add("bad_subset", path, f"{message}: those of faces alone are honoured")
    return indices


def face_count(mesh: Usd.Prim, time: Usd.TimeCode) -> int:
    """Number of faces of a mesh as they are authored at a time."""
    return len(UsdGeom.Mesh(mesh).GetFaceVertexCountsAttr().Get(time) or [])


def subsets_vary(prim: Usd.Prim) -> bool:
    """Whether a material subset's faces may change over time."""
    if not prim.IsA(UsdGeom.Mesh):
        return False
    subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()
    return any(subset.GetIndicesAttr().ValueMightBeTimeVarying() for subset in subsets)


def bound_material(prim: Usd.Prim, purposes: Sequence[str]) -> str:
    """The path of the material on a prim, even one that does not exist; empty where nothing is bound.

    Where a purpose has no binding of its own, USD takes the one without purpose.
    """
    for purpose in purposes:
        material, relationship = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(purpose)
        if material:
            return str(material.GetPath())
        if relationship and relationship.GetTargets():
            return str(relationship.GetTargets()[-1])
    return ""


def face_owner(parts: list[BoundPart], face_count: int) -> IntArray:
    """``(face_count,)`` which part has each face."""
    owner = np.full(face_count, len(parts) - 1, np.int32)
    for number in range(len(parts) - 1, -1, -1):
        faces = parts[number].faces
        if faces is not None:
            owner[faces[(faces >= 0) & (faces < face_count)]] = number
    return owner
