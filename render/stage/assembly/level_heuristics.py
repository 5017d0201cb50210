"""Heuristics of levels of detail (UsdLod), which USD computes, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom, UsdLod

from render.model.arrays import DoubleArray
from render.stage.values import format_value, schema_type

_DOMAIN = "imaging"
_ORDERS = {"LODDistanceHeuristic": ("ascending", 1), "LODScreenSizeHeuristic": ("descending", -1)}
"""Heuristics that are known, and the order and sign of the steps of their thresholds."""


class HeuristicError(ValueError):
    """Heuristic that cannot be used; the message ends a sentence."""


def make_query(prim: Usd.Prim, time: Usd.TimeCode) -> UsdLod.HeuristicQuery | None:
    """Make the query that computes levels by a heuristic at a time; None where the heuristic is for others than pictures.

    Raises:
        HeuristicError: it cannot be used.
    """
    kind = schema_type(prim) if prim else ""
    domain = UsdLod.Heuristic(prim).GetLodDomainAttr().Get() if kind and prim.IsA(UsdLod.Heuristic) else None
    if domain and domain != _DOMAIN:
        return None
    if kind not in _ORDERS:
        raise HeuristicError(f"it must be one of {', '.join(_ORDERS)}, and is {kind or 'missing'}")
    if not domain:
        raise HeuristicError(f"its lod:domain must be {_DOMAIN}, and there is none")
    try:
        if kind == "LODDistanceHeuristic":
            query: UsdLod.HeuristicQuery = UsdLod.DistanceHeuristic(prim).CreateDistanceHeuristicQuery(time)
        else:
            query = UsdLod.ScreenSizeHeuristic(prim).CreateScreenSizeHeuristicQuery(time)
    except Tf.ErrorException as problem:
        raise HeuristicError(f"it cannot be read ({' '.join(str(problem).split())})") from problem
    if kind == "LODScreenSizeHeuristic" and query.projectionMethod not in ("projectedSphere", "projectedExtent"):
        raise HeuristicError(f"USD knows no projectionMethod {query.projectionMethod!r}")
    order, sign = _ORDERS[kind]
    thresholds = np.array(query.thresholds, np.float64)
    if not np.isfinite(thresholds).all() or (sign * np.diff(thresholds) < 0).any():
        expected = f"its thresholds must be finite numbers in {order} order"
        raise HeuristicError(f"{expected}, got {format_value(query.thresholds)}")
    if kind == "LODScreenSizeHeuristic" and query.extent.IsEmpty():
        raise HeuristicError("its extent must be two corners, the lower one first")
    if kind == "LODDistanceHeuristic" and not np.isfinite(query.center).all():
        raise HeuristicError(f"its center must be finite numbers, got {format_value(query.center)}")
    if not (query.extent.IsEmpty() or np.isfinite([*query.extent.GetMin(), *query.extent.GetMax()]).all()):
        raise HeuristicError("the extent that it measures must be finite numbers")
    return query


def find_faults(prim: Usd.Prim, query: UsdLod.HeuristicQuery, time: Usd.TimeCode) -> Iterator[str]:
    """Faults of a heuristic that USD passes over; each ends a sentence."""
    blends = np.array(query.blendThresholds, np.float64)
    if len(blends) and (len(blends) != len(query.thresholds) or not np.isfinite(blends).all()):
        expected = f"its blendThresholds must be {len(query.thresholds)} finite numbers, as its thresholds are, or none"
        yield f"{expected}, got {format_value(query.blendThresholds)}"
    volumes = prim.GetRelationship("boundingVolume").GetForwardedTargets()
    boundables = (UsdGeom.Boundable(prim.GetStage().GetPrimAtPath(path)) for path in volumes)
    if volumes and not any(boundable and boundable.GetExtentAttr().Get(time) for boundable in boundables):
        yield f"its boundingVolume must name a prim with an extent, got {volumes[0]}"


def compute_levels(query: UsdLod.HeuristicQuery, camera: Gf.Camera, places: Sequence[Gf.Matrix4d]) -> DoubleArray:
    """Levels ``(k,)``, between which there are mixes, that a camera shows of roots at some places.

    Args:
        query: of a heuristic.
        camera: the camera.
        places: stage from the root's own space, as USD has it.

    Raises:
        HeuristicError: USD finds none.
    """
    is_distance = isinstance(query, UsdLod.DistanceHeuristicQuery)
    if not is_distance and camera.projection == Gf.Camera.Perspective and not 0 < camera.focalLength < np.inf:
        raise HeuristicError(
            f"the focalLength of the camera must be a finite number above 0, got {camera.focalLength:g}"
        )
    try:
        view = camera.frustum.GetPosition() if is_distance else camera.frustum
        levels = np.array([query.ComputeLOD(view, place) for place in places], np.float64)
    except Tf.ErrorException as problem:
        raise HeuristicError(f"it cannot be computed ({' '.join(str(problem).split())})") from problem
    if not np.isfinite(levels).all():
        raise HeuristicError("its levels are not finite numbers")
    return levels
