"""Values at the points of refined meshes by the rules of Catmull-Clark, Loop and bilinear refinement, and limit positions.

Sources: Catmull & Clark 1978, "Recursively generated B-spline surfaces on arbitrary topological meshes"; Loop 1987, "Smooth
subdivision surfaces based on triangles"; Halstead, Kass & DeRose 1993, "Efficient, fair interpolation using Catmull-Clark
surfaces" (limit positions); DeRose, Kass & Truong 1998, "Subdivision surfaces in character animation" (creases). Where they leave
choices, those of OpenSubdiv 3 hold, which USD names: blends of rules at a point, borders, and the weights of smooth triangles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from render.model.arrays import BoolArray, DoubleArray, IndexArray
from render.stage.geometry.subdivision.topology import INFINITE, Topology, part_of, soften, split

Scheme = Literal["catmullClark", "loop", "bilinear"]

_SMOOTH_TRIANGLE = 0.470
"""Weight of a triangle's middle in an edge's point by the rule ``smooth``; quads have 1/4."""


@dataclass(frozen=True, eq=False)
class PointRules:
    """Rules at points: their shares add up to 1.

    Attributes:
        smooth: ``(n,)`` share of the smooth rule.
        crease: ``(n,)`` share of the rule along a crease.
        corner: ``(n,)`` share of the rule that keeps a point.
        creased: ``(k,)`` points with a share of the crease rule.
        along: ``(k, 2)`` neighbours of these points along the crease.
    """

    smooth: DoubleArray
    crease: DoubleArray
    corner: DoubleArray
    creased: IndexArray
    along: IndexArray


def point_rules(topology: Topology, *, at_limit: bool = False) -> PointRules:
    """Rules at the points of a mesh for the next step; where sharpness ends in it, those of before and after are mixed.

    Args:
        topology: the mesh.
        at_limit: take what is sharp for sharp for ever.
    """
    sharp = topology.edge_sharpness > 0
    edge_after = topology.edge_sharpness if at_limit else soften(topology.edge_sharpness)
    point_after = topology.point_sharpness if at_limit else soften(topology.point_sharpness)
    now, now_count = _rules(topology, sharp, topology.point_sharpness)
    later, later_count = _rules(topology, edge_after > 0, point_after)
    share = _share_of_now(topology, edge_after, point_after)
    shares = [
        np.where(now == later, now == rule, share * (now == rule) + (1 - share) * (later == rule)) for rule in range(3)
    ]
    smooth, crease, corner = (np.asarray(each, np.float64) for each in shares)
    creased = np.flatnonzero(crease > 0)
    along = np.zeros((topology.points, 2), np.intp)
    for count, edges in ((now_count, sharp), (later_count, edge_after > 0)):
        _note_neighbours(topology, edges, count == 2, along)
    return PointRules(smooth, crease, corner, creased, along[creased])


_SMOOTH, _CREASE, _CORNER = range(3)


def _rules(topology: Topology, sharp: BoolArray, point_sharpness: DoubleArray) -> tuple[IndexArray, IndexArray]:
    count = np.bincount(topology.edges[sharp].ravel(), minlength=topology.points)
    rules = np.where(count == 2, _CREASE, np.where(count > 2, _CORNER, _SMOOTH))
    return np.where(point_sharpness > 0, _CORNER, rules), count


def _share_of_now(topology: Topology, edge_after: DoubleArray, point_after: DoubleArray) -> DoubleArray:
    """Mean of what is sharp now and not after the step, at each point."""
    total, count = np.zeros(topology.points), np.zeros(topology.points)
    ends = (topology.edge_sharpness > 0) & (edge_after <= 0)
    for side in range(2):
        points = topology.edges[ends, side]
        total += np.bincount(points, topology.edge_sharpness[ends], topology.points)
        count += np.bincount(points, minlength=topology.points)
    ends = (topology.point_sharpness > 0) & (point_after <= 0)
    total[ends] += topology.point_sharpness[ends]
    count[ends] += 1
    return np.asarray(total / np.maximum(count, 1))


def _note_neighbours(topology: Topology, sharp: BoolArray, wanted: BoolArray, along: IndexArray) -> None:
    """Note the ends of the two sharp edges at each wanted point."""
    edges = topology.edges[sharp]
    here, other = np.concatenate([edges[:, 0], edges[:, 1]]), np.concatenate([edges[:, 1], edges[:, 0]])
    chosen = wanted[here]
    order = np.argsort(here[chosen], kind="stable")
    points = here[chosen][order]
    along[points[::2]] = other[chosen][order].reshape(-1, 2)


@dataclass(frozen=True, eq=False)
class Step:
    """One step of refinement: values at the points of a mesh to values at those of the finer one.

    Attributes:
        scheme: rules of points and edges.
        topology: the mesh before the step.
        smooth_triangles: whether edges of triangles have the weights of the triangle rule ``smooth``; Catmull-Clark alone.
    """

    scheme: Scheme
    topology: Topology
    smooth_triangles: bool = False

    def refine(self, values: DoubleArray, *, linear: bool = False) -> DoubleArray:
        """Refine values ``(n, k)``, linearly or by the scheme's rules: of old points, edges and, but for Loop, faces."""
        faces = self._face_means(values)
        middles = values[self.topology.edges].mean(axis=1)
        if linear or self.scheme == "bilinear":
            parts = [values, middles]
        else:
            rules = point_rules(self.topology)
            is_loop = self.scheme == "loop"
            edges = self._loop_edges(values, middles) if is_loop else self._quad_edges(values, middles, faces)
            smooth = self._loop_points(values) if is_loop else self._quad_points(values, faces)
            parts = [_mix(rules, values, smooth, 0.75), edges]
        return np.concatenate(parts if self.scheme == "loop" else [*parts, faces])

    def _face_means(self, values: DoubleArray) -> DoubleArray:
        topology = self.topology
        if not len(topology.counts):
            return np.zeros((0, values.shape[1]))
        sums = np.add.reduceat(values[topology.corners], topology.starts, axis=0)
        return np.asarray(sums / topology.counts[:, None])

    def _mix_edges(self, middles: DoubleArray, smooth: DoubleArray) -> DoubleArray:
        sharp = np.minimum(self.topology.edge_sharpness, 1.0)[:, None]
        return np.asarray(sharp * middles + (1 - sharp) * smooth)

    def _quad_edges(self, values: DoubleArray, middles: DoubleArray, faces: DoubleArray) -> DoubleArray:
        topology = self.topology
        face, edge, count = topology.face_of_corner, topology.edge_of_corner, len(topology.edges)
        around = sum_rows(edge, faces[face], count) / 2
        weight = np.full(count, 0.5)  # of the faces' mean
        if self.smooth_triangles:
            each = np.where(topology.counts[face] == 3, _SMOOTH_TRIANGLE, 0.25)
            weight = np.bincount(edge, each, count)
        return self._mix_edges(middles, (1 - weight[:, None]) * middles + weight[:, None] * around)

    def _quad_points(self, values: DoubleArray, faces: DoubleArray) -> DoubleArray:
        topology = self.topology
        valence = np.maximum(topology.edges_at_points(), 1)[:, None].astype(np.float64)
        around = neighbour_sums(topology, values) + sum_rows(
            topology.corners, faces[topology.face_of_corner], topology.points
        )
        return np.asarray((1 - 2 / valence) * values + around / valence**2)

    def _loop_edges(self, values: DoubleArray, middles: DoubleArray) -> DoubleArray:
        topology = self.topology
        opposite = values[topology.corners[topology.beside(-1)]]
        return self._mix_edges(
            middles, 0.75 * middles + sum_rows(topology.edge_of_corner, opposite, len(topology.edges)) / 8
        )

    def _loop_points(self, values: DoubleArray) -> DoubleArray:
        valence = np.maximum(self.topology.edges_at_points(), 1)[:, None]
        weight = _loop_weight(valence)
        return np.asarray((1 - valence * weight) * values + weight * neighbour_sums(self.topology, values))


_STEPS_AT_ENDS = 20
"""Steps by which the limit position of a crease's end is found: each halves what is left."""
MOST_UNSETTLED = 20_000
"""Points without a closed form whose limit is found; of more, as of a mesh that is all creases, sharp is sharp for ever."""


def limit(scheme: Scheme, topology: Topology, values: DoubleArray) -> DoubleArray:
    """Values ``(n, k)`` at the points of a refined mesh brought to the limit surface.

    Points whose rules change in later steps, or at which one sharp edge ends, have no closed form: the faces around them are
    refined on.

    Args:
        scheme: rules.
        topology: a mesh of quads, or of triangles for Loop.
        values: at its points.
    """
    if scheme == "bilinear":
        return values
    found = _limit_by_rules(scheme, topology, values)
    unsettled = _unsettled(topology)
    if 0 < np.count_nonzero(unsettled) <= MOST_UNSETTLED:
        points = np.flatnonzero(unsettled)
        found[points] = _limit_by_steps(scheme, topology, values, points)
    return found


def _limit_by_rules(scheme: Scheme, topology: Topology, values: DoubleArray) -> DoubleArray:
    valence = np.maximum(topology.edges_at_points(), 1)[:, None].astype(np.float64)
    near = neighbour_sums(topology, values)
    if scheme == "loop":
        weight = 1 / (valence + 3 / (8 * _loop_weight(valence)))
        smooth = (1 - valence * weight) * values + weight * near
    else:
        across = sum_rows(topology.corners, values[topology.corners[topology.beside(2)]], topology.points)
        smooth = (valence**2 * values + 4 * near + across) / (valence * (valence + 5))
    return _mix(point_rules(topology, at_limit=True), values, smooth, 2 / 3)


def _limit_by_steps(scheme: Scheme, topology: Topology, values: DoubleArray, points: IndexArray) -> DoubleArray:
    """Values ``(k, n)`` at some points, by refining the faces around them until their rules stay."""
    left = _STEPS_AT_ENDS
    while left > 0:
        is_wanted = np.zeros(topology.points, bool)
        is_wanted[points] = True
        faces = np.unique(topology.face_of_corner[is_wanted[topology.corners]])
        part, own = part_of(topology, faces)
        points = np.searchsorted(own, points)
        values = Step(scheme, part).refine(values[own])
        topology = split(part, in_triangles=scheme == "loop")
        if not _changes(topology)[points].any():
            left = left - 1 if _ends(topology)[points].any() else 0
    return _limit_by_rules(scheme, topology, values)[points]


def _unsettled(topology: Topology) -> BoolArray:
    """``(n,)`` points of faces that have no closed form."""
    return np.asarray((_changes(topology) | _ends(topology)) & (topology.faces_at_points() > 0))


def _changes(topology: Topology) -> BoolArray:
    """``(n,)`` points whose rule changes in later steps."""
    changing = (topology.edge_sharpness > 0) & (topology.edge_sharpness < INFINITE)
    points = (topology.point_sharpness > 0) & (topology.point_sharpness < INFINITE)
    points[topology.edges[changing].ravel()] = True
    return np.asarray(points)


def _ends(topology: Topology) -> BoolArray:
    """``(n,)`` smooth points at which one sharp edge ends."""
    count = np.bincount(topology.edges[topology.edge_sharpness > 0].ravel(), minlength=topology.points)
    return np.asarray((count == 1) & (topology.point_sharpness <= 0))


def _loop_weight(valence: DoubleArray | IndexArray) -> DoubleArray:
    return np.asarray((5 / 8 - (3 / 8 + np.cos(2 * np.pi / valence) / 4) ** 2) / valence)


def _mix(rules: PointRules, values: DoubleArray, smooth: DoubleArray, kept: float) -> DoubleArray:
    """Mix values by the rules at points; along a crease, ``kept`` of a point's value stays."""
    mixed = rules.smooth[:, None] * smooth + (rules.corner + kept * rules.crease)[:, None] * values
    mixed[rules.creased] += (1 - kept) * rules.crease[rules.creased, None] * values[rules.along].mean(axis=1)
    return np.asarray(mixed)


def neighbour_sums(topology: Topology, values: DoubleArray) -> DoubleArray:
    """``(n, k)`` sum of the values at the other ends of each point's edges."""
    first, last = topology.edges.T
    return sum_rows(first, values[last], topology.points) + sum_rows(last, values[first], topology.points)


def sum_rows(index: IndexArray, rows: DoubleArray, count: int) -> DoubleArray:
    """``(count, k)`` sums of the rows of each index."""
    return (
        np.stack([np.bincount(index, column, count) for column in rows.T], axis=1)
        if rows.shape[1]
        else np.zeros((count, 0))
    )
