"""Foliage of cards: rectangles that a texture's opacity cuts to leaves."""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import smooth_curve, tube
from render.demo.shapes.mesh import Mesh, merge, unit
from render.model.arrays import DoubleArray


def cards(
    roots: DoubleArray, along: DoubleArray, facing: DoubleArray, lengths_m: DoubleArray, normals: DoubleArray
) -> Mesh:
    """Rectangles as wide as long that grow from their roots.

    Args:
        roots: ``(n, 3)`` middles of their lower edges, metres.
        along: ``(n, 3)`` directions of growth.
        facing: ``(n, 3)`` directions that they face, made square to ``along``.
        lengths_m: ``(n,)``.
        normals: ``(n, 3)`` unit, for shading: those of the crown that they fill, not their own, shade it round.
    """
    up = unit(along)
    right = unit(np.cross(up, facing))
    half = lengths_m[:, None] / 2
    low, high = roots, roots + up * lengths_m[:, None]
    corners = np.stack([low - right * half, low + right * half, high + right * half, high - right * half], axis=1)
    uvs = np.tile([[0.0, 0.0], [1, 0], [1, 1], [0, 1]], (len(roots), 1))
    quads = np.arange(4 * len(roots), dtype=np.int32).reshape(-1, 4)
    return Mesh(corners.reshape(-1, 3), np.repeat(normals, 4, axis=0), uvs, quads)


def crown(radius_m: float, count: int, card_m: float, seed: int) -> Mesh:
    """A tree's crown about the origin: cards all over a ball, denser towards its skin, growing outward."""
    random = np.random.default_rng(seed)
    outward = unit(random.normal(size=(count, 3)) * [1.0, 0.85, 1.0])
    depth = random.uniform(0.35, 0.95, count) ** 0.7
    roots = outward * (radius_m * depth)[:, None] * [1.0, 0.88, 1.0]
    along = unit(outward + 0.8 * random.normal(size=(count, 3)) + [0, 0.25, 0])
    facing = random.normal(size=(count, 3))
    return cards(roots, along, facing, card_m * random.uniform(0.7, 1.2, count), unit(outward + np.array([0, 0.3, 0])))


def trunk(height_m: float, radius_m: float, seed: int) -> Mesh:
    """A tree's trunk from the ground, with a few boughs."""
    random = np.random.default_rng(seed)
    lean = random.uniform(-0.06, 0.06, 2) * height_m
    stem = smooth_curve([[0, 0, 0], [lean[0], 0.5 * height_m, lean[1]], [0.4 * lean[0], height_m, 0]], 14)
    parts = [tube(stem, np.linspace(radius_m, 0.5 * radius_m, 14), 9)]
    for k in range(4):
        turn = 2 * np.pi * (k + random.uniform(0, 0.6)) / 4
        out = np.array([np.cos(turn), 0.9, np.sin(turn)]) * 0.42 * height_m
        start = stem[9 + k % 3]
        bough = smooth_curve([start, start + 0.4 * out + [0, 0.05, 0], start + out], 8)
        parts.append(tube(bough, np.linspace(0.4 * radius_m, 0.12 * radius_m, 8), 6))
    return merge(parts)


def hanging_branch(path: DoubleArray, twigs: int, card_m: float, seed: int) -> tuple[Mesh, Mesh]:
    """A branch along a path with cards on both sides.

    Args:
        path: ``(n, 3)`` control points from stem to tip, metres.
        twigs: number of cards.
        card_m: their length.
        seed: of their turns.

    Returns:
        The wood and the leaves.
    """
    random = np.random.default_rng(seed)
    curve = smooth_curve(path, 24)
    wood = tube(curve, np.linspace(0.08, 0.02, 24) * card_m, 7)
    t = np.linspace(0.1, 0.98, twigs) * 23
    i = np.minimum(t.astype(int), 22)
    roots = curve[i] + (t - i)[:, None] * (curve[i + 1] - curve[i])
    ahead = unit(curve[i + 1] - curve[i])
    side = unit(np.cross(ahead, [0.0, 0, 1])) * np.where(np.arange(twigs) % 2, 1.0, -1.0)[:, None]
    along = unit(0.7 * ahead + side + 0.35 * random.normal(size=(twigs, 3)) + [0, -0.25, 0])
    facing = unit(np.array([0.0, 0.3, 1.0]) + 0.5 * random.normal(size=(twigs, 3)))
    leaves = cards(roots, along, facing, card_m * random.uniform(0.75, 1.15, twigs), facing)
    return wood, leaves
