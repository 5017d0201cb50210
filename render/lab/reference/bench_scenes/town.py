"""A model town, one part in twenty-six: a street with arcades down to its gate tower, seen past a railing and a branch.

It stands for the paper's Town (Lee, Eisemann & Seidel 2010, table 1: 98 thousand triangles).
"""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import ball, box, disk, lathe, plate, ring, rounded_box, tube
from render.demo.shapes.mesh import Mesh, merge
from render.lab.reference.bench_scenes import textures
from render.lab.reference.bench_scenes.assembly import (
    Assembly,
    Look,
    bench_camera,
    lamp_lights,
    poses_at,
    sun,
    textured,
)
from render.lab.reference.bench_scenes.greenery import crown, hanging_branch, trunk
from render.lab.reference.bench_scenes.houses import House, house_parts
from render.lab.reference.bench_scenes.masonry import arcade, column, floor, gable_roof, gables, railing, window_frame
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Dome, Image, Material, Scene

STREET_M = 8.0
_FOCUS_M = 9.6

_LEFT = (
    House(9.0, 2, "ochre", "green", arcaded=True, seed=1),
    House(7.5, 3, "brick", "blue", arcaded=True, seed=2),
    House(10.0, 2, "cream", "red", arcaded=True, seed=3),
    House(8.0, 3, "rose", "green", seed=4),
    House(9.0, 2, "brick", "blue", seed=5),
)
_RIGHT = (
    House(8.0, 2, "brick", "green", balcony=True, seed=6),
    House(9.0, 3, "cream", "blue", balcony=True, seed=7),
    House(7.0, 2, "rose", "red", seed=8),
    House(9.5, 3, "ochre", "green", seed=9),
    House(8.5, 2, "cream", "blue", seed=10),
)


def town() -> tuple[Scene, Camera]:
    """The scene and a camera that is focused on the fountain."""
    made = Assembly(_looks())
    _street(made)
    for houses, side in ((_LEFT, -1), (_RIGHT, 1)):
        _row(made, houses, side)
    _arcade(made)
    _gate_tower(made, -49.0)
    _fountain(made, np.array([0.5, 0.0, -_FOCUS_M - 0.3]))
    _lamps(made)
    _strings(made)
    _trees(made)
    _market(made)
    _foreground(made)
    lights = (
        sun((0.8, 0.75, 0.75), (-0.42, -0.76, -0.50), "/Town/sun"),
        *lamp_lights(_LAMPS + np.array([0, 2.92, 0]), (13.0, 8.5, 4.2), 0.2, "/Town/lamps/light"),
        *lamp_lights(_lanterns(), (6.0, 3.6, 1.6), 0.2, "/Town/strings/light"),
    )
    sky = textures.evening_sky((0.40, 0.55, 0.80), (0.96, 0.80, 0.66), (0.36, 0.33, 0.30), 11)
    dome = Dome((0.4, 0.4, 0.44), np.eye(4), sky, path="/Town/sky")
    return made.scene(lights, dome), bench_camera((0.9, 2.7, 0.0), (-0.25, 2.35, -12.0), _FOCUS_M, "/Town/camera")


def _looks() -> dict[str, Look]:
    def wall(image: Image, tile_m: float, roughness: float = 0.9) -> Look:
        return Look(Material(lookups={"base_color": textured(image, tile_m)}, roughness=roughness))

    leaves = textures.leaf_card((0.36, 0.52, 0.20), 8)
    foliage = {"base_color": textured(leaves, clamped=True), "opacity": textured(leaves, clamped=True, channel=3)}
    lit = textures.lit_window((0.45, 0.33, 0.2), 9)
    return {
        "brick": wall(textures.bricks((0.60, 0.30, 0.22), (0.66, 0.62, 0.55), 1), 1.9),
        "ochre": wall(textures.plaster((0.86, 0.66, 0.40), 2), 4.0),
        "cream": wall(textures.plaster((0.88, 0.82, 0.70), 12), 4.0),
        "rose": wall(textures.plaster((0.82, 0.56, 0.48), 22), 4.0),
        "roof": wall(textures.roof_tiles((0.66, 0.32, 0.20), 3), 2.6),
        "cobbles": wall(textures.cobbles(4), 4.5, 0.75),
        "paving": wall(textures.checkers((0.74, 0.71, 0.66), (0.55, 0.52, 0.48), 5), 3.2, 0.8),
        "stone": wall(textures.plaster((0.74, 0.72, 0.68), 32), 3.0, 0.8),
        "wood": wall(textures.planks((0.55, 0.40, 0.26), 5), 1.2, 0.7),
        "green": wall(textures.planks((0.24, 0.42, 0.33), 6), 0.9, 0.6),
        "blue": wall(textures.planks((0.28, 0.40, 0.56), 7), 0.9, 0.6),
        "red": wall(textures.planks((0.56, 0.22, 0.18), 8), 0.9, 0.6),
        "awning": Look(
            Material(lookups={"base_color": textured(textures.stripes((0.72, 0.20, 0.16)), (1.0, 1.0))}, roughness=0.9),
            True,
        ),
        "trim": Look(Material(base_color=(0.62, 0.60, 0.55), roughness=0.8)),
        "iron": Look(Material(base_color=(0.035, 0.04, 0.045), roughness=0.55)),
        "clay": Look(Material(base_color=(0.36, 0.14, 0.08), roughness=0.8)),
        "bronze": Look(Material(base_color=(0.16, 0.20, 0.15), roughness=0.55)),
        "water": Look(Material(base_color=(0.04, 0.09, 0.10), roughness=0.25)),
        "dark window": Look(Material(base_color=(0.03, 0.035, 0.045), roughness=0.35)),
        "lit window": Look(
            Material(base_color=(0.02, 0.02, 0.02), roughness=0.6, lookups={"emissive": textured(lit, clamped=True)})
        ),
        "lamp": Look(Material(base_color=(0, 0, 0), emissive=(0.5, 0.36, 0.2))),
        "clock": Look(Material(base_color=(0.1, 0.1, 0.1), emissive=(0.4, 0.33, 0.22))),
        "lantern": Look(Material(base_color=(0, 0, 0), emissive=(0.55, 0.36, 0.18))),
        "leaves": Look(Material(lookups=foliage, roughness=0.7, opacity_threshold=0.5), True),
        "hedge": Look(Material(base_color=(0.10, 0.16, 0.05), roughness=0.9)),
        "fruit": Look(Material(base_color=(0.75, 0.22, 0.03), roughness=0.5)),
        "squash": Look(Material(base_color=(0.62, 0.42, 0.05), roughness=0.5)),
    }


def _street(made: Assembly) -> None:
    half = STREET_M / 2
    made.add("cobbles", floor(-half, half, 3.0, -64.0), "/Town/street")
    for side in (-1, 1):
        inner, outer = sorted((side * half, side * 14.0))
        made.add("paving", floor(inner, outer, 3.0, -64.0).at(0, 0.14, 0), "/Town/pavement")
        made.add("stone", box([0.25, 0.16, 66]).at(side * (half - 0.1), 0.07, -31), "/Town/kerb")
    made.add("cobbles", floor(-40, 40, -63.9, -90.0), "/Town/street")


def _row(made: Assembly, houses: tuple[House, ...], side: int) -> None:
    z = -4.0
    for house in houses:
        z -= house.width_m / 2
        for look, mesh in house_parts(house):
            made.add(look, mesh.rotate(y=-90 * side).at(side * (STREET_M / 2 + 2.4), 0, z), "/Town/houses")
        z -= house.width_m / 2


def _arcade(made: Assembly) -> None:
    """Under the first three houses on the left: the wall's plane is the kerb, the houses stand back over it."""
    length = sum(h.width_m for h in _LEFT if h.arcaded)
    bays = 10
    pillars, wall = arcade(bays, length / bays, 2.05, 3.6, column(2.05, 0.2), 0.5)
    place = -STREET_M / 2 - 0.4
    for look, mesh in (
        ("stone", pillars),
        ("stone", wall),
        ("stone", box([length, 0.2, 2.2]).at(length / 2, 3.6, -0.9)),
    ):
        made.add(look, mesh.rotate(y=90).at(place, 0.14, -4.0), "/Town/arcade")


def _gate_tower(made: Assembly, z: float) -> None:
    _, wall = arcade(1, 4.2, 3.0, 6.0, column(3.0, 0.4), 5.0)
    made.add("stone", wall.at(-2.1, 0, z - 2.5), "/Town/gate")
    for side in (-1, 1):
        made.add("stone", box([2.4, 6.0, 5.0]).at(side * 3.3, 3.0, z - 2.5), "/Town/gate")
        made.add("brick", box([7.5, 7.0, 3.0]).at(side * 8.2, 3.5, z - 2.5), "/Town/gate")
        made.add("roof", gable_roof(7.5, 3.0, 1.6).at(side * 8.2, 7.0, z - 1.0), "/Town/gate")
    made.add("ochre", box([6.4, 8.0, 5.0]).at(0, 10.0, z - 2.5), "/Town/gate")
    made.add("trim", box([7.2, 0.4, 5.6]).at(0, 6.0, z - 2.5), "/Town/gate")
    made.add("trim", box([7.2, 0.4, 5.6]).at(0, 14.0, z - 2.5), "/Town/gate")
    made.add("roof", gable_roof(6.4, 5.0, 4.0).at(0, 14.1, z), "/Town/gate")
    made.add("ochre", gables(6.4, 5.0, 4.0).at(0, 14.1, z), "/Town/gate")
    for x in (-1.7, 1.7):
        made.add("trim", window_frame(1.1, 2.0).at(x, 8.4, z + 0.05), "/Town/gate")
        made.add("lit window", plate(1.1, 2.0).at(x, 8.4, z + 0.06), "/Town/gate")
    made.add("trim", ring(1.05, 0.09, 32, 8).rotate(x=90).at(0, 12.0, z + 0.06), "/Town/gate")
    made.add("clock", disk(1.0, 32).rotate(x=90).scale(1, 1, 0.5).at(0, 12.0, z + 0.05), "/Town/gate")


def _fountain(made: Assembly, place: DoubleArray) -> None:
    basin = lathe(
        [
            [1.5, 0],
            [1.55, 0.1],
            [1.42, 0.2],
            [1.42, 0.5],
            [1.55, 0.6],
            [1.5, 0.66],
            [1.3, 0.66],
            [1.3, 0.35],
            [0, 0.35],
        ],
        8,
    )
    stem = lathe([[0.3, 0.3], [0.34, 0.4], [0.2, 0.6], [0.16, 1.1], [0.24, 1.2], [0.2, 1.26]], 24)
    bowl = lathe([[0.12, 1.2], [0.4, 1.26], [0.74, 1.44], [0.8, 1.5], [0.74, 1.5], [0.4, 1.38], [0.0, 1.36]], 40)
    foot = lathe([[0.2, 1.4], [0.24, 1.52], [0.1, 1.62], [0.14, 1.74], [0.3, 1.8], [0.0, 1.82]], 24)
    balls = [
        ball(0.16, 16, 10).at(1.46 * np.sin(a), 0.68, 1.46 * np.cos(a)) for a in np.pi / 8 + np.arange(8) * np.pi / 4
    ]
    for look, mesh in (
        ("stone", merge([basin, stem, *balls])),
        ("bronze", merge([bowl, foot, _pine_cone(0.36, 0.85).at(0, 1.78, 0)])),
        ("water", merge([disk(1.32, 24).at(0, 0.52, 0), disk(0.72, 32).at(0, 1.46, 0)])),
    ):
        made.add(look, mesh.at(*place), "/Town/fountain")


def _pine_cone(radius_m: float, height_m: float) -> Mesh:
    """Scales on a spiral of golden angles about an egg that stands on the origin."""
    t = np.linspace(0, 1, 14)
    girth = radius_m * np.sin(np.pi * (0.12 + 0.88 * t)) ** 0.8
    parts = [lathe(np.stack([0.86 * girth, height_m * t], axis=1), 20)]
    scale = ball(0.24 * radius_m, 9, 7).scale(1, 1.2, 0.6)
    for k in range(130):
        v = (k + 0.5) / 130
        turn = k * 137.50776
        reach = 0.9 * radius_m * np.sin(np.pi * (0.12 + 0.88 * v)) ** 0.8
        parts.append(scale.rotate(x=38).at(0, 0, reach).rotate(y=turn).at(0, height_m * v, 0))
    return merge(parts)


_LAMPS = np.array([[s * 3.35, 0.0, z] for z in (-7.2, -15.0) for s in (-1, 1)])


def _lamps(made: Assembly) -> None:
    post = lathe(
        [[0.16, 0.0], [0.17, 0.12], [0.08, 0.3], [0.055, 0.6], [0.045, 2.6], [0.09, 2.66], [0.03, 2.74], [0, 2.75]], 12
    )
    cap = lathe([[0.24, 3.1], [0.22, 3.16], [0.08, 3.3], [0.03, 3.42], [0, 3.43]], 12)
    made.add_instances("iron", merge([post, cap]), poses_at(_LAMPS), "/Town/lamps")
    made.add_instances("lamp", ball(0.2, 20, 14).at(0, 2.93, 0), poses_at(_LAMPS), "/Town/lamps")


_STRINGS = ((-5.6, 4.4), (-13.0, 4.6))


def _hanging(x: DoubleArray, height: float) -> DoubleArray:
    return height - 1.0 * (1 - (x / 4.2) ** 2)


def _lanterns() -> DoubleArray:
    x = np.linspace(-3.6, 3.6, 6)
    return np.concatenate([np.stack([x, _hanging(x, h) - 0.24, np.full_like(x, z)], axis=1) for z, h in _STRINGS])


def _strings(made: Assembly) -> None:
    """Strings of paper lanterns across the street, each hanging in a parabola; no farther away than a lantern is some pixels
    wide, since of a hundred rays a matter of chance find a smaller one, in the reference as in the picture against it."""
    x = np.linspace(-4.2, 4.2, 15)
    wires = [tube(np.stack([x, _hanging(x, h), np.full_like(x, z)], axis=1), 0.018, 5) for z, h in _STRINGS]
    made.add("iron", merge(wires), "/Town/strings")
    made.add_instances("lantern", ball(0.2, 24, 16), poses_at(_lanterns()), "/Town/strings")


def _trees(made: Assembly) -> None:
    places = np.array(
        [
            [2.9, 0.1, -13.5],
            [-2.9, 0.1, -19.0],
            [3.0, 0.1, -27.0],
            [-3.0, 0.1, -35.0],
            [2.8, 0.1, -43.0],
            [-9.5, 0, -60.0],
            [9.0, 0, -58.0],
        ]
    )
    turns = np.arange(len(places)) * 1.3
    sizes = np.array([0.85, 0.95, 1.0, 1.05, 1.0, 1.8, 2.0])
    made.add_instances("wood", trunk(2.4, 0.13, 3), poses_at(places, turns, sizes), "/Town/trees")
    made.add_instances("leaves", crown(1.35, 420, 0.75, 5).at(0, 3.3, 0), poses_at(places, turns, sizes), "/Town/trees")
    made.add_instances("hedge", ball(1.15, 24, 16).at(0, 3.3, 0), poses_at(places, turns, sizes), "/Town/trees")


def _market(made: Assembly) -> None:
    """A stall, barrels and crates beside the fountain."""
    stall = np.array([-2.6, 0.0, -10.8])
    posts = [tube([[x, 0, z], [x, 2.1 + 0.25 * (z < 0), z]], 0.035, 8) for x in (-0.9, 0.9) for z in (-0.6, 0.6)]
    table = [rounded_box([2.0, 0.08, 1.3], 0.02, 1).at(0, 0.85, 0), box([1.9, 0.7, 0.06]).at(0, 0.45, 0.6)]
    made.add("wood", merge([*posts, *table]).at(*stall), "/Town/stall")
    made.add("awning", plate(2.2, 1.7, 9, 2).rotate(x=-80).at(*(stall + np.array([0, 2.22, 0.05]))), "/Town/stall")
    random = np.random.default_rng(14)
    heap = [
        [stall[0] + x, 0.95 + 0.1 * random.random(), stall[2] + z]
        for x in np.linspace(-0.8, 0.8, 9)
        for z in np.linspace(-0.4, 0.5, 5)
    ]
    half = len(heap) // 2
    made.add_instances("fruit", ball(0.085, 12, 8), poses_at(np.array(heap[:half])), "/Town/stall")
    made.add_instances("squash", ball(0.1, 12, 8).scale(1, 0.8, 1), poses_at(np.array(heap[half:])), "/Town/stall")
    barrel = lathe(
        [[0.24, 0.0], [0.30, 0.2], [0.32, 0.42], [0.30, 0.64], [0.24, 0.84], [0.21, 0.84], [0.21, 0.78], [0, 0.78]], 18
    )
    hoops = merge([ring(0.305, 0.014, 20, 6).at(0, y, 0) for y in (0.2, 0.64)])
    places = np.array([[2.7, 0.0, -8.6], [3.2, 0.0, -9.2], [2.5, 0, -9.5], [-3.1, 0.0, -8.0]])
    made.add_instances("wood", barrel, poses_at(places, np.arange(4.0)), "/Town/barrels")
    made.add_instances("iron", hoops, poses_at(places), "/Town/barrels")


def _foreground(made: Assembly) -> None:
    """The balcony's railing and a branch, as near as the lens blurs most."""
    made.add("iron", railing(4.0, 1.0, 13).rotate(y=5).at(-2.45, 0.95, -4.95), "/Town/balcony")
    made.add("stone", box([4.4, 0.1, 0.35]).rotate(y=5).at(-0.45, 0.91, -5.05), "/Town/balcony")
    path = np.array([[3.25, 4.85, -5.4], [2.4, 4.55, -5.3], [1.6, 4.1, -5.2], [1.0, 3.55, -5.25]])
    wood, leaves = hanging_branch(path, 26, 0.46, 6)
    made.add("wood", wood, "/Town/branch")
    made.add("leaves", leaves, "/Town/branch")
