"""The bench's scenes are what a bench needs: so many triangles, lit and textured, in few draws, blurred widely both ways."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.bench_scenes import SCENES
from render.model.camera import Camera
from render.model.scene import Scene
from render.optics.thin_lens import coc_radius_px, focus_w, pupil_radius_m
from render.optics.view import PinholeView

LEAST_BLUR_PX, MOST_BLUR_PX = 30.0, 40.0
TRIANGLES = {"town": 100_000, "statues": 400_000, "dragons": 1_000_000}


@pytest.fixture(scope="module")
def renderer() -> Iterator[FrameRenderer]:
    with FrameRenderer() as made:
        yield made


@pytest.fixture(scope="module", params=SCENES)
def built(request: pytest.FixtureRequest) -> tuple[str, Scene, Camera]:
    return request.param, *SCENES[request.param]()


def test_scene_is_large_lit_textured_and_of_few_draws(built: tuple[str, Scene, Camera]) -> None:
    name, scene, _ = built
    assert scene.triangle_count == pytest.approx(TRIANGLES[name], rel=0.1)
    assert len(scene.batches) < 40
    assert any(light.kind == "distant" and light.casts_shadow for light in scene.lights)
    assert any(light.kind == "sphere" for light in scene.lights)
    assert scene.dome is not None
    textured = [b for b in scene.batches if "base_color" in b.material.lookups]
    triangles = sum(len(b.geometry.triangles) * len(b.poses) for b in textured)
    assert triangles > scene.triangle_count / 3


@pytest.mark.gl
def test_nearest_and_farthest_surfaces_blur_widely(built: tuple[str, Scene, Camera], renderer: FrameRenderer) -> None:
    _, scene, camera = built
    settings = FrameSettings(400, 300, engine="pinhole", rays=1, supersample=1, aovs=("depth",))
    frame = renderer.render(scene, camera, settings)
    depth = frame.aovs["depth"]
    view = PinholeView.from_camera(camera, 800, 600)
    blur_px = coc_radius_px(view.fx, pupil_radius_m(camera), 1 / depth[np.isfinite(depth)], focus_w(camera))
    # a hundredth of the picture at the least, at either end, and not so wide that nothing can be made out
    near, far = np.percentile(blur_px, [1, 99])
    assert -MOST_BLUR_PX < blur_px.min() < near < -LEAST_BLUR_PX
    assert LEAST_BLUR_PX < far < blur_px.max() < MOST_BLUR_PX
    assert np.mean(np.abs(blur_px) < 2) > 0.05  # something is sharp
    assert frame.color[..., :3].max() < 5  # lanterns shine, and none outweighs the picture


def test_scene_is_the_same_each_time() -> None:
    (first, camera), (second, camera_again) = SCENES["statues"](), SCENES["statues"]()
    np.testing.assert_array_equal(camera.world_from_camera, camera_again.world_from_camera)
    for one, other in zip(first.batches, second.batches, strict=True):
        np.testing.assert_array_equal(one.geometry.positions, other.geometry.positions)
        np.testing.assert_array_equal(one.geometry.triangles, other.geometry.triangles)
        np.testing.assert_array_equal(one.poses, other.poses)
        for name, lookup in one.material.lookups.items():
            np.testing.assert_array_equal(lookup.image.pixels, other.material.lookups[name].image.pixels)
