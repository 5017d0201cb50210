"""Parts of buildings: arches, columns, windows, roofs, railings. Lengths are metres, +Y is up; fronts face +Z."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.demo.shapes.kit import box, lathe, ring, rounded_box, surface, tube
from render.demo.shapes.mesh import Mesh, merge

Doubles = NDArray[np.float64]


def column(height_m: float, radius_m: float, segments: int = 18) -> Mesh:
    """A round column on a square plinth, with a swelling shaft, base and capital."""
    r, h = radius_m, height_m
    t = np.linspace(0, 1, 9)
    shaft = np.stack([r * (1 - 0.17 * t**1.8), 0.16 * h + 0.70 * h * t], axis=1)
    base = [
        [1.32 * r, 0.06 * h],
        [1.38 * r, 0.08 * h],
        [1.30 * r, 0.105 * h],
        [1.10 * r, 0.115 * h],
        [1.16 * r, 0.14 * h],
    ]
    head = [[0.84 * r, 0.875 * h], [1.0 * r, 0.885 * h], [0.98 * r, 0.905 * h], [1.3 * r, 0.945 * h], [0.0, 0.945 * h]]
    plinth = box([2.9 * r, 0.06 * h, 2.9 * r]).at(0, 0.03 * h, 0)
    abacus = box([2.8 * r, 0.06 * h, 2.8 * r]).at(0, 0.97 * h, 0)
    return merge([plinth, lathe([*base, *shaft.tolist(), *head], segments), abacus])


def fluted_column(height_m: float, radius_m: float, flutes: int = 20, rows: int = 24) -> Mesh:
    """A column whose shaft has hollow flutes."""

    def shaft(u: Doubles, v: Doubles) -> Doubles:
        turn = 2 * np.pi * u
        hollow = 0.07 * np.abs(np.sin(flutes * turn / 2)) * np.clip(np.minimum(v, 1 - v) * 16, 0, 1)
        r = radius_m * (1 - 0.16 * np.clip(v, 0, 1) ** 1.8 - hollow)
        return np.stack([r * np.sin(turn), (0.10 + 0.79 * v) * height_m, r * np.cos(turn)], axis=-1)

    r, h = radius_m, height_m
    base = lathe(
        [[1.36 * r, 0.04 * h], [1.42 * r, 0.06 * h], [1.34 * r, 0.078 * h], [1.1 * r, 0.083 * h], [1.14 * r, 0.10 * h]],
        32,
    )
    head = lathe(
        [[0.86 * r, 0.885 * h], [1.0 * r, 0.895 * h], [1.0 * r, 0.91 * h], [1.36 * r, 0.95 * h], [0.0, 0.95 * h]], 32
    )
    blocks = [rounded_box([3.0 * r, 0.04 * h, 3.0 * r], 0.02, 1).at(0, y * h, 0) for y in (0.02, 0.97)]
    return merge([*blocks, base, surface(shaft, 6 * flutes + 1, rows), head])


def arch(width_m: float, spring_m: float, top_m: float, depth_m: float, steps: int = 16) -> Mesh:
    """A bay of wall over a round arch that spans ``width_m``, from its springing to ``top_m``: both faces and the soffit."""
    r = width_m / 2

    def rim(u: Doubles) -> tuple[Doubles, Doubles]:
        turn = np.pi * (1 - u)
        return r * np.cos(turn), spring_m + r * np.sin(np.clip(turn, 0, np.pi))

    def face(u: Doubles, v: Doubles) -> Doubles:
        x, low = rim(u)
        return np.stack([x, low + (top_m - low) * v, np.full_like(u, depth_m / 2)], axis=-1)

    def soffit(u: Doubles, v: Doubles) -> Doubles:
        x, low = rim(u)
        return np.stack([x, low, depth_m * (0.5 - v)], axis=-1)

    front = _in_metres(surface(face, steps + 1, 2), (0, 1))
    return merge([front, front.rotate(y=180), surface(soffit, steps + 1, 2)])


def arcade(
    bays: int, bay_m: float, spring_m: float, top_m: float, pillar: Mesh, depth_m: float = 0.5
) -> tuple[Mesh, Mesh]:
    """A row of arches along +X from the origin, standing on pillars.

    Returns:
        The pillars and the wall above them.
    """
    pillars = merge(pillar.at(i * bay_m, 0, 0) for i in range(bays + 1))
    wall = merge(arch(bay_m, spring_m, top_m, depth_m).at((i + 0.5) * bay_m, 0, 0) for i in range(bays))
    return pillars, wall


def window_frame(width_m: float, height_m: float, bars: int = 2) -> Mesh:
    """A window's frame, glazing bars and sill about its centre; the pane lies at z = 0."""
    t = 0.07
    sides = [box([t, height_m, 0.10]).at(s * (width_m - t) / 2, 0, 0.03) for s in (-1, 1)]
    ends = [box([width_m, t, 0.10]).at(0, s * (height_m - t) / 2, 0.03) for s in (-1, 1)]
    glazing = [box([width_m, 0.035, 0.05]).at(0, height_m * ((k + 1) / (bars + 1) - 0.5), 0.02) for k in range(bars)]
    return merge(
        [
            *sides,
            *ends,
            *glazing,
            box([0.04, height_m, 0.06]).at(0, 0, 0.02),
            box([width_m + 0.24, 0.07, 0.22]).at(0, -height_m / 2 - 0.03, 0.08),
        ]
    )


def shutters(width_m: float, height_m: float) -> Mesh:
    """A pair of open shutters beside a window about its centre, each with its two rails."""
    leaf = 0.5 * width_m
    parts = []
    for side in (-1, 1):
        x = side * (width_m / 2 + leaf / 2 + 0.03)
        parts.append(box([leaf, height_m, 0.05]).at(x, 0, 0.05))
        parts += [box([leaf - 0.06, 0.09, 0.03]).at(x, y * height_m, 0.085) for y in (-0.33, 0.33)]
    return merge(parts)


def gable_roof(width_m: float, depth_m: float, rise_m: float, overhang_m: float = 0.35) -> Mesh:
    """Two slopes over a ridge along X, above a box from z = 0 back to ``-depth_m``; the eaves are at y = 0."""
    half = depth_m / 2
    slope, angle = float(np.hypot(half, rise_m)), float(np.degrees(np.arctan2(rise_m, half)))
    length = slope + overhang_m
    # The slab hangs down from the ridge: its middle is half its length down the slope.
    slab = box([width_m + 0.5, 0.14, length]).at(0, 0, length / 2).rotate(x=angle).at(0, rise_m, -half)
    back = slab.at(0, 0, half).rotate(y=180).at(0, 0, -half)
    ridge = tube([[-width_m / 2 - 0.25, rise_m + 0.06, -half], [width_m / 2 + 0.25, rise_m + 0.06, -half]], 0.12, 8)
    return merge([slab, back, ridge])


def gables(width_m: float, depth_m: float, rise_m: float) -> Mesh:
    """The two triangles of wall under a `gable_roof`."""
    z = np.array([0.0, -depth_m, -depth_m / 2])
    y = np.array([0.0, 0.0, rise_m])
    parts = []
    for side in (-1.0, 1.0):
        points = np.stack([np.full(3, side * width_m / 2), y, z], axis=1)
        corners = np.array([[0, 1, 2]] if side > 0 else [[1, 0, 2]], np.int32)
        parts.append(Mesh(points, np.tile([side, 0.0, 0.0], (3, 1)), np.stack([z, y], axis=1), triangles=corners))
    return merge(parts)


def floor(left: float, right: float, near_z: float, far_z: float) -> Mesh:
    """A level rectangle at y = 0, with texture coordinates in metres."""
    points = np.array([[left, 0, near_z], [right, 0, near_z], [right, 0, far_z], [left, 0, far_z]])
    return Mesh(points, np.tile([0.0, 1, 0], (4, 1)), points[:, [0, 2]], np.array([[0, 1, 2, 3]], np.int32))


def railing(length_m: float, height_m: float, bars: int) -> Mesh:
    """Wrought iron along +X from the origin: bars between two rails, a row of rings under the upper one."""
    radius = length_m / bars / 2 * 0.86
    parts = [tube([[0, height_m, 0], [length_m, height_m, 0]], 0.030, 8)]
    parts += [
        rounded_box([length_m, 0.03, 0.04], 0.01, 1).at(length_m / 2, y, 0) for y in (0.10, height_m - 2.2 * radius)
    ]
    for k in range(bars + 1):
        parts.append(tube([[k * length_m / bars, 0.0, 0], [k * length_m / bars, height_m, 0]], 0.013, 6, capped=False))
    hoop = ring(radius, 0.011, 14, 5).rotate(x=90)
    parts += [hoop.at((k + 0.5) * length_m / bars, height_m - 1.1 * radius, 0) for k in range(bars)]
    return merge(parts)


def _in_metres(mesh: Mesh, axes: tuple[int, int]) -> Mesh:
    """A flat mesh with its own coordinates for texture coordinates."""
    return Mesh(mesh.points, mesh.normals, mesh.points[:, axes], mesh.quads, mesh.triangles)
