"""Generated scenes for tests and benches: geometry whose optics is hard in a known way, and single lights to measure by.

All numbers come from the seed. Cameras stand at the origin and look along -Z.
"""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Geometry, Light, Material, Scene

_HERE = np.eye(4)[None]


def triangles_of(
    positions: DoubleArray, normals: DoubleArray, triangles: IntArray, colors: FloatArray | None = None, prim: int = 0
) -> Geometry:
    """Geometry of one prim whose faces are its triangles.

    Args:
        positions: ``(n, 3)`` metres.
        normals: ``(n, 3)``.
        triangles: ``(m, 3)``.
        colors: ``(n, 4)`` or None.
        prim: index into the scene's prim paths.
    """
    count = len(triangles)
    return Geometry(
        positions=np.asarray(positions, np.float32),
        normals=np.asarray(normals, np.float32),
        triangles=np.asarray(triangles, np.int32),
        prim_ids=np.full(count, prim, np.int32),
        face_ids=np.arange(count, dtype=np.int32),
        fan_ids=np.zeros(count, np.int32),
        colors=None if colors is None else np.asarray(colors, np.float32),
    )


def sphere(centre: tuple[float, float, float], radius_m: float, rings: int = 32, prim: int = 0) -> Geometry:
    """A sphere with smooth normals."""
    polar, azimuth = np.meshgrid(np.linspace(0, np.pi, rings), np.linspace(0, 2 * np.pi, 2 * rings), indexing="ij")
    normals = np.stack([np.sin(polar) * np.cos(azimuth), np.cos(polar), np.sin(polar) * np.sin(azimuth)], -1).reshape(
        -1, 3
    )
    row = 2 * rings
    a = (np.arange(rings - 1)[:, None] * row + np.arange(row - 1)).ravel()
    faces = np.concatenate([np.stack([a, a + 1, a + row], 1), np.stack([a + 1, a + row + 1, a + row], 1)])
    return triangles_of(normals * radius_m + np.asarray(centre), normals, faces, prim=prim)


def rectangle(
    centre: tuple[float, float, float], right: tuple[float, float, float], up: tuple[float, float, float], prim: int = 0
) -> Geometry:
    """A rectangle that spans ``centre ± right ± up`` and faces ``right x up``."""
    c, r, u = (np.asarray(v, np.float64) for v in (centre, right, up))
    normal = np.cross(r, u) / np.linalg.norm(np.cross(r, u))
    corners = np.stack([c - r - u, c + r - u, c + r + u, c - r + u])
    return triangles_of(corners, np.tile(normal, (4, 1)), np.array([[0, 1, 2], [0, 2, 3]]), prim=prim)


def checkerboard(columns: int, rows: int, cell_m: float, y_m: float, near_m: float, prim: int = 0) -> Geometry:
    """A level floor of coloured cells that begins ``near_m`` in front of the camera (behind it where negative)."""
    i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    x, z = (i.ravel() - columns / 2) * cell_m, -near_m - j.ravel() * cell_m
    corners = np.stack([x, np.full_like(x, y_m), z], -1)[:, None, :] + cell_m * np.array(
        [[0, 0, 0], [1, 0, 0], [1, 0, -1], [0, 0, -1]], np.float64
    )
    light = ((i + j) % 2).ravel().astype(bool)
    colors = np.where(light[:, None], [0.8, 0.75, 0.6, 1], [0.1, 0.12, 0.2, 1]).repeat(4, axis=0)
    first = 4 * np.arange(len(x))[:, None, None]
    faces = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return triangles_of(corners.reshape(-1, 3), np.tile([0.0, 1, 0], (4 * len(x), 1)), faces, colors, prim)


def spheres_over_checkerboard(seed: int = 0) -> tuple[Scene, Camera]:
    """Two dozen spheres from 1.2 to 14 m over a floor, forty small lights behind, a hard sun: textbook depth of field."""
    rng = np.random.default_rng(seed)
    batches = [
        Batch(checkerboard(20, 36, 0.6, -1.0, -2.0), Material(uses_display_color=True, base_color=(1, 1, 1)), _HERE)
    ]
    for prim in range(1, 25):
        centre = (rng.uniform(-3, 3), rng.uniform(-0.8, 1.5), -rng.uniform(1.2, 14))
        ball = sphere(centre, rng.uniform(0.15, 0.5), prim=prim)
        red, green, blue = rng.uniform(0.1, 0.9, 3)
        batches.append(Batch(ball, Material(base_color=(red, green, blue), roughness=0.6), _HERE))
    bulb = Material(name="bulb", base_color=(0, 0, 0), emissive=(8, 6, 3))
    poses = np.tile(np.eye(4), (40, 1, 1))
    poses[:, :3, 3] = np.stack([rng.uniform(-6, 6, 40), rng.uniform(0, 4, 40), -rng.uniform(15, 19, 40)], -1)
    batches.append(Batch(sphere((0, 0, 0), 0.04, 8, prim=25), bulb, poses))
    tilt = np.eye(4)
    tilt[1:3, 1:3] = np.array([[1, 1], [-1, 1]]) / np.sqrt(2)
    sun = Light("distant", (2.0, 2.0, 2.0), tilt, angle_rad=0.01)
    paths = tuple(f"/World/prim{i}" for i in range(26))
    return Scene(tuple(batches), (sun,), Dome((0.15, 0.2, 0.3), np.eye(4)), paths), bench_camera(4.0)


def posts_before_wall(seed: int = 0) -> tuple[Scene, Camera]:
    """Ninety thin posts at all depths in front of a coloured wall: many layers in a pixel, edges everywhere."""
    rng = np.random.default_rng(seed)
    batches = []
    for _ in range(90):
        z, x = rng.uniform(1.5, 9), rng.uniform(-0.6, 0.6)
        half = rng.uniform(0.004, 0.02) * z
        red, green, blue = rng.uniform(0.05, 0.95, 3)
        post = rectangle((x * z, 0, -z), (half, 0, 0), (0, 0.45 * z * rng.uniform(0.3, 1), 0))
        batches.append(Batch(post, Material(base_color=(red, green, blue), roughness=1.0), _HERE, double_sided=True))
    wall = checkerboard(48, 30, 0.3, 0, 0)
    upright = np.eye(4)
    upright[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    upright[:3, 3] = [0, -4.5, -10]
    batches.append(
        Batch(wall, Material(uses_display_color=True, base_color=(1, 1, 1)), upright[None], double_sided=True)
    )
    return Scene(tuple(batches), (), Dome((0.9, 0.9, 0.9), np.eye(4), visible=False), ("/World/posts",)), bench_camera(
        3.0
    )


def point_light(depth_m: float, radius_m: float) -> Scene:
    """A small bright square of half side ``radius_m`` on the view axis and nothing else."""
    glow = Material(name="glow", base_color=(0, 0, 0), emissive=(1000.0, 1000.0, 1000.0))
    batch = Batch(rectangle((0, 0, -depth_m), (radius_m, 0, 0), (0, radius_m, 0)), glow, _HERE, double_sided=True)
    return Scene((batch,), (), Dome((0, 0, 0), np.eye(4), visible=False), ("/light",))


def bench_camera(focus_distance_m: float) -> Camera:
    """Camera of the generated scenes: at the origin, 35 mm at f/1.4, 24 by 18 mm of film."""
    return Camera(
        np.eye(4),
        focal_length_mm=35,
        horizontal_aperture_mm=24,
        vertical_aperture_mm=18,
        f_stop=1.4,
        focus_distance_m=focus_distance_m,
        near_m=0.1,
        path="/camera",
    )
