"""Textures that do not fit their budget lose what no look-up reaches: pictures stay the same."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.layers.texture_budget import TEXTURE_BUDGET_BYTES, TextureBudget, uv_densities
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Batch, Geometry, Image, Material, Scene, TextureLookup

SIDE_PX = 2048
WHOLE_BYTES = SIDE_PX**2 * 8 * 4 / 3
SETTINGS = FrameSettings(96, 72, shading="unlit", rays=16)
CAMERA = Camera(np.eye(4), 50, 36, 27, f_stop=4.0, focus_distance_m=0.8, near_m=0.1)
CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)


@pytest.fixture(scope="module")
def pattern() -> Image:
    """Noise of all sizes, from texels to a quarter of the image."""
    rng, pixels = np.random.default_rng(7), np.ones((SIDE_PX, SIDE_PX, 4), np.float32)
    pixels[..., :3] = 0
    for side in (4, 32, 256, SIDE_PX):
        cells = rng.random((side, side, 3), np.float32)
        pixels[..., :3] += np.repeat(np.repeat(cells, SIDE_PX // side, 0), SIDE_PX // side, 1) / 4
    return Image(pixels.astype(np.float16), "pattern")


def card(image: Image, depth_m: float, at_x_m: float = 0.0, size_m: float = 1.0, tilt: float = 0.0) -> Batch:
    """A square with the image, its right side farther by ``tilt`` of its width."""
    shape = rectangle((at_x_m, 0, -depth_m), (size_m / 2, 0, -tilt * size_m / 2), (0, size_m / 2, 0))
    material = Material(lookups={"base_color": TextureLookup(replace_image(image))})
    return Batch(replace(shape, uvs=CORNERS), material, np.eye(4)[None], double_sided=True)


def replace_image(image: Image) -> Image:
    """The same image as another object, which is another texture."""
    return Image(image.pixels, image.name)


def scene_of(*cards: Batch) -> Scene:
    return Scene(cards, (), None, ("/card",))


@pytest.fixture
def budget(renderer: FrameRenderer) -> Iterator[TextureBudget]:
    own = renderer.device.peeler.textures
    yield own
    own.bytes = TEXTURE_BUDGET_BYTES


def held_bytes(renderer: FrameRenderer) -> int:
    """Memory of the textures of the loaded scene."""
    return sum(texture.bytes_from(texture.first_level) for texture in renderer.device.peeler.index.textures)


def draw(renderer: FrameRenderer, scene: Scene, engine: str = "lens", camera: Camera = CAMERA) -> FloatArray:
    renderer.forget_layers()
    return renderer.render(scene, camera, replace(SETTINGS, engine=engine)).color


@pytest.mark.parametrize("engine", ["lens", "accumulation", "gather"])
def test_pictures_within_a_small_budget_are_equal(
    renderer: FrameRenderer, budget: TextureBudget, pattern: Image, engine: str
) -> None:
    """Cards near and far, upright and tilted, one wound the other way, and one beside the view."""
    cards = (
        card(pattern, 0.8, -0.3),
        card(pattern, 4.0, 0.6, tilt=2.0),
        card(pattern, 8.0, -1.0, size_m=-4.0),
        card(pattern, 3.0, 9.0),
    )
    whole = draw(renderer, scene_of(*cards), engine)
    assert held_bytes(renderer) == pytest.approx(4 * WHOLE_BYTES, rel=1e-3)
    budget.bytes = int(1.3 * WHOLE_BYTES)
    reduced = draw(renderer, scene_of(*cards), engine)
    assert held_bytes(renderer) <= budget.bytes
    np.testing.assert_allclose(reduced, whole, atol=1e-3)
    assert whole[..., :3].std() > 0.05


def test_what_comes_near_is_held_finer(renderer: FrameRenderer, budget: TextureBudget, pattern: Image) -> None:
    """The budget is less than one texture: from afar a small part of it is enough, and near the card a larger one."""
    scene = scene_of(card(pattern, 60.0, size_m=2.0))
    budget.bytes = int(WHOLE_BYTES / 2)
    draw(renderer, scene)
    far = held_bytes(renderer)
    pose = np.eye(4)
    pose[2, 3] = -55.0
    draw(renderer, scene, camera=replace(CAMERA, world_from_camera=pose))
    assert far < held_bytes(renderer) <= budget.bytes


def test_the_budget_holds_where_less_than_what_is_seen_fits(
    renderer: FrameRenderer, budget: TextureBudget, pattern: Image
) -> None:
    scene = scene_of(card(pattern, 1.0, size_m=2.0), card(pattern, 0.8, 0.5, size_m=0.5))
    whole = draw(renderer, scene)
    budget.bytes = 20_000
    soft = draw(renderer, scene)
    assert held_bytes(renderer) <= budget.bytes
    assert soft[..., :3].std() < whole[..., :3].std()
    np.testing.assert_allclose(soft.mean(axis=(0, 1)), whole.mean(axis=(0, 1)), rtol=0.05)


def test_a_scene_that_fits_again_is_held_whole(renderer: FrameRenderer, budget: TextureBudget, pattern: Image) -> None:
    one, two = card(pattern, 2.0), card(pattern, 3.0)
    budget.bytes = int(1.5 * WHOLE_BYTES)
    draw(renderer, scene_of(one, two))
    assert held_bytes(renderer) <= budget.bytes
    draw(renderer, scene_of(one))
    assert held_bytes(renderer) == pytest.approx(WHOLE_BYTES, rel=1e-3)


def test_densities_of_texture_coordinates_are_singular_values() -> None:
    """Triangles with random coordinates, against numpy."""
    rng = np.random.default_rng(3)
    positions = rng.normal(size=(12, 3)).astype(np.float32)
    uvs = rng.normal(size=(12, 2)).astype(np.float32)
    flat = np.zeros_like(positions)
    triangles = np.arange(12).reshape(-1, 3).astype(np.int32)
    ids = np.zeros(4, np.int32)
    geometry = Geometry(positions, flat, triangles, ids, ids, ids, uvs)
    largest = []
    for corners in triangles:
        edges = (positions[corners[1:]] - positions[corners[0]]).astype(np.float64)
        steps = (uvs[corners[1:]] - uvs[corners[0]]).astype(np.float64)
        largest.append(np.linalg.svd(steps.T @ np.linalg.pinv(edges.T), compute_uv=False)[0])
    np.testing.assert_allclose(uv_densities(geometry), [min(largest)], rtol=1e-5)
    assert uv_densities(replace(geometry, positions=flat)) == np.inf
    assert uv_densities(replace(geometry, uvs=None)) == 0
