"""The nearest thing in view: never overlooked, and not nearer than it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.frame import FrameRenderer
from render.gl.shaders import ProgramCache
from render.lab.reference.scenes import (
    checkerboard,
    posts_before_wall,
    rectangle,
    sphere,
    spheres_over_checkerboard,
    triangles_of,
)
from render.layers import nearest
from render.layers.index import SceneIndex
from render.layers.nearest import nearest_depth_m
from render.layers.peel import HIDES_ALL, Peeler
from render.model.camera import Camera
from render.model.scene import Batch, Geometry, Material, Scene
from render.optics.view import PinholeView

HERE = np.eye(4)[None]
CAMERA = Camera(np.eye(4), 36, 36, 27, near_m=0.1, far_m=100.0)
VIEW = PinholeView.from_camera(CAMERA, 320, 240)


def index_of(*geometries: Geometry) -> SceneIndex:
    index = SceneIndex()
    index.update(Scene(tuple(Batch(geometry, Material(), HERE) for geometry in geometries)))
    return index


def shell(half: tuple[float, float, float]) -> Geometry:
    """The inside of a box around the camera, cut into many triangles: its own box says nothing."""
    x, y, z = half
    sides = [
        rectangle(centre, right, up)
        for sign in (-1, 1)
        for centre, right, up in (
            ((sign * x, 0.0, 0.0), (0.0, 0.0, z), (0.0, y, 0.0)),
            ((0.0, sign * y, 0.0), (x, 0.0, 0.0), (0.0, 0.0, z)),
            ((0.0, 0.0, sign * z), (x, 0.0, 0.0), (0.0, y, 0.0)),
        )
    ]
    count = len(sides)
    return triangles_of(
        np.concatenate([side.positions for side in sides]),
        np.concatenate([side.normals for side in sides]),
        np.concatenate([side.triangles + 4 * i for i, side in zip(range(count), sides, strict=True)]),
    )


@pytest.fixture
def peeler(renderer: FrameRenderer) -> Iterator[Peeler]:
    made = Peeler(renderer.graphics, ProgramCache(renderer.graphics.ctx))
    yield made
    made.release()


def test_a_floor_under_the_camera_begins_where_the_picture_does() -> None:
    """The floor's box holds the camera's foot; it comes into view at the height over the tangent of half the field."""
    floor = checkerboard(40, 40, 0.5, -1.0, -10.0)
    tangent = 27 / 36 / 2
    assert nearest_depth_m(index_of(floor), VIEW) == pytest.approx(1 / tangent, rel=1e-6)


def test_a_room_around_the_camera_is_as_near_as_its_nearest_wall() -> None:
    room = shell((1.5, 1.2, 4.0))
    assert nearest_depth_m(index_of(room), VIEW) == pytest.approx(min(1.5 / 0.5, 1.2 / (27 / 36 / 2)), rel=1e-6)


def test_what_is_not_in_view_does_not_count() -> None:
    beside, behind, beyond = sphere((2.0, 0, -1.5), 0.5), sphere((0, 0, 3.0), 1.0), sphere((0, 0, -150.0), 20.0)
    assert np.isinf(nearest_depth_m(index_of(beside, behind, beyond), VIEW))
    assert nearest_depth_m(index_of(beside, behind, beyond, sphere((0, 0, -9.0), 1.0)), VIEW) == pytest.approx(8, 0.01)
    assert np.isinf(nearest_depth_m(SceneIndex(), VIEW))


def test_what_touches_the_camera_is_as_near_as_anything_is_drawn() -> None:
    assert nearest_depth_m(index_of(rectangle((0, 0, -1.0), (0, 0, 2.0), (0, 1.0, 0))), VIEW) == VIEW.near_m


@pytest.mark.parametrize("opened", [0, 1, 2, 5])
def test_a_search_that_is_given_up_overlooks_nothing(monkeypatch: pytest.MonkeyPatch, opened: int) -> None:
    """A limit on what is opened costs exactness alone: the answer comes nearer, to the near plane at the worst."""
    index = index_of(shell((1.5, 1.2, 4.0)), sphere((0.1, 0, -2.0), 0.4), checkerboard(40, 40, 0.5, -1.0, -10.0))
    exact = nearest_depth_m(index, VIEW)
    assert exact == pytest.approx(1.6, rel=0.01)
    monkeypatch.setattr(nearest, "MAX_STEPS", opened)
    assert VIEW.near_m <= nearest_depth_m(index, VIEW) <= exact
    if opened == 0:
        assert nearest_depth_m(index, VIEW) < 0.2, "the room's box holds the camera"


@given(st.integers(0, 2**31), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_no_point_in_view_is_nearer(seed: int, eye_x: float, eye_y: float) -> None:
    """Triangles anywhere around the camera, looked at from a point beside its own: sampled points are never nearer."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 700))
    corners = rng.uniform(-4, 4, (count, 1, 3)) + rng.normal(size=(count, 3, 3)) * rng.uniform(0.05, 2)
    soup = triangles_of(
        corners.reshape(-1, 3), np.tile([0.0, 0, 1], (3 * count, 1)), np.arange(3 * count).reshape(-1, 3)
    )
    view = replace(VIEW, eye_x_m=eye_x, eye_y_m=eye_y)
    found = nearest_depth_m(index_of(soup), view)
    points = (rng.dirichlet(np.ones(3), (count, 20)) @ soup.positions[soup.triangles]).reshape(-1, 3)
    pixels, depth = view.project(points)
    seen = (depth >= view.near_m) & (depth <= view.far_m) & (pixels >= 0).all(1) & (pixels <= [320, 240]).all(1)
    assert view.near_m <= found
    if seen.any():
        assert found <= depth[seen].min() * (1 + 1e-6)


@pytest.mark.parametrize("make", [spheres_over_checkerboard, posts_before_wall])
def test_what_is_drawn_is_as_near_as_the_search_says(peeler: Peeler, make: Callable[[], tuple[Scene, Camera]]) -> None:
    scene, camera = make()
    peeler.load(scene)
    view = PinholeView.from_camera(camera, 640, 480)
    layers = peeler.peel(view, layers=1, umbra=HIDES_ALL, unlit=True)
    drawn = np.frombuffer(layers.targets.packed_w[0].read(), np.float32)[::4].max()
    found = peeler.nearest_w(view)
    assert drawn * (1 - 1e-5) <= found <= 1.02 * drawn
    assert peeler.nearest_w(view) == found
