"""Names of settings that differ between REST, where they carry their unit, and the shot."""

from __future__ import annotations

from service.models.exposure import ExposureKeyed
from service.models.film_settings import FilmKeyed
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


def photography_setting(attribute: ExposureKeyed | FilmKeyed) -> str:
    """Return the shot's name of an exposure or film setting.

    Args:
        attribute: its name over REST.
    """
    return next(item.name for item in rest_settings("exposure") + rest_settings("film") if item.camel_name == attribute)
