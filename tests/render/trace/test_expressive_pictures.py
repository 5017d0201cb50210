"""A picture that no lens takes: foreground and background sharp, and what stands between them soft."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.focus.expressive import SurfacePoints, focal_controls
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import triangles_of
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.focal_surface import FocalPlane, FocalSurface
from render.model.scene import Batch, Dome, Geometry, Material, Scene

WIDTH, HEIGHT = 320, 160
SETTINGS = FrameSettings(WIDTH, HEIGHT, rays=64, shading="unlit")
CARDS = {-0.24: 1.2, 0.0: 2.5, 0.24: 8.0}
"""Slope across and depth in m of three cards with a chequered front, side by side."""
HALF_SLOPE, CELLS = 0.085, 20
CHEQUERED = Material(uses_display_color=True, base_color=(1, 1, 1))


def card(slope: float, depth_m: float) -> Geometry:
    i, j = (part.ravel() for part in np.meshgrid(np.arange(CELLS), np.arange(CELLS), indexing="ij"))
    low = np.stack([i, j, np.zeros_like(i)], axis=-1)[:, None] + [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    corners = (low / CELLS * 2 - 1) * HALF_SLOPE * depth_m + [slope * depth_m, 0, 0]
    corners[..., 2] = -depth_m
    colors = np.where(((i + j) % 2).astype(bool)[:, None], [0.8, 0.8, 0.8, 1], [0.1, 0.1, 0.1, 1]).repeat(4, axis=0)
    faces = (4 * np.arange(len(i))[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return triangles_of(corners.reshape(-1, 3), np.tile([0.0, 0, 1], (4 * len(i), 1)), faces, colors)


def shot(focus_distance_m: float = 2.5) -> tuple[Scene, Camera]:
    batches = tuple(Batch(card(*place), CHEQUERED, np.eye(4)[None]) for place in CARDS.items())
    scene = Scene(batches, (), Dome((0.3, 0.3, 0.3), np.eye(4)), ("/card",))
    return scene, Camera(np.eye(4), 50.0, 36.0, 18.0, f_stop=2.0, focus_distance_m=focus_distance_m, near_m=0.1)


def surface(camera: Camera, blurs_mm: list[float]) -> FocalSurface:
    plane = FocalPlane(1 / camera.focus_distance_m)
    blurs = np.array(blurs_mm)
    every = np.ones(3)
    points = SurfacePoints(
        names=("near", "middle", "far"),
        slopes=np.array([[slope, 0.0] for slope in CARDS]),
        depths_m=np.array(list(CARDS.values())),
        weights=every,
        soft=blurs > 0,
        blurs_mm=blurs,
        surface_offsets_m=0 * every,
        falloffs=0 * every,
        extents=every,
        fades=every,
        field_shifts_w=0 * every,
    )
    return FocalSurface(plane, focal_controls(points, plane=plane, coc_slope_mm_m=1.25, frame_width=0.72))


def contrasts(picture: FloatArray, sharp: FloatArray) -> list[float]:
    """Return the contrast in the middle of each card, relative to a sharp picture."""
    found = []
    for slope in CARDS:
        x, r = round(WIDTH / 2 + slope * WIDTH / 0.72), 16
        part = np.s_[HEIGHT // 2 - r : HEIGHT // 2 + r, x - r : x + r, 1]
        found.append(float(picture[part].std() / sharp[part].std()))
    return found


def test_foreground_and_background_are_sharp_and_the_middle_soft(renderer: FrameRenderer) -> None:
    scene, camera = shot()
    sharp = renderer.render(scene, replace(camera, f_stop=0.0), SETTINGS).color
    plain = contrasts(renderer.render(scene, camera, SETTINGS).color, sharp)
    assert plain[1] > 0.95
    assert max(plain[0], plain[2]) < 0.65, "a lens has one of the three sharp"
    bent = replace(camera, focal_surface=surface(camera, [0, 1.0, 0]))
    near, middle, far = contrasts(renderer.render(scene, bent, SETTINGS).color, sharp)
    assert min(near, far) > 0.8
    assert middle < 0.35


def test_all_of_them_may_be_sharp(renderer: FrameRenderer) -> None:
    scene, camera = shot()
    sharp = renderer.render(scene, replace(camera, f_stop=0.0), SETTINGS).color
    bent = replace(camera, focal_surface=surface(camera, [0, 0, 0]))
    assert min(contrasts(renderer.render(scene, bent, SETTINGS).color, sharp)) > 0.8


@pytest.mark.parametrize("blur_mm", [0.25, 0.5])
def test_the_picture_has_the_requested_blur(renderer: FrameRenderer, blur_mm: float) -> None:
    """The card looks as through a plain lens that is focused so far before it. Only the plain one has a sharp layer below a
    supersampling of four."""
    scene, camera = shot(2.5)
    settings = replace(SETTINGS, supersample=4)
    bent = renderer.render(scene, replace(camera, focal_surface=surface(camera, [0, blur_mm, 0])), settings).color
    plain_camera = replace(camera, focus_distance_m=1 / (1 / 2.5 + blur_mm / 1.25))
    plain = renderer.render(scene, plain_camera, settings).color
    middle = np.s_[HEIGHT // 2 - 6 : HEIGHT // 2 + 6, WIDTH // 2 - 6 : WIDTH // 2 + 6]
    assert np.abs(bent[middle] - plain[middle]).mean() < 0.02
