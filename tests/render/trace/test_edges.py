"""Edges of what is in focus: as of sixteen samples in a pixel; nothing is lost where blur begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.engines.shared.layer_scale import texel_offset
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import rectangle
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Batch, Material, Scene
from render.optics.view import PinholeView
from render.trace.rays import make_ray_pattern

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


@pytest.mark.parametrize("parts", [1, 4])
def test_moments_whose_layers_are_offset_have_finer_edges(renderer: FrameRenderer, parts: int) -> None:
    """The mean over four layers of 2x2 pixels for a pixel, offset against each other, against those of 4x4."""
    bars = [card((x, 0, -4), (0.02, 1.0), 0.9, turn=0.1 * x) for x in np.linspace(-1.6, 1.6, 9)]
    scene = Scene((*bars, card((0, 0, -4.01), (9, 9), 0.1)))
    view, pattern = PinholeView.from_camera(CAMERA, 120, 80), make_ray_pattern(256, CAMERA.iris, tiled=False)
    with renderer.on_device():
        renderer.load(scene, CAMERA, SETTINGS)
        device = renderer.device
        pictures = {
            scale: np.mean(
                [
                    device.tracer.picture(
                        device.peeler,
                        CAMERA,
                        view,
                        pattern,
                        layers=1,
                        supersample=scale,
                        texel_offset=texel_offset(FrameSettings(), (part, of)),
                        unlit=True,
                    ).color
                    for part in range(of)
                ],
                axis=0,
            )
            for scale, of in ((2.0, parts), (4.0, 1))
        }
    error = psnr_db(pictures[2.0], pictures[4.0])
    assert error > 33 if parts == 4 else error < 31


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
