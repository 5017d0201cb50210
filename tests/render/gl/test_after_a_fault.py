"""A frame that fails leaves a renderer that draws the next one right: the service keeps one for all its shots."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from render.errors import GraphicsError, SettingsError
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import spheres_over_checkerboard
from render.layers.renderer import LayerRenderer
from render.model.limits import MAX_PICTURE_SIDE_PX
from render.model.scene import Dome, Image, Scene

SMALL = FrameSettings(64, 48, rays=4, supersample=1)


@pytest.fixture
def renderer() -> Iterator[FrameRenderer]:
    with FrameRenderer() as own:
        yield own


def test_a_fault_while_drawing_costs_that_frame_alone(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    scene, camera = spheres_over_checkerboard()
    before = renderer.render(scene, camera, SMALL).color
    with monkeypatch.context() as patched:
        patched.setattr(
            LayerRenderer, "_draw_range", lambda *_, **__: (_ for _ in ()).throw(RuntimeError("driver says no"))
        )
        with pytest.raises(GraphicsError, match="driver says no"):
            renderer.render(scene, camera, replace(SMALL, supersample=2))  # whose layers are not there yet
    np.testing.assert_array_equal(renderer.render(scene, camera, SMALL).color, before)


def test_a_scene_that_cannot_be_loaded_is_not_half_loaded(renderer: FrameRenderer) -> None:
    scene, camera = spheres_over_checkerboard()
    before = renderer.render(scene, camera, SMALL).color
    broken = replace(scene.batches[2], poses=np.zeros((1, 3)))
    with pytest.raises(Exception, match=r".+"):
        renderer.render(replace(scene, batches=(*scene.batches[:2], broken)), camera, SMALL)
    with pytest.raises(Exception, match=r".+"):
        renderer.render(replace(scene, batches=(*scene.batches[:2], broken)), camera, SMALL)
    np.testing.assert_array_equal(renderer.render(scene, camera, SMALL).color, before)


def test_a_picture_too_large_to_hold_is_refused_by_its_size(renderer: FrameRenderer) -> None:
    scene, camera = spheres_over_checkerboard()
    before = renderer.render(scene, camera, SMALL).color
    large = [FrameSettings(9100, 9100, engine="accumulation", rays=1)]
    if (
        int(renderer.graphics.ctx.info["GL_MAX_TEXTURE_SIZE"]) <= MAX_PICTURE_SIDE_PX
    ):  # too little for supersampled layers
        large.append(FrameSettings(16000, 40, engine="flag"))
    for settings in large:
        with pytest.raises(SettingsError, match="smaller picture or supersample less"):
            renderer.render(scene, camera, settings)
    np.testing.assert_array_equal(renderer.render(scene, camera, SMALL).color, before)


@pytest.mark.parametrize("shape", [(1, 1), (1, 128), (2, 4), (3, 5), (64, 128), (97, 200)])
def test_a_dome_of_any_size_is_a_furnace(renderer: FrameRenderer, shape: tuple[int, int]) -> None:
    """All white: a white Lambert wall under it is as white, whatever the image's size."""
    scene, camera = spheres_over_checkerboard()
    dome = Dome((1.0, 1.0, 1.0), np.eye(4), Image(np.ones((*shape, 4), np.float16)))
    white = replace(
        scene.batches[1], material=replace(scene.batches[1].material, base_color=(1, 1, 1), specular=(0, 0, 0))
    )
    frame = renderer.render(Scene((white,), (), dome, scene.prim_paths), camera, SMALL)
    np.testing.assert_allclose(frame.color[..., :3], 1.0, rtol=0.05)  # 4 % of fitted sheen, less at normal incidence
