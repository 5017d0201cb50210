"""Declarations of the shutter and of the light meter."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from usd_schemas.settings.setting import Bounds, Floats, Option, Pair, Slider, schema_group, setting


@schema_group("Film:Shutter", rest="exposure")
@dataclass(frozen=True)
class Shutter:
    """Shutter: the course of the exposure over the picture; the travel time is in seconds."""

    type: Literal["global", "rolling", "focalPlane", "leaf"] = setting(
        "film:shutter:type",
        "global",
        "Type",
        "Order in which a frame's exposure runs over the picture: all at once, row after row as a sensor is read, as a "
        "travelling slit, or by blades at the iris.",
        "When it opens and closes is UsdGeomCamera's shutter:*.",
        unit="none, a token",
        keyable=False,
    )
    direction: Literal["down", "up", "left", "right"] = setting(
        "film:shutter:direction",
        "down",
        "Direction",
        "Direction in which rolling and focal-plane shutters run over the picture as it is seen.",
        unit="none, a token",
        keyable=False,
    )
    travel_s: float = setting(
        "film:shutter:travelTime",
        0.0,
        "Travel Time",
        "Time that a rolling or focal-plane shutter takes from one edge of the picture to the other.",
        unit="seconds",
        hard=(0, None),
        soft=(None, 0.05),
        bounds=Bounds(0, 1e6),
    )
    efficiency: Floats = setting(
        "film:shutter:efficiency",
        (),
        "Efficiency",
        "Share to which the shutter is open at even steps from opening to closing, joined by straight lines; empty for one "
        "that opens and closes at once.",
        unit="none, ratios from 0 to 1",
        bounds=Bounds(0, 1e9, length=256),
    )


@schema_group("Film:Exposure", rest="exposure")
@dataclass(frozen=True)
class Exposing:
    """Which stop the exposure is by."""

    stop: Literal["exposure", "iris"] = setting(
        "film:exposure:stop",
        "exposure",
        "Stop",
        "Stop that exposes: exposure:fStop, or the iris's fStop, so that stopping down darkens the picture.",
        "- exposure: exposure:fStop, a number of its own, as UsdGeomCamera computes its exposure.\n"
        "- iris: fStop, which also deepens the focus; a pinhole keeps exposure:fStop.",
        unit="none, a token",
        keyable=False,
        option=Option("--expose-by"),
    )


@schema_group("Film:Metering", rest="exposure")
@dataclass(frozen=True)
class Metering:
    """Light meter: the part of the picture it reads, its compensation in stops, and its smoothing in seconds."""

    mode: Literal["manual", "spot", "center", "average"] = setting(
        "film:metering:mode",
        "manual",
        "Mode",
        "Meter that decides the compensation of the exposure, if any.",
        "- manual: the attribute exposure, as it is authored.\n"
        "- spot: a meter on film:metering:focusPoint, or on the place film:metering:spot.\n"
        "- center: a meter on the whole picture, its middle most.\n"
        "- average: a meter on the whole picture alike.\n"
        "The meter's reading takes the place of the attribute exposure. Tools that do not meter need it as keys of that "
        "attribute, with the mode set to manual: `pullfocus meter --key` writes such a layer.",
        unit="none, a token",
        keyable=False,
    )
    focus_point: str = setting(
        "film:metering:focusPoint",
        "",
        "Focus Point",
        "Name of the focus point that spot metering looks at; empty takes the place film:metering:spot.",
        unit="none, text",
        keyable=False,
        bounds=Bounds(length=100),
    )
    spot: Pair = setting(
        "film:metering:spot",
        (0.5, 0.5),
        "Spot",
        "Place in the picture that spot metering looks at where no focus point is named: (0, 0) is its top left "
        "corner and (1, 1) the bottom right one.",
        unit="none, shares of the picture's width and height",
        bounds=Bounds(0, 1),
    )
    compensation_stops: float = setting(
        "film:metering:compensation",
        0.0,
        "Compensation",
        "Stops by which the metered light is brighter than middle grey: what the dial on a camera that meters by "
        "itself sets.",
        unit="stops",
        hard=(-20, 20),
        soft=(-3, 3),
        slider=Slider(-6, 6, 1 / 3, unit="stops", label="Brighter", panel="meter"),
    )
    smoothing_s: float = setting(
        "film:metering:smoothing",
        1.0,
        "Smoothing",
        "Time that metering takes to follow a sudden change, half of it ahead and half of it behind; what changes "
        "faster does not flicker in the picture.",
        unit="seconds",
        keyable=False,
        hard=(0.04, 60),
        soft=(0.25, 4),
    )
