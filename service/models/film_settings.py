"""What a camera's light falls on and what becomes of it: film or sensor, and grade, and the keys of all that."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import KEYS_AT, Bounded, Model, NotNegative, Positive, TimeCode, shown_as
from service.models.films import FilmProcess, Knots
from service.models.focus import KEY_EXAMPLE, Key

FILM_EXAMPLE: JsonDict = {
    "camera": "/World/Camera",
    "time": 24.0,
    "body": "Super 35 4-perf",
    "gateMm": [24.89, 18.66],
    "process": "negative",
    "stock": "vision3_500t_5219",
    "printStock": "vision_2383",
    "speed": 0.0,
    "push": 1.0,
    "whiteBalanceK": 3200.0,
    "tint": 0.0,
    "curveSource": "stock",
    "curveRed": [],
    "curveGreen": [],
    "curveBlue": [],
    "curveMiddleGray": 0.0,
    "curveMinDensity": [0.1, 0.1, 0.1],
    "curveMaxDensity": [2.5, 2.5, 2.5],
    "curveGamma": [0.6, 0.6, 0.6],
    "curveToe": [0.5, 0.5, 0.5],
    "curveShoulder": [0.5, 0.5, 0.5],
    "grainAmount": 1.0,
    "grainRms": [0.0, 0.0, 0.0],
    "grainSizeUm": 0.0,
    "grainSeed": 0,
    "halationAmount": 0.01,
    "halationRadiusMm": 0.1,
    "halationColor": [1.0, 0.3, 0.1],
    "sensorFullWellE": 40000.0,
    "sensorReadNoiseE": 0.0,
    "sensorClipStops": 0.0,
    "sensorSensitivity": [1.0, 1.0, 1.0],
    "display": "sRGB - Display",
    "view": "ACES 2.0 - SDR 100 nits (Rec.709)",
    "look": "",
    "cdlSlope": [1.0, 1.0, 1.0],
    "cdlOffset": [0.0, 0.0, 0.0],
    "cdlPower": [1.0, 1.0, 1.0],
    "cdlSaturation": 1.0,
    "ocioConfig": "",
    "cdlFile": "",
    "keys": {"push": [KEY_EXAMPLE]},
    "etag": '"92c4bf18a0860070"',
}


CurveSource = Literal["stock", "knots", "parametric"]
FilmKeyed = Literal[
    "speed",
    "push",
    "whiteBalanceK",
    "tint",
    "curveMiddleGray",
    "grainAmount",
    "grainSizeUm",
    "halationAmount",
    "halationRadiusMm",
    "sensorFullWellE",
    "sensorReadNoiseE",
    "sensorClipStops",
    "cdlSaturation",
]


Triple = tuple[float, float, float]
BoundedTriple = tuple[Bounded, Bounded, Bounded]
NotNegativeTriple = tuple[NotNegative, NotNegative, NotNegative]
KnotsEdit = Annotated[tuple[tuple[Bounded, Bounded], ...], Field(max_length=256)]
Kelvin = Annotated[float, Field(ge=0, le=40_000)]
Word = Annotated[str, Field(max_length=200)]

_FILM: dict[str, str] = {
    "process": "`negative` and `monochrome` are seen through a print, `reversal` is seen itself, `digital` is a sensor.",
    "stock": "Name of the stock in the camera, of the library.",
    "print_stock": "Name of the stock that a negative is printed on; empty takes the usual one.",
    "speed": "ISO speed that the film is rated at, or the sensor's base; 0 takes the stock's own.",
    "push": "Stops by which it is developed longer.",
    "white_balance_k": "Colour temperature that looks neutral; 0 leaves the light as it is.",
    "tint": "Across the line of colour temperatures; positive toward magenta.",
    "curve_source": "Whether density goes by the stock's curve, by knots or by the numbers of `curve…`.",
    "curve_red": "Knots (log10 exposure, density).",
    "curve_green": "Knots (log10 exposure, density); of black and white the one curve.",
    "curve_blue": "Knots (log10 exposure, density).",
    "curve_middle_gray": "Log exposure where a metered 18 % grey lands.",
    "curve_min_density": "Base and fog of red, green and blue.",
    "curve_max_density": "Of red, green and blue.",
    "curve_gamma": "Slope of the straight line of red, green and blue.",
    "curve_toe": "How far the toe reaches, of red, green and blue.",
    "curve_shoulder": "How far the shoulder reaches, of red, green and blue.",
    "grain_amount": "0 is none, 1 as the stock has it.",
    "grain_rms": "Diffuse RMS granularity of red, green and blue, in 1/1000 of density; 0 takes the stock's.",
    "grain_size_um": "Correlation length on the film; 0 takes the usual one.",
    "grain_seed": "Which grain.",
    "halation_amount": "Share of the light that the base throws back.",
    "halation_radius_mm": "Of its ring, on the film.",
    "halation_color": "Its ratio in red, green and blue.",
    "sensor_full_well_e": "Electrons that a photosite holds.",
    "sensor_read_noise_e": "In electrons.",
    "sensor_clip_stops": "Above middle grey; 0 takes what the full well says.",
    "sensor_sensitivity": "Of red, green and blue.",
    "display": "Of the OpenColorIO configuration; empty takes its default.",
    "view": "Of the display; empty takes its default.",
    "look": "Looks of the configuration, with commas between; `-` in front inverts.",
    "cdl_slope": "Of the ASC CDL: red, green and blue.",
    "cdl_offset": "Of the ASC CDL: red, green and blue.",
    "cdl_power": "Of the ASC CDL: red, green and blue.",
    "cdl_saturation": "Of the ASC CDL.",
}


class FilmSettings(Model):
    """What a camera's light falls on at one time, and what becomes of it."""

    model_config = shown_as(FILM_EXAMPLE)

    camera: str = Field(description="Prim path.")
    time: float = Field(description="USD time code.")
    body: str = Field(description="What the body is called, the `title` of one of the library; may be empty.")
    gate_mm: tuple[float, float] = Field(description="USD's apertures: the gate as wide as it looks through the lens.")
    process: FilmProcess = Field(description=_FILM["process"])
    stock: str = Field(description=_FILM["stock"])
    print_stock: str = Field(description=_FILM["print_stock"])
    speed: float = Field(description=_FILM["speed"])
    push: float = Field(description=_FILM["push"])
    white_balance_k: float = Field(description=_FILM["white_balance_k"])
    tint: float = Field(description=_FILM["tint"])
    curve_source: CurveSource = Field(description=_FILM["curve_source"])
    curve_red: Knots = Field(description=_FILM["curve_red"])
    curve_green: Knots = Field(description=_FILM["curve_green"])
    curve_blue: Knots = Field(description=_FILM["curve_blue"])
    curve_middle_gray: float = Field(description=_FILM["curve_middle_gray"])
    curve_min_density: Triple = Field(description=_FILM["curve_min_density"])
    curve_max_density: Triple = Field(description=_FILM["curve_max_density"])
    curve_gamma: Triple = Field(description=_FILM["curve_gamma"])
    curve_toe: Triple = Field(description=_FILM["curve_toe"])
    curve_shoulder: Triple = Field(description=_FILM["curve_shoulder"])
    grain_amount: float = Field(description=_FILM["grain_amount"])
    grain_rms: Triple = Field(description=_FILM["grain_rms"])
    grain_size_um: float = Field(description=_FILM["grain_size_um"])
    grain_seed: int = Field(description=_FILM["grain_seed"])
    halation_amount: float = Field(description=_FILM["halation_amount"])
    halation_radius_mm: float = Field(description=_FILM["halation_radius_mm"])
    halation_color: Triple = Field(description=_FILM["halation_color"])
    sensor_full_well_e: float = Field(description=_FILM["sensor_full_well_e"])
    sensor_read_noise_e: float = Field(description=_FILM["sensor_read_noise_e"])
    sensor_clip_stops: float = Field(description=_FILM["sensor_clip_stops"])
    sensor_sensitivity: Triple = Field(description=_FILM["sensor_sensitivity"])
    display: str = Field(description=_FILM["display"])
    view: str = Field(description=_FILM["view"])
    look: str = Field(description=_FILM["look"])
    cdl_slope: Triple = Field(description=_FILM["cdl_slope"])
    cdl_offset: Triple = Field(description=_FILM["cdl_offset"])
    cdl_power: Triple = Field(description=_FILM["cdl_power"])
    cdl_saturation: float = Field(description=_FILM["cdl_saturation"])
    ocio_config: str = Field(
        description="The OpenColorIO configuration that the shot names; empty for the service's own."
    )
    cdl_file: str = Field(description="The CDL file that the shot names, in place of the numbers; empty for none.")
    keys: dict[FilmKeyed, list[Key]] = Field(description="Keys in order of time, of each setting that has any.")
    etag: str = Field(description="The camera's `ETag`: for `If-Match`.")


class FilmSettingsEdit(Model):
    """What to change of film and grade; what is left out stays as it is."""

    model_config = shown_as({"stock": "5219", "push": 1, "whiteBalanceK": 3200})

    stock: Annotated[str, Field(max_length=80)] | None = Field(
        default=None,
        description="Puts a stock of the library in the camera, by its name or a part of it that no other has, null none: for "
        "all time. It brings its process and its curves, and where there was no film its print and its grain; what is sent "
        "beside it is set after that. Left out, the film stays.",
    )
    process: FilmProcess | None = Field(default=None, description=_FILM["process"])
    print_stock: Annotated[str, Field(max_length=80)] | None = Field(default=None, description=_FILM["print_stock"])
    speed: NotNegative | None = Field(default=None, description=_FILM["speed"])
    push: Annotated[float, Field(ge=-5, le=5)] | None = Field(default=None, description=_FILM["push"])
    white_balance_k: Kelvin | None = Field(default=None, description=_FILM["white_balance_k"])
    tint: Bounded | None = Field(default=None, description=_FILM["tint"])
    curve_source: CurveSource | None = Field(default=None, description=_FILM["curve_source"])
    curve_red: KnotsEdit | None = Field(default=None, description=_FILM["curve_red"])
    curve_green: KnotsEdit | None = Field(default=None, description=_FILM["curve_green"])
    curve_blue: KnotsEdit | None = Field(default=None, description=_FILM["curve_blue"])
    curve_middle_gray: Bounded | None = Field(default=None, description=_FILM["curve_middle_gray"])
    curve_min_density: NotNegativeTriple | None = Field(default=None, description=_FILM["curve_min_density"])
    curve_max_density: NotNegativeTriple | None = Field(default=None, description=_FILM["curve_max_density"])
    curve_gamma: NotNegativeTriple | None = Field(default=None, description=_FILM["curve_gamma"])
    curve_toe: NotNegativeTriple | None = Field(default=None, description=_FILM["curve_toe"])
    curve_shoulder: NotNegativeTriple | None = Field(default=None, description=_FILM["curve_shoulder"])
    grain_amount: NotNegative | None = Field(default=None, description=_FILM["grain_amount"])
    grain_rms: NotNegativeTriple | None = Field(default=None, description=_FILM["grain_rms"])
    grain_size_um: NotNegative | None = Field(default=None, description=_FILM["grain_size_um"])
    grain_seed: Annotated[int, Field(ge=0, le=2**31 - 1)] | None = Field(default=None, description=_FILM["grain_seed"])
    halation_amount: NotNegative | None = Field(default=None, description=_FILM["halation_amount"])
    halation_radius_mm: NotNegative | None = Field(default=None, description=_FILM["halation_radius_mm"])
    halation_color: NotNegativeTriple | None = Field(default=None, description=_FILM["halation_color"])
    sensor_full_well_e: Positive | None = Field(default=None, description=_FILM["sensor_full_well_e"])
    sensor_read_noise_e: NotNegative | None = Field(default=None, description=_FILM["sensor_read_noise_e"])
    sensor_clip_stops: NotNegative | None = Field(default=None, description=_FILM["sensor_clip_stops"])
    sensor_sensitivity: NotNegativeTriple | None = Field(default=None, description=_FILM["sensor_sensitivity"])
    display: Word | None = Field(default=None, description=_FILM["display"])
    view: Word | None = Field(default=None, description=_FILM["view"])
    look: Word | None = Field(default=None, description=_FILM["look"])
    cdl_slope: BoundedTriple | None = Field(default=None, description=_FILM["cdl_slope"])
    cdl_offset: BoundedTriple | None = Field(default=None, description=_FILM["cdl_offset"])
    cdl_power: BoundedTriple | None = Field(default=None, description=_FILM["cdl_power"])
    cdl_saturation: NotNegative | None = Field(default=None, description=_FILM["cdl_saturation"])
    time: TimeCode | None = Field(default=None, description=KEYS_AT)


class DisplayChoice(Model):
    """A display of an OpenColorIO configuration."""

    model_config = shown_as(
        {"name": "sRGB - Display", "views": ["ACES 2.0 - SDR 100 nits (Rec.709)", "Raw"], "defaultView": "Raw"}
    )

    name: str
    views: list[str]
    default_view: str


class GradeChoices(Model):
    """What a camera's picture can be graded by."""

    model_config = shown_as(
        {
            "displays": [{"name": "sRGB - Display", "views": ["Raw", "Un-tone-mapped"], "defaultView": "Raw"}],
            "defaultDisplay": "sRGB - Display",
            "looks": ["ACES 1.3 Reference Gamut Compression"],
        }
    )

    displays: list[DisplayChoice]
    default_display: str
    looks: list[str]
