"""Bounds: geometry in view is never left out, geometry wholly beside the view is."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from render.lab.reference.scenes import sphere
from render.layers.bounds import BoxCache, may_be_seen
from render.model.camera import Camera
from render.model.scene import Batch, Material
from render.optics.view import PinholeView

VIEW = PinholeView.from_camera(Camera(np.eye(4), 36, 36, 27, near_m=0.1, far_m=100.0), 320, 240)
CLIP = VIEW.projection_matrix() @ VIEW.camera_from_world
coordinate = st.floats(-60, 60)


@given(st.tuples(coordinate, coordinate, coordinate), st.tuples(*[st.floats(0, 20)] * 3))
def test_a_box_that_holds_a_visible_point_may_be_seen(centre: tuple[float, ...], half: tuple[float, ...]) -> None:
    signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    corners = np.array(centre) + signs * np.array(half)
    inside = np.random.default_rng(0).uniform(-1, 1, (64, 3)) * half + centre
    pixels, depth = VIEW.project(inside)
    visible = (depth >= 0.1) & (depth <= 100) & (pixels >= 0).all(1) & (pixels <= [320, 240]).all(1)
    if visible.any():
        assert may_be_seen(corners, CLIP)


def test_what_lies_beside_behind_or_beyond_is_left_out() -> None:
    ball = Batch(sphere((0, 0, 0), 1.0), Material(), np.eye(4)[None])
    for place in ([9, 0, -5], [0, -8, -5], [0, 0, 3], [0, 0, -120]):
        pose = np.eye(4)
        pose[:3, 3] = place
        corners = BoxCache().corners(Batch(ball.geometry, ball.material, pose[None]))
        assert not may_be_seen(corners, CLIP), place
    assert may_be_seen(BoxCache().corners(ball), CLIP), "the camera stands in it"
    assert not may_be_seen(np.zeros((0, 3)), CLIP)
