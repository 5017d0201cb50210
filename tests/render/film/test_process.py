"""From exposed light to the print: where grey lands, what a stop and a push do, and what stays as it was."""

from __future__ import annotations

import numpy as np
import PyOpenColorIO as ocio
import pytest

from render.colour import rgb_to_working, working_config
from render.errors import SettingsError
from render.film.balance import balance_gains
from render.film.grade import Grade
from render.film.print_space import print_space
from render.film.process import densities, develop_on_film, print_densities
from render.film.settings import FilmSettings, film_settings
from render.model.arrays import FloatArray
from usd_schemas import FilmData, Grain, Halation, library_films

CAMERA = [film.name for film in library_films() if film.kind == "camera"]
NEGATIVES = [film.name for film in library_films() if film.kind == "camera" and film.film.process != "reversal"]
GATE = (24.9, 14.0)


def flat(*levels: float) -> FloatArray:
    """A row of greys."""
    return np.repeat(np.array(levels, np.float32)[None, :, None], 3, axis=2)


def shown(light: FloatArray, film: FilmSettings) -> FloatArray:
    return develop_on_film(light, film, frame=1, gate_mm=GATE)


@pytest.mark.parametrize("name", NEGATIVES)
def test_metered_grey_is_a_tenth_of_clear_on_a_print(name: str) -> None:
    film = film_settings(FilmData(), name=name)
    assert film.print_stock is not None
    printed = print_densities(densities(flat(0.18), film), film)[0, 0]
    assert printed == pytest.approx([base + 1.0 for base in film.print_stock.base], abs=0.001)
    assert shown(flat(0.18), film)[0, 0] == pytest.approx([0.1, 0.1, 0.1], rel=0.002)


@pytest.mark.parametrize("name", CAMERA)
def test_more_light_is_never_darker_and_clear_film_is_white(name: str) -> None:
    film = film_settings(FilmData(), name=name)
    light = shown(flat(*(0.18 * 2.0 ** np.linspace(-10, 12, 89))), film)[0]
    assert (np.diff(light, axis=0) >= 0).all()
    assert light.min() > 0
    assert light.max() <= 1.0
    assert light[0].max() < 0.01


@pytest.mark.parametrize("name", ["vision3_500t_5219", "ektachrome_100d", "tri_x_400"])
@pytest.mark.parametrize("push", [1.0, -1.0, 0.5])
def test_a_push_is_so_many_stops_along_the_curve(name: str, push: float) -> None:
    as_made, pushed = (film_settings(FilmData(push=stops), name=name) for stops in (0.0, push))
    levels = 0.18 * 2.0 ** np.linspace(-5, 5, 21)
    found = densities(flat(*levels), pushed)
    assert found == pytest.approx(densities(flat(*(levels * 2**push)), as_made), abs=1e-5)
    assert shown(flat(0.18 / 2**push), pushed) == pytest.approx(shown(flat(0.18), as_made), rel=1e-4)


def test_black_and_white_film_has_no_colour() -> None:
    film = film_settings(FilmData(), name="5222")
    light = shown(np.array([[[0.3, 0.1, 0.05], [0.45, 0.0, 0.0]]], np.float32), film)[0]
    assert np.ptp(light, axis=1) == pytest.approx([0, 0])
    assert light[0] == pytest.approx(light[1], rel=1e-5)  # as much light in all


def test_light_that_the_balance_is_set_to_looks_neutral() -> None:
    from pxr import UsdLux

    for kelvin in (2800, 3200, 5600, 9000):
        lamp = UsdLux.BlackbodyTemperatureAsRgb(kelvin)
        grey = 0.18 * np.array([[rgb_to_working((lamp[0], lamp[1], lamp[2]))]], np.float32)
        for name in ("5219", "velvia_50"):
            film = film_settings(FilmData(white_balance_k=kelvin), name=name)
            plain = film_settings(FilmData(), name=name)
            assert shown(grey, film) == pytest.approx(shown(flat(0.18), plain), rel=0.02)
        digital = FilmSettings(white_balance_k=kelvin)
        assert shown(grey, digital) == pytest.approx(flat(0.18), rel=0.01)


def test_tungsten_film_is_blue_by_day_and_tint_turns_to_magenta() -> None:
    red, _, blue = balance_gains(3200) / balance_gains(5600)
    assert red < 0.9 < 1.5 < blue
    for kelvin in (0, 3200, 5600):
        red, green, blue = balance_gains(kelvin, 30) / balance_gains(kelvin)
        assert green < 0.98 < 1.02 < min(red, blue)
    assert balance_gains(0).tolist() == [1, 1, 1]


@pytest.mark.parametrize(("kelvin", "tint"), [(500, 0), (1e6, 0), (3200, 5000)])
def test_an_impossible_balance_is_refused(kelvin: float, tint: float) -> None:
    with pytest.raises(SettingsError, match="white balance"):
        balance_gains(kelvin, tint)


def test_without_film_light_stays_as_it_is() -> None:
    light = np.random.default_rng(1).random((4, 5, 3), np.float32)
    assert (shown(light, FilmSettings()) == light).all()


def test_light_below_nought_and_very_bright_light_stay_finite() -> None:
    light = np.array([[[-1.0, 0.0, 65504.0]]], np.float32)
    for name in ("5219", "velvia_50", "5222"):
        developed = shown(light, film_settings(FilmData(halation=Halation(amount=0.1)), name=name))
        assert np.isfinite(developed).all()
        assert developed.dtype == np.float32


def test_grain_and_halation_are_on_the_picture_on_request() -> None:
    spot = np.full((64, 96, 3), 0.18, np.float32)
    spot[32, 48] = 5000.0
    plain = shown(spot, film_settings(FilmData(), name="5219"))
    glowing = shown(spot, film_settings(FilmData(halation=Halation(amount=0.05, radius_mm=1.0)), name="5219"))
    # 1 mm is 3.9 pixels across and 4.6 down; red comes back most.
    assert glowing[32, 53, 0] > 2 * plain[32, 53, 0]
    assert glowing[32, 53, 0] > glowing[32, 53, 1] > glowing[32, 53, 2] > plain[32, 53, 2]
    grain = film_settings(FilmData(grain=Grain(amount=1.0)), name="5219")
    grainy = develop_on_film(spot, grain, frame=1, gate_mm=(1.2, 0.8))  # 12.5 µm to a pixel
    assert 0.005 < grainy[:, :40].std() < 0.05
    assert abs(grainy[:, :40].mean() - 0.1) < 0.01


def test_a_print_is_shown_as_it_is_clear_film_as_white() -> None:
    light = np.array([[1, 1, 1], [0.1, 0.1, 0.1], [0.0, 0.0, 0.0]], np.float32)
    assert working_config().getColorSpace(print_space()).getEncoding() == "scene-linear"
    sent = light.copy()
    Grade().processor(print_space()).getDefaultCPUProcessor().applyRGB(sent)
    assert sent[0] == pytest.approx([1, 1, 1], abs=1e-4)
    assert sent[1] == pytest.approx([0.349, 0.349, 0.349], abs=2e-3)  # sRGB of a tenth
    assert sent[2] == pytest.approx([0, 0, 0], abs=1e-4)
    assert ocio.ROLE_SCENE_LINEAR in working_config().getRoleNames()


@pytest.mark.parametrize(("shape", "gate"), [((4, 4), GATE), ((4, 4, 4), GATE), ((4, 4, 3), (0.0, 14.0))])
def test_what_is_no_picture_or_no_gate_is_refused(shape: tuple[int, ...], gate: tuple[float, float]) -> None:
    with pytest.raises(SettingsError, match=r"exposed light must be|a film gate needs"):
        develop_on_film(np.zeros(shape, np.float32), FilmSettings(), frame=1, gate_mm=gate)
