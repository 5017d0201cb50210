"""The camera schemas of Pullfocus: lens, aperture, tilt-shift, film and focus, as a USD plugin and as typed Python.

Importing the package registers the plugin with USD, and raises `SchemaError` if that cannot be. USD reads its schema
definitions once, so import it before the first stage is opened. A tool without this Python finds the same plugin with
``PXR_PLUGINPATH_NAME`` set to this folder.

    import usd_schemas
    camera = usd_schemas.LensCamera(stage.GetPrimAtPath("/shot/main_cam"))
    camera.aperture.author(usd_schemas.ApertureData(blades=7, roundness=0.2))
    camera.focus_point("hero").set_key("weight", 24, 1.0, "auto")
"""

from __future__ import annotations

from usd_schemas.body_library import LibraryBody, body_names, library_bodies, library_body, mount_body
from usd_schemas.data import (
    AberrationScales,
    ApertureData,
    Asset,
    DataSheet,
    FocusData,
    FocusPoint,
    HeightField,
    HydraDistortion,
    LensData,
    Prescription,
    Seidel,
    SplitDiopter,
    TiltShiftData,
)
from usd_schemas.errors import SchemaError
from usd_schemas.film_data import (
    CharacteristicCurve,
    Exposing,
    FilmData,
    GradeData,
    Grain,
    Halation,
    Metering,
    PrintCurve,
    Sensor,
    Shutter,
)
from usd_schemas.film_library import LibraryFilm, film_names, library_film, library_films
from usd_schemas.focus_point import FocusPointView
from usd_schemas.keys import Interpolation, Key, Tangents
from usd_schemas.lens_library import LibraryLens, lens_names, library_lens, library_lenses
from usd_schemas.mounting import Mounted, mount_lens
from usd_schemas.registration import FOLDER as PLUGIN_FOLDER
from usd_schemas.registration import register
from usd_schemas.view import LensCamera, SchemaView, define_camera, define_lens_camera

register()

__all__ = [
    "PLUGIN_FOLDER",
    "AberrationScales",
    "ApertureData",
    "Asset",
    "CharacteristicCurve",
    "DataSheet",
    "Exposing",
    "FilmData",
    "FocusData",
    "FocusPoint",
    "FocusPointView",
    "GradeData",
    "Grain",
    "Halation",
    "HeightField",
    "HydraDistortion",
    "Interpolation",
    "Key",
    "LensCamera",
    "LensData",
    "LibraryBody",
    "LibraryFilm",
    "LibraryLens",
    "Metering",
    "Mounted",
    "Prescription",
    "PrintCurve",
    "SchemaError",
    "SchemaView",
    "Seidel",
    "Sensor",
    "Shutter",
    "SplitDiopter",
    "Tangents",
    "TiltShiftData",
    "body_names",
    "define_camera",
    "define_lens_camera",
    "film_names",
    "lens_names",
    "library_bodies",
    "library_body",
    "library_film",
    "library_films",
    "library_lens",
    "library_lenses",
    "mount_body",
    "mount_lens",
]
