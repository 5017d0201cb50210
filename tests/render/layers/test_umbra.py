"""Extended umbra: the depth range a pixel's surface hides from a whole lens, and the bound on layers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.frame import FrameRenderer
from render.gl.shaders import ProgramCache
from render.lab.reference.scenes import posts_before_wall, rectangle
from render.layers.peel import Peeler
from render.layers.umbra import HIDES_ALL, layers_needed, umbra_reach
from render.model.camera import Camera
from render.model.limits import MAX_LAYERS
from render.model.scene import Batch, Material, Scene
from render.optics.view import PinholeView

VIEW = PinholeView.from_camera(Camera(np.eye(4), 36, 36, 27, near_m=0.1), 640, 480)


@pytest.fixture
def peeler(renderer: FrameRenderer) -> Iterator[Peeler]:
    made = Peeler(renderer.graphics, ProgramCache(renderer.graphics.ctx))
    yield made
    made.release()


def test_the_papers_offset_is_our_constant_in_inverse_depth() -> None:
    """x = d·s/(E − s) with s = d/f_px (Lee et al. 2010, section 3.1) against our w − 1/(f_px·E)."""
    f_px, pupil_m = 1119.6, 0.009
    for depth in (0.5, 2.0, 7.0):
        s = depth / f_px
        x = depth * s / (pupil_m - s)
        assert 1 / (depth + x) == pytest.approx(1 / depth - umbra_reach(f_px * pupil_m))


def shift_px(at: tuple[float, float], w: float, behind: float, eye: tuple[float, float]) -> float:
    """Return the shift between a pixel's surface at ``w`` and a point at ``behind`` on the same ray, as seen from the pupil.

    In pixels on the surface, to a side.
    """
    x, y = (at[0] - VIEW.cx) / VIEW.fx, (VIEW.cy - at[1]) / VIEW.fy
    ray = np.array([[x, y, -1.0]])
    through = replace(VIEW, eye_x_m=eye[0], eye_y_m=eye[1])
    surface, beyond = through.project(ray / w)[0], through.project(ray / behind)[0]
    return float(np.abs(surface - beyond).max())


@given(
    st.tuples(st.floats(0, 640), st.floats(0, 480)),
    st.floats(0.3, 10),
    st.floats(0.01, 1.2),
    st.tuples(st.floats(-0.02, 0.05), st.floats(-0.01, 0.01)),
)
def test_no_eye_on_any_pupil_looks_past_a_surface_into_its_umbra(
    at: tuple[float, float], w: float, share: float, eye: tuple[float, float]
) -> None:
    """A pupil that lies to one side: its reach is its far edge. What is hidden stays behind the pixel and its neighbours'
    centres from every eye on it; from the farthest, what lies just beyond the umbra comes out."""
    reach_m = 0.05
    behind = w - share * umbra_reach(VIEW.fx * reach_m)
    if behind <= 0:
        return
    if share <= 1:
        assert shift_px(at, w, behind, eye) <= 1 + 1e-6
    assert shift_px(at, w, behind, (reach_m, 0.0)) == pytest.approx(share, rel=1e-6)


def walls(inverse_depths: list[float]) -> Scene:
    """Walls across the whole view."""
    faces = [rectangle((0, 0, -1 / w), (9 / w, 0, 0), (0, 9 / w, 0), prim=i) for i, w in enumerate(inverse_depths)]
    paths = tuple(f"/wall{i}" for i in range(len(faces)))
    return Scene(tuple(Batch(face, Material(), np.eye(4)[None]) for face in faces), prim_paths=paths)


@pytest.mark.parametrize("pupil_px", [0.3, 1.0, 1.7, 2.5, 4.5, 6.9])
def test_no_scene_has_more_layers_than_the_bound_and_one_has_as_many(peeler: Peeler, pupil_px: float) -> None:
    """Walls that follow each other as closely as the umbra lets them be seen, the first at 1 m."""
    umbra, needed = umbra_reach(pupil_px), layers_needed(pupil_px, 1.0)
    peeler.load(walls([w for i in range(12) if (w := 1 - i * umbra * 1.0001) > 0]))
    assert peeler.peel(VIEW, layers=MAX_LAYERS, umbra=umbra).count == needed
    scene, _ = posts_before_wall()
    peeler.load(scene)
    count = peeler.peel(VIEW, layers=MAX_LAYERS, umbra=umbra).count
    assert 1 <= count <= layers_needed(pupil_px, peeler.nearest_w(VIEW))


def test_a_pinhole_needs_one_layer_and_a_small_lens_two() -> None:
    assert umbra_reach(0.0) == HIDES_ALL
    assert layers_needed(0.0, 10.0) == 1
    assert layers_needed(1.5, 1.0) == 2
    assert layers_needed(1119.6 * 0.009, 1.0) == 11, "the paper's example, which it rounds to ten"
    assert layers_needed(1e-9, 0.0) == 1, "nothing is in view"
