"""Settings that every UsdGeomCamera has: its lens, its exposure and its shutter."""

from __future__ import annotations

from dataclasses import dataclass

from usd_schemas.settings.setting import Bounds, Option, Setting, schema_group, setting


@schema_group("Lens", rest="camera")
@dataclass(frozen=True)
class CameraData:
    """The lens as every USD camera has it; lengths are in millimetres and metres, whatever the unit of the scene."""

    f_stop: float = setting("fStop", 0.0, "Stop", "f-number; 0 is a pinhole.", unit="f-number", usd_type="float")
    focal_length_mm: float = setting(
        "focalLength",
        50.0,
        "Focal Length",
        "Focal length of the lens.",
        unit="millimetres",
        usd_type="float",
        length="tenths",
    )
    focus_distance_m: float = setting(
        "focusDistance",
        0.0,
        "Focus Distance",
        "Depth of the plane of focus; 0 focuses at infinity.",
        unit="metres",
        usd_type="float",
        length="units",
    )


@schema_group("Exposure", rest="exposure")
@dataclass(frozen=True)
class ExposureData:
    """The exposure and the shutter as every USD camera has them."""

    exposure_time_s: float = setting(
        "exposure:time",
        1.0,
        "Exposure Time",
        "USD's `exposure:time`: the time that brightness goes by.",
        "Motion is blurred by the shutter's own times.",
        unit="seconds",
        usd_type="float",
        bounds=Bounds(0, 1e9, above=True),
        option=Option("--exposure-time", "TIME", is_time=True),
    )
    iso: float = setting(
        "exposure:iso",
        100.0,
        "ISO",
        "USD's `exposure:iso`: the speed that the camera is set to; twice the speed is a stop.",
        unit="ISO",
        usd_type="float",
        bounds=Bounds(0, 1e9, above=True),
        option=Option("--iso"),
    )
    exposure_f_stop: float = setting(
        "exposure:fStop",
        1.0,
        "Exposure Stop",
        "USD's `exposure:fStop`: an f-number of its own, beside the iris's `fStop`.",
        unit="f-number",
        usd_type="float",
        bounds=Bounds(0, 1e9, above=True),
        option=Option("--exposure-stop"),
    )
    compensation_stops: float = setting(
        "exposure",
        0.0,
        "Compensation",
        "USD's `exposure`: brighter (positive) or darker than what is set.",
        "It does not count where a meter decides the exposure.",
        unit="stops",
        usd_type="float",
        bounds=Bounds(-100, 100),
    )
    responsivity: float = setting(
        "exposure:responsivity",
        1.0,
        "Responsivity",
        "USD's `exposure:responsivity`: a factor on the light.",
        unit="none, a factor",
        usd_type="float",
        bounds=Bounds(0, 1e9, above=True),
    )
    shutter_open: float = setting(
        "shutter:open",
        0.0,
        "Shutter Opens",
        "USD's `shutter:open`, time codes from the frame's own.",
        unit="time codes",
    )
    shutter_close: float = setting(
        "shutter:close",
        0.0,
        "Shutter Closes",
        "USD's `shutter:close`, time codes from the frame's own.",
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
    name="shutter_angle_deg",
    type=float,
    group="Exposure",
)
"""Computed from `shutter:open`, `shutter:close` and the frame rate; setting it sets `shutter:close`."""
