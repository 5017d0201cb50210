"""Normals of subdivision surfaces on both sides of what stays sharp in the limit."""

from __future__ import annotations

import numpy as np

from render.model.arrays import BoolArray, DoubleArray, IndexArray
from render.stage.geometry.polygons import Values, unit
from render.stage.geometry.subdivision.rules import sum_rows
from render.stage.geometry.subdivision.topology import INFINITE, Topology


def sharp_normals(topology: Topology, points: DoubleArray, *, left_handed: bool) -> Values | None:
    """Normals of each corner, one for each side of a crease. Semi-sharp creases are smooth in the limit and do not split them.

    At a crease those of the faces on one side are joined; at a corner, as where three creases meet, each face has its own
    (DeRose, Kass & Truong 1998, section 3, and OpenSubdiv's limit tangents). They are means of the faces' normals by area, as
    elsewhere on the surface.

    Args:
        topology: the mesh, with all that is sharp.
        points: ``(n, 3)`` where its points are.
        left_handed: whether faces are clockwise seen from outside.

    Returns:
        Face-varying normals, or None where nothing is sharp but borders.
    """
    stays = topology.edge_sharpness >= INFINITE
    inner = topology.edge_faces() > 1
    if not (stays & inner).any() and not _cones(topology).any():
        return None
    group = _groups(topology, stays)
    here, after, before = (points[topology.corners[topology.beside(step)]] for step in (0, 1, -1))
    normals = np.cross(after - here, before - here)
    summed = sum_rows(group, -normals if left_handed else normals, int(group.max(initial=-1)) + 1)
    return Values(unit(summed.astype(np.float32)), "faceVarying", group.astype(np.int32))


def _cones(topology: Topology) -> BoolArray:
    """``(n,)`` sharp points of several faces."""
    return np.asarray((topology.point_sharpness >= INFINITE) & (topology.faces_at_points() > 1))


def _groups(topology: Topology, stays: BoolArray) -> IndexArray:
    """``(c,)`` groups of corners at one point that have one normal."""
    creases = np.bincount(topology.edges[stays].ravel(), minlength=topology.points)
    is_corner = (topology.point_sharpness >= INFINITE) | (creases > 2)
    is_split = is_corner | (creases > 0)
    label = np.where(is_split[topology.corners], topology.points + np.arange(len(topology.corners)), topology.corners)
    one, other = _linked_corners(topology, stays)
    is_crease = (is_split & ~is_corner)[topology.corners[one]]
    one, other = one[is_crease], other[is_crease]
    while len(one):
        least = np.minimum(label[one], label[other])
        if (least == label[one]).all() and (least == label[other]).all():
            break
        np.minimum.at(label, one, least)
        np.minimum.at(label, other, least)
    return np.unique(label, return_inverse=True)[1]


def _linked_corners(topology: Topology, stays: BoolArray) -> tuple[IndexArray, IndexArray]:
    """Pairs of corners at one point, whose faces meet in an edge that is smooth."""
    edge = topology.edge_of_corner
    is_link = (~stays & (topology.edge_faces() == 2))[edge]
    linked = np.flatnonzero(is_link)
    first, second = linked[np.argsort(edge[linked], kind="stable")].reshape(-1, 2).T
    after = topology.beside(1)
    is_turned = (
        topology.corners[first] == topology.corners[after[second]]
    )  # else the faces do not agree on their outside
    at_begin = np.where(is_turned, after[second], second)
    at_end = np.where(is_turned, second, after[second])
    return np.concatenate([first, after[first]]), np.concatenate([at_begin, at_end])
