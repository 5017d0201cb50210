"""From the film library to models. Runs in the stage process, the one that imports USD."""

from __future__ import annotations

from functools import lru_cache

from render.errors import NotFoundError
from service.models.films import Film, FilmCurves, FilmList, FilmSummary
from usd_schemas import LibraryFilm, SchemaError, library_film, library_films


def list_films() -> FilmList:
    """All stocks of the library."""
    return FilmList(films=[_summary(entry) for entry in library_films()])


def read_film(name: str) -> Film:
    """One stock of the library.

    Raises:
        NotFoundError: there is none of that name.
    """
    entry = film_entry(name)
    film = entry.film
    curve = film.curve if entry.kind == "camera" else film.print_curve
    return Film(
        **_summary(entry).model_dump(),
        print_stock=film.print_stock or None,
        densitometry=entry.densitometry,
        relative_exposure=entry.relative_exposure,
        middle_gray=film.curve.middle_gray if entry.kind == "camera" else None,
        curves=FilmCurves(red=list(curve.red), green=list(curve.green), blue=list(curve.blue)),
        granularity={channel: list(pairs) for channel, pairs in entry.granularity.items()},
        granularity_from_base=entry.granularity_from_base,
    )


@lru_cache(maxsize=16)
def draw_film(name: str) -> bytes:
    """All about a stock of the library on one sheet: PNG.

    Raises:
        NotFoundError: there is none of that name.
    """
    from render.drawing.film_sheet import film_sheet  # matplotlib takes a second to load
    from render.film.report import film_report

    return film_sheet(film_report(film_entry(name).name), "png")


def film_entry(name: str) -> LibraryFilm:
    """A stock of the library.

    Raises:
        NotFoundError: there is none of that name; the message has the nearest names.
    """
    try:
        return library_film(name)
    except SchemaError as error:
        raise NotFoundError(str(error), code="unknown_stock", path=name) from error


def _summary(entry: LibraryFilm) -> FilmSummary:
    return FilmSummary(
        name=entry.name,
        title=entry.title,
        kind=entry.kind,
        process=entry.film.process,
        speed=entry.film.speed or None,
        balance_k=entry.balance_k,
        year=entry.year,
        description=entry.description,
    )
