"""Film stocks: characteristic curves, the exposure that anchors them, and granularity."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from render.errors import SettingsError
from render.film.curve import MAX_LOG_EXPOSURE, Curve, Knots, parametric_knots
from usd_schemas import CharacteristicCurve, LibraryFilm, PrintCurve, SchemaError, library_film

MIDDLE_GREY = 0.18
"""Reflectance of the grey that meters are made for, and its value in a well exposed scene-linear picture."""
NEGATIVE_AIM = 0.75
"""Density above base of a metered grey on a negative: what laboratories aim at, 0.7 to 0.8 in the green record."""
PRINT_AIM = 1.0
"""Density above base of that grey on a print: Kodak's laboratory aim density (publication H-61) is 1.0 within 0.1 in each record
of Status A. Equal above the base in all three, so that grey is as neutral as the clear print."""

_CHANNELS = ("red", "green", "blue")
_NET_DENSITIES = np.concatenate([[0.0], np.geomspace(0.01, 1.0, 16), np.geomspace(1.0, 4.0, 8)[1:]])


@dataclass(frozen=True)
class Stock:
    """Camera or print stock: three records, or one for black and white.

    Attributes:
        name: for messages and metadata.
        curves: of red, green and blue; or one.
        middle_log_exposure: log10 exposure where a metered 18 % grey lands, for each curve; of a print stock, where the
            printer's lights put it.
        granularity: (density, standard deviation of density through a round 48 µm aperture) for each curve; empty where it
            is not known.

    Raises:
        SettingsError: the curves do not all rise or all fall, or grey lands beyond all exposures.
    """

    name: str
    curves: tuple[Curve, ...]
    middle_log_exposure: tuple[float, ...]
    granularity: tuple[Knots, ...] = ()

    def __post_init__(self) -> None:
        if any(curve.rises != self.curves[0].rises for curve in self.curves):
            raise SettingsError(
                f"the curves of {self.name} must all rise (a negative) or all fall (a reversal stock) with exposure",
                code="bad_curve",
            )
        if not all(abs(middle) <= MAX_LOG_EXPOSURE for middle in self.middle_log_exposure):
            raise SettingsError(
                f"middle grey of {self.name} must land from {-MAX_LOG_EXPOSURE:g} to {MAX_LOG_EXPOSURE:g} of log10 "
                f"exposure, got {', '.join(f'{middle:g}' for middle in self.middle_log_exposure)}",
                code="bad_curve",
            )

    @property
    def rises(self) -> bool:
        """Whether it is a negative or print stock; a reversal stock's density falls with exposure."""
        return self.curves[0].rises

    @property
    def base(self) -> tuple[float, ...]:
        """Least density of each curve."""
        return tuple(curve.base for curve in self.curves)

    @property
    def middle_density(self) -> tuple[float, ...]:
        """Density of a metered 18 % grey on each curve."""
        pairs = zip(self.curves, self.middle_log_exposure, strict=True)
        return tuple(float(curve.density(exposure)) for curve, exposure in pairs)


def camera_stock(name: str, speed: float = 0.0, rms: Sequence[float] = (0.0, 0.0, 0.0)) -> Stock:
    """Stock of the library, anchored by its speed.

    A reversal stock is anchored by its green record, and filtered (as a photographer does, with the filters that the maker
    prints on the box) so that the grey of red and blue lies equally far above the base: there is no print to set it right.

    Args:
        name: of the library, or a part of it.
        speed: ISO speed that it is rated at; 0 for the library's. Twice the speed needs half the exposure.
        rms: diffuse RMS granularity of red, green and blue, in 1/1000 of density; 0 takes the library's.

    Raises:
        SettingsError: the library has no such camera stock, or the speed puts grey beyond all exposures.
    """
    entry = library_stock(name)
    if entry.kind != "camera":
        raise SettingsError(f"{entry.name} is a print stock, expected one for the camera", code="unknown_stock")
    film = entry.film
    curves = _curves(film.curve, entry.name)
    middle = film.curve.middle_gray - (math.log10(speed / film.speed) if speed > 0 else 0.0)
    middles = (middle,) * len(curves)
    if film.process == "reversal":
        filters = _neutral_at(curves, film.curve.middle_gray)
        middles = tuple(middle + shift for shift in filters)
    stock = Stock(entry.name, curves, middles)
    channel_rms = tuple(own or known for own, known in zip(rms, film.grain.rms, strict=True))
    return replace(stock, granularity=_granularity(entry, stock, channel_rms if len(curves) == 3 else channel_rms[1:2]))


def custom_stock(curve: CharacteristicCurve, reversal: bool, monochrome: bool, rms: Sequence[float]) -> Stock:
    """Stock whose curve the shot itself gives, by knots or by toe, line and shoulder.

    Args:
        curve: FilmAPI's curve, its source ``knots`` or ``parametric``.
        reversal: whether it is a positive; it decides the aim of parametric curves.
        monochrome: whether the green record is all there is.
        rms: diffuse RMS granularity of red, green and blue, in 1/1000 of density; 0 for no grain.

    Raises:
        SettingsError: a curve is impossible, or grey lands beyond all exposures.
    """
    if curve.source == "knots":
        curves = _curves(curve, "film:curve", monochrome)
    else:
        channels = (1,) if monochrome else (0, 1, 2)
        aim = PRINT_AIM if reversal else NEGATIVE_AIM
        curves = tuple(_parametric(curve, channel, aim) for channel in channels)
    stock = Stock("the film that the shot draws", curves, (curve.middle_gray,) * len(curves))
    return replace(stock, granularity=_siedentopf(stock, rms[1:2] if monochrome else rms) if any(rms) else ())


def print_stock(name_or_curve: str | PrintCurve) -> Stock:
    """Print stock; its middle exposure is the setting of the printer's lights, at which grey has the density
    `PRINT_AIM` above base.

    Args:
        name_or_curve: of the library; or the curves that the shot draws.

    Raises:
        SettingsError: the library has no such print stock, or the curves are impossible or fall.
    """
    if isinstance(name_or_curve, str):
        entry = library_stock(name_or_curve)
        if entry.kind != "print":
            raise SettingsError(f"{entry.name} is a camera stock, expected one for prints", code="unknown_stock")
        name, curves = entry.name, _curves(entry.film.print_curve, entry.name)
    else:
        name, curves = "the print that the shot draws", _curves(name_or_curve, "film:printCurve")
    if not all(curve.rises for curve in curves):
        raise SettingsError(
            f"the curves of {name} run backwards: a print's density rises with exposure", code="bad_curve"
        )
    aims = [curve.base + min(PRINT_AIM, (curve.greatest - curve.base) / 2) for curve in curves]
    return Stock(name, curves, tuple(curve.exposure_at(aim) for curve, aim in zip(curves, aims, strict=True)))


def library_stock(name: str) -> LibraryFilm:
    """Stock of the library; an unknown name raises a setting's error.

    Args:
        name: of the library, or a part of it.

    Raises:
        SettingsError: no such stock.
    """
    try:
        return library_film(name)
    except SchemaError as error:
        raise SettingsError(str(error), code="unknown_stock") from error


def _curves(drawn: CharacteristicCurve | PrintCurve, name: str, monochrome: bool = False) -> tuple[Curve, ...]:
    """Curves of the stock: the green one alone, or all three."""
    knots = [drawn.green] if monochrome or not (drawn.red or drawn.blue) else [drawn.red, drawn.green, drawn.blue]
    channels = _CHANNELS if len(knots) == 3 else ("green",)
    return tuple(Curve(k, f"the {channel} curve of {name}") for k, channel in zip(knots, channels, strict=True))


def _parametric(curve: CharacteristicCurve, channel: int, aim: float) -> Curve:
    name = f"the {_CHANNELS[channel]} curve of film:curve"
    numbers = (curve.min_density, curve.max_density, curve.gamma, curve.toe, curve.shoulder)
    least, greatest, gamma, toe, shoulder = (number[channel] for number in numbers)
    return Curve(parametric_knots(least, greatest, gamma, toe, shoulder, aim, name), name)


def _neutral_at(curves: tuple[Curve, ...], middle: float) -> list[float]:
    """Additional log exposure that each record needs for a density above base equal to the green record's at ``middle``."""
    green = curves[1]
    above_base = float(green.density(middle)) - green.base
    return [curve.exposure_at(curve.base + above_base) - middle for curve in curves]


def _granularity(entry: LibraryFilm, stock: Stock, rms: Sequence[float]) -> tuple[Knots, ...]:
    """Granularity curves from the maker's measurements, scaled to the single figure where there is one; else from a law
    fitted to it.
    """
    if not entry.granularity:
        return _siedentopf(stock, rms) if any(rms) else ()
    channels = _CHANNELS if len(stock.curves) == 3 else ("green",)
    tables = []
    for channel, base, figure in zip(channels, stock.base, rms, strict=True):
        densities, deviations = np.array(entry.granularity[channel]).T
        densities = densities + (base if entry.granularity_from_base else 0.0)
        if figure:
            deviations = deviations * figure / 1000 / np.interp(base + 1.0, densities, deviations)
        tables.append(tuple(zip(densities.tolist(), deviations.tolist(), strict=True)))
    return tuple(tables)


def _siedentopf(stock: Stock, rms: Sequence[float]) -> tuple[Knots, ...]:
    """Granularity that grows as the root of the density above base (Siedentopf 1937; Selwyn 1935), ``rms``/1000 at 1.0."""
    roots = np.sqrt(_NET_DENSITIES)
    return tuple(
        tuple(zip((base + _NET_DENSITIES).tolist(), (figure / 1000 * roots).tolist(), strict=True))
        for base, figure in zip(stock.base, rms, strict=True)
    )
