"""Light filters on the device, against closed forms of what passes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.layers.light_filters import place_filters
from render.model.arrays import DoubleArray
from render.model.light_filters import MAX_FILTERS, RAMP_STEPS, Barn, LightFilter, PreBarn, Ramp, RampMode, Window
from render.model.scene import Light, LightKind
from tests.render.kits.lit_walls import CAMERA, facing_the_wall, lit

pytestmark = pytest.mark.gl
WIDTH = 41
X_M = (np.arange(WIDTH) + 0.5 - WIDTH / 2) / WIDTH * 4.0  # of the wall, four metres away
SQUARE = Window((0.5, 0.5, 0.5, 0.5))
SUN = Light("distant", (np.pi,) * 3, facing_the_wall(4.0), casts_shadow=False)


def share(renderer: FrameRenderer, light: Light, *filters: LightFilter) -> DoubleArray:
    """Share ``(WIDTH, WIDTH, 3)`` of a light that its filters leave on the wall, seen from four metres."""
    settings = FrameSettings(WIDTH, WIDTH, rays=1, supersample=1, engine="pinhole")
    plain, filtered = (
        renderer.render(lit(one), CAMERA, settings).color[..., :3].astype(np.float64)
        for one in (light, replace(light, filters=filters))
    )
    return filtered / plain


def ahead(shape: Barn | Ramp, distance_m: float, **effect: float | bool) -> LightFilter:
    """A filter so far before the wall."""
    return LightFilter(shape, facing_the_wall(distance_m), **effect)  # type: ignore[arg-type]


def smooth(x: DoubleArray) -> DoubleArray:
    x = np.clip(x, 0, 1)
    return x * x * (3 - 2 * x)


def round_share(x: DoubleArray) -> DoubleArray:
    """Share of a disk on one side of a chord; x from -1 to 1."""
    x = np.clip(x, -1, 1)
    return np.asarray(0.5 + (x * np.sqrt(1 - x * x) + np.arcsin(x)) / np.pi)


def test_doors_fade_over_their_edges(renderer: FrameRenderer) -> None:
    """Parallel light, so that the opening is on the wall as it is; other widths of its edges on each side."""
    window = Window((0.5, 0.8, 0.6, 0.6), edges=(0.4, 0.8, 0.2, 0.2))
    found = share(renderer, SUN, ahead(Barn(window, source=(0, 0, 1, 0)), 2.0))[WIDTH // 2, :, 0]
    expected = np.where(X_M < 0, 1 - smooth((-X_M - 0.5) / 0.4), 1 - smooth((X_M - 0.8) / 0.8))
    np.testing.assert_allclose(found, expected, atol=2e-3)


def test_a_source_of_its_own_spreads_an_opening(renderer: FrameRenderer) -> None:
    """From a metre behind the doors, two metres before the wall: three times as wide."""
    window = Window((0.4, 0.4, 0.3, 0.3), edges=(0.1,) * 4)
    found = share(renderer, SUN, ahead(Barn(window, source=(0, 0, 1, 1)), 2.0))
    np.testing.assert_allclose(found[WIDTH // 2, :, 0], 1 - smooth((np.abs(X_M) / 3 - 0.4) / 0.1), atol=4e-3)
    np.testing.assert_allclose(found[:, WIDTH // 2, 0], 1 - smooth((np.abs(X_M) / 3 - 0.3) / 0.1), atol=4e-3)


def test_round_corners_are_round(renderer: FrameRenderer) -> None:
    window = Window((1.0,) * 4, radii=(1.0, 1.0), edges=(0.5,) * 4)
    found = share(renderer, SUN, ahead(Barn(window, source=(0, 0, 1, 0)), 2.0))[..., 0]
    away = np.hypot(*np.meshgrid(X_M, X_M))
    np.testing.assert_allclose(found, 1 - smooth((away - 1.0) / 0.5), atol=3e-3)


@pytest.mark.parametrize("kind", ["rect", "disk", "sphere"])
def test_penumbrae_are_the_share_of_the_light_seen(kind: LightKind, renderer: FrameRenderer) -> None:
    """A light 4 m and doors 2 m before the wall: light and opening are seen from there as 0.25 m to 0.5 m in the doors' plane."""
    light = Light(kind, (1.0,) * 3, facing_the_wall(4.0), radius_m=0.5, width_m=1.0, height_m=0.6, casts_shadow=False)
    found = share(renderer, light, ahead(Barn(SQUARE), 2.0))[WIDTH // 2, :, 0]
    edges = (0.5 + X_M / 2) / 0.25, (0.5 - X_M / 2) / 0.25
    below = round_share if kind != "rect" else lambda x: np.asarray(np.clip(0.5 + x / 2, 0, 1))
    np.testing.assert_allclose(found, below(edges[0]) + below(edges[1]) - 1, atol=3e-3)


def test_a_narrow_opening_shows_part_of_a_light(renderer: FrameRenderer) -> None:
    light = Light("rect", (1.0,) * 3, facing_the_wall(4.0), width_m=2.0, height_m=2.0, casts_shadow=False)
    found = share(renderer, light, ahead(Barn(Window((0.1, 0.1, 0.05, 0.05))), 2.0))
    assert found[WIDTH // 2, WIDTH // 2, 0] == pytest.approx(0.2 * 0.1 / (1.0 * 1.0), rel=0.01)


def test_a_wide_sun_has_penumbrae_of_its_angle(renderer: FrameRenderer) -> None:
    sun = replace(SUN, angle_rad=2 * np.arctan(0.2))
    found = share(renderer, sun, ahead(Barn(SQUARE), 2.0))[WIDTH // 2, :, 0]
    np.testing.assert_allclose(found, round_share((0.5 - np.abs(X_M)) / 0.4), atol=3e-3)


@pytest.mark.parametrize(("before", "expected"), [("all", [1, 1]), ("none", [0, 0]), ("cone", [1, 0])])
def test_light_before_doors(before: PreBarn, expected: list[float], renderer: FrameRenderer) -> None:
    """The wall stands between the light and the doors, 2 m behind it: what will pass is 1/3 of the opening wide."""
    light = Light("sphere", (1e6,) * 3, facing_the_wall(1.0), radius_m=1e-3, casts_shadow=False)
    doors = ahead(Barn(Window((1.5, 1.5, 1.5, 1.5)), before), -2.0)
    found = share(renderer, light, doors)[WIDTH // 2, :, 0]
    np.testing.assert_allclose([found[WIDTH // 2 + 4], found[WIDTH // 2 + 7]], expected, atol=1e-3)


def test_doors_behind_a_light_leave_it_as_it_is(renderer: FrameRenderer) -> None:
    light = Light("sphere", (1e6,) * 3, facing_the_wall(1.0), radius_m=1e-3, casts_shadow=False)
    np.testing.assert_allclose(share(renderer, light, ahead(Barn(SQUARE), 2.0)), 1.0, atol=1e-3)


def test_a_ramp_multiplies_by_distance(renderer: FrameRenderer) -> None:
    light = Light("sphere", (1e4,) * 3, facing_the_wall(1.0), radius_m=0.01, casts_shadow=False)
    colors = np.linspace([1, 0, 0], [0, 1, 0], RAMP_STEPS).astype(np.float32)
    found = share(renderer, light, ahead(Ramp("distance", 1.0, 2.0, colors), 3.0))
    x, y = np.meshgrid(X_M, X_M)
    along = np.clip(np.sqrt(1 + x * x + y * y) - 1, 0, 1)
    np.testing.assert_allclose(found, np.stack([1 - along, along, 0 * along], -1), atol=3e-3)


@pytest.mark.parametrize(
    ("mode", "along"),
    [
        ("linear", lambda x, y: 0 * x + 0.25),
        ("radial", lambda x, y: np.hypot(x, y) / 4),
        ("spherical", lambda x, y: np.sqrt(x * x + y * y + 1) / 4),
    ],
)
def test_ramps_by_place(
    mode: RampMode, along: Callable[[DoubleArray, DoubleArray], DoubleArray], renderer: FrameRenderer
) -> None:
    """A filter a metre before the wall."""
    colors = np.repeat(np.linspace(1, 0, RAMP_STEPS)[:, None], 3, 1).astype(np.float32)
    found = share(renderer, SUN, ahead(Ramp(mode, 0.0, 4.0, colors), 1.0))[..., 0]
    np.testing.assert_allclose(found, 1 - along(*np.meshgrid(X_M, X_M)), atol=3e-3)


def test_effects_of_several_filters_multiply(renderer: FrameRenderer) -> None:
    """Half the density leaves half of what doors hold back; what is turned about lets through what they do not."""
    doors = Barn(SQUARE, source=(0, 0, 1, 0))
    half, turned = ahead(doors, 2.0, density=0.5, strength=2.0), ahead(doors, 2.0, inverted=True, density=0.25)
    found = share(renderer, SUN, half, turned)[WIDTH // 2, :, 0]
    assert found[[WIDTH // 2, 0]] == pytest.approx([2.0 * 0.75, 2.0 * 0.5], rel=2e-3)
    apart = ahead(doors, 2.0, diffuse=0.5)
    assert share(renderer, SUN, apart)[WIDTH // 2, 0, 0] == pytest.approx(0.5, rel=2e-3)


def test_each_light_has_its_own_filters(renderer: FrameRenderer) -> None:
    """Those of more lights than there is room for are left out together."""
    doors = ahead(Barn(SQUARE, source=(0, 0, 1, 0)), 2.0)
    lights = [replace(SUN, filters=(doors,) * count) for count in (0, MAX_FILTERS - 1, 2, 1)]
    assert place_filters(lights) == {1: 0, 3: MAX_FILTERS - 1}
    settings = FrameSettings(WIDTH, WIDTH, rays=1, supersample=1, engine="pinhole")
    color = renderer.render(lit(SUN, replace(SUN, filters=(doors,))), CAMERA, settings).color
    assert color[WIDTH // 2, [WIDTH // 2, 0], 0] == pytest.approx([1.0, 0.5], rel=2e-3)
