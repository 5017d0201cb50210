"""Exposure and the display transform: their effect on light."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from render.errors import SettingsError
from render.film import Grade, develop, list_displays

UNTONED = Grade(view="Un-tone-mapped")


def grey(*levels: float) -> np.ndarray:
    """A picture one pixel high with a neutral pixel for each level."""
    return np.repeat(np.array(levels, np.float32), 3).reshape(1, -1, 3)


def srgb_encoded(linear: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(linear, 1 / 2.4) - 0.055)


def test_without_tone_mapping_neutral_light_is_encoded_as_srgb() -> None:
    linear = np.array([0.0, 0.001, 0.01, 0.18, 0.5, 1.0])

    picture = develop(grey(*linear), 1.0, UNTONED)

    # The built-in configuration's matrices are written with about 7 digits.
    np.testing.assert_allclose(picture[0, :, 1], srgb_encoded(linear), atol=2e-5)


def test_exposure_multiplies_light() -> None:
    light = np.random.default_rng(0).uniform(0, 4, (7, 5, 3)).astype(np.float32)

    np.testing.assert_array_equal(develop(light, 2.0, Grade()), develop(light * 2, 1.0, Grade()))


@given(st.lists(st.floats(0, 1e6, width=32), min_size=2, max_size=2).map(sorted))
@settings(max_examples=40)
def test_more_light_is_never_darker_and_stays_on_the_display(levels: list[float]) -> None:
    darker, brighter = develop(grey(*levels), 1.0, Grade())[0, :, 1]

    assert 0 <= darker <= brighter + 1e-5 <= 1 + 2e-5


def test_grey_stays_grey() -> None:
    picture = develop(grey(0.01, 0.18, 1.0, 10.0), 1.0, Grade())

    assert np.ptp(picture, axis=-1).max() < 1e-4


def test_broken_light_does_not_break_the_picture() -> None:
    light = grey(np.nan, np.inf, 1e30, 65504.0, 0.18)
    light[0, 4] = [-np.inf, 0.5, np.nan]

    picture = develop(light, 1.0, Grade())

    assert np.isfinite(picture).all()
    assert picture.min() >= 0
    assert picture.max() <= 1
    assert (picture[0, 0] == 0).all(), "light that is no number counts as none"
    np.testing.assert_array_equal(picture[0, 1], picture[0, 3])
    np.testing.assert_array_equal(picture[0, 2], picture[0, 3])


def test_a_pixel_does_not_depend_on_the_pixels_around_it() -> None:
    light = np.random.default_rng(1).uniform(0, 3, (150, 6, 3)).astype(np.float32)

    whole = develop(light, 1.0, Grade())
    rows = [develop(light[i : i + 1], 1.0, Grade()) for i in range(len(light))]

    np.testing.assert_array_equal(whole, np.concatenate(rows))


def test_the_light_itself_is_left_alone_and_alpha_is_not_graded() -> None:
    light = np.random.default_rng(2).uniform(0, 1, (4, 4, 4)).astype(np.float32)
    before = light.copy()

    picture = develop(light, 0.5, Grade())

    np.testing.assert_array_equal(light, before)
    np.testing.assert_array_equal(picture, develop(before[..., :3], 0.5, Grade()))


def test_a_look_changes_what_it_is_for_and_nothing_else() -> None:
    compressed = Grade(look="ACES 1.3 Reference Gamut Compression")
    neutral, saturated = grey(0.18), np.array([[[0.9, -0.1, -0.2]]], np.float32)

    np.testing.assert_allclose(develop(neutral, 1.0, compressed), develop(neutral, 1.0, Grade()), atol=1e-4)
    assert np.abs(develop(saturated, 1.0, compressed) - develop(saturated, 1.0, Grade())).max() > 0.01


def test_the_default_grade_names_what_it_is() -> None:
    assert Grade().working_space == "ACEScg"
    assert Grade().working_space_id == "lin_ap1_scene"
    assert Grade().picture_space_id == "srgb_rec709_display"
    assert Grade(display="Display P3 - Display").picture_space_id == "srgb_p3d65_display"
    assert Grade().view_name in list_displays()[Grade().display_name]


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        ({"display": "nope"}, "unknown display 'nope': expected one of 'sRGB - Display', "),
        ({"view": "nope"}, "unknown view 'nope' of display 'sRGB - Display': expected one of 'ACES 2.0 - SDR"),
        ({"look": "nope"}, "unknown look 'nope': expected one of 'ACES 1.3 Reference Gamut Compression'"),
        ({"config": "/no/such/config.ocio"}, "cannot read the OpenColorIO configuration /no/such/config.ocio: "),
        ({"config": "ocio://nope"}, "cannot read the OpenColorIO configuration ocio://nope: "),
    ],
)
def test_an_unknown_name_is_refused_with_the_names_that_exist(setting: dict[str, str], expected: str) -> None:
    with pytest.raises(SettingsError) as caught:
        Grade(**setting)

    assert str(caught.value).startswith(expected)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("scale", [float("nan"), float("inf"), -1.0])
def test_an_impossible_exposure_is_refused(scale: float) -> None:
    with pytest.raises(SettingsError, match="exposure scale must be a finite number from 0 up"):
        develop(grey(0.18), scale, Grade())


def test_the_environment_names_the_configuration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OCIO", "ocio://studio-config-v5.0.0_aces-v2.1_ocio-v2.6")

    assert len(list_displays()) > len(list_displays("ocio://default"))

    broken = tmp_path / "broken.ocio"
    broken.write_text("not: a config\n  at all")
    monkeypatch.setenv("OCIO", str(broken))
    with pytest.raises(SettingsError, match="cannot read the OpenColorIO configuration"):
        Grade()
