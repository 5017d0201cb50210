"""A hall of dragons, one part in twenty-six: scaly bodies coil about fluted columns over boulders and a hoard of coins.

It stands for the paper's Dragon (Lee, Eisemann & Seidel 2010, table 1: 935 thousand triangles).
"""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import ball, box, lathe, smooth_curve, tube
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
from render.lab.reference.bench_scenes.masonry import arcade, column, floor, fluted_column, railing
from render.lab.reference.bench_scenes.relief import boulder, scaly_body
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Dome, Image, Material, Scene

_FOCUS_M = 8.3

_DRAGONS = np.array([[-1.5, 0.0, -9.4], [2.6, 0.0, -13.5], [-3.2, 0.0, -19.0]])
_COLUMNS = np.array(
    [[-1.5, 0, -9.4], [2.6, 0, -13.5], [-3.2, 0, -19.0], [3.6, 0, -20.5], [-5.2, 0, -13.0], [5.6, 0, -10.5]]
)
_LAMPS = np.array([[0.9, 2.6, -8.2], [-3.6, 2.4, -11.5], [0.2, 2.8, -16.0], [4.4, 2.4, -16.5]])


def dragons() -> tuple[Scene, Camera]:
    """The scene and a camera that is focused on the nearest dragon's head."""
    made = Assembly(_looks())
    made.add("paving", floor(-16, 16, 2.0, -36.0), "/Dragons/floor")
    _coils(made)
    _hall(made)
    _hoard(made)
    _lanterns(made)
    _foreground(made)
    lights = (
        sun((2.6, 2.4, 2.1), (-0.45, -0.75, -0.48), "/Dragons/sun"),
        *lamp_lights(_LAMPS, (26.0, 17.0, 8.0), 0.15, "/Dragons/light"),
    )
    sky = textures.evening_sky((0.30, 0.40, 0.62), (0.86, 0.70, 0.58), (0.28, 0.25, 0.22), 41)
    dome = Dome((0.7, 0.7, 0.7), np.eye(4), sky, path="/Dragons/sky")
    return made.scene(lights, dome), bench_camera((0.3, 2.3, 0.0), (0.0, 1.8, -10.0), _FOCUS_M, "/Dragons/camera")


def _looks() -> dict[str, Look]:
    def rough(image: Image, tile_m: float, roughness: float = 0.8) -> Look:
        return Look(Material(lookups={"base_color": textured(image, tile_m)}, roughness=roughness))

    return {
        "paving": rough(textures.cobbles(41), 5.0),
        "hide": rough(textures.marble((0.30, 0.50, 0.36), (0.62, 0.56, 0.30), 42), 1.6, 0.55),
        "horn": rough(textures.planks((0.66, 0.56, 0.40), 43), 0.6, 0.6),
        "stone": rough(textures.plaster((0.72, 0.68, 0.62), 44), 3.0),
        "rock": rough(textures.plaster((0.50, 0.47, 0.45), 45), 1.5, 0.9),
        "wall": rough(textures.bricks((0.52, 0.44, 0.38), (0.58, 0.54, 0.48), 46), 2.4),
        "coin": Look(Material(base_color=(0.72, 0.46, 0.10), roughness=0.5)),
        "iron": Look(Material(base_color=(0.04, 0.04, 0.045), roughness=0.55)),
        "eye": Look(Material(base_color=(0.02, 0.01, 0.0), emissive=(3.0, 1.1, 0.1))),
        "lantern": Look(Material(base_color=(0, 0, 0), emissive=(3.4, 2.5, 1.4))),
    }


def _coils(made: Assembly) -> None:
    turns, sizes = np.array([0.2, -0.5, 0.9]), np.array([1.0, 1.05, 1.15])
    poses = poses_at(_DRAGONS, turns, sizes)
    path, radii = _spine()
    body = merge([scaly_body(path, radii, 88, 26), _head(path[-1])])
    made.add_instances("hide", body, poses, "/Dragons/bodies")
    made.add_instances("horn", merge([*_spikes(path, radii), *_horns(path[-1])]), poses, "/Dragons/horns")
    eyes = [ball(0.045, 16, 10).at(*(path[-1] + np.array([s * 0.17, 0.12, 0.24]))) for s in (-1, 1)]
    made.add_instances("eye", merge(eyes), poses, "/Dragons/eyes")


def _spine() -> tuple[DoubleArray, DoubleArray]:
    """Two and a half turns up a column from the tail on the ground; the neck leans out to +Z."""
    t = np.linspace(0, 1, 26)
    turn = 2 * np.pi * (2.4 * t - 2.4 + 0.06)
    reach = 0.82 + 0.8 * (1 - t) ** 3
    coil = np.stack([reach * np.sin(turn), 0.22 + 2.3 * t**1.15, reach * np.cos(turn)], axis=1)
    neck = np.array([[0.75, 2.78, 1.05], [0.72, 2.95, 1.30], [0.55, 2.80, 1.55]])
    path = smooth_curve(np.concatenate([coil, neck]), 1150)
    s = np.linspace(0, 1, len(path))
    return path, np.interp(s, [0, 0.25, 0.6, 0.82, 0.93, 1.0], [0.02, 0.17, 0.31, 0.26, 0.17, 0.19])


def _head(place: DoubleArray) -> Mesh:
    """A skull, a snout and a jaw about the end of the spine, looking to +Z."""
    skull = boulder(0.26, 96, 64, 51, 0.10).scale(0.95, 0.85, 1.1)
    snout = boulder(0.20, 96, 64, 52, 0.10).scale(0.8, 0.6, 1.7).at(0, -0.02, 0.36)
    jaw = boulder(0.17, 64, 48, 53, 0.10).scale(0.75, 0.4, 1.7).rotate(x=14).at(0, -0.19, 0.28)
    return merge([skull, snout, jaw]).at(*place)


def _horns(place: DoubleArray) -> list[Mesh]:
    horns = []
    for side in (-1, 1):
        line = smooth_curve([[side * 0.14, 0.14, 0.0], [side * 0.26, 0.34, -0.2], [side * 0.24, 0.50, -0.46]], 20)
        horns.append(tube(line + place, np.linspace(0.06, 0.008, 20), 16))
    return horns


def _spikes(path: DoubleArray, radii: DoubleArray) -> list[Mesh]:
    """A comb of spikes along the back, which is away from the column's axis."""
    spikes = []
    for i in range(120, len(path) - 60, 23):
        outward = path[i] * [1, 0, 1]
        outward = outward / np.linalg.norm(outward) + [0, 0.35, 0]
        tip = path[i] + outward * (radii[i] * 1.75)
        line = np.linspace(path[i] + outward * radii[i] * 0.7, tip, 6)
        spikes.append(tube(line, np.linspace(0.30, 0.03, 6) * radii[i], 10))
    return spikes


def _hall(made: Assembly) -> None:
    made.add_instances("stone", fluted_column(5.2, 0.42, 22, 24), poses_at(_COLUMNS), "/Dragons/columns")
    pillars, wall = arcade(9, 3.3, 2.9, 6.4, column(2.9, 0.3, 24), 0.9)
    for look, mesh in (("stone", pillars), ("wall", wall)):
        made.add(look, mesh.at(-14.85, 0, -27.0), "/Dragons/arcade")
    made.add("wall", box([44, 4.2, 0.4]).at(0, 2.1, -34.0), "/Dragons/wall")
    random = np.random.default_rng(47)
    places = np.stack([random.uniform(-6, 6, 14), np.full(14, 0.12), random.uniform(-23, -11, 14)], axis=1)
    made.add_instances(
        "rock",
        boulder(0.5, 60, 40, 48),
        poses_at(places, random.uniform(0, 6, 14), random.uniform(0.5, 1.4, 14)),
        "/Dragons/rocks",
    )


def _hoard(made: Assembly) -> None:
    """Coins heaped before the nearest dragon, and three eggs on them."""
    random = np.random.default_rng(49)
    count = 420
    away, turn = random.rayleigh(0.5, count), random.uniform(0, 2 * np.pi, count)
    height = 0.55 * np.exp(-((away / 0.75) ** 2)) * random.uniform(0.6, 1.0, count)
    places = np.stack([0.9 + away * np.sin(turn), height + 0.02, -8.9 + away * np.cos(turn)], axis=1)
    poses = poses_at(places, turn)
    tilt = random.uniform(-0.7, 0.7, count)
    lean = np.tile(np.eye(4), (count, 1, 1))
    lean[:, 1, 1] = lean[:, 2, 2] = np.cos(tilt)
    lean[:, 2, 1], lean[:, 1, 2] = np.sin(tilt), -np.sin(tilt)
    coin = lathe([[0, -0.012], [0.085, -0.012], [0.09, -0.006], [0.09, 0.006], [0.085, 0.012], [0, 0.012]], 20)
    made.add_instances("coin", coin, poses @ lean, "/Dragons/coins")
    eggs = np.array([[0.75, 0.62, -8.75], [1.15, 0.5, -8.7], [0.95, 0.45, -8.35]])
    egg = boulder(0.2, 128, 96, 50, 0.05).scale(1, 1.35, 1)
    made.add_instances("hide", egg, poses_at(eggs, np.arange(3.0)), "/Dragons/eggs")


def _lanterns(made: Assembly) -> None:
    chain = tube([[0, 0.2, 0], [0, 4.0, 0]], 0.015, 6)
    made.add_instances("iron", chain, poses_at(_LAMPS), "/Dragons/lanterns")
    made.add_instances("lantern", ball(0.15, 20, 14), poses_at(_LAMPS), "/Dragons/lanterns")


def _foreground(made: Assembly) -> None:
    """Iron bars and a tail's tip from above, as near as the lens blurs most."""
    made.add("iron", railing(3.2, 1.1, 10).rotate(y=6).at(-2.3, 0.25, -4.5), "/Dragons/railing")
    line = smooth_curve(
        [[2.75, 4.4, -5.1], [2.0, 3.7, -5.0], [1.8, 3.1, -4.95], [1.45, 2.8, -4.95], [1.32, 3.05, -4.95]], 420
    )
    made.add("hide", scaly_body(line, np.linspace(0.24, 0.03, 420), 80, 22), "/Dragons/tail")
