"""The focus law: samples taken once against the lens set to each distance."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from render.errors import SettingsError
from render.model.camera import Camera
from render.model.lens import Lens
from render.model.lens_law import LensLaw
from render.optics.depth_of_field import coc_slope_mm_m
from render.optics.focus_law import focus_law, focus_laws, ring_scale
from render.optics.prescription.mounting import distance_from_film_m, mount_lens
from tests.render.kits.lenses import PLANAR, SIX_LENSES, KnownLens

TO_FIRST_ORDER = (
    5e-3  # the law is of light near the axis; lenses are set to where the spot of their whole pupil is least
)
NAMES = [lens.prescription.name for lens in SIX_LENSES]


def camera_with(lens: KnownLens, focal_mm: float = 50.0, **changes: object) -> Camera:
    glass = Lens("prescription", prescription=lens.prescription)
    stopped = 2 * lens.f_stop
    return replace(Camera(np.eye(4), focal_length_mm=focal_mm, f_stop=stopped, lens=glass), **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("breathing", [False, True])
@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_the_law_of_glass_is_that_of_the_lens_set_to_each_distance(lens: KnownLens, breathing: bool) -> None:
    camera = camera_with(lens, breathing=breathing)
    law = focus_law(camera)
    for distance_m in (math.inf, 20.0, 2.0, 0.7):
        glass = mount_lens(replace(camera, focus_distance_m=distance_m))
        scale_mm = glass.image_scale_mm if breathing else camera.focal_length_mm
        slope = scale_mm * 2 * glass.entrance_pupil_radius_mm / 1000
        assert law.coc_slope_mm_m([1 / distance_m])[0] == pytest.approx(slope, rel=TO_FIRST_ORDER)
        assert law.pupil_radius_mm([1 / distance_m])[0] == pytest.approx(
            glass.entrance_pupil_radius_mm, rel=TO_FIRST_ORDER
        )
        assert law.f_stops[0] == pytest.approx(glass.f_stop)


@pytest.mark.parametrize("group", [None, (6, 10)])
def test_the_law_ends_where_the_lens_does(group: tuple[int, int] | None) -> None:
    moving = replace(PLANAR.prescription, focus_group=group)
    camera = camera_with(replace(PLANAR, prescription=moving), 80.0)
    nearest_w = float(focus_law(camera).near_w[0])
    mount_lens(replace(camera, focus_distance_m=1.02 / nearest_w))
    if group is not None:
        with pytest.raises(SettingsError):
            mount_lens(replace(camera, focus_distance_m=0.97 / nearest_w))


@pytest.mark.parametrize("model", ["thin", "prescription"])
@pytest.mark.parametrize("marked_m", [0.4, 0.9])
def test_what_is_engraved_is_measured_from_the_film(model: str, marked_m: float) -> None:
    camera = camera_with(PLANAR, 82.5)
    lens = replace(camera.lens, model=model, close_focus_m=marked_m)  # type: ignore[arg-type]
    camera = replace(camera, lens=lens)
    nearest_m = 1 / float(focus_law(camera).near_w[0])
    assert distance_from_film_m(replace(camera, focus_distance_m=nearest_m)) == pytest.approx(marked_m, rel=1e-3)


def test_a_mark_nearer_than_life_size_is_taken_for_life_size() -> None:
    camera = Camera(np.eye(4), focal_length_mm=50.0, f_stop=2.0, lens=Lens(close_focus_m=0.1))
    assert focus_law(camera).near_w[0] == pytest.approx(1 / 0.1)


@pytest.mark.parametrize("model", ["thin", "prescription"])
@pytest.mark.parametrize("marked_m", [0.0, 0.9])
def test_the_scale_of_the_ring_is_from_pupil_and_film(model: str, marked_m: float) -> None:
    camera = camera_with(PLANAR, 82.5)
    camera = replace(camera, lens=replace(camera.lens, model=model, close_focus_m=marked_m))  # type: ignore[arg-type]
    scale = ring_scale(camera)
    from_film_m = scale.close_focus_m + scale.to_film_mm[1] / 1000
    assert distance_from_film_m(replace(camera, focus_distance_m=scale.close_focus_m)) == pytest.approx(
        from_film_m, rel=1e-3
    )
    assert distance_from_film_m(replace(camera, focus_distance_m=5000.0)) == pytest.approx(
        5000.0 + scale.to_film_mm[0] / 1000, rel=1e-6
    )
    assert (
        from_film_m == pytest.approx(marked_m, rel=1e-3) if marked_m else scale.close_focus_m == pytest.approx(0.9075)
    )


@pytest.mark.parametrize("breathing", [False, True])
def test_the_law_of_a_thin_lens_is_the_one_of_depth_of_field(breathing: bool) -> None:
    camera = Camera(np.eye(4), focal_length_mm=85.0, f_stop=1.4, breathing=breathing)
    law = focus_law(camera)
    for distance_m in (math.inf, 10.0, 1.0, 0.2):
        expected = coc_slope_mm_m(85.0, 1.4, distance_m, breathing=breathing)
        assert law.coc_slope_mm_m([1 / distance_m])[0] == pytest.approx(expected, rel=1e-9)
    assert law.at_stops(2.8).coc_slope_mm_m([0.0])[0] == pytest.approx(law.coc_slope_mm_m([0.0])[0] / 2)
    assert law.at_stops(0.0).coc_slope_mm_m([0.5])[0] == 0


def test_a_zoom_is_looked_at_once_for_many_focal_lengths() -> None:
    """Focal lengths close to each other share a lens, scaled; each has the law that it would have by itself."""
    cameras = [camera_with(PLANAR, focal_mm) for focal_mm in (50.0, 50.4, 35.0)]
    laws = focus_laws([*cameras, Camera(np.eye(4), f_stop=4.0)])
    assert laws.frames == 4
    for i, camera in enumerate(cameras):
        glass = mount_lens(replace(camera, focus_distance_m=0.8))
        slope = camera.focal_length_mm * 2 * glass.entrance_pupil_radius_mm / 1000
        assert laws.coc_slope_mm_m(np.full(4, 1.25))[i] == pytest.approx(slope, rel=TO_FIRST_ORDER)
    assert laws.coc_slope_mm_m(np.full(4, 1.25))[3] == pytest.approx(coc_slope_mm_m(50.0, 4.0))


def test_a_law_that_is_none_is_refused() -> None:
    even, one = np.ones((1, 3)), np.ones(1)
    with pytest.raises(SettingsError, match="above 0"):
        LensLaw(0 * even, even, one, one, 0 * one, one)
    with pytest.raises(SettingsError, match="far limit"):
        LensLaw(even, even, one, one, one, one)
    with pytest.raises(SettingsError, match="as many as its frames"):
        LensLaw(even, even[:, :2], one, one, 0 * one, one)
    with pytest.raises(SettingsError, match="f-numbers"):
        LensLaw(even, even, -one, one, 0 * one, one)


@pytest.mark.parametrize("lens", [None, PLANAR], ids=["thin", "glass"])
def test_circles_may_grow_with_the_image_distance_alone(lens: KnownLens | None) -> None:
    """Kyaw 2013, equation 5.3, with v / (N'P) for the pupil's diameter A: ``v²|S − u| / (u·S·N'·P) = v·A·|1/u − 1/S|``."""
    camera = Camera(np.eye(4), focal_length_mm=50.0, f_stop=2.0) if lens is None else camera_with(lens)
    by_image = focus_law(replace(camera, circles_by_image_distance=True))
    breathing, plain = focus_law(replace(camera, breathing=True)), focus_law(camera)
    near_w = np.array([1.0])
    assert by_image.coc_slope_mm_m(near_w) == pytest.approx(breathing.coc_slope_mm_m(near_w))
    assert by_image.coc_slope_mm_m(near_w)[0] > 1.02 * plain.coc_slope_mm_m(near_w)[0]
    if lens is None:
        v_mm, a_mm, s_mm, u_mm = 1000 / 19, 25.0, 2000.0, 1000.0
        assert by_image.coc_slope_mm_m(near_w)[0] * 0.5 == pytest.approx(
            v_mm**2 * (s_mm - u_mm) / (u_mm * s_mm * (v_mm / a_mm))
        )
