"""The cos⁴ law in pictures: what the map adds to the rays of an ideal lens is what glass does by itself."""

from __future__ import annotations

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.lens import Glass, Lens, Prescription, SeidelErrors, Surface
from render.model.scene import Dome, Scene
from render.optics.photometry.illuminance import natural_vignetting
from render.optics.view import PinholeView

WHITE = Scene((), (), Dome((1.0, 1.0, 1.0), np.eye(4)), ())
SMALL = FrameSettings(96, 64, rays=64)
GLASS = Glass(1.5, 0.0)
FLAT = Prescription(
    (
        Surface(0.0, 1e-3, semi_diameter_mm=0.8, is_stop=True),
        Surface(28.0, 0.1, GLASS, 1.4),
        Surface(-28.0, 0.0, semi_diameter_mm=1.4),
    ),
    name="a lens that is nearly flat",
)


def wide(lens: Lens, f_stop: float) -> Camera:
    """65° across, corner to corner 75°."""
    return Camera(np.eye(4), 28.0, 36.0, 24.0, f_stop=f_stop, focus_distance_m=4.0, lens=lens)


def cos4(view: PinholeView) -> DoubleArray:
    """Return the fourth power of the cosine of each pixel's angle to the axis."""
    directions = np.array([[view.ray(x + 0.5, y + 0.5)[1] for x in range(view.width)] for y in range(view.height)])
    return np.asarray((directions[..., 2] / np.linalg.norm(directions, axis=-1)) ** 4)


def seen(renderer: FrameRenderer, camera: Camera) -> tuple[FloatArray, PinholeView]:
    picture = renderer.render(WHITE, camera, SMALL).color[..., :3]
    return picture, PinholeView.from_camera(camera, SMALL.width, SMALL.height)


@pytest.mark.gl
@pytest.mark.parametrize("lens", [Lens(), Lens("seidel", seidel=SeidelErrors())], ids=["thin", "seidel"])
def test_an_ideal_lens_with_the_map_falls_off_by_cos4_to_a_thousandth(renderer: FrameRenderer, lens: Lens) -> None:
    picture, view = seen(renderer, wide(lens, 2.8))
    exposed = picture * natural_vignetting(view)[..., None]
    np.testing.assert_allclose(exposed, np.repeat(cos4(view)[..., None], 3, axis=-1), rtol=1e-3)
    assert exposed.min() < 0.45


@pytest.mark.gl
def test_glass_as_thin_as_the_ideal_lens_falls_off_as_the_map_says(renderer: FrameRenderer) -> None:
    picture, view = seen(renderer, wide(Lens("prescription", FLAT.name, FLAT), 22.0))
    np.testing.assert_allclose(picture[..., 1], natural_vignetting(view), rtol=0.01)
