"""The pinhole view is one affine map, whichever way it is asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import CameraError, SettingsError
from render.model.camera import Camera
from render.model.focal_surface import FocalPlane
from render.optics.view import PinholeView


def camera(**changes: object) -> Camera:
    pose = np.eye(4)
    angle = 0.4
    pose[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    pose[:3, 3] = [1.0, 2.0, -0.5]
    base = Camera(
        pose,
        focal_length_mm=40,
        horizontal_aperture_mm=24,
        vertical_aperture_mm=13.5,
        horizontal_offset_mm=2,
        vertical_offset_mm=-1,
    )
    return replace(base, near_m=0.1, **changes)  # type: ignore[arg-type]


VIEW = PinholeView.from_camera(camera(), 640, 360)
places = st.tuples(st.floats(-50, 700), st.floats(-50, 400), st.floats(0.11, 500))


@given(places)
def test_the_ray_of_a_place_comes_back_to_it(place: tuple[float, float, float]) -> None:
    x, y, depth = place
    origin, direction = VIEW.ray(x, y)
    pixels, depths = VIEW.project((origin + depth * direction)[None])
    np.testing.assert_allclose(pixels[0], [x, y], atol=1e-6)
    assert depths[0] == pytest.approx(depth)


@given(places, st.floats(-0.05, 0.05), st.floats(-0.05, 0.05))
def test_the_projection_matrix_says_the_same_as_project(
    place: tuple[float, float, float], eye_x: float, eye_y: float
) -> None:
    view = replace(VIEW, eye_x_m=eye_x, eye_y_m=eye_y)
    origin, direction = VIEW.ray(*place[:2])
    world = origin + place[2] * direction
    clip = view.projection_matrix() @ view.camera_from_world @ [*world, 1.0]
    expected, depth = view.project(world[None])
    np.testing.assert_allclose((clip[:2] / clip[3] + 1) / 2 * [view.width, view.height], expected[0], atol=1e-6)
    assert clip[3] == pytest.approx(depth[0])
    assert clip[2] / clip[3] == pytest.approx(view.near_m / depth[0])


@given(places, st.floats(0.2, 50), st.floats(-0.05, 0.05), st.floats(-0.05, 0.05))
def test_through_the_pupil_a_point_moves_by_the_one_equation(
    place: tuple[float, float, float], focus_m: float, lens_x: float, lens_y: float
) -> None:
    """s(w) = p + f·l·(w − w_f): what lands at p through l is seen from the centre at s(w) (DESIGN, the one equation)."""
    origin, direction = VIEW.ray(*place[:2])
    world = (origin + place[2] * direction)[None]
    central, through = (
        VIEW.project(world)[0][0],
        VIEW.through(lens_x, lens_y, FocalPlane(1 / focus_m)).project(world)[0][0],
    )
    shift = 1 / place[2] - 1 / focus_m
    np.testing.assert_allclose(central - through, [VIEW.fx * lens_x * shift, -VIEW.fy * lens_y * shift], atol=1e-6)


def test_a_shifted_gate_shows_the_other_side() -> None:
    """A gate moved right (positive offset) looks right, so the axis lies left of the picture's middle, as in UsdGeomCamera."""
    assert VIEW.cx == pytest.approx(640 * (0.5 - 2 / 24))
    assert VIEW.cy == pytest.approx(360 * (0.5 - 1 / 13.5))


def test_breathing_stretches_by_the_image_distance() -> None:
    still = PinholeView.from_camera(camera(focus_distance_m=1.0), 640, 360)
    breathing = PinholeView.from_camera(camera(focus_distance_m=1.0, breathing=True), 640, 360)
    assert breathing.fx / still.fx == pytest.approx(1000 / (1000 - 40))


@pytest.mark.parametrize("size", [(0, 360), (640, -1), (100_000, 10)])
def test_a_picture_without_pixels_is_refused(size: tuple[int, int]) -> None:
    with pytest.raises(SettingsError, match="pixels"):
        PinholeView.from_camera(camera(), *size)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"focal_length_mm": -35.0}, "focal length"),
        ({"focal_length_mm": float("nan")}, "focal length"),
        ({"horizontal_aperture_mm": 0.0}, "horizontal aperture"),
        ({"near_m": 0.0}, "near clipping"),
        ({"far_m": 0.05}, "far clipping"),
        ({"f_stop": -1.0}, "f-number"),
        ({"focus_distance_m": float("nan")}, "focus distance"),
        ({"world_from_camera": np.full((4, 4), np.nan)}, "transform"),
        ({"breathing": True, "focus_distance_m": 0.01}, "breathing"),
    ],
)
def test_impossible_cameras_are_refused_by_name(change: dict[str, object], named: str) -> None:
    with pytest.raises(CameraError, match=named):
        PinholeView.from_camera(replace(camera(), **change), 640, 360)  # type: ignore[arg-type]
