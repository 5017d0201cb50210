"""The settings of a camera and of its focus points, in tables by name and by the resource of REST that has them."""

from __future__ import annotations

from usd_schemas.settings.camera import SHUTTER_ANGLE, CameraData, ExposureData
from usd_schemas.settings.film import FilmData
from usd_schemas.settings.focus import FocusData
from usd_schemas.settings.focus_point import FocusPoint
from usd_schemas.settings.lens import LensData
from usd_schemas.settings.setting import Resource, Setting, settings_of
from usd_schemas.settings.tilt_shift import TiltShiftData

LENS_SETTINGS = {item.name: item for item in settings_of(CameraData)}
"""The lens of every USD camera."""

FOCUS_SETTINGS = {
    item.name: item for item in (*settings_of(FocusData, "FocusAPI"), *settings_of(TiltShiftData, "TiltShiftAPI"))
}
"""Settings of the focus and of the lens's movements, by name."""

_FILM_API = settings_of(FilmData, "FilmAPI")

EXPOSURE_SETTINGS = {
    item.name: item
    for item in (*settings_of(ExposureData), *settings_of(LensData, "LensAPI"), *_FILM_API)
    if item.rest == "exposure"
}
"""Settings of the light on the film, by name: exposure, shutter, light meter and stray light."""

FILM_SETTINGS = {item.name: item for item in _FILM_API if item.name not in EXPOSURE_SETTINGS}
"""The rest of FilmAPI: film or sensor, and grade."""

SETTINGS = LENS_SETTINGS | FOCUS_SETTINGS | EXPOSURE_SETTINGS | FILM_SETTINGS
"""All settings of a camera by their names in Python."""

POINT_SETTINGS = {item.name: item for item in settings_of(FocusPoint, "FocusPointAPI")}
"""Settings of a focus point, by name."""


def rest_settings(resource: Resource) -> tuple[Setting, ...]:
    """The settings that a resource of REST has, in order."""
    computed = (SHUTTER_ANGLE,) if resource == "exposure" else ()
    return (*(item for item in (SETTINGS | POINT_SETTINGS).values() if item.rest == resource), *computed)
