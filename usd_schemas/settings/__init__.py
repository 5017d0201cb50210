"""The settings of a camera, each declared once, and the typed data that the declarations give; see `settings.setting`.

Lens and film lengths are millimetres, scene lengths scene units, angles degrees, as in the schema.
"""

from __future__ import annotations

from usd_schemas.settings.aperture import ApertureData
from usd_schemas.settings.film import FilmData, FilmProcess, Grain, Halation, Sensor
from usd_schemas.settings.film_curves import CharacteristicCurve, PrintCurve
from usd_schemas.settings.focus import FocusData, FocusMode
from usd_schemas.settings.focus_point import FocusPoint, FocusPointKind
from usd_schemas.settings.grade import GradeData
from usd_schemas.settings.lens import LensData, LensModel
from usd_schemas.settings.lens_configurations import Configurations
from usd_schemas.settings.lens_errors import AberrationScales, DataSheet, HydraDistortion, Seidel, SplitDiopter
from usd_schemas.settings.metering import Exposing, Metering, Shutter
from usd_schemas.settings.prescription import HeightField, Prescription
from usd_schemas.settings.setting import Asset, Floats, Pair, Pairs, Triple, Triples
from usd_schemas.settings.tilt_shift import TiltShiftData

__all__ = [
    "AberrationScales",
    "ApertureData",
    "Asset",
    "CharacteristicCurve",
    "Configurations",
    "DataSheet",
    "Exposing",
    "FilmData",
    "FilmProcess",
    "Floats",
    "FocusData",
    "FocusMode",
    "FocusPoint",
    "FocusPointKind",
    "GradeData",
    "Grain",
    "Halation",
    "HeightField",
    "HydraDistortion",
    "LensData",
    "LensModel",
    "Metering",
    "Pair",
    "Pairs",
    "Prescription",
    "PrintCurve",
    "Seidel",
    "Sensor",
    "Shutter",
    "SplitDiopter",
    "TiltShiftData",
    "Triple",
    "Triples",
]
