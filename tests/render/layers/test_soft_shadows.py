"""Penumbrae of lights with a size, by closed forms: the share of a light that a straight edge leaves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle, sphere
from render.layers.shadow_cells import ShadowCells
from render.layers.shadows import light_outline
from render.model.arrays import DoubleArray
from render.model.scene import POINT_RADIUS_M, Batch, Image, Light
from render.optics.view import PinholeView
from render.trace.rays import make_ray_pattern
from tests.render.kits.lit_walls import CAMERA, MATT, WALL, facing_the_wall, lit

WIDTH_PX, ACROSS_M = 160, 4.0
PLACES = ((np.arange(WIDTH_PX) + 0.5) / WIDTH_PX - 0.5) * ACROSS_M
"""Places on the wall across the picture's middle row, metres."""
NEAR_WALL = replace(WALL, geometry=rectangle((0, 0, -4), (2.5, 0, 0), (0, 2.5, 0)))
LIGHT_M, EDGE_M = 3.0, 1.0
"""Distances of the light and of the edge from the wall."""


def half_plane(distance_m: float = EDGE_M, turn: float = 0.0) -> Batch:
    """A board before the wall that ends along Y, or a line turned from it, and covers all at -X. The camera does not see it."""
    x = np.array([np.cos(turn), np.sin(turn), 0.0])
    y = np.array([-np.sin(turn), np.cos(turn), 0.0])
    board = rectangle(tuple(-3 * x + [0, 0, distance_m - 4]), tuple(3 * x), tuple(3 * y), prim=1)
    return Batch(board, MATT, np.eye(4)[None], camera_role="unseen", double_sided=True)


def visible_share(renderer: FrameRenderer, light: Light, *casters: Batch, channels: int | slice = 0) -> DoubleArray:
    """Light along the middle of the wall, over that without the casters."""
    settings = FrameSettings(WIDTH_PX, 9, rays=1, supersample=1, engine="pinhole")
    camera = replace(CAMERA, vertical_aperture_mm=36 * 9 / WIDTH_PX)
    rows = [
        renderer.render(lit(light, batches=(NEAR_WALL, *some)), camera, settings)
        .color[4, :, channels]
        .astype(np.float64)
        for some in (casters, ())
    ]
    return np.asarray(rows[0] / rows[1])


def of_a_square(edge: DoubleArray) -> DoubleArray:
    """Share of a square from -1 to 1 beyond an edge."""
    return np.clip(0.5 - 0.5 * edge, 0, 1)


def of_a_disc(edge: DoubleArray) -> DoubleArray:
    """Share of a disc of radius 1 beyond an edge: a circular segment."""
    e = np.clip(edge, -1, 1)
    return (np.arccos(e) - e * np.sqrt(1 - e**2)) / np.pi


LIGHTS: dict[str, tuple[Light, float, Callable[[DoubleArray], DoubleArray]]] = {
    "rect": (Light("rect", (3.0,) * 3, facing_the_wall(LIGHT_M), width_m=1.0, height_m=0.4), 0.5, of_a_square),
    "small rect": (Light("rect", (3.0,) * 3, facing_the_wall(LIGHT_M), width_m=0.2, height_m=0.2), 0.1, of_a_square),
    "disk": (Light("disk", (3.0,) * 3, facing_the_wall(LIGHT_M), radius_m=0.4), 0.4, of_a_disc),
    "sphere": (Light("sphere", (3.0,) * 3, facing_the_wall(LIGHT_M), radius_m=0.3), 0.3, of_a_disc),
    "tube": (Light("cylinder", (3.0,) * 3, facing_the_wall(LIGHT_M), radius_m=0.02, length_m=0.6), 0.3, of_a_square),
    "sun": (Light("distant", (3.0,) * 3, facing_the_wall(LIGHT_M), angle_rad=0.2), np.tan(0.1) * 3.0, of_a_disc),
}


def width_of(share: DoubleArray) -> float:
    """Width of a penumbra from 10 % to 90 % of the light."""
    return float(np.interp(0.9, share, PLACES) - np.interp(0.1, share, PLACES))


@pytest.mark.parametrize("name", LIGHTS)
def test_an_edge_leaves_the_share_of_the_light(renderer: FrameRenderer, name: str) -> None:
    """Within 3 % of the light anywhere; and the penumbra is as wide."""
    light, half_m, share_beyond = LIGHTS[name]
    # where the edge, seen from a place on the wall, cuts the light's plane; a sun's image is as large from anywhere
    beyond = (LIGHT_M - EDGE_M) / EDGE_M if name != "sun" else LIGHT_M / EDGE_M
    expected = share_beyond(-PLACES * beyond / half_m)
    shown = visible_share(renderer, light, half_plane())
    np.testing.assert_allclose(shown, expected, atol=0.03)
    assert width_of(shown) == pytest.approx(width_of(expected), rel=0.1)


def test_penumbrae_have_the_colours_of_an_image(renderer: FrameRenderer) -> None:
    """Red at -X and green at +X: an edge that covers all at -X hides the red first. Blue is at +Y: it is hidden evenly."""
    pixels = np.zeros((4, 4, 4), np.float16)
    pixels[:, 2:, 0] = pixels[:, :2, 1] = pixels[:2, :, 2] = 1.0
    light = Light("rect", (6.0,) * 3, facing_the_wall(LIGHT_M), width_m=1.0, height_m=0.4, image=Image(pixels))
    shown = visible_share(renderer, light, half_plane(), channels=slice(3))
    edge = -PLACES * (LIGHT_M - EDGE_M) / EDGE_M / 0.5
    expected = [np.clip(-edge, 0, 1), np.clip(1 - edge, 0, 1), of_a_square(edge)]
    np.testing.assert_allclose(shown, np.stack(expected, 1), atol=0.035)


@pytest.mark.parametrize("turn", [0.3, 0.785])
def test_an_edge_across_a_rect_light(renderer: FrameRenderer, turn: float) -> None:
    """The light's own shape counts: the share of a square beyond a line that is turned against it, by its points."""
    light = Light("rect", (3.0,) * 3, facing_the_wall(LIGHT_M), width_m=0.8, height_m=0.8)
    points = (np.arange(400) + 0.5) / 200 - 1
    across = np.sort((0.4 * (points[:, None] * np.cos(turn) + points * np.sin(turn))).ravel())
    edge = -PLACES * np.cos(turn) * (LIGHT_M - EDGE_M) / EDGE_M
    expected = 1 - np.searchsorted(across, edge) / across.size
    np.testing.assert_allclose(visible_share(renderer, light, half_plane(turn=turn)), expected, atol=0.04)


def test_a_sketch_builds_nothing_for_penumbrae(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    """Shadows of sketches are hard. The picture at rest, of the same shadow maps, has its penumbra as without the sketch."""
    built: list[int] = []
    build = ShadowCells.build

    def note_build(cells: ShadowCells, layer: int) -> None:
        built.append(layer)
        build(cells, layer)

    monkeypatch.setattr(ShadowCells, "build", note_build)
    settings = FrameSettings(WIDTH_PX, 9, rays=1, supersample=1, engine="pinhole")
    camera = replace(CAMERA, vertical_aperture_mm=36 * 9 / WIDTH_PX)
    scenes = [lit(LIGHTS["rect"][0], batches=(NEAR_WALL, half_plane())) for _ in range(2)]
    wanted = renderer.render(scenes[0], camera, settings).color
    count = len(built)
    assert count > 0
    device = renderer.device
    with renderer.on_device():
        drawn = renderer.load(scenes[1], camera, settings, is_preview=True)
        view = PinholeView.from_camera(drawn, WIDTH_PX, 9)
        device.previewer.peel(device.peeler, drawn, view, unlit=False, sketch="always")
        assert len(built) == count
    np.testing.assert_array_equal(renderer.render(scenes[1], camera, settings).color, wanted)
    assert len(built) == 2 * count


def test_a_shadow_is_hard_where_its_caster_is_near(renderer: FrameRenderer) -> None:
    """A penumbra grows with the distance from what casts it."""
    light = LIGHTS["disk"][0]
    widths = [width_of(visible_share(renderer, light, half_plane(distance_m))) for distance_m in (0.02, 0.2, 0.5, 1.0)]
    assert widths[0] < 0.06  # texels of the map
    assert (np.diff(widths) > 0).all()


def test_a_light_that_is_a_point_has_a_hard_shadow(renderer: FrameRenderer) -> None:
    point = Light("sphere", (3e4,) * 3, facing_the_wall(LIGHT_M), radius_m=POINT_RADIUS_M)
    assert light_outline(point)[2] == 0
    assert light_outline(LIGHTS["sphere"][0])[2] != 0
    assert width_of(visible_share(renderer, point, half_plane())) < 0.05


@pytest.mark.parametrize("name", LIGHTS)
def test_what_nothing_hides_is_lit(renderer: FrameRenderer, name: str) -> None:
    """A wall and a ball do not shade themselves, at grazing light either: no acne."""
    turn = np.eye(4)
    turn[:3, :3] = np.array([[0.6, 0, -0.8], [0, 1, 0], [0.8, 0, 0.6]])
    pose = turn @ facing_the_wall(LIGHT_M)
    pose[:3, 3] = [-2.5, 0.3, -2.5]
    light = replace(LIGHTS[name][0], pose=pose)
    for alone in (NEAR_WALL, Batch(sphere((0.0, 0.0, -3.0), 0.7), MATT, np.eye(4)[None])):
        shown, plain = (
            renderer.render(lit(one, batches=(alone,)), CAMERA, FrameSettings(48, 48, rays=1, engine="pinhole")).color
            for one in (light, replace(light, casts_shadow=False))
        )
        assert plain.max() > 0
        np.testing.assert_allclose(shown[..., 0], plain[..., 0], rtol=0.02, atol=2e-3 * float(plain.max()))


@pytest.mark.parametrize("name", LIGHTS)
def test_no_light_leaks_into_the_umbra(renderer: FrameRenderer, name: str) -> None:
    """Behind a board as wide as the light, with a second one behind it at another depth."""
    boards = [
        Batch(rectangle((0, 0, z - 4), (size, 0, 0), (0, size, 0), prim=1), MATT, np.eye(4)[None], camera_role="unseen")
        for z, size in ((1.0, 1.0), (0.3, 0.8))
    ]
    share = visible_share(renderer, LIGHTS[name][0], *boards)
    assert share[np.abs(PLACES) < 0.7].max() < 0.01


def test_pictures_of_soft_shadows_are_equal(renderer: FrameRenderer) -> None:
    light = LIGHTS["rect"][0]
    first, again = (visible_share(renderer, light, half_plane(turn=0.3)) for _ in range(2))
    np.testing.assert_array_equal(first, again)


def test_a_shadow_ends_at_its_distance(renderer: FrameRenderer) -> None:
    """`inputs:shadow:distance`, from the caster to the surface; it fades before by `falloff` and `falloffGamma`."""
    point = Light("sphere", (3e4,) * 3, facing_the_wall(LIGHT_M), radius_m=POINT_RADIUS_M)
    dark = np.abs(PLACES + 0.5) < 0.1  # about a metre from the board, along the light
    for light in (LIGHTS["rect"][0], LIGHTS["sun"][0], LIGHTS["sphere"][0], point):
        limits = ((1.5, 0.0), (0.9, 0.0), (1.4, 0.8))
        full, none, faded = (
            visible_share(
                renderer,
                replace(light, shadow_reach_m=reach_m, shadow_fade_m=fade_m, shadow_gamma=2.0),
                half_plane(),
            )[dark]
            for reach_m, fade_m in limits
        )
        assert full.max() < 0.01, light.kind
        assert none.min() > 0.99, light.kind
        np.testing.assert_allclose(faded, 1 - 0.5**2, atol=0.05, err_msg=light.kind)


def sketched_row(renderer: FrameRenderer, sketch: Literal["never", "always"], *casters: Batch) -> DoubleArray:
    """Light along the middle of the wall in a small picture, or in the sketch of one."""
    view, settings = PinholeView.from_camera(CAMERA, WIDTH_PX, WIDTH_PX), FrameSettings(WIDTH_PX, WIDTH_PX, rays=4)
    device, scene = renderer.device, lit(LIGHTS["sphere"][0], batches=(NEAR_WALL, *casters))
    with renderer.on_device():
        camera = renderer.load(scene, CAMERA, settings, is_preview=True)
        device.peeler.clear_cache()
        peeled, small = device.previewer.peel(device.peeler, camera, view, unlit=False, sketch=sketch)
        pattern = make_ray_pattern(4, camera.iris, seed=1, tiled=False)
        light = device.previewer.trace(device.peeler, peeled, camera, small, pattern, 1)
    return np.asarray(light[len(light) // 2, :, 0], np.float64)


def test_shadows_of_sketches_are_hard(renderer: FrameRenderer) -> None:
    """Pictures while something is dragged do without penumbrae, which take most of the lighting's time."""
    widths = []
    for sketch in ("never", "always"):
        share = sketched_row(renderer, sketch, half_plane()) / sketched_row(renderer, sketch)
        widths.append(np.mean((share > 0.1) & (share < 0.9)))
    assert widths[1] < 0.4 * widths[0]
