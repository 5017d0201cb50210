"""The camera schemas of Pullfocus: lens, aperture, tilt-shift, film and focus, as a USD plugin and as typed Python.

Importing the package makes the plugin known to USD. USD reads its schema definitions once, so import it before the first stage
is opened. The first use of a camera or a library through the package checks that USD knows the schemas, and raises
`SchemaError` if not. A tool without this Python finds the same plugin with ``PXR_PLUGINPATH_NAME`` set to this folder.
`usd_schemas.settings` does not load USD.

    import usd_schemas
    camera = usd_schemas.LensCamera(stage.GetPrimAtPath("/shot/main_cam"))
    camera.aperture.author(usd_schemas.ApertureData(blades=7, roundness=0.2))
    camera.focus_point("hero").set_key("weight", 24, 1.0, "auto")
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from usd_schemas.errors import SchemaError
from usd_schemas.settings import (
    AberrationScales,
    ApertureData,
    Asset,
    CharacteristicCurve,
    Configurations,
    DataSheet,
    Exposing,
    FilmData,
    FocusData,
    FocusPoint,
    GradeData,
    Grain,
    Halation,
    HeightField,
    HydraDistortion,
    LensData,
    Metering,
    Prescription,
    PrintCurve,
    Seidel,
    Sensor,
    Shutter,
    SplitDiopter,
    TiltShiftData,
)

if TYPE_CHECKING:
    from usd_schemas.body_library import LibraryBody, body_names, library_bodies, library_body, mount_body
    from usd_schemas.film_library import LibraryFilm, film_names, library_film, library_films
    from usd_schemas.focus_point import FocusPointView
    from usd_schemas.keys import Interpolation, Key, Tangents
    from usd_schemas.lens_library import LibraryLens, StatedNumbers, lens_names, library_lens, library_lenses
    from usd_schemas.lens_search import LensSearch
    from usd_schemas.mounting import Mounted, mount_lens
    from usd_schemas.view import LensCamera, SchemaView, define_camera, define_lens_camera

PLUGIN_FOLDER = Path(__file__).resolve().parent

_WITH_USD = {
    "body_library": ("LibraryBody", "body_names", "library_bodies", "library_body", "mount_body"),
    "film_library": ("LibraryFilm", "film_names", "library_film", "library_films"),
    "focus_point": ("FocusPointView",),
    "keys": ("Interpolation", "Key", "Tangents"),
    "lens_library": ("LibraryLens", "StatedNumbers", "lens_names", "library_lens", "library_lenses"),
    "lens_search": ("LensSearch",),
    "mounting": ("Mounted", "mount_lens"),
    "view": ("LensCamera", "SchemaView", "define_camera", "define_lens_camera"),
}
"""Names of the package that need USD, by their module: imported when they are first used."""


def __getattr__(name: str) -> Any:
    for module, names in _WITH_USD.items():
        if name in names:
            return getattr(import_module(f"usd_schemas.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def _make_plugin_known() -> None:
    """Let USD find the plugin: by its search path where USD is not loaded yet, else by registering it now.

    Raises:
        SchemaError: USD is loaded, and the plugin cannot be registered.
    """
    if "pxr" in sys.modules:
        import_module("usd_schemas.registration")
        return
    paths = [path for path in os.environ.get("PXR_PLUGINPATH_NAME", "").split(os.pathsep) if path]
    if str(PLUGIN_FOLDER) not in paths:
        os.environ["PXR_PLUGINPATH_NAME"] = os.pathsep.join([*paths, str(PLUGIN_FOLDER)])


_make_plugin_known()

__all__ = [
    "PLUGIN_FOLDER",
    "AberrationScales",
    "ApertureData",
    "Asset",
    "CharacteristicCurve",
    "Configurations",
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
    "LensSearch",
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
    "StatedNumbers",
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
