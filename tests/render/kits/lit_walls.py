"""A white wall under lights, and what its middle sends back."""

from __future__ import annotations

import numpy as np

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Light, Material, Scene

# no reflection at normal incidence and fully rough: what is left is Lambert
MATT = Material(name="matt", base_color=(0.5, 0.5, 0.5), roughness=1.0, specular=(0.0, 0.0, 0.0))
WALL = Batch(rectangle((0, 0, -4), (40, 0, 0), (0, 40, 0)), MATT, np.eye(4)[None])
BLACK = Dome((0, 0, 0), np.eye(4), visible=False)
CAMERA = Camera(np.eye(4), 36, 36, 36)


def centre_radiance(renderer: FrameRenderer, scene: Scene, shading: str = "lit") -> DoubleArray:
    frame = renderer.render(
        scene, CAMERA, FrameSettings(9, 9, rays=1, supersample=1, engine="pinhole", shading=shading)
    )
    return frame.color[4, 4, :3].astype(np.float64)


def facing_the_wall(distance_m: float) -> DoubleArray:
    """A light's pose on the axis, shining along -Z at the wall four metres away, ``distance_m`` in front of it."""
    pose = np.eye(4)
    pose[2, 3] = -4 + distance_m
    return pose


def lit(*lights: Light, batches: tuple[Batch, ...] = (WALL,), dome: Dome | None = BLACK) -> Scene:
    return Scene(batches, lights, dome, ("/wall", "/other"))
