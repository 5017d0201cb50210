"""The lens engine against the accumulation buffer with the same lens samples: at least 40 dB and 0.99.

What is left between them is at edges: the layers hold one sample in each of their pixels, two to a picture pixel along each
axis, while the reference samples every view anew. It shrinks with the layers' resolution, as a test below shows.

The demo shot is held to the bound unlit, which isolates the optics (DESIGN, section 5). Lit, its bulbs are twenty times white
and its street glints: a glint smaller than a pixel is shaded four times a pixel in the layers and once a ray in the reference,
and one ray that meets a bulb or misses it turns a pixel of the clipped picture from black to white. Measured there at 800x450
with 100 rays: 42.3 dB and 0.993 unlit, 31.1 dB and 0.971 lit, the energy within 0.3 %.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db, ssim
from render.lab.reference.scenes import posts_before_wall, spheres_over_checkerboard
from render.model.camera import Camera
from render.model.scene import Scene
from render.shot import Shot

SETTINGS = FrameSettings(400, 300, rays=32, tiled=False)


def compare(
    renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings, light: float = 5e-3
) -> tuple[float, float]:
    """PSNR in dB and SSIM; ``light``: largest relative difference of the means."""
    traced = renderer.render(scene, camera, settings).color
    reference = renderer.render(scene, camera, replace(settings, engine="accumulation")).color
    assert np.isfinite(traced).all()
    assert np.isfinite(reference).all()
    np.testing.assert_allclose(traced.mean((0, 1)), reference.mean((0, 1)), rtol=light)
    return psnr_db(traced, reference), ssim(traced, reference)


@pytest.mark.parametrize("make", [spheres_over_checkerboard, posts_before_wall])
def test_generated_scenes(renderer: FrameRenderer, make: Callable[[], tuple[Scene, Camera]]) -> None:
    psnr, similarity = compare(renderer, *make(), SETTINGS)
    assert psnr >= 40
    assert similarity >= 0.99


@pytest.fixture(scope="module")
def demo(demo_file: Path) -> tuple[Scene, Camera]:
    shot = Shot.open(demo_file)
    return shot.scene_at(48.0), shot.camera_at(None, 48.0, 800, 450)


def test_the_demo_shots_optics(renderer: FrameRenderer, demo: tuple[Scene, Camera]) -> None:
    psnr, similarity = compare(renderer, *demo, FrameSettings(800, 450, rays=48, tiled=False, shading="unlit"))
    assert psnr >= 40
    assert similarity >= 0.99


def test_the_demo_shot_lit(renderer: FrameRenderer, demo: tuple[Scene, Camera]) -> None:
    """Views at the picture's resolution widen the highlights of thin rims, and lose 0.7 % of the light of views twice as fine."""
    psnr, similarity = compare(renderer, *demo, FrameSettings(640, 360, rays=48, tiled=False), light=0.02)
    assert psnr >= 27.5
    assert similarity >= 0.95


def test_finer_layers_come_closer(renderer: FrameRenderer) -> None:
    scene, camera = spheres_over_checkerboard()
    small = replace(SETTINGS, width=160, height=120, rays=32)
    reference = renderer.render(scene, camera, replace(small, engine="accumulation")).color
    errors = [
        psnr_db(renderer.render(scene, camera, replace(small, supersample=s)).color, reference) for s in (1, 2, 4)
    ]
    assert errors[1] > errors[0] + 3
    assert errors[2] > errors[1] + 2


def test_tiled_patterns_converge_to_the_same_picture(renderer: FrameRenderer) -> None:
    """Patterns that differ from pixel to pixel make noise, not another picture: with many rays both are the same."""
    scene, camera = spheres_over_checkerboard()
    many = FrameSettings(160, 120, rays=1024)
    tiled = renderer.render(scene, camera, many).color
    shared = renderer.render(scene, camera, replace(many, tiled=False)).color
    assert psnr_db(tiled, shared) > 45


def test_the_same_frame_twice_is_the_same_to_the_bit(renderer: FrameRenderer) -> None:
    scene, camera = posts_before_wall()
    settings = FrameSettings(160, 120, rays=32)
    first = renderer.render(scene, camera, settings).color
    renderer.render(scene, replace(camera, f_stop=4.0), settings)
    assert np.array_equal(first, renderer.render(scene, camera, settings).color)
