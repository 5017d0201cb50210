"""Settings that every UsdGeomCamera has: its lens, its exposure and its shutter."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from usd_schemas.settings.setting import MAX_FINITE, Bounds, Option, Range, Setting, Slider, schema_group, setting


@schema_group("Lens", rest="camera")
@dataclass(frozen=True)
class CameraData:
    """The lens as every USD camera has it; lengths are in millimetres and metres, whatever the unit of the scene."""

    f_stop: float = setting(
        "fStop",
        0.0,
        "Stop",
        "f-number; 0 is a pinhole.",
        unit="f-number",
        usd_type="float",
        settable=Range(0, MAX_FINITE, zero="a pinhole"),
        bounds=Bounds(0, 1000),
        slider=Slider(0.7, 32, 2 ** (1 / 6), "stop", label="f-number"),
    )
    focal_length_mm: float = setting(
        "focalLength",
        50.0,
        "Focal Length",
        "Focal length of the lens.",
        unit="millimetres",
        usd_type="float",
        length="tenths",
        settable=Range(0, MAX_FINITE, above=True),
        bounds=Bounds(0, 100_000, above=True),
        slider=Slider(8, 400, 1.02, "zoom", unit="mm", label="Focal length"),
    )
    focus_distance_m: float = setting(
        "focusDistance",
        0.0,
        "Focus Distance",
        "Depth of the plane of focus; 0 focuses at infinity.",
        "Over REST it sets `focusMode` to `manual` where none is sent beside it.",
        unit="metres",
        usd_type="float",
        length="units",
        settable=Range(0, inf, above=True),
        bounds=Bounds(0, 1e9),
        slider=Slider(0.05, 200, 1.02, "ring", unit="m", label="Focus distance"),
    )


@schema_group("Exposure", rest="exposure")
@dataclass(frozen=True)
class ExposureData:
    """The exposure and the shutter as every USD camera has them."""

    exposure_time_s: float = setting(
        "exposure:time",
        1.0,
        "Exposure Time",
        "Time that the picture is exposed for.",
        "It is USD's `exposure:time`, by which brightness goes; motion is blurred by the shutter's own times.",
        unit="seconds",
        usd_type="float",
        bounds=Bounds(0, 1e9, above=True),
        option=Option("--exposure-time", "TIME", is_time=True),
    )
    iso: float = setting(
        "exposure:iso",
        100.0,
        "ISO",
        "Speed that the camera is set to; twice the speed is a stop.",
        "It is USD's `exposure:iso`.",
        unit="ISO",
        usd_type="float",
        bounds=Bounds(0, 1e9, above=True),
        option=Option("--iso"),
        slider=Slider(12.5, 51_200, 2 ** (1 / 3), "iso"),
    )
    exposure_f_stop: float = setting(
        "exposure:fStop",
        1.0,
        "Exposure Stop",
        "f-number that the exposure goes by, which need not be the iris's.",
        "It is USD's `exposure:fStop`.",
        unit="f-number",
        usd_type="float",
        bounds=Bounds(0, 1e9, above=True),
        option=Option("--exposure-stop"),
        slider=Slider(0.7, 32, 2 ** (1 / 6), "stop", label="Stop", panel="stop"),
    )
    compensation_stops: float = setting(
        "exposure",
        0.0,
        "Compensation",
        "Stops brighter (positive) or darker than what is set; it does not count where the meter exposes.",
        "It is USD's `exposure`.",
        unit="stops",
        usd_type="float",
        bounds=Bounds(-100, 100),
        slider=Slider(-6, 6, 1 / 3, unit="stops"),
    )
    responsivity: float = setting(
        "exposure:responsivity",
        1.0,
        "Responsivity",
        "Factor on the light.",
        "It is USD's `exposure:responsivity`.",
        unit="none, a factor",
        usd_type="float",
        bounds=Bounds(0, 1e9, above=True),
    )
    shutter_open: float = setting(
        "shutter:open",
        0.0,
        "Shutter Opens",
        "Time at which the shutter opens, in time codes from the frame's own.",
        "It is USD's `shutter:open`.",
        unit="time codes",
    )
    shutter_close: float = setting(
        "shutter:close",
        0.0,
        "Shutter Closes",
        "Time at which the shutter closes, in time codes from the frame's own.",
        "It is USD's `shutter:close`.",
        unit="time codes",
    )


SHUTTER_ANGLE = Setting(
    usd="",
    default=0.0,
    label="Shutter",
    help="Opening of a rotating shutter that is open for as long; 360 is a whole frame.",
    more="It sets when the shutter closes: send no `shutterClose` beside it.",
    unit="degrees",
    bounds=Bounds(0, 360_000),
    keyable=False,
    rest="exposure",
    slider=Slider(0, 360, 7.5, unit="°", zero="still", panel="shutter"),
    name="shutter_angle_deg",
    type=float,
    group="Exposure",
)
"""Computed from `shutter:open`, `shutter:close` and the frame rate; setting it sets `shutter:close`."""
