"""The lens engine against pictures made ray by ray: every ray through the glass in float64, to the scene's own triangles.

At least 40 dB. What is left is what the layers hold of a scene, as against the accumulation buffer; the scene is unlit, since
the slow picture does not shade. The prescription covers a small gate, where its rims clip little: of 32 rays in one pattern for
all pixels, how many a rim blocks is a matter of chance, which shifts the slow picture's brightness; the engine knows how much
light comes through.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.ray_by_ray import ray_by_ray_picture
from render.lab.reference.scenes import posts_before_wall
from render.model.lens import Glass, Lens, Prescription, SeidelErrors, Surface
from tests.render.kits.lenses import WIDE

SINGLET = Prescription(
    (
        Surface(0.0, 2.0, is_stop=True),
        Surface(51.0, 6.0, Glass(1.5168, 64.17), 14.0),
        Surface(-51.0, 0.0, semi_diameter_mm=14.0),
    ),
    f_stop=2.8,
    name="singlet",
)
WIDTH, HEIGHT = 80, 60


@pytest.mark.parametrize(
    ("lens", "focal_length_mm", "f_stop", "rays"),
    [
        (Lens("spherical", prescription=SINGLET), 50.0, 2.8, 32),
        (Lens("prescription", prescription=WIDE.prescription), 22.0, 2.9, 32),
        (Lens("seidel", seidel=SeidelErrors(w040=4, w131=4, w222=3, reference_f_stop=2.0)), 50.0, 2.0, 32),
    ],
    ids=["spherical", "prescription", "seidel"],
)
def test_the_engine_agrees_with_every_ray_on_its_own(
    renderer: FrameRenderer, lens: Lens, focal_length_mm: float, f_stop: float, rays: int
) -> None:
    scene, camera = posts_before_wall()
    camera = replace(camera, lens=lens, focal_length_mm=focal_length_mm, f_stop=f_stop)
    gate_mm = 12.0 if lens.model != "prescription" else 4.0
    camera = replace(camera, horizontal_aperture_mm=gate_mm, vertical_aperture_mm=0.75 * gate_mm)
    slow = ray_by_ray_picture(scene, camera, width=WIDTH, height=HEIGHT, rays=rays)
    settings = FrameSettings(WIDTH, HEIGHT, rays=rays, layers=8, supersample=4, shading="unlit", tiled=False)
    fast = renderer.render(scene, camera, settings).color
    assert psnr_db(fast, slow) >= 40
