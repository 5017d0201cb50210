"""Points as polygons: a ball for each, with faces in number by how many there are."""

from __future__ import annotations

from functools import cache

import numpy as np
from pxr import Usd

from render.model.arrays import DoubleArray, IntArray
from render.stage.findings import FindingLog
from render.stage.geometry.points_data import authored_widths, read_points
from render.stage.geometry.polygons import BadGeometry, Polygons, Values, check_finite
from render.stage.geometry.sampling import Sampling, own_places, sample_widths

ATTRIBUTES = ("points", "widths", "primvars:widths")
"""Attributes that the shape of points follows, and may follow over time."""
MOST_POINTS = 1_000_000
_CUTS = ((1_000, 3), (20_000, 2), (100_000, 1))
"""Points of a prim up to which each is an octahedron whose edges are halved so many times."""


def point_polygons(prim: Usd.Prim, time: Usd.TimeCode, log: FindingLog) -> Polygons:
    """The polygons of a Points prim at a time, in its own space and units.

    Balls are so large that their outline has the area of the circle, averaged over all directions of view (Cauchy: a quarter of
    the surface).

    Raises:
        BadGeometry: there are no points, too many, or values do not fit; the message explains the fault.
    """
    places = read_points(prim, time)
    check_finite(places)
    if len(places) > MOST_POINTS:
        raise BadGeometry(f"it has {len(places)} points, and at most {MOST_POINTS} can be drawn")
    vertices, triangles = _ball(next((cuts for most, cuts in _CUTS if len(places) <= most), 0))
    own, zeros = own_places(len(places)), np.zeros(len(places), np.int64)
    sampling = Sampling(own, own, np.repeat(np.arange(len(places)), len(vertices)), zeros.repeat(len(triangles)))
    widths = sample_widths(authored_widths(prim, time, log), sampling, zeros)
    points = places[:, None] + widths[:, None, None] / 2 * (_size(vertices, triangles) * vertices).astype(np.float32)
    corners = triangles + (np.arange(len(places)) * len(vertices))[:, None, None]
    return Polygons(
        points=points.reshape(-1, 3).astype(np.float32),
        counts=np.full(len(places) * len(triangles), 3, np.int32),
        corners=corners.ravel().astype(np.int32),
        normals=Values(np.tile(vertices, (len(places), 1)).astype(np.float32), "vertex"),
        sampling=sampling,
    )


@cache
def _ball(cuts: int) -> tuple[DoubleArray, IntArray]:
    """Vertices of unit length and triangles, counter-clockwise from outside, of an octahedron whose edges are halved."""
    vertices = np.concatenate([np.eye(3), -np.eye(3)])
    triangles = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])
    for _ in range(cuts):
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        distinct, number = np.unique(edges, axis=0, return_inverse=True)
        middle = vertices[distinct].sum(axis=1)
        halves = len(vertices) + number.reshape(-1, 3)
        vertices = np.concatenate([vertices, middle / np.linalg.norm(middle, axis=1, keepdims=True)])
        (a, b, c), (ab, bc, ca) = triangles.T, halves.T
        triangles = np.concatenate(
            [np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
    return vertices, triangles.astype(np.int32)


def _size(vertices: DoubleArray, triangles: IntArray) -> float:
    """Factor that gives a ball's surface the area of the unit sphere."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return float(np.sqrt(4 * np.pi / area))
