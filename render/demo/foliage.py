"""Leaves: the clipped trees along the street, and the branch and railing that the camera passes."""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import lathe, rounded_box, smooth_curve, surface, tube
from render.demo.shapes.mesh import Array, Mesh, merge, rotation, translation, unit


def leaf(length: float = 0.09, width: float = 0.05, columns: int = 5, rows: int = 7) -> Mesh:
    """Build a leaf from the origin along +Y, facing +Z, folded at its rib and bent back; metres; texture (u, v) in 0..1."""

    def shape(u: Array, v: Array) -> Array:
        across = u * 2 - 1
        half = width / 2 * np.sin(np.pi * np.clip(v, 0, 1) ** 0.75) ** 0.8
        fold = 0.28 * half * np.abs(across)
        bow = -0.22 * length * v**2
        return np.stack([across * half, v * length, fold + bow], axis=-1)

    return surface(shape, columns, rows)


def clipped_ball(radius: float, leaves: int, seed: int) -> Mesh:
    """Build a ball of leaves about the origin: the crown of a clipped tree. ``radius`` in metres."""
    random = np.random.default_rng(seed)
    small = leaf(0.11, 0.07, 3, 4)
    parts = []
    for k in range(leaves):
        # A Fibonacci sphere with random displacement.
        height = 1 - 2 * (k + 0.5) / leaves
        yaw = k * 180 * (3 - 5**0.5) + random.uniform(-9, 9)
        pitch = np.degrees(np.arccos(height)) + random.uniform(-28, 8)
        out = radius * random.uniform(0.72, 0.98)
        turn = rotation(y=yaw) @ rotation(x=pitch)
        parts.append(small.rotate(y=random.uniform(-50, 50)).transform(turn @ translation([0, out - 0.05, 0])))
    return merge(parts)


def branch_curves() -> list[Array]:
    """Return the twigs of the branch that hangs into the picture, ``(n, 3)`` metres each, from stem to tip."""
    stem = smooth_curve([[0.78, 1.52, -0.85], [0.61, 1.44, -0.90], [0.46, 1.37, -0.96], [0.32, 1.305, -1.02]], 24)
    side = smooth_curve([[0.61, 1.44, -0.90], [0.52, 1.31, -0.86], [0.47, 1.19, -0.88]], 14)
    high = smooth_curve([[0.50, 1.39, -0.95], [0.37, 1.38, -1.04], [0.22, 1.37, -1.10]], 14)
    return [stem, side, high]


def branch() -> Mesh:
    """Build the wood of the branch."""
    return merge(tube(curve, np.linspace(0.008, 0.003, len(curve)), 6) for curve in branch_curves())


def leaf_poses(seed: int = 17, count: int = 96) -> tuple[Array, Array, Array]:
    """Place the branch's leaves.

    Returns:
        ``(n, 3)`` metres, ``(n, 3)`` rotation in degrees about X, Y, Z, and ``(n,)`` scale.
    """
    random = np.random.default_rng(seed)
    curves = branch_curves()
    places, turns = [], []
    for k in range(count):
        curve = curves[k % 3]
        t = random.uniform(0.05, 1.0) * (len(curve) - 1)
        i = min(int(t), len(curve) - 2)
        places.append(curve[i] + (t - i) * (curve[i + 1] - curve[i]))
        along = unit(curve[i + 1] - curve[i])
        heading = np.degrees(np.arctan2(-along[0], along[1]))
        side = random.choice([-1.0, 1.0])
        turns.append([random.uniform(-40, 40), random.uniform(-35, 35), heading + side * random.uniform(25, 75)])
    return np.array(places), np.array(turns), random.uniform(0.55, 1.05, count)


def railing() -> Mesh:
    """Build the café's wrought-iron railing: scrolls between a top and a bottom rail, 1.2 m long along +X from the origin."""
    parts = [tube([[0, 0.86, 0], [1.2, 0.86, 0]], 0.018, 12), rounded_box([1.2, 0.02, 0.03], 0.008, 1).at(0.6, 0.12, 0)]
    angle = np.linspace(0, 2.6 * np.pi, 36)
    spiral = 0.008 + 0.062 * angle / angle[-1]
    for k in range(5):
        x = 0.12 + 0.24 * k
        parts.append(tube([[x - 0.12, 0.12, 0], [x - 0.12, 0.86, 0]], 0.009, 8))
        for flip in (-1, 1):
            curl = np.stack(
                [x + flip * spiral * np.cos(angle), 0.49 + flip * (0.13 + spiral * np.sin(angle)), 0 * angle], axis=1
            )
            parts.append(tube(curl, 0.006, 6))
    post = lathe([[0.03, 0.0], [0.03, 0.06], [0.018, 0.09], [0.018, 0.86], [0.026, 0.88], [0.0, 0.90]], 16)
    return merge([*parts, post.at(1.2, 0, 0)])


def ivy_poses(seed: int = 29, count: int = 110) -> tuple[Array, Array, Array]:
    """Place ivy leaves along the railing's top rail, in the railing's space; returns what `leaf_poses` returns."""
    random = np.random.default_rng(seed)
    along = random.uniform(0.0, 1.22, count)
    places = np.stack([along, 0.86 + random.normal(0.0, 0.035, count), random.normal(0.0, 0.03, count)], axis=1)
    turns = np.stack(
        [random.uniform(-70, 70, count), random.uniform(-60, 60, count), random.uniform(-150, 150, count)], axis=1
    )
    return places, turns, random.uniform(0.5, 0.95, count)


def ivy_lights() -> Array:
    """Place fairy lights in the ivy: ``(n, 3)`` metres in the railing's space."""
    along = np.linspace(0.08, 1.16, 9)
    return np.stack([along, 0.87 + 0.03 * np.sin(17 * along), 0.045 + 0.012 * np.cos(23 * along)], axis=1)
