"""The circle of confusion that is measured beside the picture, through lenses that have a table of rays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import spheres_over_checkerboard
from render.model.camera import Camera
from render.model.lens import Lens, SeidelErrors
from tests.render.kits.lenses import DOUBLE_GAUSS, PLANAR

WIDTH, HEIGHT = 96, 72
SETTINGS = FrameSettings(WIDTH, HEIGHT, rays=1, aovs=("color", "depth", "coc", "focus_depth"))
SCENE, CAMERA = spheres_over_checkerboard()


def growth_mm_m(renderer: FrameRenderer, camera: Camera) -> float:
    """Growth of the diameter of the circle of confusion with inverse depth, on the film in the middle of the picture."""
    aovs = renderer.render(SCENE, camera, SETTINGS).aovs
    middle = np.s_[HEIGHT // 2, WIDTH // 2]
    coc_px, depth_m, sharp_m = (float(aovs[name][middle]) for name in ("coc", "depth", "focus_depth"))
    return 2 * coc_px * camera.horizontal_aperture_mm / WIDTH / (1 / sharp_m - 1 / depth_m)


@pytest.mark.parametrize(
    "lens",
    [
        Lens(),
        Lens("seidel", seidel=SeidelErrors(w131=3.0, w220=-20.0, reference_f_stop=2.8, reference_height_mm=15.0)),
        Lens("prescription", prescription=DOUBLE_GAUSS.prescription),
        Lens("prescription", prescription=PLANAR.prescription),
    ],
    ids=["thin", "seidel", "double gauss", "planar"],
)
def test_it_grows_as_focal_length_and_f_number_say(renderer: FrameRenderer, lens: Lens) -> None:
    camera = replace(CAMERA, focal_length_mm=50.0, f_stop=4.0, focus_distance_m=3.0, lens=lens)
    assert growth_mm_m(renderer, camera) == pytest.approx(50**2 / 4.0 / 1000, rel=0.01)
