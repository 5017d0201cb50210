"""Windows of pictures: the same pixels as in the whole picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.model.camera import Camera
from render.model.framing import WHOLE, Framing, Window
from render.model.lens import Lens
from render.optics.prescription.mounting import mount_lens
from render.optics.view import PinholeView
from tests.render.kits.lenses import PLANAR

CAMERA = Camera(np.eye(4), 35, 36, 24, horizontal_offset_mm=3, vertical_offset_mm=-2, f_stop=2)


@pytest.mark.parametrize("window", [Window(10, 5, 120, 80), Window(-7, -9, 120, 80), Window(100, 70, 120, 80)])
def test_a_window_projects_as_the_whole_picture_does(window: Window) -> None:
    points = np.array([[0.1, 0.2, -3.0], [-1.0, 0.5, -2.0], [2.0, -1.0, -9.0]])
    whole, _ = PinholeView.from_camera(CAMERA, 120, 80).project(points)
    cut = Framing(window=window).apply(CAMERA, 40, 30)
    part, _ = PinholeView.from_camera(cut, 40, 30).project(points)
    np.testing.assert_allclose(part, whole - [window.left, window.top], atol=1e-9)


@pytest.mark.parametrize("window", [Window(10, 5, 120, 80), Window(-7, -9, 120, 80), Window(100, 70, 120, 80)])
def test_the_gate_of_a_window_gives_that_of_the_whole(window: Window) -> None:
    framing = Framing(window=window)
    camera, *size = framing.uncut(framing.apply(CAMERA, 40, 30), 40, 30)
    assert size == [120, 80]
    for name in (f"{axis}_{what}_mm" for axis in ("horizontal", "vertical") for what in ("aperture", "offset")):
        assert getattr(camera, name) == pytest.approx(getattr(CAMERA, name))
    assert WHOLE.uncut(CAMERA, 40, 30) == (CAMERA, 40, 30)


def test_the_shape_of_the_whole_picture_counts_pixels_by_their_shape() -> None:
    assert WHOLE.aspect(120, 80) == 1.5
    assert Framing(pixel_aspect=2.0).aspect(120, 80) == 3.0
    assert Framing(pixel_aspect=2.0, window=Window(0, 0, 100, 50)).aspect(10, 40) == 4.0


def test_a_window_does_not_change_the_glass() -> None:
    camera = replace(
        CAMERA, lens=Lens("prescription", prescription=PLANAR.prescription), focus_distance_m=3.0, focal_length_mm=50
    )
    whole, cut = mount_lens(camera), mount_lens(Framing(window=Window(10, 5, 120, 80)).apply(camera, 40, 30))
    assert whole is cut


def test_a_sharp_picture_is_a_pinholes() -> None:
    assert Framing(is_sharp=True).apply(CAMERA, 12, 8).f_stop == 0
    assert WHOLE.apply(CAMERA, 12, 8) is CAMERA
