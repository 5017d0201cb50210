"""Which material is on which faces: bindings by inheritance, purpose, collection and geom subset."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom, UsdShade

from render.model.arrays import IntArray
from render.stage.findings import FindingLog

# Purpose of bindings in final pictures; bindings without a purpose are the fallback.
_PURPOSE = UsdShade.Tokens.full


@dataclass(frozen=True, eq=False)
class BoundPart:
    """The faces of a prim that wear one material.

    Attributes:
        material: path of the material prim, which may not exist; empty where nothing is bound.
        faces: ``(n,)`` int32 authored face indices, or None for all that no other part has.
    """

    material: str
    faces: IntArray | None = None


def bound_parts(prim: Usd.Prim, time: Usd.TimeCode, log: FindingLog) -> list[BoundPart]:
    """The parts of a prim by material; the part of all other faces comes last.

    Subsets are those of the ``materialBind`` family, as in UsdShade. Where two contain a face the first one wins.
    """
    parts: list[BoundPart] = []
    subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets() if prim.IsA(UsdGeom.Mesh) else []
    for subset in subsets:
        if subset.GetElementTypeAttr().Get() != UsdGeom.Tokens.face:
            path = subset.GetPath()
            log.add("subset_ignored", path, f"geom subset {path} is not made of faces and is not honoured")
            continue
        indices = np.array(subset.GetIndicesAttr().Get(time) or [], np.int32)
        parts.append(BoundPart(bound_material(subset.GetPrim()), indices))
    parts.append(BoundPart(bound_material(prim)))
    return parts


def subsets_vary(prim: Usd.Prim) -> bool:
    """Whether a material subset's faces may change over time."""
    if not prim.IsA(UsdGeom.Mesh):
        return False
    subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()
    return any(subset.GetIndicesAttr().ValueMightBeTimeVarying() for subset in subsets)


def bound_material(prim: Usd.Prim) -> str:
    """The path of the material on a prim, even one that does not exist; empty where nothing is bound."""
    material, relationship = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(_PURPOSE)
    if material:
        return str(material.GetPath())
    targets = relationship.GetTargets() if relationship else []
    return str(targets[-1]) if targets else ""


def face_owner(parts: list[BoundPart], face_count: int) -> IntArray:
    """``(face_count,)`` which part has each face."""
    owner = np.full(face_count, len(parts) - 1, np.int32)
    for number in range(len(parts) - 1, -1, -1):
        faces = parts[number].faces
        if faces is not None:
            owner[faces[(faces >= 0) & (faces < face_count)]] = number
    return owner
