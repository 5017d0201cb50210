"""Generated scenes for `pullfocus bench quality` that are hard to sample: thin bars, small lights, dense geometry.

They are drawn unlit: colours of vertices are radiance. All numbers come from seeds. Cameras stand at the origin and look along
-Z.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from render.lab.reference.scenes import bench_camera, sphere, triangles_of
from render.model.arrays import DoubleArray, IntArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Material, Scene

_HERE = np.eye(4)[None]
_WHITE = Material(uses_display_color=True, base_color=(1.0, 1.0, 1.0))
_QUAD = np.array([[0, 1, 2], [0, 2, 3]])


def bars(seed: int = 0) -> tuple[Scene, Camera]:
    """Three fences of leaning bars before a chequered wall, the middle one sharp; bars are 0.5 to 3 px wide at 640x480."""
    rng = np.random.default_rng(seed)
    quads, colors = [_wall(-9.0, 28, 20)], [_chequers(28, 20)]
    for depth, count, width in ((1.6, 22, 0.0022), (3.0, 46, 0.0040), (5.5, 60, 0.0080)):
        x = np.linspace(-0.48, 0.48, count) * depth + rng.uniform(-0.004, 0.004, count) * depth
        half = width * rng.uniform(0.4, 1.2, count)
        lean = rng.uniform(-0.12, 0.12, count)
        tall = 0.32 * depth
        quads.append(
            _quads(x - lean * tall, x + lean * tall, half, -tall, tall, -depth + rng.uniform(-0.2, 0.2, count))
        )
        colors.append(rng.uniform(0.02, 0.95, (count, 3)))
    return _scene(np.concatenate(quads), np.concatenate(colors), (0.5, 0.6, 0.8)), bench_camera(3.0)


def lights(seed: int = 0) -> tuple[Scene, Camera]:
    """Three hundred lights of radiance 2 to 60, 1 to 4 px wide, from 1.2 to 25 m, and eight dark balls among them."""
    rng = np.random.default_rng(seed)
    count = 300
    depth = 1 / rng.uniform(1 / 25, 1 / 1.2, count)
    places = np.stack(
        [rng.uniform(-0.36, 0.36, count) * depth, rng.uniform(-0.27, 0.27, count) * depth, -depth], axis=-1
    )
    radii = depth * rng.uniform(0.0006, 0.0022, count)
    radiance = np.exp(rng.uniform(np.log(2), np.log(60), count))[:, None] * rng.uniform(0.4, 1.0, (count, 3))
    shades = rng.uniform(0.01, 0.15, (8, 3))
    balls = np.stack([rng.uniform(-1, 1, 8), rng.uniform(-0.7, 0.7, 8), -rng.uniform(2, 6, 8)], axis=-1)
    points, triangles, colors = _balls(
        np.concatenate([places, balls]),
        np.concatenate([radii, rng.uniform(0.15, 0.4, 8)]),
        np.concatenate([radiance, shades]),
        rings=10,
    )
    geometry = triangles_of(points, _outward(points), triangles, np.insert(colors, 3, 1.0, axis=1).astype(np.float32))
    return _of(Batch(geometry, _WHITE, _HERE), (0.01, 0.012, 0.02)), bench_camera(3.0)


def thicket(seed: int = 0) -> tuple[Scene, Camera]:
    """Twelve hundred coloured balls of 400 triangles each from 1 to 12 m: 480 thousand triangles, edges everywhere."""
    rng = np.random.default_rng(seed)
    count = 1200
    depth = 1 / rng.uniform(1 / 12, 1 / 1.0, count)
    places = np.stack([rng.uniform(-0.4, 0.4, count) * depth, rng.uniform(-0.3, 0.3, count) * depth, -depth], axis=-1)
    radii = np.exp(rng.uniform(np.log(0.004), np.log(0.04), count)) * depth
    points, triangles, colors = _balls(places, radii, rng.uniform(0.02, 0.95, (count, 3)), rings=11)
    colors *= 0.6 + 0.4 * np.sin(40 * points[:, 1:2] / np.abs(points[:, 2:]))  # stripes across
    geometry = triangles_of(points, _outward(points), triangles, np.insert(colors, 3, 1.0, axis=1).astype(np.float32))
    return _of(Batch(geometry, _WHITE, _HERE), (0.7, 0.8, 0.95)), bench_camera(2.5)


UNLIT_SCENES: dict[str, Callable[[], tuple[Scene, Camera]]] = {"bars": bars, "lights": lights, "thicket": thicket}
"""By name."""


def _quads(
    x_low: DoubleArray, x_high: DoubleArray, half: DoubleArray, low: float, high: float, z: DoubleArray
) -> DoubleArray:
    """Corners ``(n, 4, 3)`` of upright bars."""
    bottom, top = np.full_like(z, low), np.full_like(z, high)
    corners = (
        (x_low - half, bottom),
        (x_low + half, bottom),
        (x_high + half, top),
        (x_high - half, top),
    )
    return np.stack([np.stack([x, y, z], axis=-1) for x, y in corners], axis=1)


def _wall(z: float, columns: int, rows: int) -> DoubleArray:
    """Corners ``(n, 4, 3)`` of the squares of a wall."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij"))
    side = -z * 0.9 / columns
    x, y = (i - columns / 2) * side, (j - rows / 2) * side
    corners = ((x, y), (x + side, y), (x + side, y + side), (x, y + side))
    return np.stack([np.stack([a, b, np.full_like(a, z)], axis=-1) for a, b in corners], axis=1)


def _chequers(columns: int, rows: int) -> DoubleArray:
    i, j = (a.ravel() for a in np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij"))
    return np.where(((i + j) % 2)[:, None] > 0, [0.85, 0.8, 0.65], [0.06, 0.07, 0.12])


def _balls(
    centres: DoubleArray, radii: DoubleArray, radiance: DoubleArray, rings: int
) -> tuple[DoubleArray, IntArray, DoubleArray]:
    """Points, triangles and colours of spheres."""
    unit = sphere((0, 0, 0), 1.0, rings)
    places = centres[:, None, :] + radii[:, None, None] * unit.positions.astype(np.float64)
    size = len(unit.positions)
    triangles = unit.triangles[None] + size * np.arange(len(centres), dtype=np.int32)[:, None, None]
    return places.reshape(-1, 3), triangles.reshape(-1, 3), np.repeat(radiance, size, axis=0)


def _outward(points: DoubleArray) -> DoubleArray:
    """Normals towards the camera: nothing is lit, and renderers want some."""
    return np.asarray(-points / np.linalg.norm(points, axis=1, keepdims=True))


def _scene(quads: DoubleArray, colors: DoubleArray, behind: tuple[float, float, float]) -> Scene:
    points = quads.reshape(-1, 3)
    triangles = (4 * np.arange(len(quads))[:, None, None] + _QUAD).reshape(-1, 3).astype(np.int32)
    painted = np.insert(np.repeat(colors, 4, axis=0), 3, 1.0, axis=1).astype(np.float32)
    geometry = triangles_of(points, np.tile([0.0, 0.0, 1.0], (len(points), 1)), triangles, painted)
    return _of(Batch(geometry, _WHITE, _HERE, double_sided=True), behind)


def _of(batch: Batch, behind: tuple[float, float, float]) -> Scene:
    return Scene((batch,), (), Dome(behind, np.eye(4)), ("/World/all",))
