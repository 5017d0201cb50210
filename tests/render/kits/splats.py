"""Clouds of Gaussian splats, made by hand or at random."""

from __future__ import annotations

import numpy as np

from render.model.camera import Camera
from render.model.scene import Dome, Scene
from render.model.splats import SplatBatch, SplatCloud

GREY = 0.28209479177387814
"""The spherical harmonic of degree 0."""
CAMERA = Camera(np.eye(4), 50, 36, 24, f_stop=0.0, focus_distance_m=2.0, near_m=0.1)
SIZE = (96, 64)
BLACK = Dome((0, 0, 0), np.eye(4))


def plain_cloud(
    positions: object, sizes_m: object, colours: object, opacities: object, *, is_encoded: bool = False
) -> SplatCloud:
    """Make splats whose axes are those of the world, of a colour that is the same from all sides.

    Args:
        positions: ``(n, 3)`` metres.
        sizes_m: ``(n, 3)`` standard deviations.
        colours: ``(n, 3)`` as they are stored.
        opacities: ``(n,)``.
        is_encoded: whether the colours are sRGB's, not linear.
    """
    places = np.array(positions, np.float32)
    axes = np.eye(3, dtype=np.float32) * np.array(sizes_m, np.float32)[:, None]
    harmonics = ((np.array(colours, np.float32) - 0.5) / GREY)[:, None]
    return SplatCloud(places, axes, np.array(opacities, np.float32), harmonics.astype(np.float32), is_encoded)


def scene_of(cloud: SplatCloud, *poses: np.ndarray, batches: tuple[object, ...] = ()) -> Scene:
    """Make a scene of a cloud and some surfaces, without any other light."""
    splats = SplatBatch(cloud, np.stack(poses or (np.eye(4),)))
    return Scene(batches, (), BLACK, ("/surface",), splats=(splats,))  # type: ignore[arg-type]


def captured_set(count: int, seed: int = 1) -> SplatCloud:
    """Make a cloud as a captured set is: flat splats on the surfaces of three balls and a floor, with a pattern, and colours that
    change with the direction of view."""
    random = np.random.default_rng(seed)
    which = random.integers(0, 4, count)
    normal = random.normal(size=(count, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    centres = np.array([[-0.6, 0, -2.0], [0.1, -0.1, -3.0], [0.9, 0.1, -5.0], [0, 0, 0]])
    places = centres[which] + normal * np.array([0.35, 0.5, 0.9, 0])[which][:, None]
    on_floor = which == 3
    floor = [random.uniform(-3, 3, count), np.full(count, -0.7), random.uniform(-9, -1.2, count)]
    places[on_floor] = np.stack(floor, axis=1)[on_floor]
    normal[on_floor] = [0, 1, 0]
    along = np.cross(normal, random.normal(size=(count, 3)))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    size = np.where(on_floor, 1.6, 1.0)[:, None] * random.uniform(0.006, 0.02, (count, 1))
    axes = np.stack([along * size, np.cross(normal, along) * size * 0.6, normal * size * 0.15], axis=2)
    pattern = np.sin(12 * places[:, 0]) * np.sin(12 * places[:, 1] + 0.5) * np.cos(11 * places[:, 2])
    base = np.array([[0.9, 0.3, 0.2], [0.2, 0.7, 0.3], [0.3, 0.4, 0.9], [0.6, 0.6, 0.5]])[which]
    harmonics = np.zeros((count, 4, 3))
    harmonics[:, 0] = (base * (0.7 + 0.3 * pattern[:, None]) - 0.5) / GREY
    harmonics[:, 1:] = random.normal(size=(count, 3, 3)) * 0.03
    opacities = random.uniform(0.4, 0.95, count)
    return SplatCloud(*(part.astype(np.float32) for part in (places, axes, opacities, harmonics)))
