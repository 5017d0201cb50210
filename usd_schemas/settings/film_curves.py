"""Characteristic curves of camera and print stocks."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from usd_schemas.settings.setting import Bounds, Pairs, Range, Triple, schema_group, setting


@schema_group("Film:Characteristic Curve", rest="film")
@dataclass(frozen=True)
class CharacteristicCurve:
    """Density against log10 exposure for each channel, as knots or as toe, straight line and shoulder."""

    source: Literal["stock", "knots", "parametric"] = setting(
        "film:curve:source",
        "stock",
        "Curve From",
        "Where the characteristic curve comes from: the library's stock, the knots below, or the parameters of toe, "
        "straight line and shoulder.",
        unit="none, a token",
        keyable=False,
    )
    red: Pairs = setting(
        "film:curve:red",
        (),
        "Red Knots",
        "Knots (log10 exposure, density) of the red-sensitive layer's curve, log exposure increasing; joined by a "
        "monotone cubic and level beyond the ends.",
        unit="log10 lux-seconds or relative to them; optical density",
        bounds=Bounds(length=256),
    )
    green: Pairs = setting(
        "film:curve:green",
        (),
        "Green Knots",
        "Knots (log10 exposure, density) of the green-sensitive layer's curve, and of a black-and-white stock's.",
        unit="log10 lux-seconds or relative to them; optical density",
        bounds=Bounds(length=256),
    )
    blue: Pairs = setting(
        "film:curve:blue",
        (),
        "Blue Knots",
        "Knots (log10 exposure, density) of the blue-sensitive layer's curve.",
        unit="log10 lux-seconds or relative to them; optical density",
        bounds=Bounds(length=256),
    )
    middle_gray: float = setting(
        "film:curve:middleGray",
        0.0,
        "Middle Grey",
        "Log exposure at which a correctly metered 18 % grey lands on the curves; used by knots and parameters.",
        unit="log10 exposure, as the knots",
        soft=(-4, 2),
        accepts=Range(-30.0, 30.0, " of log10 exposure"),
    )
    min_density: Triple = setting(
        "film:curve:minDensity",
        (0.1, 0.1, 0.1),
        "Least Density",
        "Density without exposure (base and fog) of red, green and blue, for the parametric curve.",
        unit="optical density",
        bounds=Bounds(0, 1e9),
    )
    max_density: Triple = setting(
        "film:curve:maxDensity",
        (2.5, 2.5, 2.5),
        "Greatest Density",
        "Density that full exposure nears, of red, green and blue, for the parametric curve.",
        unit="optical density",
        bounds=Bounds(0, 1e9),
    )
    gamma: Triple = setting(
        "film:curve:gamma",
        (0.6, 0.6, 0.6),
        "Gamma",
        "Slope of the straight line, of red, green and blue, for the parametric curve; negative for reversal stock.",
        "The line passes the laboratory's aim at log exposure 0: 0.75 above the least density on a negative, 1.0 on "
        "a reversal stock; or half the curve's range where that is less.",
        unit="density over log10 exposure",
        bounds=Bounds(0, 1e9),
    )
    toe: Triple = setting(
        "film:curve:toe",
        (0.5, 0.5, 0.5),
        "Toe",
        "Length of the bend at the least density, a parabola, of red, green and blue, for the parametric curve.",
        unit="log10 exposure",
        bounds=Bounds(0, 1e9),
    )
    shoulder: Triple = setting(
        "film:curve:shoulder",
        (0.5, 0.5, 0.5),
        "Shoulder",
        "Length of the bend at the greatest density, a parabola, of red, green and blue, for the parametric curve.",
        unit="log10 exposure",
        bounds=Bounds(0, 1e9),
    )


@schema_group("Film:Print Curve")
@dataclass(frozen=True)
class PrintCurve:
    """Density against log10 exposure of the print stock, as knots."""

    red: Pairs = setting(
        "film:printCurve:red",
        (),
        "Red Knots",
        "Knots (log10 exposure, density) of the print stock's red-sensitive layer; empty takes film:printStock's.",
        unit="log10 exposure; optical density",
    )
    green: Pairs = setting(
        "film:printCurve:green",
        (),
        "Green Knots",
        "Knots (log10 exposure, density) of the print stock's green-sensitive layer.",
        unit="log10 exposure; optical density",
    )
    blue: Pairs = setting(
        "film:printCurve:blue",
        (),
        "Blue Knots",
        "Knots (log10 exposure, density) of the print stock's blue-sensitive layer.",
        unit="log10 exposure; optical density",
    )
