"""Names of settings that differ between REST, where they carry their unit, and the shot."""

from __future__ import annotations

from service.models.exposure import ExposureKeyed, ExposureSettings
from service.models.film_settings import FilmKeyed, FilmSettings

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
PHOTOGRAPHY_OF_FIELD = {
    "shutter_travel_s": "shutter_travel_time",
    "metering_compensation_stops": "metering_compensation",
    "metering_smoothing_s": "metering_smoothing",
    "white_balance_k": "white_balance",
    "grain_size_um": "grain_size",
    "halation_radius_mm": "halation_radius",
    "sensor_full_well_e": "sensor_full_well",
    "sensor_read_noise_e": "sensor_read_noise",
    "sensor_clip_stops": "sensor_clip",
    "display": "grade_display",
    "view": "grade_view",
    "look": "grade_look",
    "cdl_slope": "grade_cdl_slope",
    "cdl_offset": "grade_cdl_offset",
    "cdl_power": "grade_cdl_power",
    "cdl_saturation": "grade_cdl_saturation",
    "ocio_config": "grade_config",
    "cdl_file": "grade_cdl_file",
}


def photography_setting(attribute: ExposureKeyed | FilmKeyed) -> str:
    """Return the shot's name of an exposure or film setting.

    Args:
        attribute: its name over REST.
    """
    fields = {
        info.alias: field for model in (ExposureSettings, FilmSettings) for field, info in model.model_fields.items()
    }
    return PHOTOGRAPHY_OF_FIELD.get(fields[attribute], fields[attribute])
