"""The town's houses: walls with windows under gable roofs, as meshes by look."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.demo.shapes.kit import box, disk, lathe, plate
from render.demo.shapes.mesh import Mesh, merge
from render.lab.reference.bench_scenes.masonry import gable_roof, gables, railing, shutters, window_frame

Parts = list[tuple[str, Mesh]]


@dataclass(frozen=True)
class House:
    """Design of a house. Lengths are metres.

    Attributes:
        width_m: width of its front.
        storeys: floors above the ground floor, at least one.
        wall: look of its walls.
        shutter: look of its shutters and door.
        arcaded: whether its ground floor is left open for an arcade.
        balcony: whether the first floor has one.
        seed: seed of the choice of lit windows.
    """

    width_m: float
    storeys: int
    wall: str
    shutter: str
    arcaded: bool = False
    balcony: bool = False
    seed: int = 0


DEPTH_M = 6.5
GROUND_M = 3.4
STOREY_M = 2.9


def house_parts(house: House) -> Parts:
    """A house whose front stands along X in the plane z = 0, its middle at the origin, facing +Z."""
    low = GROUND_M if house.arcaded else 0.0
    top = GROUND_M + house.storeys * STOREY_M
    rise = 0.42 * DEPTH_M
    parts: Parts = [
        (house.wall, box([house.width_m, top - low, DEPTH_M]).at(0, (top + low) / 2, -DEPTH_M / 2)),
        (house.wall, gables(house.width_m, DEPTH_M, rise).at(0, top, 0)),
        ("roof", gable_roof(house.width_m, DEPTH_M, rise).at(0, top, 0)),
        ("trim", box([house.width_m + 0.16, 0.16, 0.22]).at(0, top - 0.12, 0.06)),
        ("trim", box([house.width_m + 0.06, 0.12, 0.12]).at(0, GROUND_M, 0.03)),
        ("brick", _chimney().at(0.28 * house.width_m, top + rise - 0.6, -0.62 * DEPTH_M)),
    ]
    parts += _windows(house)
    if not house.arcaded:
        parts += _ground_floor(house)
    if house.balcony:
        parts += _balcony(house)
    return parts


def _windows(house: House) -> Parts:
    random = np.random.default_rng(house.seed)
    columns = max(2, round(house.width_m / 2.4))
    frames, leaves = [], []
    panes: dict[str, list[Mesh]] = {"lit window": [], "dark window": []}
    for storey in range(house.storeys):
        for k in range(columns):
            x = house.width_m * ((k + 0.5) / columns - 0.5)
            y = GROUND_M + storey * STOREY_M + 1.55
            frames.append(window_frame(0.95, 1.55).at(x, y, 0.02))
            leaves.append(shutters(0.95, 1.55).at(x, y, 0))
            panes["lit window" if random.random() < 0.4 else "dark window"].append(plate(0.9, 1.5).at(x, y, 0.025))
    panes["dark window"].append(plate(0.7, 0.9).at(0, GROUND_M + house.storeys * STOREY_M + 1.1, -2.0))
    glazed = [(look, merge(made)) for look, made in panes.items() if made]
    return [("trim", merge(frames)), (house.shutter, merge(leaves)), *glazed]


def _ground_floor(house: House) -> Parts:
    """A door with a step and a shop's window under an awning."""
    door_x = -0.3 * house.width_m
    shop = 0.46 * house.width_m
    shop_x = 0.18 * house.width_m
    awning = plate(shop + 0.5, 1.35, 9, 2).rotate(x=-62).at(shop_x, 2.62, 0.62)
    sides = [plate(0.09, shop + 0.2).rotate(z=90).at(shop_x, 0.55 + 1.75 * k, 0.06) for k in (0, 1)]
    return [
        (house.shutter, box([1.05, 2.15, 0.10]).at(door_x, 1.2, 0.02)),
        ("trim", window_frame(1.25, 2.4, 0).at(door_x, 1.25, 0.0)),
        ("stone", box([1.7, 0.16, 0.7]).at(door_x, 0.08, 0.35)),
        ("trim", window_frame(shop, 1.75, 1).at(shop_x, 1.42, 0.02)),
        ("lit window", plate(shop, 1.7).at(shop_x, 1.42, 0.025)),
        ("trim", merge(sides)),
        ("awning", awning),
    ]


def _balcony(house: House) -> Parts:
    width = 0.72 * house.width_m
    slab = box([width, 0.12, 0.95]).at(0, GROUND_M + 0.08, 0.48)
    front = railing(width, 0.95, round(width / 0.2)).at(-width / 2, GROUND_M + 0.14, 0.9)
    pots = [_pot().at(x * width, GROUND_M + 0.14, 0.7) for x in (-0.36, 0.05, 0.38)]
    return [("stone", slab), ("iron", front), ("clay", merge(pots))]


def _chimney() -> Mesh:
    stack = box([0.75, 2.0, 0.6])
    pots = [lathe([[0.10, 0.0], [0.13, 0.45], [0.0, 0.45]], 8).at(x, 1.0, 0) for x in (-0.18, 0.18)]
    return merge([stack, box([0.9, 0.14, 0.75]).at(0, 0.95, 0), *pots])


def _pot() -> Mesh:
    side = lathe([[0.13, 0.0], [0.19, 0.26], [0.21, 0.26], [0.21, 0.32], [0.17, 0.32]], 12)
    return merge([side, disk(0.18, 12).at(0, 0.29, 0)])
