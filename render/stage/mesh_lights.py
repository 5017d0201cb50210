"""Surfaces that shine: prims with MeshLightAPI, and what a GeometryLight names."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from pxr import Usd

from render.model.arrays import DoubleArray
from render.stage.findings import FindingLog
from render.stage.geometry.polygons import check, fan
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.subdivision.reading import is_refined
from render.stage.geometry.surface import is_drawable, read_surface

_LEVEL = 2  # steps of refinement of subdivision surfaces that shine, whatever the camera


def shining_prims(prim: Usd.Prim) -> list[Usd.Prim]:
    """Prims whose surfaces a light prim shines from: itself, or those that its relationship ``geometry`` names."""
    if is_drawable(prim):
        return [prim]
    relationship = prim.GetRelationship("geometry")
    targets = relationship.GetForwardedTargets() if relationship else []
    named = (prim.GetStage().GetPrimAtPath(target) for target in targets)
    return [target for target in named if target and is_drawable(target)]


def shining_triangles(
    placed: Iterable[tuple[Usd.Prim, DoubleArray]],
    time: Usd.TimeCode,
    skeletons: Skeletons,
    log: FindingLog,
    complexity: str,
) -> DoubleArray:
    """Triangles ``(m, 3, 3)`` of surfaces: corners in the world, metres, counter-clockwise seen from outside.

    Args:
        placed: prims, and ``(4, 4)`` world from each.
        time: when.
        skeletons: bend meshes.
        log: for findings.
        complexity: of the surfaces (`render.stage.options.StageOptions`).

    Raises:
        BadGeometry: a surface's values contradict each other.
    """
    found = [np.zeros((0, 3, 3))]
    for prim, pose in placed:
        polygons = read_surface(prim, time, skeletons, log, _LEVEL if is_refined(prim, complexity) else 0)
        check(polygons)
        points = polygons.points.astype(np.float64) @ pose[:3, :3].T + pose[:3, 3]
        triangles = points[polygons.corners[fan(polygons).corners]]
        is_turned = polygons.left_handed != bool(np.linalg.det(pose[:3, :3]) < 0)
        found.append(triangles[:, ::-1] if is_turned else triangles)
    return np.concatenate(found)
