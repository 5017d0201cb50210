"""The street: wet setts with tram rails, kerbs and pavements. It runs along -Z; the camera stands near the origin."""

from __future__ import annotations

import numpy as np

from render.demo.places import RAILS_X_M
from render.demo.shapes.kit import box, plate, rounded_box, surface
from render.demo.shapes.mesh import Array, Mesh, merge

HALF_WIDTH_M = 2.7  # from the middle of the street to a kerb
WALL_M = 4.1  # from the middle of the street to the house fronts
NEAR_Z_M, FAR_Z_M = 2.0, -33.0
KERB_M = 0.12
FINE_Z_M = -13.0  # beyond it bevels are smaller than a pixel


def _roadway() -> Mesh:
    """The setts: cambered a little and uneven, so that no reflection is straight."""

    def shape(u: Array, v: Array) -> Array:
        x, z = (u - 0.5) * 2 * HALF_WIDTH_M, NEAR_Z_M + v * (FAR_Z_M - NEAR_Z_M)
        y = -0.006 * x**2 + 0.004 * np.sin(2.1 * x + 0.7 * z) + 0.004 * np.sin(1.3 * z - 0.8 * x)
        return np.stack([x, y, z], axis=-1)

    road = surface(shape, 41, 241)
    return Mesh(road.points, road.normals, road.points[:, [0, 2]] * [1, -1], road.quads, road.triangles)


def _pavements() -> Mesh:
    """Flagstones on both sides, each one a slab of its own with an open joint."""
    random = np.random.default_rng(21)
    slabs = []
    for side in (-1, 1):
        for row, width in enumerate((0.62, 0.62)):
            z = NEAR_Z_M - 0.4 * row
            while z > FAR_Z_M:
                length = random.uniform(0.7, 1.1)
                x = side * (HALF_WIDTH_M + 0.16 + 0.62 * row + width / 2)
                lift = KERB_M - 0.05 + random.uniform(-0.004, 0.004)
                size = [width - 0.012, 0.1, length - 0.012]
                slab = rounded_box(size, 0.008, 1) if z > FINE_Z_M else box(size)
                slabs.append(slab.rotate(x=random.uniform(-0.3, 0.3)).at(x, lift, z - length / 2))
                z -= length
    return merge(slabs)


def _kerbs() -> Mesh:
    stones = []
    for side in (-1, 1):
        for k in range(32):
            stone = rounded_box([0.16, 0.3, 1.08], 0.02, 1)
            stones.append(stone.at(side * (HALF_WIDTH_M + 0.08), KERB_M - 0.15, NEAR_Z_M - 0.55 - 1.1 * k))
    return merge(stones)


def _sky() -> Mesh:
    """A painted night sky behind the last houses."""
    return plate(90.0, 40.0).at(0, 19.0, FAR_Z_M - 25.0)


def street() -> dict[str, Mesh]:
    """The ground, by look."""
    length, middle = NEAR_Z_M - FAR_Z_M, (NEAR_Z_M + FAR_Z_M) / 2
    rails = merge(rounded_box([0.065, 0.03, length], 0.006, 1).at(x, -0.006, middle) for x in RAILS_X_M)
    grooves = merge(box([0.04, 0.02, length]).at(x + 0.05, -0.005, middle) for x in RAILS_X_M)
    bed = merge(box([0.3, 0.02, length]).at(side * (WALL_M - 0.05), KERB_M - 0.02, middle) for side in (-1, 1))
    return {
        "Setts": _roadway(),
        "Kerb": merge([_kerbs(), _pavements(), bed]),
        "Steel": rails,
        "Rubber": grooves,
        "Sky": _sky(),
    }
