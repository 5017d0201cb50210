"""Photometry: stops are stops, USD's exposure is ours, and the light on the film is what geometry makes it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pxr import Usd, UsdGeom

from render.errors import SettingsError
from render.model.camera import Camera
from render.optics.photometry.exposure import (
    ExposureSettings,
    equivalent,
    nd_transmittance,
    shutter_angle_rad,
    shutter_time_s,
    stops_of_density,
)
from render.optics.photometry.illuminance import (
    LightPath,
    illuminance_lux,
    light_path,
    magnification,
    natural_vignetting,
)
from render.optics.prescription.mounting import mount_lens
from render.optics.view import PinholeView
from render.shot.lens.lens_alone import lens_alone

SET = ExposureSettings(time_s=1 / 50, iso=400, f_stop=2.8, compensation_stops=0.5, responsivity=1.3)
POSITIVE = st.floats(1e-3, 1e4)
SETTINGS = st.builds(ExposureSettings, POSITIVE, POSITIVE, st.floats(0.5, 64), st.floats(-20, 20), st.floats(0.01, 100))


@given(SETTINGS)
def test_the_scale_is_usd_s_own(settings: ExposureSettings) -> None:
    stage = Usd.Stage.CreateInMemory()
    camera = UsdGeom.Camera.Define(stage, "/cam")
    attributes = {
        "time_s": camera.GetExposureTimeAttr(),
        "iso": camera.GetExposureIsoAttr(),
        "f_stop": camera.GetExposureFStopAttr(),
        "compensation_stops": camera.GetExposureAttr(),
        "responsivity": camera.GetExposureResponsivityAttr(),
    }
    for name, attribute in attributes.items():
        attribute.Set(getattr(settings, name))
    kept = ExposureSettings(**{name: attribute.Get() for name, attribute in attributes.items()})  # single floats
    assert kept.scale == pytest.approx(camera.ComputeLinearExposureScale(Usd.TimeCode.Default()), rel=1e-6)


def test_what_usd_says_by_itself_changes_nothing() -> None:
    stage = Usd.Stage.CreateInMemory()
    assert (
        ExposureSettings().scale
        == UsdGeom.Camera.Define(stage, "/cam").ComputeLinearExposureScale(Usd.TimeCode(0))
        == 1
    )


@pytest.mark.parametrize(
    "brighter",
    [
        replace(SET, time_s=2 * SET.time_s),
        replace(SET, iso=2 * SET.iso),
        replace(SET, f_stop=SET.f_stop / math.sqrt(2)),
        replace(SET, compensation_stops=SET.compensation_stops + 1),
    ],
)
def test_a_stop_is_twice_the_light(brighter: ExposureSettings) -> None:
    assert brighter.scale / SET.scale == pytest.approx(2, rel=1e-12)


@given(SETTINGS, st.floats(0.5, 64), st.floats(1e-3, 1e3))
def test_equivalent_exposures_give_the_same_picture(settings: ExposureSettings, f_stop: float, time_s: float) -> None:
    for solve, changes in (
        ("time", {"f_stop": f_stop}),
        ("iso", {"f_stop": f_stop, "time_s": time_s}),
        ("f_stop", {"time_s": time_s}),
        ("compensation", {"f_stop": f_stop, "time_s": time_s}),
    ):
        found = equivalent(settings, solve, **changes)  # type: ignore[arg-type]
        assert found.scale == pytest.approx(settings.scale, rel=1e-9)
        assert all(getattr(found, name) == value for name, value in changes.items())


def test_sunny_sixteen() -> None:
    """Full sun at noon is EV 15: f/16 and the reciprocal of the ISO; and 1/250 at f/11 is nearly the same."""
    sunny = ExposureSettings(time_s=1 / 100, iso=100, f_stop=16)
    assert sunny.ev100 == pytest.approx(14.64, abs=0.01)
    assert equivalent(sunny, "time", f_stop=11).time_s == pytest.approx(1 / 212, rel=0.01)


@given(SETTINGS, st.floats(1e-3, 1e6))
def test_usd_s_exposure_is_the_exposure_of_the_film(settings: ExposureSettings, luminance: float) -> None:
    """The equation of the light on the film, times the time, becomes the value that USD's scale gives."""
    lux_seconds = illuminance_lux(luminance, LightPath(settings.f_stop)) * settings.time_s
    assert settings.value(lux_seconds) == pytest.approx(luminance * settings.scale, rel=1e-12)


def test_a_sensor_of_saturation_based_speed_clips_at_one() -> None:
    assert ExposureSettings(iso=200).value(78 / 200) == pytest.approx(1, rel=0.01)


def test_each_term_of_the_light_on_the_film() -> None:
    plain = float(illuminance_lux(1000, LightPath(2)))
    assert plain == pytest.approx(1000 * math.pi / 16)
    assert illuminance_lux(1000, LightPath(4)) == pytest.approx(plain / 4)
    assert illuminance_lux(1000, LightPath(2, transmittance=0.8)) == pytest.approx(0.8 * plain)
    assert illuminance_lux(1000, LightPath(2, magnification=1)) == pytest.approx(plain / 4)
    assert illuminance_lux(1000, LightPath(2, magnification=1, pupil_magnification=0.5)) == pytest.approx(plain / 9)
    assert illuminance_lux(1000, LightPath(2), vignetting=0.5) == pytest.approx(plain / 2)
    assert illuminance_lux([500, 1000], LightPath(2), cos_theta=[1, 0.5]) == pytest.approx([plain / 2, plain / 16])


def test_a_lens_that_is_brighter_than_all_light_is_none() -> None:
    """At f/0.5 the film is as bright as a surface that the scene's own light falls on from everywhere: E = π·L."""
    assert illuminance_lux(1, LightPath(0.5)) == pytest.approx(math.pi)


@pytest.mark.parametrize("height_mm", [0, 6, 12, 18, 21.6])
@pytest.mark.parametrize("distance_m", [0.12, 0.5, math.inf])
def test_the_light_on_the_film_is_that_of_a_shining_pupil(height_mm: float, distance_m: float) -> None:
    """Against the light that a disc of the lens's size sends to a point of the film, summed up over the disc."""
    focal_mm, f_stop = 40.0, 32.0
    m = magnification(focal_mm, distance_m)
    radius, film = focal_mm / (2 * f_stop), focal_mm * (1 + m)
    r = (np.arange(64) + 0.5) / 64 * radius
    turn = np.arange(64) / 64 * 2 * np.pi
    squared = film**2 + (r * np.cos(turn[:, None]) - height_mm) ** 2 + (r * np.sin(turn[:, None])) ** 2
    summed = (film**2 / squared**2 * r).sum() * (radius / 64) * (2 * np.pi / 64)
    cosine = math.cos(math.atan(height_mm / film))
    assert illuminance_lux(1, LightPath(f_stop, magnification=m), cos_theta=cosine) == pytest.approx(summed, rel=1e-3)


@pytest.mark.parametrize("breathing", [False, True])
def test_the_picture_falls_off_by_cos4_over_the_field(breathing: bool) -> None:
    """At every pixel's own direction, as the projection has it, of a shifted wide lens."""
    camera = Camera(
        np.eye(4), focal_length_mm=18, vertical_offset_mm=5, f_stop=8, focus_distance_m=0.3, breathing=breathing
    )
    view = PinholeView.from_camera(camera, 64, 36)
    map_ = natural_vignetting(view)
    assert (map_.shape, map_.dtype) == ((36, 64), np.float32)
    for column, row in ((0, 0), (63, 0), (10, 30), (32, 18), (63, 35)):
        origin, direction = view.ray(column + 0.5, row + 0.5)
        cosine = -direction[2] / np.linalg.norm(direction)
        [[x, y]], _ = view.project((origin + 3 * direction)[None])
        assert (x, y) == pytest.approx((column + 0.5, row + 0.5))
        assert map_[row, column] == pytest.approx(cosine**4, rel=1e-5)
    assert map_.min() < 0.5
    np.testing.assert_allclose(natural_vignetting(view, 0.5) ** 2, map_, rtol=1e-5)


def test_t_stops_filters_and_shutters_are_read_as_they_are_marked() -> None:
    assert LightPath(2, (2 / 2.3) ** 2).t_stop == pytest.approx(2.3)
    assert LightPath(2, 0.5, 1).effective_t_stop == pytest.approx(4 * math.sqrt(2))
    assert LightPath(2, 0).t_stop == math.inf
    assert nd_transmittance(0.6) == pytest.approx(0.25, rel=0.01)
    assert stops_of_density(0.9) == pytest.approx(3, rel=0.01)
    assert shutter_time_s(math.pi, 24) == pytest.approx(1 / 48)
    assert shutter_angle_rad(shutter_time_s(3, 25), 25) == pytest.approx(3)


def test_magnification_counts_from_the_entrance_pupil() -> None:
    assert magnification(50, math.inf) == magnification(50, 0) == 0
    assert magnification(50, 0.1) == pytest.approx(1)  # twice the focal length: life size
    # P = 2: the entrance pupil lies 25 mm before the principal plane, so the object is 75 mm beyond the front focus
    assert magnification(50, 0.1, 2) == pytest.approx(50 / 75)
    with pytest.raises(SettingsError, match=r"50 mm forms no image of what is 0.05 m"):
        magnification(50, 0.05)


@pytest.mark.parametrize("lens", ["double_gauss_50", "telephoto_250", "wide_22"])
@pytest.mark.parametrize("distance_m", [1.5, 4.0, math.inf])
def test_real_glass_is_as_bright_as_its_cone_of_light_is_wide(lens: str, distance_m: float) -> None:
    """``N·(1 + m/P)`` is ``1 / (2·sin u′)``, but for what the lens departs from the sine condition."""
    camera = replace(lens_alone(lens).camera, f_stop=8.0, focus_distance_m=distance_m, breathing=True)
    glass = mount_lens(camera)
    assert light_path(camera).effective_f_stop == pytest.approx(glass.working_f_stop, rel=0.01)
    still = light_path(replace(camera, breathing=False))
    assert (still.bellows_factor, still.f_stop) == (1, pytest.approx(8))


def test_a_thin_lens_that_breathes_loses_light_close_by() -> None:
    camera = Camera(np.eye(4), focal_length_mm=50, f_stop=4, focus_distance_m=0.1)
    assert light_path(camera).bellows_factor == 1
    assert light_path(replace(camera, breathing=True)).bellows_factor == pytest.approx(4)
    with pytest.raises(SettingsError, match="f-number of a lens must be a positive number, got 0"):
        light_path(replace(camera, f_stop=0))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"time_s": 0}, "exposure time in seconds must be a positive number, got 0"),
        ({"iso": -100}, "ISO must be a positive number, got -100"),
        ({"f_stop": math.nan}, "f-number of the exposure must be a positive number, got nan"),
        ({"responsivity": math.inf}, "responsivity must be a positive number, got inf"),
        ({"compensation_stops": 1e9}, "from -100 to 100 stops, got 1e\\+09"),
    ],
)
def test_impossible_exposures_are_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        replace(SET, **changes)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: LightPath(2, 1.5), "transmittance must be from 0 to 1, got 1.5"),
        (lambda: LightPath(2, 1, -1), "magnification must be 0 or more, got -1"),
        (lambda: LightPath(2, 1, 1, 0), "pupil magnification must be a positive number, got 0"),
        (lambda: nd_transmittance(-0.3), "density of a filter must be 0 or more, got -0.3"),
        (lambda: shutter_time_s(7, 24), "up to 360°, got 401"),
        (lambda: shutter_time_s(3, 0), "frame rate must be a positive number, got 0"),
        (lambda: equivalent(SET, "iso", iso=100), "solved for iso, so it cannot be set to 100 too"),
        (lambda: equivalent(SET, "aperture"), "solved for time, iso, f_stop or compensation, got aperture"),  # type: ignore[arg-type]
    ],
)
def test_impossible_light_is_refused(make: Any, words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        make()
