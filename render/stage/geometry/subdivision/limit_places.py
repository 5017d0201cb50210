"""Places on the limit surface of a control mesh, as weights of its points."""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray, LongArray
from render.model.face_places import barycentric
from render.stage.geometry.polygons import Polygons
from render.stage.geometry.subdivision.refinement import Cage, Steps, control_topology
from render.stage.geometry.subdivision.topology import part_of

LEVELS = 3
"""Steps of refinement by which places are found; between the points of the limit surface they are on flat triangles."""
MOST_POINTS = 256
"""Points around a face whose places are found: the weights of each at each refined point are in memory at once."""


class LimitPlaces:
    """Places on a limit surface, found one by one without the refinement of the whole.

    The limit surface of a face depends on the faces around it alone, so that no others are refined.

    Args:
        cage: rules.
        polygons: control mesh, as `render.stage.geometry.polygons.check` accepts it; positions of its points do not matter.

    Raises:
        BadGeometry: as `render.stage.geometry.subdivision.refinement.Refinement`.
    """

    def __init__(self, cage: Cage, polygons: Polygons) -> None:
        self._cage = cage
        self._kept, self._topology = control_topology(cage, polygons)
        self._found: dict[tuple[int, float, float], tuple[LongArray, DoubleArray] | None] = {}

    def weights(self, face: int, place: DoubleArray) -> tuple[LongArray, DoubleArray] | None:
        """Points of the control mesh and their weights, ``(n,)`` each, that give a place on the limit surface of a face.

        Args:
            face: of the control mesh, with at least three corners.
            place: ``(2,)`` on it (`render.model.face_places`).

        Returns:
            Points and weights; None where more than `MOST_POINTS` are around the face.
        """
        key = face, float(place[0]), float(place[1])
        if key not in self._found:
            self._found[key] = self._weights(face, place)
        return self._found[key]

    def _weights(self, face: int, place: DoubleArray) -> tuple[LongArray, DoubleArray] | None:
        topology, own = self._topology, int(np.searchsorted(self._kept, face))
        start, count = int(topology.starts[own]), int(topology.counts[own])
        is_near = np.zeros(topology.points, bool)
        is_near[topology.corners[start : start + count]] = True
        faces = np.unique(topology.face_of_corner[is_near[topology.corners]])
        part, points = part_of(topology, faces)
        if len(points) > MOST_POINTS:
            return None
        steps = Steps(self._cage, part, LEVELS)
        here = np.flatnonzero(steps.faces() == np.searchsorted(faces, own))
        corners = 3 if self._cage.scheme == "loop" else 4
        fans = np.stack([np.zeros(corners - 2, np.intp), np.arange(1, corners - 1), np.arange(2, corners)], axis=1)
        triangles = (here[:, None, None] * corners + fans).reshape(-1, 3)  # as corners
        inside = barycentric(steps.places()[triangles], place)
        found = int(inside.min(axis=1).argmax())
        shares = np.maximum(inside[found], 0.0)
        at_points = steps.refine(np.eye(len(points)))[steps.last.corners[triangles[found]]]
        return points.astype(np.int64), np.asarray(shares / shares.sum() @ at_points)
