"""Headlight: a light at the camera for scenes without lights, as in usdrecord."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Dome, Light, Scene


class Headlight:
    """Adds a headlight to scenes without lights. The last result is kept, so that an unchanged scene stays the same object."""

    def __init__(self) -> None:
        self._lit: tuple[Scene, DoubleArray, Scene] | None = None

    def add_light(self, scene: Scene, camera: Camera) -> Scene:
        """Return the scene, with a light at the camera where it has none and wants one; a faint dome shows metals."""
        if scene.lights or scene.dome is not None or not scene.camera_light:
            return scene
        pose = camera.world_from_camera
        if self._lit is None or self._lit[0] is not scene or not np.array_equal(self._lit[1], pose):
            light = Light("distant", (0.8 * np.pi,) * 3, pose, casts_shadow=False, path="camera light")
            dome = Dome((0.2, 0.2, 0.2), np.eye(4), visible=False, path="camera light")
            self._lit = (scene, pose, replace(scene, lights=(light,), dome=dome))
        return self._lit[2]
