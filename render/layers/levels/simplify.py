"""Simpler levels of a geometry: vertices of a cell of a grid become one, where the surface hardly leaves its planes.

A geometry is cut into *sections*: successive triangles, mostly of one mesh. Each section has levels of its own, whose error
doubles from level to level. A level of error e is made of the one before in steps. In each step the vertices of every cell of
a grid become their mean (Rossignac & Borrel 1993, "Multi-resolution 3D approximations for rendering complex scenes"), for
cells of a width of e, 2e and 4e. Where that would leave the plane of a triangle around one of them by more than e, the steps
before counted in, a cell's vertices stay, as at edges and on thin things (the distance of Ronfard & Rossignac 1996,
"Full-range approximation of triangulated polyhedra"). Normals, texture coordinates and colours are averaged over those
vertices of a cell that triangles join within the cell, so that seams stay.

Vertices on the border of a section stay too, so that no gap opens between sections at different levels. A level that loses
more than a quarter of its section's area, as of grass, is not made, nor a coarser one. A level has at most half as many
triangles and vertices as the one before, so that all levels together have fewer than the geometry.

The library `fast-simplification` 0.2.0 (edges collapsed by quadrics) was measured in place of this: it takes 1.5 to 2.1 s for
one level of a million triangles without giving way to other threads, another 2.4 s for the map that carries attributes over,
and states no error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from render.layers.bounds import CLUSTER_TRIANGLES
from render.layers.clusters import GeometryClusters, cut_clusters
from render.model.arrays import DoubleArray, FloatArray, IndexArray, IntArray
from render.model.scene import VALUES_WIDTH, Geometry

LEAST_TRIANGLES = 4096
"""Triangles of the smallest geometry that has levels, and of the smallest section that is cut off."""
MOST_TRIANGLES = 32768
"""Triangles of the largest section."""
CELLS = (1.0, 2.0, 4.0)
"""Widths of the cells of a level's steps, in units of its error."""
_LEAST_AREA = 3 / 4
_LEAST_SHARE = 0.9  # of a level's points that stay in another one worth going on for
_GRID_BITS = 20
_SPREAD = (  # shifts and masks that put two zeros between the bits of a number
    (32, 0x1F00000000FFFF),
    (16, 0x1F0000FF0000FF),
    (8, 0x100F00F00F00F00F),
    (4, 0x10C30C30C30C30C3),
    (2, 0x1249249249249249),
)
_MOST_ROUNDS = 16  # of labels that spread within a cell; beyond, parts of it have attributes of their own
_FIRST_CELL, _LEAST_CELL = 2.0, 1.0  # widest cell of the first level, narrowest of all, in median edges


@dataclass(frozen=True, eq=False)
class Levels:
    """Levels of a geometry.

    A cluster is `CLUSTER_TRIANGLES` successive triangles, and belongs to one section, and in ``geometry`` to one level. In each
    section, those clusters are drawn for which ``error_m <= allowed < coarser_m``.

    Attributes:
        geometry: triangles of all levels of all sections, without prims, faces and fans.
        clusters: its clusters, with cones.
        section: ``(c,)`` section of each cluster of ``geometry``.
        error_m: ``(c,)`` float64 error of the cluster's level, in the geometry's metres.
        coarser_m: ``(c,)`` float64 error of the next coarser level of its section, infinite where there is none.
        full_section: ``(f,)`` section of each cluster of the geometry that they were made of.
        full_coarser_m: ``(f,)`` float64 error of the first level of that section, infinite where it has none.
    """

    geometry: Geometry
    clusters: GeometryClusters
    section: IndexArray
    error_m: DoubleArray
    coarser_m: DoubleArray
    full_section: IndexArray
    full_coarser_m: DoubleArray


@dataclass(frozen=True, eq=False)
class _Mesh:
    """Triangles of a section at some level.

    Attributes:
        points: ``(p, 3)`` float64 positions, relative to the section's box, metres.
        cells: ``(p, 3)`` cells of the finest grid that hold them, or did before they were merged.
        is_fixed: ``(p,)`` whether a point stays in all levels.
        mass: ``(p,)`` number of the first points that each stands for.
        error_m: ``(p,)`` how far a point may be off the planes of the triangles that it stands for.
        values: ``(v, k)`` float64 normal, texture coordinates and colour of each vertex.
        weight: ``(v,)`` number of the first vertices that each stands for.
        point: ``(v,)`` point of each vertex.
        triangles: ``(t, 3)`` vertices.
    """

    points: DoubleArray
    cells: NDArray[np.int64]
    is_fixed: NDArray[np.bool_]
    mass: DoubleArray
    error_m: DoubleArray
    values: DoubleArray
    weight: DoubleArray
    point: IndexArray
    triangles: IndexArray


def make_levels(geometry: Geometry, is_stale: Callable[[], bool] = lambda: False) -> Levels | None:
    """Make the levels of a geometry. The same geometry has the same levels.

    Args:
        geometry: any geometry.
        is_stale: polled before each section; once it returns True, nothing more is made.

    Returns:
        The levels; None where the geometry has fewer than `LEAST_TRIANGLES` triangles, where no section has a level, or where
        the work is stale.
    """
    if len(geometry.triangles) < LEAST_TRIANGLES or not np.isfinite(geometry.positions).all():
        return None
    ends = cut_sections(geometry.prim_ids)
    starts = [0, *ends[:-1]]
    scratch = np.zeros(len(geometry.positions), np.intp)
    values = _values(geometry)
    made: list[tuple[int, int, float, _Mesh, DoubleArray]] = []  # level, section, error, mesh, origin
    firsts = np.full(len(ends), np.inf)
    errors: list[list[float]] = [[] for _ in ends]
    for section, (start, end) in enumerate(zip(starts, ends, strict=True)):
        if is_stale():
            return None
        if end - start <= CLUSTER_TRIANGLES:
            continue
        mesh, origin = _section(geometry, values, start, end, scratch)
        for error_m, level in _levels_of(mesh):
            made.append((len(errors[section]), section, error_m, level, origin))
            errors[section].append(error_m)
        if errors[section]:
            firsts[section] = errors[section][0]
    if not made:
        return None
    made.sort(key=lambda one: one[:2])  # neighbours of one level follow each other, so that they are drawn as one range
    sizes = [_clusters(len(level.triangles)) for _, _, _, level, _ in made]
    full_section = np.repeat(np.arange(len(ends)), np.diff([0, *(-(-end // CLUSTER_TRIANGLES) for end in ends)]))
    joined = _join([(level, origin) for _, _, _, level, origin in made], geometry)
    return Levels(
        joined,
        cut_clusters(joined, cones=True),
        np.repeat([section for _, section, _, _, _ in made], sizes),
        np.repeat([error_m for _, _, error_m, _, _ in made], sizes),
        np.repeat([[*errors[section], np.inf][number + 1] for number, section, _, _, _ in made], sizes),
        full_section,
        firsts[full_section],
    )


def cut_sections(prim_ids: IntArray) -> list[int]:
    """Ends of sections, ascending.

    Sections are whole clusters. One ends with a prim once it has `LEAST_TRIANGLES`, or else after `MOST_TRIANGLES`. A cluster in
    which two such sections meet is a section by itself, too small for levels, so that none has parts that are far apart.

    Args:
        prim_ids: ``(m,)`` prim of each triangle.
    """
    count = len(prim_ids)
    prims = np.append(np.flatnonzero(np.diff(prim_ids)) + 1, count)
    ends, start = [], 0
    while start < count:
        end = int(prims[np.searchsorted(prims, min(start + LEAST_TRIANGLES, count))])
        end = min(start + MOST_TRIANGLES, end)
        if end < count and end % CLUSTER_TRIANGLES:
            end -= end % CLUSTER_TRIANGLES
            ends.append(end)
            end += CLUSTER_TRIANGLES
        start = min(end, count)
        ends.append(start)
    return ends


def _values(geometry: Geometry) -> FloatArray:
    """Attributes of the vertices side by side."""
    parts = [geometry.normals, geometry.uvs, geometry.values, geometry.colors]
    return np.concatenate([part for part in parts if part is not None], axis=1)


def _section(
    geometry: Geometry, values: FloatArray, start: int, end: int, scratch: IndexArray
) -> tuple[_Mesh, DoubleArray]:
    """Triangles of a section, and the least corner of their box."""
    flat = geometry.triangles[start:end].ravel()
    used, triangles = _compress(flat, scratch)
    positions = geometry.positions[used].astype(np.float64)
    origin = positions.min(0)
    positions -= origin
    cells = (positions * ((2**_GRID_BITS - 1) / max(float(positions.max()), 1e-30))).astype(np.int64)
    _, first, point = np.unique(_pack(cells), return_index=True, return_inverse=True)
    corners = point[triangles].reshape(-1, 3)
    return (
        _Mesh(
            positions[first],
            cells[first],
            _on_border(corners, len(first)),
            np.ones(len(first)),
            np.zeros(len(first)),
            values[used].astype(np.float64),
            np.ones(len(used)),
            point,
            triangles.reshape(-1, 3),
        ),
        origin,
    )


def _levels_of(mesh: _Mesh) -> Iterator[tuple[float, _Mesh]]:
    """Error in metres and triangles of each level of a section, finest first."""
    extent_m = float(mesh.points.max())
    edge_m = float(np.median(np.linalg.norm(np.diff(mesh.points[mesh.point[mesh.triangles[:, :2]]], axis=1), axis=2)))
    if not edge_m > 0:
        return
    least_area = _LEAST_AREA * _normals(mesh)[1].sum()
    triangles, vertices = len(mesh.triangles), len(mesh.point)
    finest_m = extent_m * 2.0**-_GRID_BITS
    first = max(2, round(np.log2(_FIRST_CELL * edge_m / finest_m)))
    for widest in range(first, _GRID_BITS + 1):
        error_m, before = finest_m * 2.0**widest / CELLS[-1], len(mesh.points)
        for cell in CELLS:
            shift = widest + round(np.log2(cell / CELLS[-1]))
            if finest_m * 2.0**shift >= _LEAST_CELL * edge_m:
                mesh = _merge(mesh, shift, error_m)
        padded = _clusters(len(mesh.triangles)) * CLUSTER_TRIANGLES
        if padded <= triangles / 2 and len(mesh.point) <= vertices / 2:
            if not len(mesh.triangles) or _normals(mesh)[1].sum() < least_area:
                return
            yield error_m, _sort(mesh)
            triangles, vertices = padded, len(mesh.point)
        elif widest >= first + 2 and len(mesh.points) > _LEAST_SHARE * before:
            return


def _merge(mesh: _Mesh, shift: int, error_m: float) -> _Mesh:
    """Merge the points of each cell of the grid whose cells are ``2**shift`` of the finest wide, where the error allows it."""
    count = len(mesh.points)
    cells = _pack(mesh.cells >> shift)
    free = np.flatnonzero(~mesh.is_fixed)
    group = np.arange(count)
    _, first, inverse = np.unique(cells[free], return_index=True, return_inverse=True)
    group[free] = free[first][inverse]
    means = _means(mesh.points, mesh.mass, group)
    corners = mesh.point[mesh.triangles]
    normals = _normals(mesh)[0]
    height = np.einsum("tx,tx->t", normals, mesh.points[corners[:, 0]])
    leaves = np.abs(np.einsum("tx,tcx->tc", normals, means[group[corners]]) - height[:, None]) + mesh.error_m[corners]
    error = np.zeros(count)
    np.maximum.at(error, group[corners].ravel(), leaves.ravel())
    stays = error[group] > error_m
    group = np.where(stays, np.arange(count), group)

    label = _label_parts(mesh, group)
    kept = group[corners]
    whole = (kept[:, 0] != kept[:, 1]) & (kept[:, 1] != kept[:, 2]) & (kept[:, 2] != kept[:, 0])
    vertices, triangles = _compress(label[mesh.triangles[whole]].ravel(), np.zeros(len(label), np.intp))
    points, point = _compress(group[mesh.point[vertices]], np.zeros(count, np.intp))
    return _Mesh(
        np.where(stays[:, None], mesh.points, means)[points],
        mesh.cells[points],
        mesh.is_fixed[points],
        np.bincount(group, mesh.mass, count).astype(np.float64)[points],
        np.where(stays, mesh.error_m, error)[points],
        _means(mesh.values, mesh.weight, label)[vertices],
        np.bincount(label, mesh.weight, len(label)).astype(np.float64)[vertices],
        point,
        triangles.reshape(-1, 3),
    )


def _label_parts(mesh: _Mesh, group: IndexArray) -> IndexArray:
    """Label for each vertex: one of those that edges within its group of points join it to, the same for all of them."""
    ends = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]])
    own = group[mesh.point]
    a, b = ends[own[ends[:, 0]] == own[ends[:, 1]]].T
    label = np.arange(len(mesh.point))
    for _ in range(_MOST_ROUNDS):
        least = np.minimum(label[a], label[b])
        before = label.copy()
        np.minimum.at(label, a, least)
        np.minimum.at(label, b, least)
        label = label[label]
        if np.array_equal(label, before):
            break
    return label


def _on_border(corners: IndexArray, count: int) -> NDArray[np.bool_]:
    """Whether points are on a border: where the triangles around a point do not close, or disagree on the side outside.

    Around a point within a surface, each neighbour follows once and precedes once, so that random numbers of those that follow
    and of those that precede have the same sum.
    """
    number = np.random.default_rng(0).integers(1, 1 << 40, count).astype(np.float64)
    total = np.zeros(count)
    for i in range(3):
        after, before = number[corners[:, (i + 1) % 3]], number[corners[:, (i + 2) % 3]]
        total += np.bincount(corners[:, i], after - before, count)
    return np.asarray(total != 0)


def _means(values: DoubleArray, weight: DoubleArray, group: IndexArray) -> DoubleArray:
    """Weighted mean of each group's rows, at the group's number."""
    count = len(values)
    total = np.maximum(np.bincount(group, weight, count), 1e-300)
    return np.stack([np.bincount(group, weight * column, count) / total for column in values.T], axis=1)


def _pack(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    return (cells[:, 0] << 42) | (cells[:, 1] << 21) | cells[:, 2]


def _compress(numbers: IndexArray | IntArray, scratch: IndexArray) -> tuple[IndexArray, IndexArray]:
    """Distinct numbers in some fixed order, and the place of each number among them; ``scratch`` is longer than any number."""
    places = np.arange(len(numbers))
    scratch[numbers] = places
    distinct = np.asarray(numbers[scratch[numbers] == places], np.intp)
    scratch[distinct] = np.arange(len(distinct))
    return distinct, scratch[numbers]


def _normals(mesh: _Mesh) -> tuple[DoubleArray, DoubleArray]:
    """Unit normal ``(t, 3)`` and area ``(t,)`` of each triangle; the normal is 0 where the area is."""
    corners = mesh.points[mesh.point[mesh.triangles]]
    (x, y, z), (u, v, w) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    normals = np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=1)
    double = np.sqrt(np.einsum("tx,tx->t", normals, normals))
    return normals / np.maximum(double, 1e-300)[:, None], double / 2


def _sort(mesh: _Mesh) -> _Mesh:
    """Triangles along a curve that keeps neighbours together (Morton 1966), so that clusters of them are compact."""
    corner = mesh.cells[mesh.point[mesh.triangles[:, 0]]]
    code = np.zeros(len(corner), np.int64)
    for axis in range(3):
        bits = corner[:, axis]
        for shift, mask in _SPREAD:
            bits = (bits | (bits << shift)) & mask
        code |= bits << axis
    vertices, triangles = _compress(
        mesh.triangles[np.argsort(code, kind="stable")].ravel(), np.zeros(len(mesh.point), np.intp)
    )
    return replace(
        mesh,
        values=mesh.values[vertices],
        weight=mesh.weight[vertices],
        point=mesh.point[vertices],
        triangles=triangles.reshape(-1, 3),
    )


def _clusters(triangles: int) -> int:
    return -(-triangles // CLUSTER_TRIANGLES)


def _join(meshes: list[tuple[_Mesh, DoubleArray]], of: Geometry) -> Geometry:
    """One geometry of several meshes; each ends with whole clusters, filled with triangles without area."""
    before = np.cumsum([0, *(len(mesh.point) for mesh, _ in meshes)])
    triangles = []
    for (mesh, _), first in zip(meshes, before, strict=False):
        fill = _clusters(len(mesh.triangles)) * CLUSTER_TRIANGLES - len(mesh.triangles)
        own = np.concatenate([mesh.triangles, np.full((fill, 3), mesh.triangles[-1, 0])])
        triangles.append((own + first).astype(np.int32))
    positions = np.concatenate([mesh.points[mesh.point] + origin for mesh, origin in meshes]).astype(np.float32)
    values = np.concatenate([mesh.values for mesh, _ in meshes])
    normals = values[:, :3] / np.maximum(np.linalg.norm(values[:, :3], axis=1), 1e-12)[:, None]
    uvs = None if of.uvs is None else np.ascontiguousarray(values[:, 3:5], np.float32)
    colors = None if of.colors is None else np.ascontiguousarray(values[:, -4:], np.float32)
    first = 3 if of.uvs is None else 5
    further = None if of.values is None else np.ascontiguousarray(values[:, first : first + VALUES_WIDTH], np.float32)
    none = np.zeros(0, np.int32)
    joined, smooth = np.concatenate(triangles), normals.astype(np.float32)
    return Geometry(positions, smooth, joined, none, none, none, uvs, colors, values=further)
