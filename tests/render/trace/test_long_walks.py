"""Rays that walk far through the layers are traced in more passes: Mesa's rasteriser ends long loops in silence."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle, sphere
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Material, Scene
from render.trace import tracer

GREY = Material(base_color=(0.5, 0.5, 0.5), roughness=1.0)
FLOOR = Batch(rectangle((0, -1, -5), (20, 0, 0), (0, 0, -15)), GREY, np.eye(4)[None], double_sided=True)
BALL = Batch(sphere((0.0, 0.0, -5.0), 0.8, prim=1), GREY, np.eye(4)[None])
SCENE = Scene((FLOOR, BALL), (), Dome((0.5, 0.5, 0.5), np.eye(4)), ("/floor", "/ball"))
LOOPS = 65_535
"""Rounds after which Mesa ends a loop (``LP_MAX_TGSI_LOOP_ITERATIONS``)."""


@pytest.mark.parametrize(("fx", "reach_m", "nearest_w"), [(1422, 1.8, 0.3), (1e5, 10.0, 10.0), (20, 0.01, 0.0)])
def test_the_rays_of_a_pass_stay_within_the_loops(fx: float, reach_m: float, nearest_w: float) -> None:
    layers, buffers = SimpleNamespace(view=SimpleNamespace(fx=fx, fy=fx)), SimpleNamespace(nearest_w=nearest_w)
    rays = tracer._rays_within_loops(reach_m, layers, buffers, has_splats=True, moves=False)  # type: ignore[arg-type]
    segments = min(fx * reach_m * nearest_w, 8 * 160)
    assert rays >= 1
    assert rays * segments * 4 < LOOPS
    assert rays >= 7


def test_more_passes_give_the_same_picture(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    camera = Camera(np.eye(4), 50.0, 36.0, 27.0, f_stop=1.4, focus_distance_m=5.0, near_m=0.1, far_m=100.0)
    settings = FrameSettings(48, 36, rays=64, adaptive=False, connections=False, shading="unlit")
    want = renderer.render(SCENE, camera, settings).color
    monkeypatch.setattr(tracer, "_MOST_LOOPS", 500)
    np.testing.assert_allclose(renderer.render(SCENE, camera, settings).color, want, atol=1e-5)
