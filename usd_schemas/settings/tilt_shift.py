"""TiltShiftAPI: the lens's movements against the film."""

from __future__ import annotations

from dataclasses import dataclass

from usd_schemas.settings.setting import Bounds, Slider, schema_group, setting


@schema_group("Tilt and Shift", rest="focus")
@dataclass(frozen=True)
class TiltShiftData:
    """TiltShiftAPI: the lens's movements against the film."""

    tilt_deg: float = setting(
        "tiltShift:tilt",
        0.0,
        "Tilt",
        "Turn of the lens about the camera's +X axis: positive looks up, negative lays the plane of focus down over "
        "the ground.",
        unit="degrees",
        hard=(-89, 89),
        soft=(-12, 12),
        slider=Slider(-20, 20, 0.5, unit="°", label="Tilt"),
    )
    swing_deg: float = setting(
        "tiltShift:swing",
        0.0,
        "Swing",
        "Turn of the lens about the camera's +Y axis, before the tilt: positive looks to the left.",
        unit="degrees",
        hard=(-89, 89),
        soft=(-12, 12),
        slider=Slider(-20, 20, 0.5, unit="°", label="Swing"),
    )
    rise_mm: float = setting(
        "tiltShift:rise",
        0.0,
        "Rise",
        "Distance that the lens is moved up against the film; it shows more of what is above, and adds to "
        "verticalApertureOffset.",
        unit="millimetres",
        soft=(-15, 15),
        bounds=Bounds(-1e3, 1e3),
    )
    shift_mm: float = setting(
        "tiltShift:shift",
        0.0,
        "Shift",
        "Distance that the lens is moved to the right against the film; it shows more of what is on the right, and adds "
        "to horizontalApertureOffset.",
        unit="millimetres",
        soft=(-15, 15),
        bounds=Bounds(-1e3, 1e3),
    )
    driven_by_points: bool = setting(
        "tiltShift:fromFocusPoints",
        True,
        "Driven by Focus Points",
        "Where focus:mode is tiltPlane: true lets the plane through the focus points set tilt and swing; false "
        "keeps the authored angles, and the points set the focus distance alone.",
        unit="none, a switch",
    )
    max_angle_deg: float = setting(
        "tiltShift:maxAngle",
        15.0,
        "Largest Angle",
        "Largest angle that focus points may tilt and swing the lens together.",
        unit="degrees",
        hard=(0, 89),
        soft=(None, 45),
        slider=Slider(0, 45, 1, unit="°", label="Largest angle"),
    )
