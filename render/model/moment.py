"""The shot at moments while the shutter is open."""

from __future__ import annotations

from dataclasses import dataclass

from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Scene


@dataclass(frozen=True, eq=False)
class ShutterScenes:
    """The scene at three times of an open shutter.

    Attributes:
        middle: half-way.
        opening: as the shutter opens.
        closing: as the shutter closes.
    """

    middle: Scene
    opening: Scene
    closing: Scene


@dataclass(frozen=True, eq=False)
class Moment:
    """The shot at one moment of the shutter's opening.

    Attributes:
        scene: the scene.
        camera: the camera, its focus solved.
        share: share of each pixel's exposure; a number, or ``(height, 1, 1)`` or ``(1, width, 1)`` where the shutter travels.
    """

    scene: Scene
    camera: Camera
    share: FloatArray | float
