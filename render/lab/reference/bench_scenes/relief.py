"""Finely tessellated shapes with relief: swept bodies with scales, bumpy boulders, draped robes. Lengths are metres, +Y is up."""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import grid_faces
from render.demo.shapes.mesh import Mesh, unit
from render.model.arrays import DoubleArray


def grid_mesh(points: DoubleArray, *, wrapped: bool, tile_m: float = 1.0) -> Mesh:
    """A grid of points as a smooth surface, its normals by central differences.

    Args:
        points: ``(rows, columns, 3)``; outside is where the column's direction × the row's direction points.
        wrapped: whether the last column is the first one again.
        tile_m: texture coordinates are metres along both directions at the middle of the grid, over this.
    """
    rows, columns = points.shape[:2]
    if wrapped:
        ring = np.concatenate([points[:, -2:-1], points, points[:, 1:2]], axis=1)
        along_u = ring[:, 2:] - ring[:, :-2]
    else:
        along_u = np.gradient(points, axis=1)
    normals = unit(np.cross(along_u, np.gradient(points, axis=0)))
    across, up = (
        np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in (points[rows // 2], points[:, columns // 2])
    )
    v, u = np.meshgrid(np.linspace(0, up / tile_m, rows), np.linspace(0, across / tile_m, columns), indexing="ij")
    uvs = np.stack([u.ravel(), v.ravel()], axis=1)
    return Mesh(points.reshape(-1, 3), normals.reshape(-1, 3), uvs, grid_faces(rows, columns))


def scaly_body(path: DoubleArray, radii_m: DoubleArray, sides: int, scales: int, depth: float = 0.09) -> Mesh:
    """A body swept along a path, covered with lozenge-shaped scales.

    Args:
        path: ``(n, 3)`` metres, from tail to head.
        radii_m: ``(n,)``.
        sides: quads around.
        scales: of them around the body; even.
        depth: of the scales' relief, as a share of the radius.
    """
    tangents = unit(np.gradient(path, axis=0))
    normals = _without_twist(tangents)
    binormals = np.cross(tangents, normals)
    turn = np.linspace(0, 2 * np.pi, sides + 1)
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    # a scale is as long as it is wide: its phase along the body grows with the way in units of the girth
    girths = np.concatenate([[0.0], np.cumsum(steps / (2 * np.pi * np.maximum(radii_m[1:], 0.05)))])
    a, b = np.meshgrid(turn * scales / 2, girths * np.pi * scales, indexing="xy")
    relief = np.sqrt(np.abs(np.sin((a + b) / 2) * np.sin((a - b) / 2)))
    radii = radii_m[:, None] * (1 + depth * (relief - 0.5))
    spokes = np.cos(turn)[None, :, None] * normals[:, None] + np.sin(turn)[None, :, None] * binormals[:, None]
    return grid_mesh(path[:, None] + spokes * radii[..., None], wrapped=True)


def boulder(radius_m: float, columns: int, rows: int, seed: int, roughness: float = 0.16) -> Mesh:
    """A bumpy blob about the origin: a ball displaced by waves in random directions, the finer the weaker."""
    random = np.random.default_rng(seed)
    turn, rise = np.linspace(0, 2 * np.pi, columns + 1), np.linspace(-np.pi / 2 + 1e-3, np.pi / 2 - 1e-3, rows)
    around, up = np.meshgrid(turn, rise)
    ball = np.stack([np.cos(up) * np.sin(around), np.sin(up), np.cos(up) * np.cos(around)], axis=-1)
    swell = np.zeros(ball.shape[:2])
    for octave in range(6):
        for direction in unit(random.normal(size=(5, 3))):
            pitch = 2.0 * 1.8**octave
            swell += np.sin(pitch * (ball @ direction) + random.uniform(0, 2 * np.pi)) / (5 * 1.9**octave)
    return grid_mesh(radius_m * ball * (1 + roughness * swell)[..., None], wrapped=True)


def robe(height_m: float, columns: int, rows: int, folds: int, seed: int) -> Mesh:
    """A long robe on the ground, its folds deep at the hem and gone at the shoulders."""
    random = np.random.default_rng(seed)
    t = np.linspace(0, 1, rows)[:, None]
    turn = np.linspace(0, 2 * np.pi, columns + 1)[None]
    profile = np.interp(
        t, [0, 0.06, 0.35, 0.60, 0.72, 0.88, 0.95, 1.0], [0.25, 0.235, 0.19, 0.125, 0.15, 0.165, 0.09, 0.05]
    )
    drift = 0.5 * np.sin(2.2 * t + random.uniform(0, 6))
    waves = np.sin(folds * turn + 2 * drift) + 0.5 * np.sin((folds + 5) * turn - 3 * drift + 1)
    fine = 0.25 * np.sin(3 * folds * turn + 9 * t + 4 * drift)
    radius = height_m * profile * (1 + 0.13 * (1 - t) ** 0.8 * (waves + fine))
    depth = np.interp(t, [0, 0.6, 1], [1.0, 0.8, 0.65])  # a body is broader than it is deep
    sway = 0.035 * height_m * np.sin(np.pi * t)
    points = np.stack(
        [radius * np.sin(turn) + sway, np.broadcast_to(height_m * t, radius.shape), radius * depth * np.cos(turn)],
        axis=-1,
    )
    return grid_mesh(points, wrapped=True)


def _without_twist(tangents: DoubleArray) -> DoubleArray:
    """Unit normals along a path, each the projection of the one before."""
    normals = np.zeros_like(tangents)
    normal = np.eye(3)[np.argmin(np.abs(tangents[0]))]
    for i, tangent in enumerate(tangents):
        normal = normal - tangent * (tangent @ normal)
        normal = normal / np.linalg.norm(normal)
        normals[i] = normal
    return normals
