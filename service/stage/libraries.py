"""Functions of the stage process that read the libraries of film stocks and camera bodies."""

from __future__ import annotations

import math
from functools import lru_cache

from render.errors import NotFoundError, SettingsError
from render.film.report import film_report
from render.optics.framing import ASPECTS, Gate, field_of_view, framing_guides
from service.models.libraries import (
    Body,
    BodyList,
    BodySummary,
    FieldOfView,
    Film,
    FilmCurves,
    FilmList,
    FilmSummary,
    FramingGuide,
    Shape,
)
from service.stage.opened import OpenedShot, stage_function
from usd_schemas import LibraryBody, LibraryFilm, SchemaError, library_bodies, library_body, library_film, library_films


@stage_function
def list_films(opened: OpenedShot) -> FilmList:
    """List the film library."""
    return FilmList(films=[_film_summary(entry) for entry in library_films()])


@stage_function
def read_film(opened: OpenedShot, name: str) -> Film:
    """Read one stock of the library. Raises `NotFoundError`."""
    entry = film_entry(name)
    film = entry.film
    curve = film.curve if entry.kind == "camera" else film.print_curve
    return Film(
        **_film_summary(entry).model_dump(),
        print_stock=film.print_stock or None,
        densitometry=entry.densitometry,
        relative_exposure=entry.relative_exposure,
        middle_gray=film.curve.middle_gray if entry.kind == "camera" else None,
        curves=FilmCurves(red=list(curve.red), green=list(curve.green), blue=list(curve.blue)),
        granularity={channel: list(pairs) for channel, pairs in entry.granularity.items()},
        granularity_from_base=entry.granularity_from_base,
    )


@stage_function
def draw_film_sheet(opened: OpenedShot, name: str) -> bytes:
    """Draw the data sheet of a stock of the library as PNG. Raises `NotFoundError`."""
    return _film_sheet_png(name)


@lru_cache(maxsize=16)
def _film_sheet_png(name: str) -> bytes:
    from render.drawing.film_sheet import draw_film_sheet  # matplotlib takes a second to import

    return draw_film_sheet(film_report(film_entry(name).name), "png")


@stage_function
def list_bodies(opened: OpenedShot) -> BodyList:
    """List the library of camera bodies, and the aspect ratios that pictures are framed for."""
    shapes = [Shape(name=name, aspect=aspect) for name, aspect in ASPECTS.items()]
    return BodyList(bodies=[_body_summary(body) for body in library_bodies()], shapes=shapes)


@stage_function
def read_body(opened: OpenedShot, name: str, focal_lengths_mm: tuple[float, ...]) -> Body:
    """Read one body of the library, with its fields of view at some focal lengths. Raises `NotFoundError`."""
    body = body_entry(name)
    return Body(
        **_body_summary(body).model_dump(),
        fields_of_view=[_field_of_view(body, focal_mm) for focal_mm in focal_lengths_mm],
        framing_guides=[
            FramingGuide(
                name=guide.name,
                aspect=guide.aspect,
                share_of_gate=(guide.width_share, guide.height_share),
                gate_mm=(guide.width_mm, guide.height_mm),
                resolution=guide.resolution if body.kind == "digital" else None,
            )
            for guide in framing_guides(_gate(body))
        ],
    )


def film_entry(name: str) -> LibraryFilm:
    """Return a stock of the library.

    Raises:
        NotFoundError: there is none of that name; the message lists the nearest names.
    """
    try:
        return library_film(name)
    except SchemaError as error:
        raise NotFoundError(str(error), code="unknown_stock", path=name) from error


def body_entry(name: str) -> LibraryBody:
    """Return a body of the library.

    Raises:
        NotFoundError: there is none of that name; the message lists the nearest names.
    """
    try:
        return library_body(name)
    except SchemaError as error:
        raise NotFoundError(str(error), code="no_such_body", path=name) from error


def body_to_mount(name: str) -> LibraryBody:
    """Return the body that an edit of a camera names.

    Raises:
        SettingsError: the library has none of that name.
    """
    try:
        return body_entry(name)
    except NotFoundError as error:  # the resource exists; the value sent for it is wrong
        raise SettingsError(error.detail, code=error.code, path="body") from error


def film_to_mount(name: str | None) -> LibraryFilm | None:
    """Return the stock that an edit of a camera's film names; None is no film.

    Raises:
        SettingsError: the library has none of that name.
    """
    try:
        return None if name is None else film_entry(name)
    except NotFoundError as error:
        raise SettingsError(error.detail, code=error.code, path="stock") from error


def _film_summary(entry: LibraryFilm) -> FilmSummary:
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


def _gate(body: LibraryBody) -> Gate:
    return Gate(*body.gate_mm, body.squeeze, body.resolution)


def _field_of_view(body: LibraryBody, focal_mm: float) -> FieldOfView:
    gate = _gate(body)
    field = field_of_view(gate, focal_mm)
    return FieldOfView(
        focal_length_mm=focal_mm,
        horizontal_deg=math.degrees(field.horizontal_rad),
        vertical_deg=math.degrees(field.vertical_rad),
        diagonal_deg=math.degrees(field.diagonal_rad),
        full_frame_mm=focal_mm * gate.crop_factor,
    )


def _body_summary(body: LibraryBody) -> BodySummary:
    gate = _gate(body)
    return BodySummary(
        name=body.name,
        title=body.title,
        kind=body.kind,
        gate_mm=body.gate_mm,
        resolution=body.resolution if body.kind == "digital" else None,
        squeeze=body.squeeze,
        aspect=gate.aspect,
        crop_factor=gate.crop_factor,
        description=body.description,
    )
