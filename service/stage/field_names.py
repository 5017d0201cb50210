"""Names of settings that differ between REST, where they carry their unit, and the shot."""

from __future__ import annotations

from service.models.changes import KeyedSetting
from service.models.solving import FocusSettings
from usd_schemas.settings.tables import rest_settings

FOCUS_OF_FIELD = {
    "circle_of_confusion_mm": "circle_of_confusion",
    "smoothing_s": "smoothing",
    "lag_s": "lag",
    "dead_zone_mm": "dead_zone",
    "max_speed_deg_s": "max_speed",
    "tilt_deg": "tilt",
    "swing_deg": "swing",
    "rise_mm": "rise",
    "shift_mm": "shift",
    "driven_by_points": "from_focus_points",
    "max_angle_deg": "max_angle",
}


_LENS_NAMES = {"focusDistanceM": "focus_distance_m", "fStop": "f_stop", "focalLengthMm": "focal_length_mm"}
_FOCUS_NAMES = {str(info.alias): FOCUS_OF_FIELD.get(field, field) for field, info in FocusSettings.model_fields.items()}
_PHOTOGRAPHY_NAMES = {item.camel_name: item.name for item in rest_settings("exposure") + rest_settings("film")}
_NAMES = _FOCUS_NAMES | _PHOTOGRAPHY_NAMES | _LENS_NAMES


def setting_name(setting: KeyedSetting) -> str:
    """Return the shot's name of a camera's setting that takes keys.

    Args:
        setting: its name over REST.
    """
    return _NAMES[setting]
