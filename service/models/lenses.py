"""Lenses: what the library has, and what a lens is made of."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, shown_as

SUMMARY_EXAMPLE: JsonDict = {
    "name": "singlet_50",
    "title": "Singlet 50 mm f/2.8",
    "manufacturer": "",
    "model": "spherical",
    "focalLengthMm": 50.0,
    "fStop": 2.8,
    "description": "One biconvex lens of BK7 glass: all the errors that lenses are corrected for.",
}
BK7_EXAMPLE: JsonDict = {
    "name": "BK7",
    "index": 1.5168,
    "abbe": 64.17,
    "sellmeierB": [1.03961212, 0.231792344, 1.01046945],
    "sellmeierC": [0.00600069867, 0.0200179144, 103.560653],
}
SURFACE_EXAMPLE: JsonDict = {
    "radiusMm": 50.2792,
    "thicknessMm": 8.0,
    "glass": BK7_EXAMPLE,
    "clearDiameterMm": 17.8572,
    "conic": 0.0,
    "aspheric": [],
    "isStop": True,
}

LensModel = Literal["pinhole", "thin", "seidel", "spherical", "heightField", "prescription", "dataSheet"]


class LensSummary(Model):
    """A lens of the library."""

    model_config = shown_as(SUMMARY_EXAMPLE)

    name: str = Field(description="Names the lens in addresses, on the command line and in edits of a camera.")
    title: str = Field(description="What is engraved on it; a camera's `lensName`.")
    manufacturer: str
    model: LensModel = Field(description="How light passes it.")
    focal_length_mm: float
    f_stop: float = Field(description="f-number wide open; 0 for a pinhole.")
    description: str = Field(description="One line.")


class LensList(Model):
    """The lens library."""

    model_config = shown_as({"lenses": [SUMMARY_EXAMPLE]})

    lenses: list[LensSummary]


class LensGlass(Model):
    """An optical medium."""

    name: str = Field(description="Catalogue name; may be empty.")
    index: float = Field(description="At the d line, 587.56 nm; 1 is air.")
    abbe: float = Field(description="Abbe number V_d; 0 for no dispersion.")
    sellmeier_b: tuple[float, float, float] | None = Field(description="Win over index and Abbe number.")
    sellmeier_c: tuple[float, float, float] | None = Field(description="In square micrometres.")


class LensSurface(Model):
    """One surface of a lens, or its stop."""

    radius_mm: float = Field(description="Positive where the centre of curvature lies toward the film; 0 is a plane.")
    thickness_mm: float = Field(description="To the next surface; of the last one to the film, 0 to be solved for.")
    glass: LensGlass | None = Field(description="The medium behind it; null is air.")
    clear_diameter_mm: float = Field(description="0 where it is unknown, to be solved for.")
    conic: float
    aspheric: list[float] = Field(description="Coefficients of r⁴, r⁶, ... with r in millimetres.")
    is_stop: bool


class LensErrors(Model):
    """Third-order wavefront errors of a thin lens, in wavelengths of the d line."""

    w040: float = Field(description="Spherical aberration.")
    w131: float = Field(description="Coma.")
    w222: float = Field(description="Astigmatism.")
    w220: float = Field(description="Field curvature.")
    w311: float = Field(description="Distortion.")
    axial_color: float = Field(description="Change of W020 from the C to the F line.")
    lateral_color: float = Field(description="Change of W111 from the C to the F line.")
    reference_f_stop: float = Field(description="At whose pupil's edge they hold.")
    reference_height: float = Field(description="Image height for which they hold, mm.")


class LensTables(Model):
    """What was measured of a lens over the image height; a table that it does not have is empty."""

    height: list[float] = Field(description="Image heights of the tables' entries, mm, from 0.")
    distortion: list[float] = Field(description="Share by which the image is farther out than an ideal lens's.")
    vignetting: list[float] = Field(description="Light over that on the axis.")
    sagittal_blur: list[float] = Field(description="Standard deviation of the blur across the radius, mm.")
    tangential_blur: list[float] = Field(description="Standard deviation of the blur along the radius, mm.")
    spherical_aberration: list[float] = Field(
        description="Share of the blur, -1 to 1: positive gives discs behind the focus a bright edge."
    )
    coma: list[float] = Field(description="Length of the flare, mm, outward.")
    field_curvature: list[float] = Field(description="How far before the film the sharp image lies, mm.")
    lateral_color: list[float] = Field(description="How much farther out red (650 nm) lies than blue (475 nm), mm.")
    axial_color: list[float] = Field(description="How far behind blue red focuses, mm.")
    f_stop: float = Field(description="At which they hold.")


class LensIris(Model):
    """The lens's own iris."""

    blades: int = Field(description="0 is round.")
    roundness: float = Field(description="0 straight blades to 1 round.")
    rotation: float = Field(description="Degrees, counter-clockwise.")
    radial_weights: list[float] = Field(description="Transmission from centre to edge; empty for even.")


class Lens(LensSummary):
    """A lens of the library, and what it is made of."""

    model_config = shown_as(
        SUMMARY_EXAMPLE
        | {
            "squeeze": 1.0,
            "surfaces": [SURFACE_EXAMPLE, SURFACE_EXAMPLE | {"radiusMm": -50.2792, "glass": None, "isStop": False}],
            "focusGroup": None,
            "errors": None,
            "tables": None,
            "iris": None,
        }
    )

    squeeze: float = Field(description="Anamorphic squeeze; 1 is spherical.")
    surfaces: list[LensSurface] = Field(description="Front to rear; empty for a lens that is not said by its surfaces.")
    focus_group: tuple[int, int] | None = Field(description="Indices of the surfaces that move to focus; null for all.")
    errors: LensErrors | None = Field(description="Of the model `seidel`.")
    tables: LensTables | None = Field(description="Of the model `dataSheet`.")
    iris: LensIris | None = Field(description="Null where the camera's own iris stays.")
