"""Stocks of the library and stocks that a shot draws: anchored, and refused where they make no sense."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from render.errors import SettingsError
from render.film.process import densities
from render.film.settings import FilmSettings, film_settings
from render.film.stock import MIDDLE_GREY, camera_stock, print_stock
from usd_schemas import CharacteristicCurve, FilmData, Grain, LibraryFilm, PrintCurve, library_films

CAMERA = [film for film in library_films() if film.kind == "camera"]
PRINTS = [film for film in library_films() if film.kind == "print"]
RISING = ((-2.0, 0.1), (0.0, 1.0), (2.0, 2.0))
FALLING = ((-2.0, 3.0), (0.0, 1.0), (2.0, 0.2))


def film_of(**said: object) -> FilmSettings:
    return film_settings(FilmData(**said))  # type: ignore[arg-type]


@pytest.mark.parametrize("film", CAMERA, ids=lambda film: film.name)
def test_a_wedge_of_21_steps_has_the_stock_s_densities(film: LibraryFilm) -> None:
    settings = film_settings(FilmData(), name=film.name)
    assert settings.stock is not None
    stock = settings.stock
    knots = film.film.curve.green
    green = stock.middle_log_exposure[len(stock.curves) // 2]
    wedge = MIDDLE_GREY * 10 ** (np.array([exposure for exposure, _ in knots]) - green)
    read = densities(np.repeat(wedge.astype(np.float32)[None, :, None], 3, axis=2), settings)[0]
    assert read[:, len(stock.curves) // 2] == pytest.approx([density for _, density in knots], abs=0.01)
    if film.film.process == "negative":
        for record, channel in enumerate((film.film.curve.red, film.film.curve.green, film.film.curve.blue)):
            assert read[:, record] == pytest.approx([density for _, density in channel], abs=0.01)


@pytest.mark.parametrize("film", PRINTS, ids=lambda film: film.name)
def test_the_printer_lights_put_grey_at_1_above_each_records_base(film: LibraryFilm) -> None:
    stock = print_stock(film.name)
    assert stock.middle_density == pytest.approx(tuple(base + 1.0 for base in stock.base), abs=1e-5)


@pytest.mark.parametrize("name", ["ektachrome_100d", "velvia_50", "kodachrome_64"])
def test_a_reversal_stock_is_filtered_so_that_grey_is_grey(name: str) -> None:
    stock = camera_stock(name)
    red, green, blue = (density - base for density, base in zip(stock.middle_density, stock.base, strict=True))
    assert (red, blue) == pytest.approx((green, green), abs=1e-5)
    filters = np.array(stock.middle_log_exposure) - stock.middle_log_exposure[1]
    assert np.abs(filters).max() < 0.11  # what a filter of a third of a stop does


def test_a_stock_rated_twice_as_fast_gets_half_the_exposure() -> None:
    as_made, faster = camera_stock("tri-x_400"), camera_stock("tri-x_400", speed=800)
    [shift] = np.subtract(faster.middle_log_exposure, as_made.middle_log_exposure)
    assert shift == pytest.approx(-math.log10(2))


def test_a_stock_that_the_shot_draws_lands_grey_where_it_says() -> None:
    knots = CharacteristicCurve(source="knots", red=RISING, green=RISING, blue=RISING, middle_gray=-0.5)
    assert film_of(process="negative", curve=knots).stock.middle_log_exposure == (-0.5,) * 3  # type: ignore[union-attr]
    drawn = CharacteristicCurve(source="parametric", gamma=(0.5, 0.6, 0.7))
    stock = film_of(process="negative", curve=drawn).stock
    assert stock is not None
    assert stock.middle_density == pytest.approx((0.85, 0.85, 0.85), abs=1e-4)
    slopes = [float(curve.density(0.3) - curve.density(0)) / 0.3 for curve in stock.curves]
    assert slopes == pytest.approx((0.5, 0.6, 0.7), abs=1e-3)
    falling = replace(drawn, gamma=(-1.5,) * 3, min_density=(0.2,) * 3, max_density=(3.2,) * 3)
    stock = film_of(process="reversal", curve=falling).stock
    assert stock is not None
    assert stock.middle_density == pytest.approx((1.2, 1.2, 1.2), abs=1e-4)


def test_a_print_that_the_shot_draws_comes_before_the_named_one() -> None:
    drawn = PrintCurve(RISING, RISING, RISING)
    film = film_of(process="negative", stock="5219", print_stock="3513di", print_curve=drawn)
    assert film.print_stock is not None
    assert film.print_stock.curves[0].knots == RISING


def test_each_process_has_a_print_of_its_own_where_none_is_named() -> None:
    assert film_of(process="negative", stock="5219").print_stock == print_stock("vision_2383")
    assert film_of(process="monochrome", stock="5222").print_stock == print_stock("print_2302")
    assert film_of(process="reversal", stock="velvia_50").print_stock is None
    assert film_of(process="none", stock="5219") == FilmSettings()


def test_a_stock_by_name_takes_the_place_of_the_shot_s() -> None:
    shot = FilmData(process="digital", speed=800, push=1.0, curve=CharacteristicCurve(source="parametric"))
    film = film_settings(shot, name="double-x_5222")
    assert (film.process, film.push) == ("monochrome", 1.0)
    assert film.stock == camera_stock("double_x_5222")


def test_granularity_is_the_maker_s_table_or_the_single_figure_s_law() -> None:
    table = camera_stock("vision3_500t_5219").granularity[1]
    assert (0.92, 0.012) in table
    for name, figure in (("velvia_50", 0.009), ("double_x_5222", 0.014), ("tri_x_400", 0.017)):
        stock = camera_stock(name)
        densities_, deviations = np.array(stock.granularity[0]).T
        assert np.interp(stock.base[0] + 1.0, densities_, deviations) == pytest.approx(figure, rel=1e-3)
    own = camera_stock("vision3_500t_5219", rms=(0.0, 5.0, 0.0))
    densities_, deviations = np.array(own.granularity[1]).T
    assert np.interp(own.base[1] + 1.0, densities_, deviations) == pytest.approx(0.005)
    assert own.granularity[0] == camera_stock("vision3_500t_5219").granularity[0]


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"process": "negative"}, "process negative needs a stock: film:stock names one, or film:curve draws it"),
        ({"process": "negative", "stock": "velvio 50"}, "no film stock named 'velvio 50' .* velvia_50"),
        ({"process": "negative", "stock": "velvia_50"}, "velvia_50 run backwards for film process negative"),
        ({"process": "reversal", "stock": "5219"}, "vision3_500t_5219 run backwards for film process reversal"),
        (
            {"process": "monochrome", "stock": "5219"},
            "needs a black-and-white stock, and vision3_500t_5219 is a colour",
        ),
        ({"process": "negative", "stock": "5222"}, "needs a colour stock, and double_x_5222 is a black-and-white one"),
        ({"process": "negative", "stock": "2383"}, "vision_2383 is a print stock, expected one for the camera"),
        ({"process": "negative", "stock": "5219", "print_stock": "5203"}, "vision3_50d_5203 is a camera stock"),
        ({"process": "negative", "stock": "5219", "print_stock": "2302"}, "a print stock of 3 records, got print_2302"),
        (
            {"process": "negative", "stock": "5219", "print_curve": PrintCurve(FALLING, FALLING, FALLING)},
            "the print that the shot draws run backwards",
        ),
        (
            {
                "process": "negative",
                "curve": CharacteristicCurve(source="knots", red=RISING, green=FALLING, blue=RISING),
            },
            "must all rise .* or all fall",
        ),
        (
            {"process": "negative", "curve": CharacteristicCurve(source="knots", red=RISING, green=RISING)},
            "the blue curve of film:curve needs at least 2 knots",
        ),
        (
            {"process": "negative", "curve": CharacteristicCurve(source="parametric", gamma=(-0.6,) * 3)},
            "run backwards for film process negative: density falls",
        ),
        (
            {"process": "negative", "stock": "portra_400", "grain": Grain(amount=1)},
            "portra_400 is known: film:grain:rms",
        ),
        ({"process": "negative", "stock": "5219", "push": 7.0}, "push is from -5 to 5 stops, got 7"),
        (
            {"process": "negative", "stock": "5219", "grain": Grain(amount=-1)},
            "film:grain:amount must be from 0 to 100, got -1",
        ),
    ],
)
def test_what_makes_no_sense_is_one_clear_error(said: dict[str, object], words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        film_of(**said)
