"""Pictures that are traced in tiles."""

from __future__ import annotations

from render.frame import Frame, FrameRenderer, FrameSettings
from render.model.camera import Camera
from render.model.scene import Scene
from render.trace.tiling.plan import LayerBudget


def render_in_tiles(
    renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings
) -> tuple[Frame, Frame]:
    """Render a frame in tiles, and in one piece."""
    tracer, frames = renderer.device.tracer, []
    for budget in (LayerBudget(bytes=1_600_000, strip_bytes=1 << 40), LayerBudget(1 << 30, 1 << 40)):
        before, tracer.budget = tracer.budget, budget
        try:
            renderer.forget_layers()
            frames.append(renderer.render(scene, camera, settings))
        finally:
            tracer.budget = before
    return frames[0], frames[1]
