"""Small bright squares, and what is behind and in front of them."""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray
from render.model.scene import Batch, Dome, Geometry, Material, Scene

WALL = Material(name="wall", base_color=(0, 0, 0), emissive=(0.2, 0.25, 0.3))
BULB = Material(name="bulb", base_color=(0, 0, 0), emissive=(12.0, 10.0, 8.0))
DARK = Material(name="dark", base_color=(0, 0, 0), emissive=(0.05, 0.05, 0.05))
PANE = Material(name="pane", base_color=(0, 0, 0), emissive=(0.02, 0.02, 0.02), opacity=0.4)


def plane(geometry: Geometry, material: Material, pose: DoubleArray | None = None) -> Batch:
    """Make a batch that is seen from both sides; ``pose``: ``(4, 4)`` to the world."""
    return Batch(geometry, material, (np.eye(4) if pose is None else pose)[None], double_sided=True)


def in_the_dark(*batches: Batch) -> Scene:
    """Make a scene without other light."""
    return Scene(batches, (), Dome((0, 0, 0), np.eye(4)), ("/p",))
