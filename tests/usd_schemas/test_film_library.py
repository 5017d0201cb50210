"""The film library: whole, legal and findable."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pxr import Usd

import usd_schemas
from usd_schemas import LibraryFilm, SchemaError, film_library, film_names, library_film, library_films
from usd_schemas.film_library import FILM_LIBRARY_FILE
from usd_schemas.validation import validate


def test_the_thirteen_stocks_are_there() -> None:
    kinds = [(film.kind, film.film.process) for film in library_films()]
    assert len(kinds) == 13
    assert kinds.count(("camera", "negative")) == 5
    assert kinds.count(("camera", "reversal")) == 3
    assert kinds.count(("camera", "monochrome")) == 2
    assert kinds.count(("print", "negative")) == 2
    assert kinds.count(("print", "monochrome")) == 1


def test_one_stock_is_read_without_the_others() -> None:
    film_library._film.cache_clear()
    library_film("velvia_50")
    assert film_library._film.cache_info().currsize == 1


def test_the_library_keeps_the_rules_of_the_schemas() -> None:
    assert validate(Usd.Stage.Open(str(FILM_LIBRARY_FILE))) == []


@pytest.mark.parametrize("entry", library_films(), ids=lambda entry: entry.name)
def test_each_stock_says_what_a_list_of_stocks_shows(entry: LibraryFilm) -> None:
    assert entry.description.endswith(".")
    assert "\n" not in entry.description
    assert entry.name in (entry.film.stock, entry.film.print_stock)
    assert all(word in entry.name for word in entry.title.lower().split()[-1:])
    curves = entry.film.curve if entry.kind == "camera" else entry.film.print_curve
    assert len(curves.green) == 21
    assert (len(curves.red), len(curves.blue)) == ((0, 0) if entry.film.process == "monochrome" else (21, 21))
    assert (entry.film.speed > 0) == (entry.kind == "camera")
    assert (entry.balance_k is not None) == (entry.kind == "camera" and entry.film.process != "monochrome")


@pytest.mark.parametrize("entry", [film for film in library_films() if film.kind == "camera"], ids=lambda f: f.name)
def test_metered_grey_is_at_the_speed_point_near_the_labs_aim(entry: LibraryFilm) -> None:
    film = entry.film
    if not entry.relative_exposure:
        assert film.curve.middle_gray == pytest.approx(math.log10(10 / film.speed), abs=1e-4)
    exposures, densities = np.array(film.curve.green).T
    above_base = np.interp(film.curve.middle_gray, exposures, densities) - densities.min()
    lowest, highest = (0.8, 1.0) if film.process == "reversal" else (0.6, 0.85)
    assert lowest < above_base < highest


@pytest.mark.parametrize("entry", [film for film in library_films() if film.granularity], ids=lambda entry: entry.name)
def test_granularity_is_read_at_densities_that_the_stock_has(entry: LibraryFilm) -> None:
    for channel, readings in entry.granularity.items():
        densities, deviations = np.array(readings).T
        assert (np.diff(densities) >= 0).all()
        assert (deviations > 0).all()
        assert deviations.max() < 0.06
        curve = np.array(getattr(entry.film.curve, channel))[:, 1]
        base = curve.min() if entry.granularity_from_base else 0.0
        assert densities.min() + base < curve.mean() < densities.max() + base


def test_a_stock_is_found_by_name_and_number_or_a_hint_is_given() -> None:
    assert library_film("Vision3-500T 5219").name == "vision3_500t_5219"
    assert library_film("5219").name == "vision3_500t_5219"
    assert library_film("2383").kind == "print"
    with pytest.raises(SchemaError, match=r"no film stock named 'eterna_50' in the library: did you mean eterna_500"):
        library_film("eterna_50")
    with pytest.raises(SchemaError, match=r"no film stock named 'vision3'.*vision3_500t_5219 or vision3_250d_5207"):
        library_film("vision3")
    with pytest.raises(SchemaError, match=r"the library has vision3_500t_5219"):
        library_film("")
    assert usd_schemas.film_names() == film_names()
