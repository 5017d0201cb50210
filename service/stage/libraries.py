"""What the stage process is asked about the libraries of films and bodies; see `service.stage.shots`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from render.errors import NotFoundError, SettingsError
from service.models.bodies import Body, BodyList
from service.models.films import Film, FilmList
from service.stage.opened import OpenedShots

if TYPE_CHECKING:
    from usd_schemas import LibraryBody, LibraryFilm


def body_to_mount(name: str) -> LibraryBody:
    """The body that an edit of a camera names.

    Raises:
        SettingsError: the library has none of that name.
    """
    from service.stage.read_bodies import body_entry

    try:
        return body_entry(name)
    except NotFoundError as error:  # the address was right, what was sent to it is not
        raise SettingsError(error.detail, code=error.code, path="body") from error


def film_to_mount(name: str | None) -> LibraryFilm | None:
    """The stock that an edit of a camera's film names; None for no film.

    Raises:
        SettingsError: the library has none of that name.
    """
    from service.stage.read_films import film_entry

    try:
        return None if name is None else film_entry(name)
    except NotFoundError as error:
        raise SettingsError(error.detail, code=error.code, path="stock") from error


@dataclass(frozen=True)
class ListFilms:
    """The film library."""

    def run(self, opened: OpenedShots) -> FilmList:
        """All of it."""
        from service.stage.read_films import list_films

        return list_films()


@dataclass(frozen=True)
class ReadLibraryFilm:
    """One stock of the library."""

    name: str

    def run(self, opened: OpenedShots) -> Film:
        """Raises `NotFoundError`."""
        from service.stage.read_films import read_film

        return read_film(self.name)


@dataclass(frozen=True)
class DrawLibraryFilm:
    """A sheet about one stock of the library: PNG."""

    name: str

    def run(self, opened: OpenedShots) -> bytes:
        """Raises `NotFoundError`."""
        from service.stage.read_films import draw_film

        return draw_film(self.name)


@dataclass(frozen=True)
class ListBodies:
    """The library of camera bodies."""

    def run(self, opened: OpenedShots) -> BodyList:
        """All of it."""
        from service.stage.read_bodies import list_bodies

        return list_bodies()


@dataclass(frozen=True)
class ReadLibraryBody:
    """One body of the library.

    Attributes:
        name: of it.
        focal_lengths_mm: to tell fields of view for.
    """

    name: str
    focal_lengths_mm: tuple[float, ...]

    def run(self, opened: OpenedShots) -> Body:
        """Raises `NotFoundError`."""
        from service.stage.read_bodies import read_body

        return read_body(self.name, list(self.focal_lengths_mm))
