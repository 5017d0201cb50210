"""Light and shadow linking on the device: each surface is lit by its own lights, and shaded by its own shadows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.layers.light_links import LinkSets
from render.layers.lights import MAX_LIGHTS
from render.model.arrays import DoubleArray, FloatArray
from render.model.scene import MAX_LINK_SETS, Batch, Dome, Image, Light, LightLinks, Material
from tests.render.kits.lit_walls import BLACK, CAMERA, MATT, WALL, facing_the_wall, lit

SUN = Light("distant", (2.0, 0.0, 0.0), np.eye(4), path="/sun", casts_shadow=False)
LAMP = Light("sphere", (0.0, 80.0, 0.0), facing_the_wall(2.0), radius_m=0.1, path="/lamp", casts_shadow=False)
GLOW = Dome((0.0, 0.0, 1.0), np.eye(4), visible=False, path="/sky")


def half(side: int, links: LightLinks, material: Material = MATT) -> Batch:
    """The left (-1) or the right (1) half of a wall four metres away."""
    return Batch(rectangle((20 * side, 0, -4), (20, 0, 0), (0, 40, 0)), material, np.eye(4)[None], links=links)


def picture(renderer: FrameRenderer, *batches: Batch, lights: tuple[Light, ...], dome: Dome = BLACK) -> FloatArray:
    settings = FrameSettings(16, 8, rays=1, supersample=1, engine="pinhole")
    camera = replace(CAMERA, vertical_aperture_mm=18)
    return np.asarray(renderer.render(lit(*lights, batches=batches, dome=dome), camera, settings).color[..., :3])


@pytest.mark.parametrize(("left", "right"), [({"/sun"}, set()), ({"/sun"}, {"/lamp", "/sky"}), ({"/sky"}, {"/sun"})])
def test_each_surface_is_as_under_its_own_lights(renderer: FrameRenderer, left: set[str], right: set[str]) -> None:
    lights = {"/sun": SUN, "/lamp": LAMP}
    sides = [half(side, LightLinks(frozenset(out))) for side, out in ((-1, left), (1, right))]
    shown = picture(renderer, *sides, lights=tuple(lights.values()), dome=GLOW)
    for columns, out in ((slice(0, 8), left), (slice(8, 16), right)):
        own = tuple(light for path, light in lights.items() if path not in out)
        plain = [replace(side, links=LightLinks()) for side in sides]
        expected = picture(renderer, *plain, lights=own, dome=BLACK if "/sky" in out else GLOW)
        np.testing.assert_allclose(shown[:, columns], expected[:, columns], rtol=2e-3, atol=1e-6)


def test_a_clear_coat_stays_where_lights_are_linked(renderer: FrameRenderer) -> None:
    """It shares its channel with the links."""
    coated = replace(MATT, clearcoat=0.6, clearcoat_roughness=0.3)
    links = LightLinks(frozenset({"/none"}))
    linked = picture(renderer, half(-1, links, coated), half(1, LightLinks(), coated), lights=(SUN, LAMP))
    plain = picture(renderer, half(-1, LightLinks(), coated), half(1, LightLinks(), coated), lights=(SUN, LAMP))
    np.testing.assert_allclose(linked, plain, rtol=4e-3, atol=1e-5)
    bare = picture(renderer, half(-1, LightLinks()), half(1, LightLinks()), lights=(SUN, LAMP))
    assert np.abs(bare - plain).max() > 0.01 * plain.max()


def test_all_parts_of_a_light_are_left_out(renderer: FrameRenderer) -> None:
    card = Light("rect", (3.0,) * 3, facing_the_wall(2.0), width_m=1, height_m=1, path="/card")
    card = replace(card, image=Image(np.ones((4, 4, 4), np.float16)))
    sides = half(-1, LightLinks(frozenset({"/card"}))), half(1, LightLinks())
    shown = picture(renderer, *sides, lights=(card,))
    assert (shown[:, :8] == 0).all()
    assert (shown[:, 8:, 0] > 0.01).all()


def shaded(renderer: FrameRenderer, lights: tuple[Light, ...], links: LightLinks) -> DoubleArray:
    """Light in the middle of the wall, which a board hides from the lights, over that without the board."""
    board = Batch(rectangle((0, 0, -3.0), (0.3, 0, 0), (0, 0.3, 0), prim=1), MATT, np.eye(4)[None], links=links)
    pose = np.eye(4)
    pose[2, 3] = -3.5
    settings = FrameSettings(9, 9, rays=1, supersample=1, engine="pinhole")
    near = replace(CAMERA, world_from_camera=pose)
    with_board, without = (
        renderer.render(lit(*lights, batches=batches), near, settings).color[4, 4, :3].astype(np.float64)
        for batches in ((WALL, board), (WALL,))
    )
    return np.asarray(with_board / np.maximum(without, 1e-6))


def test_a_surface_casts_the_shadows_that_it_is_linked_to(renderer: FrameRenderer) -> None:
    sun, lamp = replace(SUN, casts_shadow=True), replace(LAMP, casts_shadow=True)
    np.testing.assert_allclose(shaded(renderer, (sun, lamp), LightLinks())[:2], [0, 0], atol=0.02)
    links = LightLinks(unshadowed=frozenset({"/sun"}))
    np.testing.assert_allclose(shaded(renderer, (sun, lamp), links)[:2], [1, 0], atol=0.02)
    links = LightLinks(unshadowed=frozenset({"/lamp"}))
    np.testing.assert_allclose(shaded(renderer, (sun, lamp), links)[:2], [0, 1], atol=0.02)


def test_shadows_keep_their_colour(renderer: FrameRenderer) -> None:
    sun = Light("distant", (2.0,) * 3, np.eye(4), path="/sun", shadow_color=(0.5, 0.25, 0.0))
    np.testing.assert_allclose(shaded(renderer, (sun,), LightLinks()), [0.5, 0.25, 0], atol=0.02)


def test_each_set_has_a_bit_for_each_light_and_the_dome() -> None:
    first, last = LightLinks(frozenset({"/l0", "/sky"})), LightLinks(frozenset({f"/l{MAX_LIGHTS - 1}"}))
    sets = LinkSets([WALL, half(1, first), half(-1, last), half(1, first)])
    assert [sets.number(half(1, links)) for links in (LightLinks(), first, last)] == [0, 1, 2]
    rows = [f"/l{i}" for i in range(MAX_LIGHTS)]
    bits = np.frombuffer(sets.pack(rows, "/sky"), np.uint32).reshape(MAX_LINK_SETS, 4)
    assert bits[:3].tolist() == [[0, 0, 0, 0], [1, 0, 0, 1 << 31], [0, 0, 1 << 31, 0]]
    assert not bits[3:].any()
    assert LinkSets([WALL]).pack(rows, "/sky") == b""
    assert LinkSets([WALL]).options == {}
