"""The geometry kit: lathe, tube, surface, rounded box, plate. Lengths are metres, +Y is up.

Every function returns a closed or open `Mesh` with smooth normals, broken at creases.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from render.demo.shapes.mesh import Array, Indices, Mesh, merge, unit

CREASE_DEGREES = 40.0  # a profile that turns by more than this breaks its normals


def smooth_curve(controls: ArrayLike, count: int, *, closed: bool = False) -> Array:
    """``(count, d)`` points on the Catmull-Rom spline through ``controls``, evenly spaced in its parameter."""
    points = np.asarray(controls, np.float64)
    spans = len(points) if closed else len(points) - 1
    if closed:
        points = np.concatenate([points[-1:], points, points[:2]])
    else:
        points = np.concatenate([2 * points[:1] - points[1:2], points, 2 * points[-1:] - points[-2:-1]])
    parameter = np.linspace(0, spans, count, endpoint=not closed)
    span = np.minimum(parameter.astype(int), spans - 1)
    t = (parameter - span)[:, None]
    p0, p1, p2, p3 = (points[span + k] for k in range(4))
    return np.asarray(
        0.5 * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t**2 + (3 * p1 - p0 - 3 * p2 + p3) * t**3)
    )


def grid_faces(rows: int, columns: int) -> Indices:
    """``((rows-1)*(columns-1), 4)`` quads of a vertex grid, counter-clockwise for column × row directions."""
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    first = (row * columns + column).ravel()
    return np.stack([first, first + 1, first + columns + 1, first + columns], axis=1).astype(np.int32)


def _without_slivers(quads: Indices, points: Array) -> tuple[Indices, Indices]:
    """Splits a grid's quads into true quads and, where a row shrinks to a pole, triangles."""
    corners = points[quads]
    bottom = np.linalg.norm(corners[:, 0] - corners[:, 1], axis=1) < 1e-9
    top = np.linalg.norm(corners[:, 2] - corners[:, 3], axis=1) < 1e-9
    triangles = np.concatenate([quads[bottom & ~top][:, [0, 2, 3]], quads[top & ~bottom][:, [0, 1, 2]]])
    return quads[~bottom & ~top], triangles


def surface(shape: Callable[[Array, Array], Array], columns: int, rows: int) -> Mesh:
    """A parametric surface.

    Args:
        shape: maps ``u`` and ``v``, both ``(rows, columns)`` in 0..1, to points ``(rows, columns, 3)``; outside is
            where dP/du × dP/dv points.
        columns: vertices along u.
        rows: vertices along v.

    Returns:
        The mesh; its texture coordinates are (u, v).
    """
    v, u = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    step = 1e-4
    along_u = shape(u + step, v) - shape(u - step, v)
    # A pole has no direction along u: take the one slightly inside.
    inside = np.clip(v, 2e-3, 1 - 2e-3)
    pole = np.linalg.norm(along_u, axis=-1, keepdims=True) < 1e-9
    along_u = np.where(pole, shape(u + step, inside) - shape(u - step, inside), along_u)
    along_v = np.where(pole, shape(u, inside + step) - shape(u, inside - step), shape(u, v + step) - shape(u, v - step))
    points = shape(u, v).reshape(-1, 3)
    quads, triangles = _without_slivers(grid_faces(rows, columns), points)
    normals = unit(np.cross(along_u, along_v)).reshape(-1, 3)
    return Mesh(points, normals, np.stack([u.ravel(), v.ravel()], axis=1), quads, triangles)


def lathe(profile: ArrayLike, segments: int = 32) -> Mesh:
    """Turns a profile about +Y.

    Args:
        profile: ``(n, 2)`` (radius, height) along the outside, from bottom to top.
        segments: quads around.

    Returns:
        The mesh, with normals broken where the profile turns sharply; texture coordinates are metres around the
        widest radius and along the profile.
    """
    line = np.asarray(profile, np.float64)
    steps = np.diff(line, axis=0)
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    turns = np.abs((np.diff(headings) + np.pi) % (2 * np.pi) - np.pi)
    breaks = [0, *(np.flatnonzero(turns > np.radians(CREASE_DEGREES)) + 1), len(line) - 1]
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=1))])
    girth = 2 * np.pi * float(line[:, 0].max())
    return merge(_lathe_run(line[a : b + 1], lengths[a : b + 1], girth, segments) for a, b in pairwise(breaks))


def _lathe_run(line: Array, lengths: Array, girth: float, segments: int) -> Mesh:
    """One smooth stretch of a lathe's profile."""
    tangents = np.gradient(line, axis=0)
    outward = np.stack([tangents[:, 1], -tangents[:, 0]], axis=1)
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-12)
    turn = np.linspace(0, 1, segments + 1)
    sin, cos = np.sin(2 * np.pi * turn), np.cos(2 * np.pi * turn)

    def around(radial: Array, height: Array) -> Array:
        columns = [np.outer(radial, sin), np.repeat(height[:, None], segments + 1, axis=1), np.outer(radial, cos)]
        return np.stack(columns, axis=-1).reshape(-1, 3)

    points = around(line[:, 0], line[:, 1])
    uvs = np.stack([np.tile(turn * girth, len(line)), np.repeat(lengths, segments + 1)], axis=1)
    quads, triangles = _without_slivers(grid_faces(len(line), segments + 1), points)
    return Mesh(points, around(outward[:, 0], outward[:, 1]), uvs, quads, triangles)


def ball(radius: float, segments: int = 24, rows: int = 14) -> Mesh:
    """A sphere about the origin."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, rows)
    profile = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    profile[[0, -1], 0] = 0.0
    return lathe(profile, segments)


def ring(radius: float, thickness: float, segments: int = 32, sides: int = 10) -> Mesh:
    """A torus about +Y; ``thickness`` is the radius of its tube."""
    angle = np.linspace(-np.pi, np.pi, sides + 1)
    return lathe(np.stack([radius + thickness * np.cos(angle), thickness * np.sin(angle)], axis=1), segments)


def _frames(path: Array, closed: bool) -> tuple[Array, Array, Array]:
    """Tangent, normal and binormal along a path, without twist (rotation-minimising by projection)."""
    ahead = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0) if closed else np.gradient(path, axis=0)
    tangents = unit(ahead)
    normals = np.zeros_like(path)
    seed = np.eye(3)[np.argmin(np.abs(tangents[0]))]
    for i, tangent in enumerate(tangents):
        seed = seed - tangent * (seed @ tangent)
        seed /= np.linalg.norm(seed)
        normals[i] = seed
    return tangents, normals, np.cross(tangents, normals)


def tube(path: ArrayLike, radius: float | Sequence[float] | Array, sides: int = 8, *, capped: bool = True) -> Mesh:
    """Sweeps a circle along a path, with round ends.

    Args:
        path: ``(n, 3)`` metres.
        radius: of the tube, one or one for each path point.
        sides: quads around.
        capped: whether the ends are closed by half balls.
    """
    line = np.asarray(path, np.float64)
    radii = np.broadcast_to(np.asarray(radius, np.float64), len(line)).copy()
    tangents, normals, binormals = _frames(line, closed=False)
    slopes = np.gradient(radii) / np.maximum(np.linalg.norm(np.gradient(line, axis=0), axis=1), 1e-12)
    if capped:
        angle = np.linspace(0, np.pi / 2, 5)[1:]
        (head, tail), (r0, r1) = (line[0], line[-1]), (radii[0], radii[-1])
        start, end = (
            head - np.outer(r0 * np.sin(angle[::-1]), tangents[0]),
            tail + np.outer(r1 * np.sin(angle), tangents[-1]),
        )
        cosines = np.where(angle > 1.57, 0.0, np.cos(angle))
        line, radii = np.concatenate([start, line, end]), np.concatenate([r0 * cosines[::-1], radii, r1 * cosines])
        slopes = np.concatenate([np.tan(np.minimum(angle[::-1], 1.55)), slopes, -np.tan(np.minimum(angle, 1.55))])
        tangents, normals, binormals = (
            np.concatenate([np.repeat(f[:1], 4, 0), f, np.repeat(f[-1:], 4, 0)]) for f in (tangents, normals, binormals)
        )
    turn = np.linspace(0, 1, sides + 1)
    spokes = np.einsum("a,ni->nai", np.cos(2 * np.pi * turn), normals) + np.einsum(
        "a,ni->nai", np.sin(2 * np.pi * turn), binormals
    )
    points = (line[:, None] + spokes * radii[:, None, None]).reshape(-1, 3)
    outward = unit(spokes - tangents[:, None] * slopes[:, None, None]).reshape(-1, 3)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    uvs = np.stack([np.tile(turn * 2 * np.pi * radii.max(), len(line)), np.repeat(along, sides + 1)], axis=1)
    quads, triangles = _without_slivers(grid_faces(len(line), sides + 1), points)
    return Mesh(points, outward, uvs, quads, triangles)


def hoop(path: ArrayLike, radius: float, sides: int = 8) -> Mesh:
    """Sweeps a circle along a closed path."""
    line = np.asarray(path, np.float64)
    _, normals, binormals = _frames(line, closed=True)
    line, normals, binormals = (np.concatenate([a, a[:1]]) for a in (line, normals, binormals))
    turn = np.linspace(0, 1, sides + 1)
    spokes = np.einsum("a,ni->nai", np.cos(2 * np.pi * turn), normals) + np.einsum(
        "a,ni->nai", np.sin(2 * np.pi * turn), binormals
    )
    points = (line[:, None] + spokes * radius).reshape(-1, 3)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    uvs = np.stack([np.tile(turn * 2 * np.pi * radius, len(line)), np.repeat(along, sides + 1)], axis=1)
    return Mesh(points, spokes.reshape(-1, 3), uvs, grid_faces(len(line), sides + 1))


def rounded_box(size: ArrayLike, radius: float, steps: int = 2) -> Mesh:
    """A box about the origin with rounded edges.

    Args:
        size: full extent along x, y and z.
        radius: of the edges; 0, with no steps, for sharp ones.
        steps: quads across each rounded edge, on each of the two faces that meet there.
    """
    half = np.asarray(size, np.float64) / 2
    faces = []
    for axis in range(3):
        for side in (1.0, -1.0):
            faces.append(_rounded_face(half, min(radius, 0.95 * float(half.min())), steps, axis, side))
    return merge(faces)


def _rounded_face(half: Array, radius: float, steps: int, axis: int, side: float) -> Mesh:
    """One of the six faces of a rounded box, with its share of the edges."""
    first, second = ((axis + 1) % 3, (axis + 2) % 3) if side > 0 else ((axis + 2) % 3, (axis + 1) % 3)
    bevel = radius * (1 - np.tan(np.linspace(np.pi / 4, 0, steps + 1)))
    lines = [np.concatenate([-half[k] + bevel, (half[k] - bevel)[::-1]]) for k in (first, second)]
    a, b = np.meshgrid(*lines)
    cube = np.zeros((*a.shape, 3))
    cube[..., first], cube[..., second], cube[..., axis] = a, b, side * half[axis]
    core = np.clip(cube, -(half - radius), half - radius)
    normals = unit(cube - core) if radius > 0 else np.broadcast_to(side * np.eye(3)[axis], cube.shape)
    points = (core + radius * normals).reshape(-1, 3)
    # Texture coordinates in metres, upright on the walls.
    uvs = {0: points[:, [2, 1]], 1: points[:, [0, 2]], 2: points[:, [0, 1]]}[axis]
    return Mesh(points, normals.reshape(-1, 3), uvs, grid_faces(len(lines[1]), len(lines[0])))


def box(size: ArrayLike) -> Mesh:
    """A sharp box about the origin."""
    return rounded_box(size, 0.0, steps=0)


def plate(width: float, height: float, columns: int = 2, rows: int = 2) -> Mesh:
    """An upright rectangle about the origin that faces +Z; texture coordinates run 0..1 over it."""
    return surface(
        lambda u, v: np.stack([(u - 0.5) * width, (v - 0.5) * height, np.zeros_like(u)], axis=-1), columns, rows
    )


def disk(radius: float, segments: int = 24) -> Mesh:
    """A flat disk about the origin that faces +Y."""
    return lathe([[radius, 0.0], [0.0, 0.0]], segments)
