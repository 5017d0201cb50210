"""Refinement of a control mesh: its polygons on the limit surface, its primvars there, and their places on the mesh's faces."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from render.model.arrays import BoolArray, DoubleArray, LongArray
from render.model.face_places import polygon_corners
from render.stage.geometry.polygons import AuthoredFaces, BadGeometry, Polygons, Values, value_index_of_corner
from render.stage.geometry.subdivision.face_varying import face_varying_topology, is_linear
from render.stage.geometry.subdivision.rules import Scheme, Step, limit
from render.stage.geometry.subdivision.sharp_normals import sharp_normals
from render.stage.geometry.subdivision.topology import (
    Sharpness,
    Topology,
    make_topology,
    sharpen,
    split,
)

MOST_TRIANGLES = 2_000_000
"""Triangles of one refined surface."""


def fitting_level(corners: int, level: int, most_triangles: int = MOST_TRIANGLES) -> int:
    """Steps of refinement that leave at most so many triangles.

    Args:
        corners: of the control mesh.
        level: steps that are wanted.
        most_triangles: of the refined surface.
    """
    while level > 0 and triangles_at(corners, level) > most_triangles:
        level -= 1
    return level


def triangles_at(corners: int, level: int) -> int:
    """Triangles of a control mesh that is refined in some steps, at least one."""
    return int(2 * corners * 4 ** (level - 1))


@dataclass(frozen=True, eq=False)
class Cage:
    """Rules of a control mesh, as UsdGeom.Mesh states them.

    Attributes:
        scheme: ``subdivisionScheme``, other than none.
        border: ``interpolateBoundary``.
        face_varying: ``faceVaryingLinearInterpolation``.
        smooth_triangles: whether ``triangleSubdivisionRule`` is smooth.
        sharpness: creases and corners, or None.
    """

    scheme: Scheme = "catmullClark"
    border: str = "edgeAndCorner"
    face_varying: str = "cornersPlus1"
    smooth_triangles: bool = False
    sharpness: Sharpness | None = None


class Steps:
    """Steps of refinement of a mesh, and of others with the same faces.

    Args:
        cage: rules.
        topology: the mesh, with all that is sharp.
        levels: number of steps.

    Attributes:
        last: the mesh after all steps.
    """

    def __init__(self, cage: Cage, topology: Topology, levels: int) -> None:
        self._scheme = cage.scheme
        self._topology = topology
        self._steps: list[Step] = []
        for level in range(levels):
            smooth_triangles = cage.smooth_triangles and level == 0 and cage.scheme == "catmullClark"
            self._steps.append(Step(cage.scheme, topology, smooth_triangles))
            topology = self._split(topology)
        self.last = topology

    def faces(self) -> LongArray:
        """``(f,)`` face of the mesh that each refined face is a part of."""
        face = np.arange(len(self._topology.counts))
        for step in self._steps:
            face = np.repeat(face, 4 if self._scheme == "loop" else step.topology.counts)
        return face.astype(np.int64)

    def refine(self, values: DoubleArray, topology: Topology | None = None, *, linear: bool = False) -> DoubleArray:
        """Refine values ``(n, k)`` at points, and bring them to the limit unless they are linear. Returns ``(m, k)``.

        Args:
            values: at the points of the mesh, or of another.
            topology: other points of the same faces; None for the mesh's.
            linear: whether values are interpolated linearly.
        """
        topology = self._topology if topology is None else topology
        for step in self._steps:
            values = replace(step, topology=topology).refine(values, linear=linear)
            topology = self._split(topology)
        return values if linear else limit(self._scheme, topology, values)

    def corners(self, topology: Topology) -> LongArray:
        """``(c,)`` points of the refined corners of a topology with the same faces."""
        for _ in self._steps:
            topology = self._split(topology)
        return topology.corners.astype(np.int64)

    def places(self) -> DoubleArray:
        """``(c, 2)`` place of each refined corner on its face of the mesh (`render.model.face_places`)."""
        counts = self._topology.counts
        found = np.zeros((len(self.last.corners), 2))
        first_size = np.repeat(counts, counts if self._scheme != "loop" else 4)  # by face after one step
        size_of_corner = np.repeat(first_size, len(found) // max(len(first_size), 1))
        for count in np.unique(counts).tolist():
            one = make_topology(count, np.array([count]), np.arange(count))
            places = self.refine(polygon_corners(count), one, linear=True)[self.corners(one)]
            here = size_of_corner == count
            found[here] = np.tile(places, (int(here.sum()) // len(places), 1))
        return found

    def _split(self, topology: Topology) -> Topology:
        return split(topology, in_triangles=self._scheme == "loop")


class Refinement:
    """Refinement of polygons. It resamples the primvars of the polygons that it makes.

    Args:
        cage: rules.
        polygons: control mesh, as `render.stage.geometry.polygons.check` accepts it. Faces of fewer than three corners are left
            out.
        levels: number of steps, at least 1.

    Raises:
        BadGeometry: creases or corners name points that do not exist; or the scheme is Loop, and a face is no triangle.
    """

    def __init__(self, cage: Cage, polygons: Polygons, levels: int) -> None:
        self._cage, self._polygons = cage, polygons
        self._kept, self._topology = control_topology(cage, polygons)
        self._steps = Steps(cage, self._topology, levels)
        self._faces = self._kept[self._steps.faces()]

    def refine(self) -> Polygons:
        """Polygons on the limit surface."""
        polygons, last = self._polygons, self._steps.last
        holes = _hidden_faces(self._cage, polygons, self._kept, self._topology)[self._faces]
        points = self._steps.refine(polygons.points.astype(np.float64))
        is_smooth = self._cage.scheme != "bilinear"
        return Polygons(
            points=points.astype(np.float32),
            counts=last.counts.astype(np.int32),
            corners=last.corners.astype(np.int32),
            left_handed=polygons.left_handed,
            normals=sharp_normals(last, points, left_handed=polygons.left_handed) if is_smooth else None,
            smooth=is_smooth,
            holes=np.flatnonzero(holes).astype(np.int32) if holes.any() else None,
            sampling=self,
            authored=AuthoredFaces(
                self._faces.astype(np.int32),
                polygons.counts[self._faces].astype(np.int32),
                self._steps.places().astype(np.float32),
            ),
        )

    def resample(self, values: Values) -> Values:
        """Values of a primvar of the control mesh at the refined polygons.

        Raises:
            BadGeometry: there are fewer values than elements.
        """
        match values.interpolation:
            case "uniform":
                first = (np.cumsum(self._polygons.counts, dtype=np.int64) - self._polygons.counts)[self._faces]
                index = value_index_of_corner(values, self._polygons)[first]
                return Values(values.values, "uniform", index.astype(np.int32))
            case "vertex" | "varying" as interpolation:
                refined = self._steps.refine(self._at_points(values), linear=interpolation == "varying")
                return Values(refined.astype(np.float32), "vertex")
            case "faceVarying":
                return self._resample_corners(values)
            case _:
                return values

    def _at_points(self, values: Values) -> DoubleArray:
        """``(n, k)`` value of each point; the first one at those without a face."""
        index = np.zeros(len(self._polygons.points), np.intp)
        index[self._polygons.corners] = value_index_of_corner(values, self._polygons)
        return values.values[index].astype(np.float64)

    def _resample_corners(self, values: Values) -> Values:
        index = value_index_of_corner(values, self._polygons)[_corners_of(self._polygons, self._kept)]
        channel, of_point = face_varying_topology(self._topology, index, self._cage.face_varying)
        linear = is_linear(self._cage.face_varying)
        refined = self._steps.refine(values.values[of_point].astype(np.float64), channel, linear=linear)
        return Values(refined.astype(np.float32), "faceVarying", self._steps.corners(channel).astype(np.int32))


def sharpen_control_mesh(cage: Cage, polygons: Polygons) -> Polygons:
    """Polygons of a control mesh with normals on both sides of what stays sharp; unchanged where nothing does.

    Raises:
        BadGeometry: as `Refinement`.
    """
    kept, topology = control_topology(cage, polygons)
    normals = sharp_normals(topology, polygons.points.astype(np.float64), left_handed=polygons.left_handed)
    if normals is None or normals.indices is None:
        return polygons
    indices = np.zeros(len(polygons.corners), np.int32)
    indices[_corners_of(polygons, kept)] = normals.indices
    return replace(polygons, normals=replace(normals, indices=indices))


def control_topology(cage: Cage, polygons: Polygons) -> tuple[LongArray, Topology]:
    """Faces ``(f,)`` of at least three corners, and their topology with all that is sharp.

    Raises:
        BadGeometry: as `Refinement`.
    """
    kept = np.flatnonzero(polygons.counts >= 3)
    counts = polygons.counts[kept].astype(np.intp)
    if cage.scheme == "loop" and (counts != 3).any():
        raise BadGeometry("its subdivisionScheme is loop, which takes triangles alone")
    corners = polygons.corners[_corners_of(polygons, kept)].astype(np.intp)
    topology = make_topology(len(polygons.points), counts, corners)
    return kept, sharpen(topology, cage.sharpness, sharp_corners=cage.border != "edgeOnly")


def _corners_of(polygons: Polygons, faces: LongArray) -> BoolArray:
    """``(c,)`` which corners are of some faces."""
    is_chosen = np.zeros(len(polygons.counts), bool)
    is_chosen[faces] = True
    return np.repeat(is_chosen, polygons.counts)


def _hidden_faces(cage: Cage, polygons: Polygons, kept: LongArray, topology: Topology) -> BoolArray:
    """``(f,)`` faces of the control mesh that are not drawn: holes, and without interpolation of borders those at a border."""
    hidden = np.zeros(len(polygons.counts), bool)
    if polygons.holes is not None:
        hidden[polygons.holes[(polygons.holes >= 0) & (polygons.holes < len(hidden))]] = True
    if cage.border == "none":
        is_border = np.zeros(topology.points, bool)
        is_border[topology.edges[topology.edge_faces() == 1].ravel()] = True
        hidden[kept[topology.face_of_corner[is_border[topology.corners]]]] = True
    return hidden
