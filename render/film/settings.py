"""Film settings as numbers: from FilmAPI, or from a stock's name alone."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import get_args

from render.errors import SettingsError
from render.film.balance import balance_gains
from render.film.halation import halation_shares
from render.film.ranges import check_numbers
from render.film.sensor import SensorSettings
from render.film.stock import Stock, camera_stock, custom_stock, library_stock, print_stock
from render.near_names import hint
from usd_schemas.settings import FilmData, FilmProcess, Grain, Halation
from usd_schemas.settings.tables import FILM_SETTINGS

DEFAULT_PRINTS = {"negative": "vision_2383", "monochrome": "print_2302"}
PROCESSES: tuple[str, ...] = get_args(FilmProcess)
PUSHES = FILM_SETTINGS["push"].accepted
_GRAIN_AMOUNTS = FILM_SETTINGS["grain_amount"].accepted
_GRAIN_SIZES = FILM_SETTINGS["grain_size_um"].accepted


@dataclass(frozen=True)
class GrainSettings:
    """Film grain.

    Attributes:
        amount: factor; 0 none, 1 the stock's own.
        size_um: correlation length on the film in micrometres; 0 takes `render.film.grain.GRAIN_SIZE_UM`.
        seed: which grain.
    """

    amount: float = Grain.amount
    size_um: float = Grain.size_um
    seed: int = Grain.seed


@dataclass(frozen=True)
class HalationSettings:
    """Light that the base throws back: its part, the ring's radius on the film, and its ratio in each channel."""

    amount: float = Halation.amount
    radius_mm: float = Halation.radius_mm
    color: tuple[float, float, float] = Halation.color


@dataclass(frozen=True)
class FilmSettings:
    """Film or sensor, and its development.

    Attributes:
        process: none, negative (colour, seen through a print), reversal (a positive, seen directly), monochrome (a
            black-and-white negative, seen through a print) or digital.
        stock: in the camera; None for none and digital.
        print_stock: on which a negative is printed; None for the others.
        push: stops by which development is longer, and the stock faster.
        white_balance_k: colour temperature that looks neutral; 0 for the working space's white.
        tint: across the line of colour temperatures, in 1/3000 of CIE 1960 uv, positive toward magenta.
        grain: grain of film.
        halation: halation of film.
        sensor: sensor of digital.

    Raises:
        SettingsError: the stocks do not go with the process, or a number is out of range.
    """

    process: FilmProcess = FilmData.process
    stock: Stock | None = None
    print_stock: Stock | None = None
    push: float = FilmData.push
    white_balance_k: float = FilmData.white_balance_k
    tint: float = FilmData.tint
    grain: GrainSettings = GrainSettings()
    halation: HalationSettings = HalationSettings()
    sensor: SensorSettings = field(default_factory=SensorSettings)

    def __post_init__(self) -> None:
        if not PUSHES.holds(self.push):
            raise SettingsError(f"push is from {PUSHES.least:g} to {PUSHES.most:g} stops, got {self.push:g}")
        if not (_GRAIN_AMOUNTS.holds(self.grain.amount) and _GRAIN_SIZES.holds(self.grain.size_um)):
            raise SettingsError(
                f"grain needs an amount {_GRAIN_AMOUNTS} and a size {_GRAIN_SIZES}, "
                f"got {self.grain.amount:g} and {self.grain.size_um:g}"
            )
        balance_gains(self.white_balance_k, self.tint)
        halation_shares(self.halation.amount, self.halation.radius_mm, self.halation.color)
        if self.process not in ("none", "digital"):
            self._check_stocks()

    def _check_stocks(self) -> None:
        stock = self.stock
        if stock is None:
            raise SettingsError(
                f"film process {self.process} needs a stock: film:stock names one, or film:curve draws it"
            )
        expected_curves = 1 if self.process == "monochrome" else 3
        if len(stock.curves) != expected_curves:
            kinds = {1: "black-and-white", 3: "colour"}
            raise SettingsError(
                f"film process {self.process} needs a {kinds[expected_curves]} stock, and {stock.name} is a "
                f"{kinds[len(stock.curves)]} one",
                code="wrong_stock",
            )
        if stock.rises == (self.process == "reversal"):
            goes = "rises" if stock.rises else "falls"
            raise SettingsError(
                f"the curves of {stock.name} run backwards for film process {self.process}: density {goes} with exposure",
                code="wrong_stock",
            )
        if self.process != "reversal" and (self.print_stock is None or len(self.print_stock.curves) != expected_curves):
            got = self.print_stock.name if self.print_stock else "none"
            raise SettingsError(
                f"film process {self.process} needs a print stock of {expected_curves} records, got {got}",
                code="wrong_stock",
            )
        if self.grain.amount > 0 and not stock.granularity:
            raise SettingsError(
                f"no granularity of {stock.name} is known: film:grain:rms must say how grainy it is",
                code="no_granularity",
            )


def film_settings(data: FilmData, *, iso: float = 0.0, name: str | None = None) -> FilmSettings:
    """Film settings from FilmAPI, with the library's stocks filled in.

    Args:
        data: FilmAPI's values at one time.
        iso: speed that the camera is set to, for a digital sensor's noise; 0 for its base speed. Film has its own speed, and the
            picture's exposure has the camera's in it already.
        name: a stock of the library that takes the place of the shot's, process and print included, as after ``--film NAME``.

    Raises:
        SettingsError: a stock is unknown, does not go with the process, or something is out of range, whether the process uses
            it or not.
    """
    if name is not None:
        entry = library_stock(name)
        curve, own_print = replace(data.curve, source="stock"), entry.film.print_stock
        data = replace(data, process=entry.film.process, stock=name, print_stock=own_print, curve=curve, speed=0.0)
    process = data.process
    if process not in PROCESSES:
        raise SettingsError(f"there is no film process '{process}': {hint(process, PROCESSES)}", code="unknown_process")
    check_numbers(data)
    settings = FilmSettings(
        push=data.push,
        white_balance_k=data.white_balance_k,
        tint=data.tint,
        halation=HalationSettings(data.halation.amount, data.halation.radius_mm, data.halation.color),
    )
    if process == "none":
        return settings
    if process == "digital":
        return replace(settings, process=process, sensor=_sensor(data, iso))
    return replace(
        settings,
        process=process,
        stock=_stock(data),
        print_stock=None if process == "reversal" else _print(data),
        grain=GrainSettings(data.grain.amount, data.grain.size_um, data.grain.seed),
    )


def _stock(data: FilmData) -> Stock | None:
    if data.curve.source == "stock":
        return camera_stock(data.stock, data.speed, data.grain.rms) if data.stock else None
    return custom_stock(data.curve, data.process == "reversal", data.process == "monochrome", data.grain.rms)


def _print(data: FilmData) -> Stock:
    if data.print_curve.green:
        return print_stock(data.print_curve)
    return print_stock(data.print_stock or DEFAULT_PRINTS[data.process])


def _sensor(data: FilmData, iso: float) -> SensorSettings:
    sensor, base = data.sensor, data.speed or 100.0
    return SensorSettings(
        full_well_e=sensor.full_well_e,
        read_noise_e=sensor.read_noise_e,
        clip_stops=sensor.clip_stops,
        sensitivity=sensor.sensitivity,
        base_iso=base,
        iso=iso or base,
        photosites=data.resolution,
    )
