"""Textures of what is blurred: filtered over what one ray stands for, sharp where the lens is sharp, and cut-outs as they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.layers.peel import PICTURE
from render.layers.surface_sampling import PATCH_STEP_PX, SurfaceSampling, layer_sampling, patch_px_m
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Batch, Image, Material, Scene, TextureLookup
from render.optics.view import PinholeView

SETTINGS = FrameSettings(160, 120, rays=64, shading="unlit")
CAMERA = Camera(np.eye(4), 36, 36, 27, f_stop=0.1, focus_distance_m=2.0)


def squares() -> Image:
    """Black and white squares, 128 by 128 of them, two texels each."""
    tone = np.kron(np.indices((128, 128)).sum(axis=0) % 2, np.ones((2, 2)))
    return Image(np.stack([tone, tone, tone, tone], axis=2).astype(np.float16), "squares")


def wall(depth_m: float, **inputs: object) -> Scene:
    """A wall with that texture, 256 pixels wide at any distance, and its squares two."""
    half = 0.8 * depth_m
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    plain = replace(rectangle((0, 0, -depth_m), (half, 0, 0), (0, half, 0)), uvs=corners)
    return Scene((Batch(plain, Material(**inputs), np.eye(4)[None]),))  # type: ignore[arg-type]


def middle(renderer: FrameRenderer, scene: Scene, rays: int) -> FloatArray:
    """Render the part of the picture that lies inside the wall."""
    return renderer.render(scene, CAMERA, replace(SETTINGS, rays=rays)).color[30:90, 40:120]


def test_few_rays_of_a_blurred_texture_are_near_the_converged_picture(renderer: FrameRenderer) -> None:
    """Points of a wall of black and white squares are black or white: the mean of 16 would be off by an eighth."""
    blurred = wall(12.0, lookups={"base_color": TextureLookup(squares(), wrap_s="repeat", wrap_t="repeat")})
    few = middle(renderer, blurred, 16)[..., 0]
    assert few.std() < 0.05
    assert few.mean() == pytest.approx(0.5, abs=0.01)


def test_a_texture_in_focus_is_sharp(renderer: FrameRenderer) -> None:
    sharp = wall(2.0, lookups={"base_color": TextureLookup(squares(), wrap_s="repeat", wrap_t="repeat")})
    assert middle(renderer, sharp, 64)[..., 0].std() > 0.25


def test_cut_outs_keep_their_edges(renderer: FrameRenderer) -> None:
    """Half of the wall is there: a filtered opacity would be a half everywhere, and all or none of it above the threshold."""
    lookup = TextureLookup(squares(), wrap_s="repeat", wrap_t="repeat", channel=3)
    holes = wall(12.0, lookups={"opacity": lookup}, opacity_threshold=0.5)
    assert middle(renderer, holes, 256)[..., 3].mean() == pytest.approx(0.5, abs=0.05)


def test_a_rays_footprint_is_at_most_a_pixel_and_shrinks_with_rays() -> None:
    assert patch_px_m(1000, 0.02, 1) == 0
    assert patch_px_m(1000, 0.02, 400) == pytest.approx(patch_px_m(1000, 0.02, 100) / 2)


def test_layers_see_the_plane_of_focus_where_the_picture_sees_it() -> None:
    """A tilted plane of focus, in the pixels of layers with a margin and finer than the picture."""
    picture = PinholeView.from_camera(CAMERA, 160, 120)
    layers = replace(picture, width=420, height=320, fx=2.5 * picture.fx, fy=2.5 * picture.fy, cx=213.0, cy=157.0)
    found = layer_sampling(layers, picture, (0.4, 2e-3, -1e-3), 0.02, 100)
    assert isinstance(found, SurfaceSampling)
    for x, y in ((3.0, 100.0), (150.0, 11.0)):
        at = (layers.cx + 2.5 * (x - picture.cx), layers.cy + 2.5 * (y - picture.cy))
        w = found.focus[0] + found.focus[1] * at[0] + found.focus[2] * at[1]
        assert found.patch_px_m * w == pytest.approx(
            found.patch_px_m * (0.4 + 2e-3 * x - 1e-3 * y), abs=0.75 * PATCH_STEP_PX
        )


def test_layers_are_kept_while_the_focus_is_pulled(renderer: FrameRenderer) -> None:
    """Within a step of the plane of focus; the picture is the one that is drawn from new layers."""
    scene, settings, camera = wall(3.0), FrameSettings(160, 120, rays=100), replace(CAMERA, f_stop=2.0)
    kept, drawn = [], []
    for focus_m in (1.2, 1.22, 1.25, 8.0):
        kept.append(renderer.render(scene, replace(camera, focus_distance_m=focus_m), settings).color)
        drawn.append(renderer.device.peeler._kept[PICTURE][1])
    assert drawn[0] is drawn[1] is drawn[2] is not drawn[3]
    assert not np.array_equal(kept[0], kept[2])
    renderer.forget_layers()
    anew = renderer.render(scene, replace(camera, focus_distance_m=1.25), settings).color
    np.testing.assert_array_equal(kept[2], anew)
