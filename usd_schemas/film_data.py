"""What FilmAPI says, as frozen dataclasses; see `usd_schemas.data` for the rules."""

# ruff: noqa: RUF009  (usd() and group() are dataclasses.field with the property's name)

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from usd_schemas.data import Asset, FilmProcess, Floats, Pair, Pairs, Triple, group, usd


@dataclass(frozen=True)
class CharacteristicCurve:
    """Density against log10 exposure for each channel, as knots or as toe, straight line and shoulder."""

    source: Literal["stock", "knots", "parametric"] = usd("film:curve:source", "stock")
    red: Pairs = usd("film:curve:red", ())
    green: Pairs = usd("film:curve:green", ())
    blue: Pairs = usd("film:curve:blue", ())
    middle_gray: float = usd("film:curve:middleGray", 0.0)
    min_density: Triple = usd("film:curve:minDensity", (0.1, 0.1, 0.1))
    max_density: Triple = usd("film:curve:maxDensity", (2.5, 2.5, 2.5))
    gamma: Triple = usd("film:curve:gamma", (0.6, 0.6, 0.6))
    toe: Triple = usd("film:curve:toe", (0.5, 0.5, 0.5))
    shoulder: Triple = usd("film:curve:shoulder", (0.5, 0.5, 0.5))


@dataclass(frozen=True)
class PrintCurve:
    """Density against log10 exposure of the print stock, as knots."""

    red: Pairs = usd("film:printCurve:red", ())
    green: Pairs = usd("film:printCurve:green", ())
    blue: Pairs = usd("film:printCurve:blue", ())


@dataclass(frozen=True)
class Grain:
    """Film grain: amount, RMS granularity in 1/1000 of density, size in micrometres."""

    amount: float = usd("film:grain:amount", 0.0)
    rms: Triple = usd("film:grain:rms", (0.0, 0.0, 0.0))
    size: float = usd("film:grain:size", 0.0)
    seed: int = usd("film:grain:seed", 0)


@dataclass(frozen=True)
class Halation:
    """Light that the film base throws back; the radius is in millimetres on the film."""

    amount: float = usd("film:halation:amount", 0.0)
    radius: float = usd("film:halation:radius", 0.1)
    color: Triple = usd("film:halation:color", (1.0, 0.3, 0.1))


@dataclass(frozen=True)
class Sensor:
    """A digital sensor: charges in electrons, clip in stops above middle grey."""

    full_well: float = usd("film:sensor:fullWell", 40000.0)
    read_noise: float = usd("film:sensor:readNoise", 0.0)
    clip: float = usd("film:sensor:clip", 0.0)
    sensitivity: Triple = usd("film:sensor:sensitivity", (1.0, 1.0, 1.0))


@dataclass(frozen=True)
class Shutter:
    """How the exposure runs over the picture; the travel time is in seconds."""

    type: Literal["global", "rolling", "focalPlane", "leaf"] = usd("film:shutter:type", "global")
    direction: Literal["down", "up", "left", "right"] = usd("film:shutter:direction", "down")
    travel_time: float = usd("film:shutter:travelTime", 0.0)
    efficiency: Floats = usd("film:shutter:efficiency", ())


@dataclass(frozen=True)
class Exposing:
    """Which stop the exposure is by."""

    stop: Literal["exposure", "iris"] = usd("film:exposure:stop", "exposure")


@dataclass(frozen=True)
class Metering:
    """What a meter looks at, by how many stops more than it says to expose, and over how many seconds it is smoothed."""

    mode: Literal["manual", "spot", "center", "average"] = usd("film:metering:mode", "manual")
    focus_point: str = usd("film:metering:focusPoint", "")
    spot: Pair = usd("film:metering:spot", (0.5, 0.5))
    compensation: float = usd("film:metering:compensation", 0.0)
    smoothing: float = usd("film:metering:smoothing", 1.0)


@dataclass(frozen=True)
class GradeData:
    """OpenColorIO's display, view and look, and the ASC CDL of the shot."""

    config: Asset = usd("film:ocio:config", Asset())
    display: str = usd("film:ocio:display", "")
    view: str = usd("film:ocio:view", "")
    look: str = usd("film:ocio:look", "")
    cdl_slope: Triple = usd("film:cdl:slope", (1.0, 1.0, 1.0))
    cdl_offset: Triple = usd("film:cdl:offset", (0.0, 0.0, 0.0))
    cdl_power: Triple = usd("film:cdl:power", (1.0, 1.0, 1.0))
    cdl_saturation: float = usd("film:cdl:saturation", 1.0)
    cdl_file: Asset = usd("film:cdl:file", Asset())
    cdl_id: str = usd("film:cdl:id", "")


@dataclass(frozen=True)
class FilmData:
    """FilmAPI: what the light falls on and what becomes of it."""

    process: FilmProcess = usd("film:process", "none")
    stock: str = usd("film:stock", "")
    print_stock: str = usd("film:printStock", "")
    body: str = usd("film:body", "")
    resolution: tuple[int, int] = usd("film:resolution", (0, 0))
    speed: float = usd("film:speed", 0.0)
    push: float = usd("film:push", 0.0)
    white_balance: float = usd("film:whiteBalance", 0.0)
    tint: float = usd("film:tint", 0.0)
    curve: CharacteristicCurve = group(CharacteristicCurve)
    print_curve: PrintCurve = group(PrintCurve)
    grain: Grain = group(Grain)
    halation: Halation = group(Halation)
    sensor: Sensor = group(Sensor)
    shutter: Shutter = group(Shutter)
    exposure: Exposing = group(Exposing)
    metering: Metering = group(Metering)
    grade: GradeData = group(GradeData)
