"""Edges of what is in focus: as of sixteen samples in a pixel, at a supersampling of two; nothing is lost where blur begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import rectangle
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.focal_surface import Controls, FocalPlane, FocalSurface
from render.model.scene import Batch, Material, Scene

SETTINGS = FrameSettings(120, 80, rays=256, shading="unlit", tiled=False)
CAMERA = Camera(np.eye(4), 36, 36, 24, f_stop=2.0, focus_distance_m=4.0, near_m=0.1)


def card(centre: tuple[float, float, float], half: tuple[float, float], colour: float, turn: float = 0.0) -> Batch:
    """A rectangle that faces the camera, turned in its plane."""
    x, y = np.array([np.cos(turn), np.sin(turn), 0]) * half[0], np.array([-np.sin(turn), np.cos(turn), 0]) * half[1]
    return Batch(
        rectangle(centre, tuple(x), tuple(y)),
        Material(base_color=(colour, colour, colour)),
        np.eye(4)[None],
        double_sided=True,
    )


def bars() -> Scene:
    """Bars narrower than a texel of the layers, in focus, before a wall that is hardly blurred and below one that is."""
    thin = [card((x, 0, -4), (0.004, 1.0), 0.9, turn=0.1 * x) for x in np.linspace(-1.6, 1.6, 25)]
    return Scene((*thin, card((0, 0, -4.4), (9, 9), 0.2), card((0, 0.7, -2), (2, 0.1), 0.6)))


def drawn(renderer: FrameRenderer, scene: Scene, **changes: object) -> FloatArray:
    """Colour of a frame."""
    return renderer.render(scene, CAMERA, replace(SETTINGS, **changes)).color  # type: ignore[arg-type]


@pytest.mark.parametrize("turn", [0.07, 0.5])
def test_an_edge_in_focus_has_the_coverage_of_a_half_plane(renderer: FrameRenderer, turn: float) -> None:
    """A grid of 4x4 samples in a pixel is wrong by an eighth at worst, and by a sixteenth in the mean, along an edge that is
    nearly level; one of 2x2 by twice as much."""
    colour = drawn(renderer, Scene((card((0, -1, -4), (3, 1), 1.0, turn), card((0, 0, -4.01), (9, 9), 0.0))))[..., 0]
    grid = (np.arange(16) + 0.5) / 16
    x = (np.arange(120)[:, None] + grid).ravel() - 60
    y = 40 - (np.arange(80)[:, None] + grid).ravel()
    scale = 4 / 120  # m to a pixel at 4 m
    at = np.stack(np.meshgrid(x * scale, y * scale), axis=-1) - [0, -1]
    along, across = at @ [np.cos(turn), np.sin(turn)], at @ [-np.sin(turn), np.cos(turn)]
    exact = ((np.abs(along) < 3) & (np.abs(across) < 1)).reshape(80, 16, 120, 16).mean(axis=(1, 3))
    edge = (exact > 0) & (exact < 1)
    assert np.abs(colour - exact)[edge].mean() < 0.065
    assert np.abs(colour - exact)[edge].max() < 0.135


def test_thin_bars_in_focus_are_those_of_twice_the_resolution(renderer: FrameRenderer) -> None:
    """At a supersampling of four there is no sharp layer, and the layers are as fine."""
    scene = bars()
    coarse, fine = drawn(renderer, scene), drawn(renderer, scene, supersample=4.0)
    assert psnr_db(coarse, fine) > 38


def test_edges_on_a_bent_focal_surface_have_twice_the_pixels(renderer: FrameRenderer) -> None:
    """Bars at 4 m on the left and at 2.5 m on the right, all in focus."""
    left, right = (
        [card((x, 0, -z), (0.001 * z, 1.0), 0.9, turn=0.1 * x) for x in z * np.linspace(*ends, 12)]
        for z, ends in ((4.0, (-0.45, -0.05)), (2.5, (0.05, 0.45)))
    )
    scene = Scene((*left, *right, card((0, 0, -4.4), (9, 9), 0.2)))
    places = np.array([[x, y] for x in (-0.4, -0.1, 0.1, 0.4) for y in (-0.3, 0.3)])
    values = np.stack([np.where(places[:, 0] < 0, 1 / 4, 1 / 2.5), np.zeros(8)], axis=1)
    controls = Controls(places, values, np.ones(8), np.zeros(8))
    camera = replace(CAMERA, focal_surface=FocalSurface(FocalPlane(0.3), controls=controls))
    coarse, fine = (renderer.render(scene, camera, replace(SETTINGS, supersample=s)).color for s in (2.0, 4.0))
    assert psnr_db(coarse, fine) > 38


def test_no_ray_is_lost_where_surfaces_leave_the_zone(renderer: FrameRenderer) -> None:
    """Cards from near to far lean through the zone of focus, and cover the picture."""
    cards = [
        Batch(
            rectangle((0, y, -6), (30, 0, 0), (0, 0.25, -5.5 * (-1) ** i)),
            Material(base_color=(1, 1, 1)),
            np.eye(4)[None],
            double_sided=True,
        )
        for i, y in enumerate(np.linspace(-4, 4, 17))
    ]
    colour = drawn(renderer, Scene((*cards, card((0, 0, -30), (40, 40), 1.0))))
    assert colour[..., 3].min() > 0.999
    np.testing.assert_allclose(colour[..., :3], 1.0, atol=2e-3)
