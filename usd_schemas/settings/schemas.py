"""The schemas: which settings each of them brings to a camera."""

from __future__ import annotations

from dataclasses import dataclass

from usd_schemas.settings.aperture import ApertureData
from usd_schemas.settings.film import FilmData
from usd_schemas.settings.focus import FocusData
from usd_schemas.settings.focus_point import FocusPoint
from usd_schemas.settings.lens import LensData
from usd_schemas.settings.setting import Setting, settings_of
from usd_schemas.settings.tilt_shift import TiltShiftData


@dataclass(frozen=True)
class Schema:
    """One API schema.

    Attributes:
        name: such as ``FilmAPI``.
        kind: the dataclass of its settings.
        doc: what it says of a camera.
        prefix: before the instance's name, of a multiple-apply schema; empty for a single-apply schema.
    """

    name: str
    kind: type
    doc: str
    prefix: str = ""

    @property
    def settings(self) -> tuple[Setting, ...]:
        """Its settings, in the order in which the schema lists them."""
        return settings_of(self.kind, self.name)


SCHEMAS = (
    Schema(
        "LensAPI",
        LensData,
        "The glass in front of the film: which model of lens is asked for, what is engraved on its barrel, and the numbers of "
        "that model. Focal length, f-number and focus distance stay where UsdGeomCamera has them.",
    ),
    Schema(
        "ApertureAPI",
        ApertureData,
        "The iris: the shape and the weighting of an out-of-focus point. Its size is UsdGeomCamera's fStop.",
    ),
    Schema(
        "TiltShiftAPI",
        TiltShiftData,
        "The movements of a view camera: how the lens is tilted and shifted against the film.",
    ),
    Schema(
        "FilmAPI",
        FilmData,
        "Film or sensor, shutter, grain, grade and display. How long and "
        "how bright the exposure is stays in UsdGeomCamera's exposure:* and shutter:*.",
    ),
    Schema(
        "FocusAPI", FocusData, "Way in which the focus is found: by hand, or from the focus points of FocusPointAPI."
    ),
    Schema(
        "FocusPointAPI",
        FocusPoint,
        "One thing that must be sharp, or soft. It is anchored to the surface that was clicked on and follows it. The instance "
        "name is the point's name: FocusPointAPI:hero has its properties under focusPoint:hero:.",
        prefix="focusPoint",
    ),
)
