"""Face-varying primvars of control meshes, such as texture coordinates: a mesh of their own, with sharp seams."""

from __future__ import annotations

import numpy as np

from render.model.arrays import BoolArray, IndexArray, LongArray
from render.stage.geometry.subdivision.topology import INFINITE, Topology, make_topology


def is_linear(rule: str) -> bool:
    """Whether values are interpolated within the control mesh's faces (``all``)."""
    return rule == "all"


def face_varying_topology(geometry: Topology, index: LongArray, rule: str) -> tuple[Topology, IndexArray]:
    """Topology of a face-varying primvar: corners at one point with one value share a point of it.

    Seams are its borders. They stay sharp. ``faceVaryingLinearInterpolation`` says which of their points do, too: those that one
    face alone has (``cornersOnly``), also those in which more than two parts meet (``cornersPlus1``) and the ends of seams
    (``cornersPlus2``), or all of them (``boundaries``).

    Args:
        geometry: control mesh, with all that is sharp.
        index: ``(c,)`` value of each corner.
        rule: one of these.

    Returns:
        The topology, and the value ``(n,)`` of each of its points.
    """
    keys = geometry.corners * (int(index.max(initial=0)) + 1) + index
    _, first, corners = np.unique(keys, return_index=True, return_inverse=True)
    bare = make_topology(len(first), geometry.counts, corners)
    edges = bare.edge_sharpness.copy()
    edges[bare.edge_of_corner] = geometry.edge_sharpness[geometry.edge_of_corner]
    is_seam = bare.edge_faces() != 2
    edges[is_seam] = INFINITE
    of_geometry = geometry.corners[first]
    points = geometry.point_sharpness[of_geometry].copy()
    points[_sharp_points(bare, is_seam, of_geometry, geometry.points, rule)] = INFINITE
    return Topology(bare.points, bare.counts, bare.corners, bare.edges, bare.edge_of_corner, edges, points), index[
        first
    ]


def _sharp_points(topology: Topology, is_seam: BoolArray, of_geometry: IndexArray, count: int, rule: str) -> BoolArray:
    on_seam = np.zeros(topology.points, bool)
    on_seam[topology.edges[is_seam].ravel()] = True
    faces = topology.faces_at_points()
    no_manifold = np.asarray(topology.edges_at_points() != faces + on_seam)
    if rule == "none":
        return no_manifold
    if rule == "boundaries":
        return np.asarray(no_manifold | on_seam)
    sharp = no_manifold | (on_seam & (faces == 1))
    if rule in ("cornersPlus1", "cornersPlus2"):
        values = np.bincount(of_geometry, minlength=count)[of_geometry]
        sharp |= values > 2
    if rule == "cornersPlus2":
        ends = np.bincount(topology.edges[is_seam].ravel(), minlength=topology.points)
        sharp |= on_seam & (ends != 2)
    return np.asarray(sharp)
