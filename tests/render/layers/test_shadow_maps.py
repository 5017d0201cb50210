"""Shadows of what moves are drawn over those of what stands still: the same maps as if all were drawn anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.cancellation import Cancelled
from render.lab.reference.scenes import spheres_over_checkerboard
from render.layers.index import Draw
from render.layers.renderer import LayerRenderer
from render.layers.shadows import shadow_region
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.scene import Light, Scene

SETTINGS = FrameSettings(64, 48, rays=4, supersample=1)


def lit() -> tuple[Scene, Camera]:
    scene, camera = spheres_over_checkerboard()
    pose = np.eye(4)
    pose[:3, :3] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]  # shines down
    return replace(scene, lights=(Light("distant", (3.0, 3.0, 3.0), pose, angle_rad=0.01, path="/sun"),)), camera


def moved(scene: Scene, index: int, by: float) -> Scene:
    batch = scene.batches[index]
    poses = batch.poses.copy()
    poses[:, 0, 3] += by
    return replace(scene, batches=(*scene.batches[:index], replace(batch, poses=poses), *scene.batches[index + 1 :]))


def fresh(scene: Scene, camera: Camera) -> FloatArray:
    with FrameRenderer() as other:
        return other.render(scene, camera, SETTINGS).color


def test_what_moves_casts_the_shadow_that_it_would_in_a_new_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, camera = lit()
    drawn: list[int] = []
    plain = LayerRenderer.draw_shadow

    def counted(self: LayerRenderer, side_px: int, view: DoubleArray, draws: Sequence[Draw]) -> None:
        drawn.append(len(draws))
        plain(self, side_px, view, draws)

    monkeypatch.setattr(LayerRenderer, "draw_shadow", counted)
    with FrameRenderer() as renderer:
        renderer.render(scene, camera, SETTINGS)
        whole = drawn[0]
        for step in range(1, 4):
            drawn.clear()
            now = moved(scene, 2, 0.02 * step)
            np.testing.assert_array_equal(renderer.render(now, camera, SETTINGS).color, fresh(now, camera))
            here = drawn[:-1]  # the last one is that of the new scene
            assert here == ([whole - 1, 1] if step == 1 else [1]), "what stands still is drawn once"
        for other in (moved(moved(scene, 2, 0.3), 1, 0.2), scene):
            np.testing.assert_array_equal(renderer.render(other, camera, SETTINGS).color, fresh(other, camera))


def wide() -> tuple[Scene, Camera]:
    """A scene that is larger than what shadows are resolved in, with two suns, whose maps therefore follow the focus."""
    scene, camera = lit()
    sun = scene.lights[0]
    turned = sun.pose.copy()
    turned[:3, :3] = turned[:3, :3] @ np.array([[1, 0, 0], [0, 0.9, -0.436], [0, 0.436, 0.9]])
    far = moved(scene, 2, 0.0).batches[0]
    poses = far.poses.copy()
    poses[:, 2, 3] -= 400.0
    scene = replace(
        scene,
        lights=(sun, replace(sun, pose=turned, path="/other")),
        batches=(*scene.batches, replace(far, poses=poses)),
    )
    return scene, camera


def test_a_pick_casts_no_shadow_of_the_scene_that_is_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, camera = wide()
    later = replace(camera, focus_distance_m=2 * camera.focus_distance_m + 20.0)
    with FrameRenderer() as renderer:
        before = renderer.render(scene, camera, SETTINGS).color
        with monkeypatch.context() as patched:
            patched.setattr(LayerRenderer, "draw_shadow", lambda *_: pytest.fail("a pick sees no shadow"))
            patched.setattr(renderer.device.peeler._lighting._maps, "_draw", lambda *_: pytest.fail("nor does it here"))
            assert renderer.pick(scene, later, 64, 48, 32, 40) is not None
        np.testing.assert_array_equal(renderer.render(scene, camera, SETTINGS).color, before)


def test_shadows_that_were_left_half_way_are_cast_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two suns, whose maps follow the focus; work is left between the first map and the second."""
    scene, camera = wide()
    later = replace(camera, focus_distance_m=2 * camera.focus_distance_m + 20.0)
    with FrameRenderer() as renderer:
        renderer.render(scene, camera, SETTINGS)
        before = renderer.render(scene, camera, SETTINGS).color
        plain, calls = LayerRenderer.draw_shadow, 0

        def left(self: LayerRenderer, side_px: int, view: DoubleArray, draws: Sequence[Draw]) -> None:
            nonlocal calls
            calls += 1
            if calls == 2:
                raise Cancelled
            plain(self, side_px, view, draws)

        peeler = renderer.device.peeler
        with monkeypatch.context() as patched:
            patched.setattr(peeler._lighting._maps, "_draw", partial(left, peeler._renderer))
            with pytest.raises(Cancelled):
                renderer.render(scene, later, SETTINGS)
            assert calls == 2
        renderer.forget_layers()
        np.testing.assert_array_equal(renderer.render(scene, camera, SETTINGS).color, before)
        np.testing.assert_array_equal(renderer.render(scene, later, SETTINGS).color, fresh(scene, later))


def test_shadows_stand_still_while_the_focus_is_pulled() -> None:
    """Except for a step from one power of two to the next; what is in focus is always within."""
    focused = [replace(wide()[1], focus_distance_m=metres) for metres in np.geomspace(6.0, 40.0, 200)]
    regions = [shadow_region(camera) for camera in focused]
    assert len(set(regions)) == 3
    for camera, region in zip(focused, regions, strict=True):
        place = camera.world_from_camera[:3, 3] - camera.focus_distance_m * camera.world_from_camera[:3, 2]
        assert np.linalg.norm(place - region.centre) < region.radius_m / 5
