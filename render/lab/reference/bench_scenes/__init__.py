"""The scenes of `pullfocus bench lens`: three after those of the paper's table 1, generated from seeds, lit and textured.

In all three the nearest and the farthest surfaces blur by more than 30 px (radius) in a picture of 800x600.
"""

from __future__ import annotations

from collections.abc import Callable

from render.lab.reference.bench_scenes.dragons import dragons
from render.lab.reference.bench_scenes.statues import statues
from render.lab.reference.bench_scenes.town import town
from render.model.camera import Camera
from render.model.scene import Scene

SCENES: dict[str, Callable[[], tuple[Scene, Camera]]] = {"town": town, "statues": statues, "dragons": dragons}
"""By name, from the fewest triangles to the most."""
