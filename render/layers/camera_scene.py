"""Scenes as a camera sees them: without other cameras' back plates, and with a headlight where one is asked for.

The headlight is a light at the camera, as in usdrecord, with a faint dome, which shows metals.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Dome, Light, Scene


class CameraScenes:
    """Makes scenes as cameras see them. The last result is kept, so that an unchanged scene stays the same object."""

    def __init__(self) -> None:
        self._seen: tuple[Scene, str, Scene] | None = None
        self._lit: tuple[Scene, DoubleArray, Scene] | None = None

    def scene(self, scene: Scene, camera: Camera) -> Scene:
        """Return the scene as a camera sees it. A headlight's dome gives way to that of the stage where both light."""
        if self._seen is None or self._seen[0] is not scene or self._seen[1] != camera.path:
            self._seen = (scene, camera.path, scene.seen_by(camera.path))
        return self._add_headlight(self._seen[2], camera.world_from_camera)

    def _add_headlight(self, scene: Scene, pose: DoubleArray) -> Scene:
        is_lit = bool(scene.lights) or scene.dome is not None
        if scene.lit_by == "stage" or (scene.lit_by == "auto" and is_lit):
            return scene
        if self._lit is None or self._lit[0] is not scene or not np.array_equal(self._lit[1], pose):
            light = Light("distant", (0.8 * np.pi,) * 3, pose, casts_shadow=False, path="camera light")
            dome = Dome((0.2, 0.2, 0.2), np.eye(4), visible=False, path="camera light")
            lights, dome = ((light, *scene.lights), scene.dome or dome) if scene.lit_by == "both" else ((light,), dome)
            self._lit = (scene, pose, replace(scene, lights=lights, dome=dome))
        return self._lit[2]
