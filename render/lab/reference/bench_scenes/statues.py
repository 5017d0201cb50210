"""A garden of winged statues, one part in twenty-six: two rows of angels between columns, seen past a balustrade and a branch.

It stands for the paper's Angels (Lee, Eisemann & Seidel 2010, table 1: 407 thousand triangles).
"""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import ball, box, lathe, rounded_box, smooth_curve, tube
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
from render.lab.reference.bench_scenes.masonry import arcade, column, floor, fluted_column
from render.lab.reference.bench_scenes.relief import robe
from render.model.camera import Camera
from render.model.scene import Dome, Image, Material, Scene

_FOCUS_M = 8.6
_ANGEL_M = 2.1
_PEDESTAL_M = 0.75

_ANGELS = np.array(
    [[-1.2, -8.6], [1.9, -11.4], [-2.7, -13.0], [2.6, -16.5], [-2.7, -18.0], [2.6, -21.5], [-2.7, -23.0]]
)
_COLUMNS = np.array([[s * 4.0, z] for z in (-8.0, -11.5, -15.0, -18.5, -22.0) for s in (-1, 1)])
_LAMPS = np.array([[-2.2, 0.0, -10.8], [1.0, 0.0, -9.4], [-1.1, 0.0, -15.2], [1.2, 0.0, -19.4]])


def statues() -> tuple[Scene, Camera]:
    """The scene and a camera that is focused on the nearest angel."""
    made = Assembly(_looks())
    made.add("paving", floor(-14, 14, 2.0, -34.0), "/Statues/paving")
    _angels(made)
    _colonnade(made)
    _braziers(made)
    _garden(made)
    _foreground(made)
    lights = (
        sun((3.0, 2.7, 2.2), (0.50, -0.70, -0.50), "/Statues/sun"),
        *lamp_lights(_LAMPS + np.array([0, 1.35, 0]), (16.0, 9.0, 3.5), 0.13, "/Statues/light"),
    )
    sky = textures.evening_sky((0.34, 0.50, 0.78), (0.90, 0.82, 0.74), (0.30, 0.32, 0.26), 21)
    dome = Dome((0.75, 0.75, 0.75), np.eye(4), sky, path="/Statues/sky")
    return made.scene(lights, dome), bench_camera((0.5, 2.1, 0.0), (-0.1, 1.75, -10.0), _FOCUS_M, "/Statues/camera")


def _looks() -> dict[str, Look]:
    def stone(image: Image, tile_m: float, roughness: float = 0.8) -> Look:
        return Look(Material(lookups={"base_color": textured(image, tile_m)}, roughness=roughness))

    leaves = textures.leaf_card((0.30, 0.47, 0.20), 28)
    foliage = {"base_color": textured(leaves, clamped=True), "opacity": textured(leaves, clamped=True, channel=3)}
    return {
        "paving": stone(textures.checkers((0.72, 0.70, 0.66), (0.42, 0.41, 0.40), 21), 4.0),
        "marble": stone(textures.marble((0.88, 0.86, 0.82), (0.46, 0.44, 0.44), 22), 1.2, 0.6),
        "sandstone": stone(textures.plaster((0.80, 0.72, 0.58), 23), 2.5),
        "wall": stone(textures.bricks((0.58, 0.40, 0.30), (0.62, 0.57, 0.50), 24), 1.9),
        "wood": stone(textures.planks((0.40, 0.30, 0.22), 25), 1.2),
        "bronze": Look(Material(base_color=(0.20, 0.13, 0.06), roughness=0.55)),
        "flame": Look(Material(base_color=(0, 0, 0), emissive=(3.4, 2.0, 0.8))),
        "leaves": Look(Material(lookups=foliage, roughness=0.7, opacity_threshold=0.5), True),
    }


def _angels(made: Assembly) -> None:
    places = np.insert(_ANGELS, 1, _PEDESTAL_M, axis=1)
    turns = np.array([0.25, -0.45, 0.5, -0.5, 0.5, -0.5, 0.5])
    made.add_instances("marble", _angel(), poses_at(places, turns), "/Statues/angels")
    pedestal = merge(
        [
            rounded_box([1.3, 0.12, 1.3], 0.03, 3).at(0, 0.06, 0),
            rounded_box([1.05, 0.52, 1.05], 0.04, 3).at(0, 0.37, 0),
            rounded_box([1.25, 0.12, 1.25], 0.03, 3).at(0, 0.69, 0),
        ]
    )
    made.add_instances("sandstone", pedestal, poses_at(places * [1, 0, 1], turns), "/Statues/pedestals")


def _angel() -> Mesh:
    """A robed figure with wings, facing +Z, its feet at the origin."""
    body = robe(0.88 * _ANGEL_M, 128, 72, 11, 31)
    y = 0.88 * _ANGEL_M
    head = merge(
        [ball(0.145, 28, 18).scale(0.9, 1.15, 1).at(0.0, y + 0.14, 0.02), ball(0.12, 20, 12).at(0, y + 0.19, -0.08)]
    )
    arms = []
    for side in (-1, 1):
        line = smooth_curve(
            [
                [side * 0.25, 0.78 * _ANGEL_M, 0],
                [side * 0.42, 0.62 * _ANGEL_M, 0.12],
                [side * 0.05, 0.66 * _ANGEL_M, 0.42],
            ],
            22,
        )
        arms.append(tube(line, np.linspace(0.105, 0.05, 22), 20))
    wing = _wing()
    return merge([body, head, *arms, wing, wing.scale(-1, 1, 1)])


def _wing() -> Mesh:
    """The wing on the +X side: three rows of feathers along its bone."""
    bone = smooth_curve([[0.08, 1.55, -0.18], [0.42, 2.05, -0.32], [0.80, 2.35, -0.38], [1.05, 2.25, -0.36]], 30)
    parts = [tube(bone, np.linspace(0.07, 0.03, 30), 12)]
    feather = ball(0.5, 12, 10).scale(0.14, 1.0, 0.035).at(0, -0.48, 0)
    for row, (count, length) in enumerate(((17, 1.15), (14, 0.75), (12, 0.42))):
        for k in range(count):
            t = k / (count - 1)
            x, y, z = bone[int(3 + 26 * t)]
            tilt = 4 + 34 * t - 6 * row
            parts.append(feather.scale(1.0, length * (0.8 + 0.35 * t), 1.0).rotate(z=tilt).at(x, y, z + 0.035 * row))
    return merge(parts)


def _colonnade(made: Assembly) -> None:
    places = np.insert(_COLUMNS, 1, 0.0, axis=1)
    made.add_instances("sandstone", fluted_column(4.6, 0.34, 20, 22), poses_at(places), "/Statues/columns")
    for side in (-1, 1):
        beam = rounded_box([1.1, 0.55, 16.5], 0.05, 3).at(side * 4.0, 4.87, -15.0)
        made.add("sandstone", beam, "/Statues/beams")
    pillars, wall = arcade(9, 3.1, 2.6, 5.6, column(2.6, 0.28, 24), 0.8)
    for look, mesh in (("sandstone", pillars), ("wall", wall)):
        made.add(look, mesh.at(-13.95, 0, -29.0), "/Statues/arcade")
    made.add("wall", box([40, 5.0, 0.4]).at(0, 2.5, -33.0), "/Statues/wall")


def _braziers(made: Assembly) -> None:
    stand = lathe(
        [
            [0.22, 0.0],
            [0.24, 0.06],
            [0.06, 0.14],
            [0.05, 0.9],
            [0.10, 0.98],
            [0.26, 1.12],
            [0.28, 1.16],
            [0.2, 1.14],
            [0, 1.08],
        ],
        28,
    )
    made.add_instances("bronze", stand, poses_at(_LAMPS), "/Statues/braziers")
    made.add_instances("flame", ball(0.13, 18, 12).at(0, 1.2, 0), poses_at(_LAMPS), "/Statues/braziers")


def _garden(made: Assembly) -> None:
    places = np.array(
        [[-6.8, 0.0, -13.0], [6.9, 0.0, -14.5], [-7.2, 0, -20.0], [7.2, 0, -21.5], [-2.0, 0, -31.0], [5, 0, -31.2]]
    )
    turns, sizes = np.arange(len(places)) * 1.7, np.array([1.1, 1.0, 1.25, 1.2, 1.3, 1.2])
    made.add_instances("wood", trunk(2.4, 0.14, 26), poses_at(places, turns, sizes), "/Statues/trees")
    leaves = crown(1.5, 520, 0.7, 27).at(0, 3.4, 0)
    made.add_instances("leaves", leaves, poses_at(places, turns, sizes), "/Statues/trees")


def _foreground(made: Assembly) -> None:
    """A balustrade and a branch, as near as the lens blurs most."""
    profile = smooth_curve(
        [[0.07, 0.0], [0.07, 0.06], [0.05, 0.1], [0.10, 0.26], [0.055, 0.46], [0.045, 0.58], [0.07, 0.64], [0.07, 0.7]],
        40,
    )
    posts = np.array([[-2.7 + 0.36 * k, 0.42, -4.96 + 0.02 * k] for k in range(11)])
    made.add_instances("marble", lathe(profile, 30), poses_at(posts), "/Statues/balustrade")
    for y in (0.36, 1.18):
        rail = rounded_box([4.1, 0.12, 0.26], 0.03, 3).rotate(y=-3.2).at(-0.9, y, -4.86)
        made.add("sandstone", rail, "/Statues/balustrade")
    path = np.array([[2.95, 4.1, -5.15], [2.2, 3.8, -5.05], [1.65, 3.35, -5.0], [1.3, 2.8, -5.0]])
    wood, leaves = hanging_branch(path, 24, 0.36, 29)
    made.add("wood", wood, "/Statues/branch")
    made.add("leaves", leaves, "/Statues/branch")
