"""Metering: what a photocell behind a mask reads, and keys that place grey without flicker."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import InputError, SettingsError
from render.model.arrays import FloatArray
from render.optics.photometry.exposure import MIDDLE_GREY, ExposureSettings
from render.optics.photometry.metering import (
    MeterMode,
    Reading,
    meter,
    meter_weights,
    one_key,
    smoothed_keys,
    spot_radius_px,
)

SET = ExposureSettings(time_s=1 / 48, iso=800, f_stop=2.8)
MODES: tuple[MeterMode, ...] = ("spot", "center", "average")


def even(luminance: float, width: int = 60, height: int = 40) -> FloatArray:
    """A picture of one grey."""
    return np.full((height, width, 4), luminance, np.float32)


@pytest.mark.parametrize("mode", MODES)
def test_an_even_wall_reads_the_same_in_every_mode(mode: MeterMode) -> None:
    reading = meter(even(30), SET, mode, spot_px=(59.9, 0.1), spot_radius_px=3)
    assert reading.luminance_nits == pytest.approx(30, rel=1e-6)
    corrected = ExposureSettings(SET.time_s, SET.iso, SET.f_stop, reading.compensation_stops)
    assert 30 * corrected.scale == pytest.approx(MIDDLE_GREY, rel=1e-6)
    again = Reading(30, corrected)
    assert again.stops == pytest.approx(0, abs=1e-6)
    assert again.compensation_stops == pytest.approx(corrected.compensation_stops)


def test_a_reading_in_the_units_of_meters() -> None:
    sunlit_grey = Reading(0.125 * 2**15, ExposureSettings())
    assert sunlit_grey.ev100 == pytest.approx(15)
    assert sunlit_grey.incident_lux == pytest.approx(71_500, rel=0.01)  # which is what a sunny day has, nearly
    assert Reading(0.36, ExposureSettings()).stops == pytest.approx(1)
    black = Reading(0, SET)
    assert (black.ev100, black.stops) == (-math.inf, -math.inf)
    assert math.isnan(black.compensation_stops)


def test_a_lens_without_light_is_read_as_black() -> None:
    dimmed, dark = Reading(0.36, ExposureSettings(), 0.5), Reading(0.36, ExposureSettings(), 0.0)
    assert (dimmed.stops, dimmed.compensation_stops) == (pytest.approx(0), pytest.approx(0))
    assert dark.ev100 == dimmed.ev100  # the scene is lit all the same
    assert dark.stops == -math.inf
    assert math.isnan(dark.compensation_stops)


def test_the_spot_sees_what_is_under_it_alone() -> None:
    picture = even(1)
    picture[18:23, 28:33] = 64
    assert meter(picture, SET, "spot", spot_px=(30.5, 20.5), spot_radius_px=2).luminance_nits == pytest.approx(64)
    assert meter(picture, SET, "spot", spot_px=(10, 10), spot_radius_px=5).luminance_nits == pytest.approx(1)
    by_average = meter(picture, SET, "average").luminance_nits
    assert by_average == pytest.approx(1 + 63 * 25 / 2400)
    assert by_average < meter(picture, SET, "center").luminance_nits < 64


def test_three_quarters_of_the_centre_meter_is_a_third_of_the_width() -> None:
    weights = meter_weights("center", 360, 240)
    y, x = np.mgrid[:240, :360] + 0.5
    assert weights[np.hypot(x - 180, y - 120) < 60].sum() == pytest.approx(0.75, abs=0.01)
    assert weights.sum() == pytest.approx(1)


@given(st.floats(0, 60), st.floats(0, 40), st.floats(0, 30))
def test_a_spot_anywhere_in_the_picture_reads_something(x: float, y: float, radius: float) -> None:
    weights = meter_weights("spot", 60, 40, spot_px=(x, y), spot_radius_px=radius)
    assert weights.sum() == pytest.approx(1)
    assert (weights >= 0).all()


def test_a_spot_that_moves_reads_without_jumps() -> None:
    picture = even(1)
    picture[:, 30:] = 2
    read = [
        meter(picture, SET, "spot", spot_px=(x, 20), spot_radius_px=4).luminance_nits for x in np.arange(20, 40, 0.05)
    ]
    assert (np.diff(read) > -1e-9).all()
    assert np.diff(read).max() < 0.02


def test_a_spot_meter_s_field_is_a_degree() -> None:
    assert 2 * math.degrees(math.atan(spot_radius_px(2000) / 2000)) == pytest.approx(1)


def test_colours_count_as_bright_as_they_are() -> None:
    picture = even(0)
    picture[..., 1] = 10
    assert meter(picture, SET, "average", luminance_of_rgb=(0.2126, 0.7152, 0.0722)).luminance_nits == pytest.approx(
        7.152
    )


def test_broken_pixels_do_not_blind_the_meter() -> None:
    picture = even(5)
    picture[0, 0], picture[1, 1], picture[2, 2] = np.nan, np.inf, -1e30
    read = meter(picture, SET, "average").luminance_nits
    assert read == pytest.approx((5 * 2397 + 65504) / 2400, rel=1e-5)


def test_one_key_is_in_the_middle_of_what_the_frames_want() -> None:
    assert one_key([1, -1, math.nan, 3]) == pytest.approx(1)


def test_a_flickering_lamp_makes_no_flicker() -> None:
    times = np.arange(96) / 24
    wanted = 2 + np.where(np.arange(96) % 2, 1.0, -1.0)
    keys = smoothed_keys(times, wanted, 1.0)
    assert np.abs(keys[18:-18] - 2).max() < 1e-3
    assert np.abs(keys - 2).max() < 0.1  # at the ends of the shot half the bell is missing


@given(st.lists(st.floats(-8, 8), min_size=2, max_size=60), st.floats(0.05, 5))
def test_keys_stay_within_the_given_values_and_change_slowly(wanted: list[float], smoothing_s: float) -> None:
    times = np.arange(len(wanted)) / 24
    keys = smoothed_keys(times, wanted, smoothing_s)
    spread = max(wanted) - min(wanted)
    assert keys.min() >= min(wanted) - 1e-9
    assert keys.max() <= max(wanted) + 1e-9
    fastest = spread / (smoothing_s / 4 * math.sqrt(2 * math.pi))
    assert np.abs(np.diff(keys)).max() * 24 <= fastest * 1.01 + 1e-9


def test_a_sudden_change_is_spread_evenly_over_the_smoothing_time() -> None:
    times = np.arange(201) / 50
    keys = smoothed_keys(times, np.where(times < 1.99, 0.0, 4.0), 1.0)
    assert keys[99:101].mean() == pytest.approx(2, abs=0.1)
    assert (keys[75] / 4, keys[125] / 4) == pytest.approx((0.025, 0.975), abs=0.005)
    assert (np.diff(keys) >= -1e-12).all()


def test_black_frames_are_bridged_and_uneven_frames_count_by_time() -> None:
    dark = [1.0, 1.0, math.nan, math.nan, 1.0]
    np.testing.assert_allclose(smoothed_keys(np.arange(5) / 24, dark, 0.2), 1)
    # one second of 0, metered often, and one second of 4, metered seldom
    times = np.concatenate([np.arange(-100, 0) / 100, np.arange(0, 11) / 10])
    assert smoothed_keys(times, np.where(times < 0, 0.0, 4.0), 1.0)[100] == pytest.approx(2, abs=0.3)
    assert smoothed_keys([0], [3], 1) == pytest.approx([3])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([0, 1], [1, 2], 0), "smoothing time of metering must be above 0 s, got 0"),
        (([1, 0], [1, 2], 1), "at rising times"),
        (([0, 1, 2], [1, 2], 1), "one for each"),
    ],
)
def test_impossible_keys_are_refused(arguments: tuple[list[float], list[float], float], words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        smoothed_keys(*arguments)


def test_a_black_shot_cannot_be_metered() -> None:
    for keys in (lambda: one_key([math.nan]), lambda: smoothed_keys([0, 1], [math.nan] * 2, 1)):
        with pytest.raises(InputError, match="every frame is black where the meter looks"):
            keys()


def test_a_meter_that_looks_nowhere_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"in the picture of 60 x 40 pixels, and is at 61, 3"):
        meter(even(1), SET, "spot", spot_px=(61, 3))
    with pytest.raises(SettingsError, match="and is at nowhere"):
        meter(even(1), SET, "spot")
    with pytest.raises(SettingsError, match="one of spot, center, average, got matrix"):
        meter(even(1), SET, "matrix")  # type: ignore[arg-type]
    with pytest.raises(SettingsError, match=r"got \(40, 60\)"):
        meter(even(1)[..., 0], SET, "average")
