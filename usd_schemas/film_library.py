"""The film library that ships with the schemas: libraries/films.usda, as typed Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from usd_schemas.errors import SchemaError
from usd_schemas.library_prims import library_prims
from usd_schemas.lookup import hint
from usd_schemas.registration import FOLDER
from usd_schemas.settings import FilmData, Pairs
from usd_schemas.view import LensCamera

FILM_LIBRARY_FILE = FOLDER / "libraries" / "films.usda"


@dataclass(frozen=True)
class LibraryFilm:
    """One stock of the library.

    Attributes:
        name: on the command line and over REST, such as ``vision3_500t_5219``.
        title: as it stands on the box.
        description: one line.
        kind: what it is for: the camera, or prints.
        year: of the data sheet.
        densitometry: how density was measured, such as ``Status M``.
        balance_k: colour temperature of the light that it is made for, in kelvin; None where it does not matter.
        relative_exposure: whether the log exposures of its curves are relative; else they are of lux-seconds.
        granularity: (density, standard deviation of density through a round 48 µm aperture) by channel ``red``, ``green``,
            ``blue``; empty where none is published; ``green`` alone for black and white.
        granularity_from_base: whether the densities of `granularity` are counted from the base.
        film: what FilmAPI says of it.
    """

    name: str
    title: str
    description: str
    kind: Literal["camera", "print"]
    year: int
    densitometry: str
    balance_k: float | None
    relative_exposure: bool
    granularity: Mapping[str, Pairs]
    granularity_from_base: bool
    film: FilmData


def film_names() -> list[str]:
    """Names of all stocks, in the library's order."""
    return list(library_prims(FILM_LIBRARY_FILE))


def library_films() -> list[LibraryFilm]:
    """All stocks, in the library's order."""
    return [_film(name) for name in library_prims(FILM_LIBRARY_FILE)]


def library_film(name: str) -> LibraryFilm:
    """The stock of that name.

    Args:
        name: as `film_names` has it, or a part of it that one stock alone has, such as ``5219``; small and capital letters,
            and ``-`` or a space for ``_``, are the same.

    Raises:
        SchemaError: there is none; the message has the nearest names.
    """
    plain = name.strip().lower().replace("-", "_").replace(" ", "_")
    names = film_names()
    if plain in names:
        return _film(plain)
    having = [known for known in names if plain and f"_{plain}_" in f"_{known}_"]
    if len(having) == 1:
        return _film(having[0])
    suggestion = f"did you mean {' or '.join(having)}?" if having else hint(plain, names)
    raise SchemaError(f"there is no film stock named {name!r} in the library: {suggestion}")


@cache
def _film(name: str) -> LibraryFilm:
    """Read one stock: all of them take a while."""
    prim = library_prims(FILM_LIBRARY_FILE)[name]
    beside: dict[str, Any] = prim.GetCustomData()
    return LibraryFilm(
        name=name,
        title=beside["title"],
        description=prim.GetDocumentation(),
        kind=beside["kind"],
        year=beside["year"],
        densitometry=beside["densitometry"],
        balance_k=beside.get("balance"),
        relative_exposure=beside.get("exposure", "relative") == "relative",
        granularity={
            channel: tuple((float(density), float(deviation)) for density, deviation in pairs)
            for channel, pairs in beside.get("granularity", {}).items()
        },
        granularity_from_base=beside.get("granularityFrom") == "base",
        film=LensCamera(prim).film.read(),
    )
