"""Lenses that bend the picture, anamorphic ones and fisheyes among them: bounds, measurements and places agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.lens_rays import lens_rays
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import spheres_over_checkerboard
from render.model.camera import Camera
from render.model.lens import IrisShape, Lens, SeidelErrors
from render.optics.distortion import ChiefRays, chief_rays
from render.optics.view import PinholeView
from render.trace.rays import make_ray_pattern
from tests.render.kits.lenses import FISHEYE

BARREL = SeidelErrors(w311=400.0, reference_f_stop=1.4, reference_height_mm=15.0)
ANAMORPHIC = Lens("seidel", seidel=BARREL, squeeze=2.0)


def test_rays_are_looked_for_where_an_anamorphic_lens_sends_them(renderer: FrameRenderer) -> None:
    """Its distortion is half as wide: pixels far from the axis look elsewhere than without the squeeze."""
    scene, camera = spheres_over_checkerboard()
    camera = replace(camera, lens=ANAMORPHIC, f_stop=5.6)
    view = PinholeView.from_camera(camera, 320, 240)
    renderer.render(scene, camera, FrameSettings(32, 24, rays=1))  # loads the scene
    pictures = [
        renderer.device.tracer.picture(
            renderer.device.peeler,
            camera,
            view,
            make_ray_pattern(32, IrisShape()),
            layers=4,
            supersample=2,
            bound_by_rays=by_rays,
        ).color
        for by_rays in (False, True)
    ]
    assert psnr_db(*pictures) > 60


@pytest.mark.parametrize("squeeze", [1.0, 1.33, 2.0])
def test_shown_and_seen_undo_each_other(squeeze: float) -> None:
    ideal = np.linspace(0, 1.5, 200)
    places = np.random.default_rng(3).uniform(-2, 2, (500, 2))
    for seen in (np.tan(ideal), np.arctan(ideal)):  # of a fisheye, and of a pincushion
        rays = ChiefRays(ideal, seen, squeeze)
        np.testing.assert_allclose(rays.distort_slopes(rays.undistort_slopes(places)), places, rtol=1e-9, atol=1e-9)
    assert np.isnan(rays.distort_slopes(np.array([[np.nan, np.nan]]))).all()
    np.testing.assert_array_equal(rays.distort_slopes(np.zeros((1, 2))), 0.0)


def test_chief_rays_are_those_of_the_reference() -> None:
    camera = Camera(np.eye(4), 50.0, 36.0, 27.0, f_stop=2.8, focus_distance_m=3.0, near_m=0.1, lens=ANAMORPHIC)
    places = np.array([[0.3, 0.0], [0.0, 0.2], [0.25, -0.2]])
    through = chief_rays(camera)
    assert through is not None
    reference = lens_rays(camera, np.zeros((1, 2)), (0.36, 0.27)).rays(0, places[None], 587.5618)
    np.testing.assert_allclose(
        through.undistort_slopes(places), reference.slopes[0], atol=5e-5
    )  # chief rays are interpolated


def test_a_fisheye_is_measured_however_far_it_sees(renderer: FrameRenderer) -> None:
    """Its chief rays lie almost across the axis at the edge of its image circle: no picture is as wide as that."""
    scene, camera = spheres_over_checkerboard()
    lens = Lens("prescription", prescription=FISHEYE.prescription)
    camera = replace(camera, lens=lens, focal_length_mm=9.99, f_stop=4.0)
    camera = replace(camera, horizontal_aperture_mm=36.0, vertical_aperture_mm=24.0)
    settings = FrameSettings(192, 128, rays=1, aovs=("color", "depth", "prim_id"))
    measured = renderer.render(scene, camera, settings).aovs["prim_id"]
    assert measured.shape == (128, 192)
    assert len(np.unique(measured[44:84, 66:126])) > 1
