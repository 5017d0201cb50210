"""FocusAPI: how the focus is found."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from usd_schemas.settings.setting import Bounds, Slider, Triples, schema_group, setting

FocusMode = Literal["manual", "points", "tiltPlane", "surface"]


@schema_group("Focus", rest="focus")
@dataclass(frozen=True)
class FocusData:
    """FocusAPI: how the focus is found."""

    mode: FocusMode = setting(
        "focus:mode",
        "manual",
        "Mode",
        "Method that decides the focus.",
        "- manual: focusDistance as it is authored.\n"
        "- points: the focus distance that serves the focus points best.\n"
        "- tiltPlane: the plane through the focus points, reached by tilting the lens (TiltShiftAPI).\n"
        "- surface: a focal surface through every focus point, which no lens could make.",
        unit="none, a token",
        keyable=False,
    )
    solve_stop: bool = setting(
        "focus:solveStop",
        False,
        "Points Set the Stop",
        "Whether the points also set the f-number: the widest at which each keeps to its blur.",
        unit="none, a switch",
    )
    circle_of_confusion_mm: float = setting(
        "focus:circleOfConfusion",
        0.0,
        "Circle of Confusion",
        "Diameter on the film up to which a point counts as sharp, for near and far limits; 0 takes 1/1500 of the "
        "gate's diagonal.",
        unit="millimetres",
        hard=(0, None),
        soft=(None, 0.1),
        bounds=Bounds(0, 1e6),
        slider=Slider(0, 0.1, 0.001, unit="mm", zero="usual", label="Sharp up to"),
    )
    smoothing_s: float = setting(
        "focus:smoothing",
        0.0,
        "Smoothing",
        "Time over which the solved focus is smoothed; it stays exact at keys.",
        "0 for none.",
        unit="seconds",
        hard=(0, None),
        soft=(None, 2),
        bounds=Bounds(0, 1e6),
        slider=Slider(0, 2, 0.05, unit="s"),
    )
    lag_s: float = setting(
        "focus:lag",
        0.0,
        "Lag",
        "Delay with which the focus follows a moving point, like an assistant's hand.",
        unit="seconds",
        hard=(0, None),
        soft=(None, 1),
        bounds=Bounds(0, 1e6),
        slider=Slider(0, 2, 0.05, unit="s"),
    )
    dead_zone_mm: float = setting(
        "focus:deadZone",
        0.0,
        "Dead Zone",
        "Circle of confusion that a followed point may reach before the focus moves.",
        unit="millimetres on the film",
        hard=(0, None),
        soft=(None, 0.1),
        bounds=Bounds(0, 1e6),
        slider=Slider(0, 0.1, 0.005, unit="mm", label="Dead zone"),
    )
    max_speed_deg_s: float = setting(
        "focus:maxSpeed",
        0.0,
        "Fastest Turn",
        "Largest speed of the focus ring, with lens:focusThrow; 0 sets no bound.",
        unit="degrees per second",
        hard=(0, None),
        soft=(None, 720),
        bounds=Bounds(0, 1e6),
        slider=Slider(0, 720, 15, unit="°/s", zero="any", label="Ring speed"),
    )
    near_priority: float = setting(
        "focus:nearPriority",
        0.0,
        "Near Priority",
        "Exponent by which nearer points count more: weights are multiplied by (1/depth)^p, depth in metres; 0 for not at all.",
        unit="none, an exponent",
        hard=(0, None),
        soft=(None, 4),
        bounds=Bounds(0, 16),
        slider=Slider(0, 4, 0.5, label="Near priority"),
    )
    off_screen: Literal["ignore", "keep"] = setting(
        "focus:offScreen",
        "ignore",
        "Off-Screen Points",
        "Treatment of a focus point outside the frame: it is left out, or kept.",
        unit="none, a token",
        keyable=False,
    )
    occluded: Literal["ignore", "keep", "fade"] = setting(
        "focus:occluded",
        "keep",
        "Hidden Points",
        "Treatment of a focus point that something stands before: it is left out, kept, or faded out over "
        "focus:smoothing.",
        unit="none, a token",
        keyable=False,
    )
    surface_exponent: float = setting(
        "focus:surfaceExponent",
        3.0,
        "Exponent",
        "Locality of the focal surface: weights fall with the screen distance d as 1/d^exponent (Lee, Eisemann and "
        "Seidel 2010, section 5.2, beta).",
        unit="none, an exponent",
        hard=(1, None),
        soft=(2, 4),
        group="Focus:Surface",
        bounds=Bounds(1, 16),
        slider=Slider(2, 4, 0.1, label="Locality"),
    )
    expressive: float = setting(
        "focus:expressive",
        1.0,
        "Expressive Blend",
        "From what a lens can do (0) to what is drawn (1): where focus:mode is surface, from the plane of focus to "
        "the focal surface; in all modes, how much of focus:fieldOffsets there is.",
        unit="none, a ratio from 0 to 1",
        hard=(0, 1),
        group="Focus:Surface",
        slider=Slider(0, 1, 0.05, unit="%", label="Expressive"),
    )
    field_offsets: Triples = setting(
        "focus:fieldOffsets",
        (),
        "Field Offsets",
        "Curvature of field drawn by hand: (x, y, offset) with x and y from 0 to 1 across and down the frame and "
        "the offset of the image plane toward the lens, interpolated like the focal surface.",
        unit="none, none, millimetres",
        group="Focus:Surface",
    )
