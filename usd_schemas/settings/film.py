"""FilmAPI: what the light falls on, and its development and grade."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from usd_schemas.settings.film_curves import CharacteristicCurve, PrintCurve
from usd_schemas.settings.grade import GradeData
from usd_schemas.settings.metering import Exposing, Metering, Shutter
from usd_schemas.settings.setting import Bounds, Range, Slider, Triple, group, schema_group, setting

FilmProcess = Literal["none", "negative", "reversal", "monochrome", "digital"]


@schema_group("Film:Grain", rest="film")
@dataclass(frozen=True)
class Grain:
    """Film grain: amount, RMS granularity in 1/1000 of density, size in micrometres."""

    amount: float = setting(
        "film:grain:amount",
        0.0,
        "Amount",
        "Multiplies the grain: 0 none, 1 as the stock has it.",
        unit="none, a factor",
        hard=(0, None),
        soft=(None, 3),
        accepts=Range(0.0, 100.0),
        slider=Slider(0, 2, 0.1, unit="×", label="Grain"),
    )
    rms: Triple = setting(
        "film:grain:rms",
        (0.0, 0.0, 0.0),
        "RMS Granularity",
        "Diffuse RMS granularity of red, green and blue: 1000 times the standard deviation of density at density "
        "1.0 through a 48 micrometre aperture; 0 takes the stock's.",
        unit="1/1000 of density",
        bounds=Bounds(0, 1e9),
        accepts=Range(0.0, 1000.0, " thousandths of density"),
    )
    size_um: float = setting(
        "film:grain:size",
        0.0,
        "Size",
        "Correlation length of the grain on the film; 0 takes the stock's.",
        unit="micrometres",
        hard=(0, None),
        soft=(None, 30),
        accepts=Range(0.0, 500.0, " µm"),
    )
    seed: int = setting(
        "film:grain:seed",
        0,
        "Seed",
        "Which grain: the same seed and frame number give the same grain.",
        unit="none, a number",
        keyable=False,
        soft=(0, 1000),
        bounds=Bounds(0, 2**31 - 1),
    )


@schema_group("Film:Halation", rest="film")
@dataclass(frozen=True)
class Halation:
    """Light that the film base throws back; the radius is in millimetres on the film."""

    amount: float = setting(
        "film:halation:amount",
        0.0,
        "Amount",
        "Part of the light that the film base throws back around bright points.",
        unit="none, a ratio from 0 to 1",
        hard=(0, 1),
        soft=(None, 0.2),
        bounds=Bounds(0, 1e9),
        slider=Slider(0, 0.1, 0.005, unit="%", label="Halation"),
    )
    radius_mm: float = setting(
        "film:halation:radius",
        0.1,
        "Radius",
        "Radius of the ring of light that comes back.",
        unit="millimetres on the film",
        hard=(0, None),
        soft=(None, 2),
        accepts=Range(0.0, 5.0, " mm"),
    )
    color: Triple = setting(
        "film:halation:color",
        (1.0, 0.3, 0.1),
        "Colour",
        "Colour of the light that comes back, scene-linear.",
        unit="none, ratios",
        usd_type="color3d",
        bounds=Bounds(0, 1e9),
    )


@schema_group("Film:Sensor", rest="film")
@dataclass(frozen=True)
class Sensor:
    """A digital sensor: charges in electrons, clip in stops above middle grey."""

    full_well_e: float = setting(
        "film:sensor:fullWell",
        40000.0,
        "Full Well",
        "Charge at which a photosite clips, at the sensor's base speed.",
        unit="electrons",
        hard=(1, None),
        soft=(None, 150000),
        bounds=Bounds(0, 1e9, above=True),
        accepts=Range(1.0, 1e9, " electrons"),
    )
    read_noise_e: float = setting(
        "film:sensor:readNoise",
        0.0,
        "Read Noise",
        "Standard deviation of the noise of reading one photosite; photon noise follows from the full well.",
        unit="electrons",
        hard=(0, None),
        soft=(None, 30),
        accepts=Range(0.0, 1e6, " electrons"),
    )
    clip_stops: float = setting(
        "film:sensor:clip",
        0.0,
        "Clip",
        "Stops above middle grey at which the sensor clips; 0 never clips.",
        unit="stops",
        hard=(0, None),
        soft=(None, 10),
        accepts=Range(0.0, 40.0, " stops"),
    )
    sensitivity: Triple = setting(
        "film:sensor:sensitivity",
        (1.0, 1.0, 1.0),
        "Channel Sensitivity",
        "Relative sensitivity of the red, green and blue photosites.",
        unit="none, ratios",
        bounds=Bounds(0, 1e9),
        accepts=Range(1e-3, 1e3),
    )


@schema_group("Film", rest="film")
@dataclass(frozen=True)
class FilmData:
    """FilmAPI: what the light falls on and what becomes of it."""

    process: FilmProcess = setting(
        "film:process",
        "none",
        "Process",
        "Film or sensor that the light falls on.",
        "- none: scene-linear light goes straight to the grade.\n"
        "- negative: a colour negative, seen through a print stock.\n"
        "- reversal: a positive, seen directly.\n"
        "- monochrome: a black-and-white negative, seen through a print.\n"
        "- digital: a sensor, film:sensor:*.",
        unit="none, a token",
        keyable=False,
    )
    stock: str = setting(
        "film:stock",
        "",
        "Stock",
        "Name of the camera stock in a film library; empty where the numbers below say it all.",
        unit="none, text",
        keyable=False,
        bounds=Bounds(length=80),
    )
    print_stock: str = setting(
        "film:printStock",
        "",
        "Print Stock",
        "Name of the stock on which a negative is printed.",
        unit="none, text",
        keyable=False,
        bounds=Bounds(length=80),
    )
    body: str = setting(
        "film:body",
        "",
        "Camera Body",
        'Name of the camera body or gate in a body library, such as "Super 35 4-perf".',
        "The size of the gate is UsdGeomCamera's apertures.",
        unit="none, text",
        keyable=False,
        read_only=True,
    )
    resolution: tuple[int, int] = setting(
        "film:resolution",
        (0, 0),
        "Resolution",
        "Photosites of the sensor, across and up; (0, 0) for film or where it does not matter.",
        unit="pixels",
        keyable=False,
        rest="",
        accepts=Range(0, 1_000_000, " photosites"),
    )
    speed: float = setting(
        "film:speed",
        0.0,
        "Rated Speed",
        "The stock's own speed, which anchors its curve to exposure; 0 takes the library's.",
        "Of a sensor, the speed at which it uses its full well whole; 0 is 100. What the camera is set to is "
        "exposure:iso.",
        unit="ISO",
        hard=(0, None),
        soft=(None, 6400),
        accepts=Range(0.01, 1e7, " ISO", zero="the stock's or sensor's own"),
    )
    push: float = setting(
        "film:push",
        0.0,
        "Push",
        "Longer (push, positive) or shorter (pull, negative) development: it moves the stock's curve by log10 2 of "
        "exposure for each stop, and leaves its shape alone.",
        unit="stops",
        hard=(-5, 5),
        soft=(-2, 2),
        slider=Slider(-2, 3, 0.5, unit="stops", zero="none"),
    )
    white_balance_k: float = setting(
        "film:whiteBalance",
        0.0,
        "White Balance",
        "Colour temperature of the light that shall look neutral; 0 leaves the working space's white.",
        unit="kelvin",
        hard=(0, 40000),
        soft=(2000, 10000),
        slider=Slider(2000, 10_000, 100, unit="K", zero="as lit", label="Balance"),
    )
    tint: float = setting(
        "film:tint",
        0.0,
        "Tint",
        "Correction of the white balance across the line of colour temperatures: positive toward magenta.",
        unit="1/3000 of CIE 1960 uv",
        soft=(-150, 150),
    )
    curve: CharacteristicCurve = group(CharacteristicCurve)
    print_curve: PrintCurve = group(PrintCurve)
    grain: Grain = group(Grain)
    halation: Halation = group(Halation)
    sensor: Sensor = group(Sensor)
    shutter: Shutter = group(Shutter)
    exposure: Exposing = group(Exposing)
    metering: Metering = group(Metering)
    grade: GradeData = group(GradeData, prefix="")
