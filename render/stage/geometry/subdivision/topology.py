"""Faces, edges and sharpness of a control mesh, and those of the mesh after one step of refinement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray, IndexArray
from render.stage.geometry.polygons import BadGeometry

INFINITE = 10.0
"""Sharpness from which an edge or a point stays sharp however often it is refined (OpenSubdiv's ``SHARPNESS_INFINITE``)."""


@dataclass(frozen=True, eq=False)
class Topology:
    """Faces of at least three corners, and their edges. Edge of corner i leads from its point to that of the face's next corner.

    Attributes:
        points: number of points.
        counts: ``(f,)`` corners of each face.
        corners: ``(c,)`` point of each corner.
        edges: ``(e, 2)`` points at the ends of each edge.
        edge_of_corner: ``(c,)``.
        edge_sharpness: ``(e,)`` 0 is smooth, `INFINITE` and more stays sharp.
        point_sharpness: ``(n,)`` likewise.
    """

    points: int
    counts: IndexArray
    corners: IndexArray
    edges: IndexArray
    edge_of_corner: IndexArray
    edge_sharpness: DoubleArray
    point_sharpness: DoubleArray

    @property
    def starts(self) -> IndexArray:
        """``(f,)`` first corner of each face."""
        return np.cumsum(self.counts) - self.counts

    @property
    def face_of_corner(self) -> IndexArray:
        """``(c,)`` face of each corner."""
        return np.repeat(np.arange(len(self.counts)), self.counts)

    def beside(self, step: int) -> IndexArray:
        """``(c,)`` corner that lies some steps on in the same face."""
        face = self.face_of_corner
        start, count = self.starts[face], self.counts[face]
        return start + (np.arange(len(self.corners)) - start + step) % count

    def edge_faces(self) -> IndexArray:
        """``(e,)`` number of faces at each edge."""
        return np.bincount(self.edge_of_corner, minlength=len(self.edges))

    def edges_at_points(self) -> IndexArray:
        """``(n,)`` number of edges at each point."""
        return np.bincount(self.edges.ravel(), minlength=self.points)

    def faces_at_points(self) -> IndexArray:
        """``(n,)`` number of corners at each point."""
        return np.bincount(self.corners, minlength=self.points)


def make_topology(points: int, counts: IndexArray, corners: IndexArray) -> Topology:
    """Find the edges of faces. All of them are smooth, so far.

    Args:
        points: number of points.
        counts: ``(f,)`` corners of each face, at least three.
        corners: ``(c,)`` point of each corner, in range.
    """
    bare = Topology(
        points, counts, corners, np.zeros((0, 2), np.intp), np.zeros(0, np.intp), np.zeros(0), np.zeros(points)
    )
    ends = np.sort(np.stack([corners, corners[bare.beside(1)]], axis=1), axis=1)
    _, first, edge = np.unique(ends[:, 0] * points + ends[:, 1], return_index=True, return_inverse=True)
    return Topology(points, counts, corners, ends[first], edge, np.zeros(len(first)), np.zeros(points))


@dataclass(frozen=True, eq=False)
class Sharpness:
    """Sharpness that a mesh states, as in UsdGeom.Mesh.

    Attributes:
        creases: ``(k, 2)`` points at the ends of edges.
        of_creases: ``(k,)`` their sharpness.
        points: ``(m,)`` points.
        of_points: ``(m,)`` their sharpness.
    """

    creases: IndexArray
    of_creases: DoubleArray
    points: IndexArray
    of_points: DoubleArray


def sharpen(topology: Topology, stated: Sharpness | None, *, sharp_corners: bool) -> Topology:
    """Set what is sharp: what the mesh states, its border, and where its surface is no manifold.

    Args:
        topology: faces and edges.
        stated: stated sharpness; creases that are no edges count for nothing.
        sharp_corners: whether a point of the border that one face alone has is sharp (``edgeAndCorner``).

    Raises:
        BadGeometry: a stated point does not exist, or a sharpness is not a number.
    """
    edge, point = topology.edge_sharpness.copy(), topology.point_sharpness.copy()
    if stated is not None:
        _check(stated, topology.points)
        keys = topology.edges[:, 0] * topology.points + topology.edges[:, 1]
        low, high = np.sort(stated.creases, axis=1).T
        wanted = low * topology.points + high
        place = np.minimum(np.searchsorted(keys, wanted), max(len(keys) - 1, 0))
        if len(keys):
            is_edge = keys[place] == wanted
            np.maximum.at(edge, place[is_edge], stated.of_creases[is_edge])
        np.maximum.at(point, stated.points, stated.of_points)
    faces, edges = topology.faces_at_points(), topology.edges_at_points()
    edge[topology.edge_faces() != 2] = INFINITE
    is_border = np.zeros(topology.points, bool)
    is_border[topology.edges[topology.edge_faces() == 1].ravel()] = True
    point[edges != faces + is_border] = INFINITE  # fans that meet in a point alone
    if sharp_corners:
        point[is_border & (faces == 1)] = INFINITE
    return Topology(
        topology.points, topology.counts, topology.corners, topology.edges, topology.edge_of_corner, edge, point
    )


def _check(stated: Sharpness, points: int) -> None:
    for name, index in (("creaseIndices", stated.creases), ("cornerIndices", stated.points)):
        if index.size and not 0 <= index.min() <= index.max() < points:
            raise BadGeometry(f"{name} run from {index.min()} to {index.max()}, but there are {points} points")
    for name, values in (("creaseSharpnesses", stated.of_creases), ("cornerSharpnesses", stated.of_points)):
        if np.isnan(values).any():
            raise BadGeometry(f"{name} has a value that is not a number")


def soften(sharpness: DoubleArray) -> DoubleArray:
    """Sharpness after one step of refinement (uniform creases: DeRose, Kass & Truong 1998, section 3)."""
    return np.where(sharpness >= INFINITE, INFINITE, np.maximum(sharpness - 1.0, 0.0))


def split_in_quads(topology: Topology) -> Topology:
    """Topology after a step that makes a quad of each corner. Its points: the old ones, one of each edge, and of each face.

    Quad of corner i: the corner's point, its edge's, the face's, and that of the edge before.
    """
    old, edges, corners = topology.points, len(topology.edges), len(topology.corners)
    here, before = topology.corners, topology.beside(-1)
    after_edge, before_edge = topology.edge_of_corner, topology.edge_of_corner[before]
    face_point = old + edges + topology.face_of_corner
    number = np.arange(corners)

    def half(edge: IndexArray) -> IndexArray:
        return np.asarray(2 * edge + (topology.edges[edge, 1] == here))

    quads = np.stack([here, old + after_edge, face_point, old + before_edge], axis=1)
    own_edges = np.stack([half(after_edge), 2 * edges + number, 2 * edges + before, half(before_edge)], axis=1)
    halves = np.stack([topology.edges.ravel(), np.repeat(old + np.arange(edges), 2)], axis=1)
    spokes = np.stack([old + after_edge, face_point], axis=1)
    return Topology(
        old + edges + len(topology.counts),
        np.full(corners, 4, np.intp),
        quads.ravel(),
        np.concatenate([halves, spokes]),
        own_edges.ravel(),
        np.concatenate([np.repeat(soften(topology.edge_sharpness), 2), np.zeros(corners)]),
        np.concatenate([soften(topology.point_sharpness), np.zeros(edges + len(topology.counts))]),
    )


def split_in_triangles(topology: Topology) -> Topology:
    """Topology of triangles after a step that makes four of each. Its points are the old ones, then one of each edge.

    Of each triangle come the three at its corners, in order, and then that between its edges' points.
    """
    old, edges, faces = topology.points, len(topology.edges), len(topology.counts)
    here = topology.corners.reshape(-1, 3)
    edge = topology.edge_of_corner.reshape(-1, 3)
    before = edge[:, [2, 0, 1]]
    at_corner = np.stack([here, old + edge, old + before], axis=2)
    middle = old + edge[:, None, :]

    def half(of: IndexArray) -> IndexArray:
        return np.asarray(2 * of + (topology.edges[of, 1] == here))

    inner = 2 * edges + np.arange(3 * faces).reshape(
        -1, 3
    )  # across corner i, from its edge's point to that of the edge before
    edges_at_corner = np.stack([half(edge), inner, half(before)], axis=2)
    edges_of_middle = inner[:, [1, 2, 0]][:, None, :]
    halves = np.stack([topology.edges.ravel(), np.repeat(old + np.arange(edges), 2)], axis=1)
    across = np.stack([old + edge.ravel(), old + before.ravel()], axis=1)
    return Topology(
        old + edges,
        np.full(4 * faces, 3, np.intp),
        np.concatenate([at_corner, middle], axis=1).ravel(),
        np.concatenate([halves, across]),
        np.concatenate([edges_at_corner, edges_of_middle], axis=1).ravel(),
        np.concatenate([np.repeat(soften(topology.edge_sharpness), 2), np.zeros(3 * faces)]),
        np.concatenate([soften(topology.point_sharpness), np.zeros(edges)]),
    )


def split(topology: Topology, *, in_triangles: bool) -> Topology:
    """Topology after a step of the schemes of triangles (Loop), or of all others."""
    return split_in_triangles(topology) if in_triangles else split_in_quads(topology)


def part_of(topology: Topology, faces: IndexArray) -> tuple[Topology, IndexArray]:
    """Topology of some faces, and the points ``(n,)`` that are its own, ascending. Edges that lose a face are sharp."""
    is_chosen = np.zeros(len(topology.counts), bool)
    is_chosen[faces] = True
    chosen = is_chosen[topology.face_of_corner]
    points, corners = np.unique(topology.corners[chosen], return_inverse=True)
    bare = make_topology(len(points), topology.counts[is_chosen], corners)
    edges = bare.edge_sharpness.copy()
    edges[bare.edge_of_corner] = topology.edge_sharpness[topology.edge_of_corner[chosen]]
    edges[bare.edge_faces() != 2] = INFINITE
    sharpness = topology.point_sharpness[points]
    return Topology(bare.points, bare.counts, bare.corners, bare.edges, bare.edge_of_corner, edges, sharpness), points
