"""Report of a stock: the position of grey, its slope, and the densities of a grey wedge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import SettingsError
from render.film.curve import Curve
from render.film.process import STOP, densities, print_densities, project_print
from render.film.settings import DEFAULT_PRINTS, FilmSettings, film_settings
from render.film.stock import Stock, library_stock
from render.film.targets import grey_wedge, wedge_stops
from render.model.arrays import DoubleArray
from usd_schemas import FilmData, LibraryFilm

TRIED_WITH = {"negative": "vision3_250d_5207", "monochrome": "double_x_5222"}
"""Negatives that print stocks are tried with."""
_GREY_SPAN = 1.0  # stops to each side of middle grey
_LEVEL = 0.1  # share of the steepest slope below which a curve counts as bent to level


@dataclass(frozen=True, eq=False)
class FilmReport:
    """Known and measured properties of a stock.

    Attributes:
        entry: the stock's entry in the library.
        film: settings of the trial: the stock alone, or with the stock that it is printed on or from.
        stock: the stock itself, in the camera or in the printer.
        gamma: slope of the straight line of each curve, density over log10 exposure; negative for a reversal stock.
        slope_at_grey: slope of each curve around middle grey, likewise: what a scene of usual contrast meets.
        latitude_stops: ``(curves, 2)`` range of each curve below and above middle grey, in stops.
        stops: ``(21,)`` stops of the grey wedge, from middle grey.
        camera_densities: ``(21, curves)`` densities of the wedge on the camera stock.
        print_densities: ``(21, curves)`` densities of its print; None where there is none.
        light: ``(21, 3)`` light on the screen, 1 where the film is clear.
    """

    entry: LibraryFilm
    film: FilmSettings
    stock: Stock
    gamma: tuple[float, ...]
    slope_at_grey: tuple[float, ...]
    latitude_stops: tuple[tuple[float, float], ...]
    stops: DoubleArray
    camera_densities: DoubleArray
    print_densities: DoubleArray | None
    light: DoubleArray

    @property
    def tried_with(self) -> str | None:
        """Name of the other stock, if there is one."""
        both = {s.name for s in (self.film.stock, self.film.print_stock) if s is not None}
        return next(iter(both - {self.entry.name}), None)

    @property
    def granularity_at_1(self) -> tuple[float, ...]:
        """Standard deviation of density through 48 µm, 1.0 above the base of each curve; empty where it is not known."""
        pairs = zip(self.stock.base, self.stock.granularity, strict=False)
        return tuple(float(np.interp(base + 1.0, *np.array(table).T)) for base, table in pairs)


def film_report(name: str, *, push: float = 0.0, partner: str | None = None) -> FilmReport:
    """Try a stock of the library.

    Args:
        name: of the library, or a part of it.
        push: stops by which the camera stock is pushed.
        partner: the print stock that a negative is printed on, or the negative that a print stock is tried with; None takes
            the usual one.

    Raises:
        SettingsError: a stock is unknown, or they do not go together.
    """
    entry = library_stock(name)
    film = film_settings(_trial_settings(entry, push, partner))
    stock = film.stock if entry.kind == "camera" else film.print_stock
    if stock is None:
        raise SettingsError(f"{entry.name} cannot be tried")
    wedge = grey_wedge()
    camera = densities(wedge, film)
    printed = None if film.print_stock is None else print_densities(camera, film)[0].astype(np.float64)
    return FilmReport(
        entry=entry,
        film=film,
        stock=stock,
        gamma=tuple(straight_line_slope(curve) for curve in stock.curves),
        slope_at_grey=_slope_at_grey(stock),
        latitude_stops=tuple(_latitude(stock, record) for record in range(len(stock.curves))),
        stops=wedge_stops(),
        camera_densities=camera[0].astype(np.float64),
        print_densities=printed,
        light=project_print(camera, film)[0].astype(np.float64),
    )


def _trial_settings(entry: LibraryFilm, push: float, partner: str | None) -> FilmData:
    process = entry.film.process
    if entry.kind == "print":
        return FilmData(process=process, stock=partner or TRIED_WITH[process], print_stock=entry.name, push=push)
    if process == "reversal":
        if partner:
            raise SettingsError(
                f"{entry.name} is a reversal stock, which is not printed; got the print stock {partner}"
            )
        return FilmData(process=process, stock=entry.name, push=push)
    return FilmData(process=process, stock=entry.name, print_stock=partner or DEFAULT_PRINTS[process], push=push)


def straight_line_slope(curve: Curve) -> float:
    """Return the slope of the straight line between the toe and the shoulder of a characteristic curve, its gamma.

    It is the greatest mean slope over one stop (Hurter, Driffield 1890): where a curve is straight over a stop or more, the slope
    of that line. Shorter stretches would show how the knots of a data sheet were read off.

    Args:
        curve: of one layer.

    Returns:
        Density over log10 exposure; negative where density falls.
    """
    x, density = curve.table
    span = min(STOP, float(x[-1] - x[0]))
    starts = x[x <= x[-1] - span]
    rises = np.interp(starts + span, x, density) - np.interp(starts, x, density)
    return float(rises[np.argmax(np.abs(rises))] / span)


def _slope_at_grey(stock: Stock) -> tuple[float, ...]:
    span = _GREY_SPAN * STOP
    pairs = zip(stock.curves, stock.middle_log_exposure, strict=True)
    return tuple(
        float(curve.density(middle + span) - curve.density(middle - span)) / (2 * span) for curve, middle in pairs
    )


def _latitude(stock: Stock, record: int) -> tuple[float, float]:
    """Latitude: the range in which the curve is steeper than a tenth of its steepest, in stops below and above middle grey."""
    x, density = stock.curves[record].table
    slope = np.abs(np.gradient(density, x))
    steep = x[slope > _LEVEL * slope.max()]
    middle = stock.middle_log_exposure[record]
    return float(steep[0] - middle) / STOP, float(steep[-1] - middle) / STOP
