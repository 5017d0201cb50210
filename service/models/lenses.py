"""The lens library."""

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
    "focalLengthRangeMm": None,
    "fStop": 2.8,
    "families": ["normal", "singlet"],
    "year": None,
    "source": "ours",
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
    "odd": [],
    "isStop": True,
}

LensModel = Literal["pinhole", "thin", "seidel", "spherical", "heightField", "prescription", "dataSheet"]


class LensSummary(Model):
    """A lens of the library."""

    model_config = shown_as(SUMMARY_EXAMPLE)

    name: str = Field(description="Name of the lens in URLs, on the command line and in edits of a camera.")
    title: str = Field(description="Engraving; the `lensName` of a camera that it is mounted on.")
    manufacturer: str
    model: LensModel = Field(description="Kind of lens model.")
    focal_length_mm: float
    focal_length_range_mm: tuple[float, float] | None = Field(
        description="Shortest and longest focal length of a zoom; null for a lens of one focal length."
    )
    f_stop: float = Field(description="f-number wide open; 0 is a pinhole.")
    families: list[str] = Field(
        description="Words for what it is and how it draws, such as `petzval`, `wide`, `soft focus`."
    )
    year: int | None = Field(description="Year of its patent or publication; null for lenses of our own.")
    source: str = Field(description="Whence its numbers are: a patent with its example, or a publication.")
    description: str = Field(description="One line.")


class StatedLens(Model):
    """Numbers that the source of a lens states of it, at the size that it has in the library."""

    focal_length_mm: float
    f_stop: float = Field(description="f-number wide open.")
    field_deg: float | None = Field(description="Full angle of the field in degrees; null where the source has none.")


class LensList(Model):
    """The lens library."""

    model_config = shown_as({"lenses": [SUMMARY_EXAMPLE]})

    lenses: list[LensSummary]


class LensGlass(Model):
    """An optical medium."""

    name: str = Field(description="Catalogue name; may be empty.")
    index: float = Field(description="Refractive index at the d line, 587.56 nm; 1 is air.")
    abbe: float = Field(description="Abbe number V_d; 0 for no dispersion.")
    sellmeier_b: tuple[float, float, float] | None = Field(description="Sellmeier B; replaces index and Abbe number.")
    sellmeier_c: tuple[float, float, float] | None = Field(description="Sellmeier C, square micrometres.")


class LensSurface(Model):
    """One surface of a lens, or its stop."""

    radius_mm: float = Field(description="Positive where the centre of curvature lies toward the film; 0 is a plane.")
    thickness_mm: float = Field(
        description="Distance to the next surface, or from the last one to the film; 0 is solved for."
    )
    glass: LensGlass | None = Field(description="Medium behind the surface; null is air.")
    clear_diameter_mm: float = Field(description="Clear diameter; 0 where it is unknown and solved for.")
    conic: float
    aspheric: list[float] = Field(description="Coefficients of r⁴, r⁶, ... with r in millimetres.")
    odd: list[float] = Field(description="Coefficients of r³, r⁵, ...; empty for most surfaces.")
    is_stop: bool


class LensConfiguration(Model):
    """Places of a lens's groups at one position of zoom and focus."""

    focal_length_mm: float = Field(description="Focal length of the zoom position, focused at infinity.")
    object_distance_mm: float | None = Field(
        description="Distance from the object in focus to the first surface; null is infinity."
    )
    f_stop: float | None = Field(description="f-number wide open, at infinity; null where it is that of the lens.")
    thicknesses_mm: list[float] = Field(description="Thickness behind each surface; behind the last, to the film.")


class LensErrors(Model):
    """Third-order wavefront errors of a thin lens, in wavelengths of the d line."""

    w040: float = Field(description="Spherical aberration.")
    w131: float = Field(description="Coma.")
    w222: float = Field(description="Astigmatism.")
    w220: float = Field(description="Field curvature.")
    w311: float = Field(description="Distortion.")
    axial_color: float = Field(description="Axial colour: change of W020 from the C to the F line.")
    lateral_color: float = Field(description="Lateral colour: change of W111 from the C to the F line.")
    reference_f_stop: float = Field(description="f-number at whose pupil edge the errors hold.")
    reference_height: float = Field(description="Image height at which the errors hold, mm.")


class LensTables(Model):
    """Measurements of a lens over the image height; tables without measurements are empty."""

    height: list[float] = Field(description="Image heights of the entries, mm, from 0.")
    distortion: list[float] = Field(description="Distortion: image height over that of an ideal lens, minus 1.")
    vignetting: list[float] = Field(description="Relative illumination: 1 on the axis.")
    sagittal_blur: list[float] = Field(description="Standard deviation of the blur across the radius, mm.")
    tangential_blur: list[float] = Field(description="Standard deviation of the blur along the radius, mm.")
    spherical_aberration: list[float] = Field(
        description="Share of the blur, -1 to 1; positive values give discs behind the focus a bright edge."
    )
    coma: list[float] = Field(description="Length of the flare, mm, outward.")
    field_curvature: list[float] = Field(description="Distance of the sharp image in front of the film, mm.")
    lateral_color: list[float] = Field(description="Image height of red (650 nm) minus that of blue (475 nm), mm.")
    axial_color: list[float] = Field(description="Distance of the red focus behind the blue one, mm.")
    f_stop: float = Field(description="f-number at which the tables hold.")


class LensIris(Model):
    """Iris of a lens."""

    blades: int = Field(description="Number of blades; 0 is round.")
    roundness: float = Field(description="0 is straight blades, 1 is round.")
    rotation: float = Field(description="Degrees, counter-clockwise.")
    radial_weights: list[float] = Field(description="Transmission from centre to edge; empty for even.")


class Lens(LensSummary):
    """A lens of the library with its optical data."""

    model_config = shown_as(
        SUMMARY_EXAMPLE
        | {
            "stated": None,
            "squeeze": 1.0,
            "surfaces": [SURFACE_EXAMPLE, SURFACE_EXAMPLE | {"radiusMm": -50.2792, "glass": None, "isStop": False}],
            "focusGroup": None,
            "configurations": [],
            "errors": None,
            "tables": None,
            "iris": None,
        }
    )

    stated: StatedLens | None = Field(description="What its source states of it; null for lenses of our own.")
    squeeze: float = Field(description="Anamorphic squeeze; 1 is spherical.")
    surfaces: list[LensSurface] = Field(description="Front to rear; empty for a lens that has no prescription.")
    focus_group: tuple[int, int] | None = Field(description="Indices of the surfaces that move to focus; null for all.")
    configurations: list[LensConfiguration] = Field(
        description="Positions of zoom and focus, by rising focal length; empty for a lens of one position."
    )
    errors: LensErrors | None = Field(description="Errors of the model `seidel`.")
    tables: LensTables | None = Field(description="Tables of the model `dataSheet`.")
    iris: LensIris | None = Field(description="Null where the camera's own iris is used.")
