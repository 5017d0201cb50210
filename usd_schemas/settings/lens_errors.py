"""Errors of a lens: wavefront coefficients, measured tables, factors on either, and Hydra's distortion."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from usd_schemas.settings.setting import Floats, Pair, schema_group, setting


@schema_group("Lens:Seidel")
@dataclass(frozen=True)
class Seidel:
    """Third-order wavefront coefficients, in wavelengths of the d line."""

    w040: float = setting(
        "lens:seidel:w040",
        0.0,
        "Spherical Aberration W040",
        "Wavefront coefficient of spherical aberration, W040 r^4, at the edge of the reference pupil.",
        unit="wavelengths of the d line (587.56 nm)",
        soft=(-20, 20),
    )
    w131: float = setting(
        "lens:seidel:w131",
        0.0,
        "Coma W131",
        "Wavefront coefficient of coma, W131 h r^3 cos(theta), at the edge of the reference pupil and field.",
        unit="wavelengths of the d line (587.56 nm)",
        soft=(-20, 20),
    )
    w222: float = setting(
        "lens:seidel:w222",
        0.0,
        "Astigmatism W222",
        "Wavefront coefficient of astigmatism, W222 h^2 r^2 cos^2(theta), at the edge of the reference pupil and "
        "field.",
        unit="wavelengths of the d line (587.56 nm)",
        soft=(-20, 20),
    )
    w220: float = setting(
        "lens:seidel:w220",
        0.0,
        "Field Curvature W220",
        "Wavefront coefficient of field curvature, W220 h^2 r^2, at the edge of the reference pupil and field.",
        unit="wavelengths of the d line (587.56 nm)",
        soft=(-20, 20),
    )
    w311: float = setting(
        "lens:seidel:w311",
        0.0,
        "Distortion W311",
        "Wavefront coefficient of distortion, W311 h^3 r cos(theta), at the edge of the reference pupil and field.",
        unit="wavelengths of the d line (587.56 nm)",
        soft=(-200, 200),
    )
    axial_color: float = setting(
        "lens:seidel:axialColor",
        0.0,
        "Axial Colour",
        "Change of the defocus coefficient W020 from the C line (656.27 nm) to the F line (486.13 nm), at the edge "
        "of the reference pupil.",
        unit="wavelengths of the d line (587.56 nm)",
        soft=(-20, 20),
    )
    lateral_color: float = setting(
        "lens:seidel:lateralColor",
        0.0,
        "Lateral Colour",
        "Change of the tilt coefficient W111 from the C line (656.27 nm) to the F line (486.13 nm), at the edge of "
        "the reference pupil and field.",
        unit="wavelengths of the d line (587.56 nm)",
        soft=(-20, 20),
    )
    reference_f_stop: float = setting(
        "lens:seidel:referenceFStop",
        2.8,
        "Reference F-Number",
        "The f-number whose pupil has r = 1: the coefficients are the wavefront errors at its edge.",
        unit="f-number",
        hard=(0.5, None),
        soft=(None, 16),
    )
    reference_height: float = setting(
        "lens:seidel:referenceHeight",
        21.6,
        "Reference Image Height",
        "The distance from the axis on the film where the field h = 1; 21.6 is the corner of 36 x 24.",
        unit="millimetres",
        hard=(0.1, None),
        soft=(None, 60),
    )


@schema_group("Lens:Data Sheet")
@dataclass(frozen=True)
class DataSheet:
    """Measured errors of a lens against image height: each array has one entry for each height, or none."""

    height: Floats = setting(
        "lens:table:height",
        (),
        "Image Heights",
        "Distances from the axis on the film at which the tables of this group have their entries, increasing from 0.",
        "All lens:table arrays have as many entries, or none.",
        unit="millimetres",
    )
    distortion: Floats = setting(
        "lens:table:distortion",
        (),
        "Distortion",
        "Radial distortion at each height, (real - ideal) / ideal: negative is barrel, positive is pincushion.",
        unit="none, a ratio (0.02 is 2 %)",
    )
    vignetting: Floats = setting(
        "lens:table:vignetting",
        (),
        "Relative Illumination",
        "Light at each height over light on the axis, with all causes together, at lens:table:fStop.",
        unit="none, a ratio from 0 to 1",
    )
    sagittal_blur: Floats = setting(
        "lens:table:sagittalBlur",
        (),
        "Sagittal Blur",
        "Standard deviation, across the radius, of the light of a point in the plane of focus at each height: of "
        "all errors of one colour together.",
        unit="millimetres on the film",
    )
    tangential_blur: Floats = setting(
        "lens:table:tangentialBlur",
        (),
        "Tangential Blur",
        "Standard deviation, along the radius, of the light of a point in the plane of focus at each height: of all "
        "errors of one colour together.",
        unit="millimetres on the film",
    )
    spherical_aberration: Floats = setting(
        "lens:table:sphericalAberration",
        (),
        "Spherical Aberration Factor",
        "Share of the blur that is spherical aberration at each height, and so how uneven the disc behind the focus "
        "is: 0 even, positive with a bright edge, negative with a bright middle.",
        unit="none, -1 to 1",
    )
    coma: Floats = setting(
        "lens:table:coma",
        (),
        "Coma",
        "Length of the coma's flare along the radius at each height; positive points outward.",
        unit="millimetres on the film",
    )
    field_curvature: Floats = setting(
        "lens:table:fieldCurvature",
        (),
        "Field Curvature",
        "Distance of the sharp image before the film at each height; positive toward the lens.",
        unit="millimetres",
    )
    lateral_color: Floats = setting(
        "lens:table:lateralColor",
        (),
        "Lateral Colour",
        "Distance from the image in blue (475 nm) to the image in red (650 nm) at each height; positive where red "
        "lies farther out.",
        unit="millimetres on the film",
    )
    axial_color: Floats = setting(
        "lens:table:axialColor",
        (),
        "Axial Colour",
        "Distance along the axis from the sharp image in blue (475 nm) to that in red (650 nm) at each height; "
        "positive where red focuses farther from the lens.",
        unit="millimetres",
    )
    f_stop: float = setting(
        "lens:table:fStop",
        0.0,
        "Measured At",
        "The f-number at which the tables were measured; 0 takes that of lens:fStopRange wide open.",
        unit="f-number",
        hard=(0, None),
        soft=(None, 22),
    )


@schema_group("Lens:Aberrations")
@dataclass(frozen=True)
class AberrationScales:
    """Factors on the errors of whatever lens there is: 0 none, 1 as the lens has them."""

    spherical: float = setting(
        "lens:aberration:spherical",
        1.0,
        "Spherical",
        "Multiplies the model's spherical aberration: 0 none, 1 as the lens has it, above 1 exaggerated.",
        unit="none, a factor",
        soft=(0, 5),
    )
    coma: float = setting(
        "lens:aberration:coma",
        1.0,
        "Coma",
        "Multiplies the model's coma.",
        unit="none, a factor",
        soft=(0, 5),
    )
    astigmatism: float = setting(
        "lens:aberration:astigmatism",
        1.0,
        "Astigmatism",
        "Multiplies the model's astigmatism.",
        unit="none, a factor",
        soft=(0, 5),
    )
    field_curvature: float = setting(
        "lens:aberration:fieldCurvature",
        1.0,
        "Field Curvature",
        "Multiplies the model's field curvature.",
        unit="none, a factor",
        soft=(0, 5),
    )
    distortion: float = setting(
        "lens:aberration:distortion",
        1.0,
        "Distortion",
        "Multiplies the model's distortion.",
        unit="none, a factor",
        soft=(0, 5),
    )
    chromatic: float = setting(
        "lens:aberration:chromatic",
        1.0,
        "Chromatic",
        "Multiplies the spread of the refractive index over wavelength, and with it axial and lateral colour: 0 "
        "none, 1 as the glass has it, above 1 exaggerated.",
        unit="none, a factor",
        soft=(0, 5),
    )
    vignetting: float = setting(
        "lens:aberration:vignetting",
        1.0,
        "Vignetting",
        "Part of the loss of light toward the corners that is kept: 0 none, 1 all.",
        unit="none, a factor from 0 to 1",
        hard=(0, 1),
    )


@schema_group("Lens:Hydra Distortion")
@dataclass(frozen=True)
class HydraDistortion:
    """Lens distortion as Hydra's cameras have it; `lensDistortion:*`."""

    type: Literal["standard", "fisheye"] = setting(
        "lensDistortion:type",
        "standard",
        "Type",
        "Which projection Hydra's lens distortion is a polynomial of.",
        "The name and meaning are Hydra's.",
        unit="none, a token",
    )
    k1: float = setting(
        "lensDistortion:k1",
        0.0,
        "K1",
        "Hydra's first radial coefficient, of r^2.",
        unit="none",
        usd_type="float",
        soft=(-1, 1),
    )
    k2: float = setting(
        "lensDistortion:k2",
        0.0,
        "K2",
        "Hydra's second radial coefficient, of r^4.",
        unit="none",
        usd_type="float",
        soft=(-1, 1),
    )
    center: Pair = setting(
        "lensDistortion:center",
        (0.0, 0.0),
        "Centre",
        "Hydra's centre of the distortion in the frame.",
        unit="none, screen coordinates",
        usd_type="float2",
    )
    ana_sq: float = setting(
        "lensDistortion:anaSq",
        1.0,
        "Anamorphic Squeeze",
        "Hydra's anamorphic squeeze of the distortion; lens:squeeze is the lens's own.",
        unit="none, a ratio",
        usd_type="float",
        hard=(0.009999999776482582, None),
        soft=(0.5, 2),
    )
    asym: Pair = setting(
        "lensDistortion:asym",
        (0.0, 0.0),
        "Asymmetry",
        "Hydra's asymmetry of the distortion, across and up.",
        unit="none",
        usd_type="float2",
    )
    scale: float = setting(
        "lensDistortion:scale",
        1.0,
        "Scale",
        "Hydra's scale of the distorted picture.",
        unit="none, a ratio",
        usd_type="float",
        hard=(0.009999999776482582, None),
        soft=(0.5, 2),
    )
    ior: float = setting(
        "lensDistortion:ior",
        0.0,
        "Index",
        "Hydra's index of refraction for dispersing the distortion; 0 for none.",
        unit="none",
        usd_type="float",
        hard=(0, None),
        soft=(None, 2),
    )


@schema_group("Lens:Split Diopter")
@dataclass(frozen=True)
class SplitDiopter:
    """Half lenses before the lens, as Hydra's cameras have them; `splitDiopter:*`."""

    count: int = setting(
        "splitDiopter:count",
        0,
        "Count",
        "Number of half lenses before the lens.",
        "The names of this group are Hydra's.",
        unit="none, a count from 0 to 2",
        hard=(0, 2),
    )
    angle: float = setting(
        "splitDiopter:angle",
        0.0,
        "Angle",
        "Turn of the split about the view axis.",
        unit="degrees",
        usd_type="float",
        soft=(-180, 180),
    )
    offset1: float = setting(
        "splitDiopter:offset1",
        0.0,
        "First Offset",
        "Where the first half lens's edge lies, from the middle of the frame.",
        unit="none, screen coordinates (-1 to 1)",
        usd_type="float",
        soft=(-1, 1),
    )
    width1: float = setting(
        "splitDiopter:width1",
        0.0,
        "First Width",
        "Width of the zone in which the first half lens fades in.",
        unit="none, screen coordinates",
        usd_type="float",
        hard=(0, None),
        soft=(None, 1),
    )
    focus_distance1: float = setting(
        "splitDiopter:focusDistance1",
        0.0,
        "First Focus Distance",
        "Distance that is sharp through the first half lens.",
        unit="scene units, as focusDistance",
        usd_type="float",
        hard=(0, None),
    )
    offset2: float = setting(
        "splitDiopter:offset2",
        0.0,
        "Second Offset",
        "Where the second half lens's edge lies, from the middle of the frame.",
        unit="none, screen coordinates (-1 to 1)",
        usd_type="float",
        soft=(-1, 1),
    )
    width2: float = setting(
        "splitDiopter:width2",
        0.0,
        "Second Width",
        "Width of the zone in which the second half lens fades in.",
        unit="none, screen coordinates",
        usd_type="float",
        hard=(0, None),
        soft=(None, 1),
    )
    focus_distance2: float = setting(
        "splitDiopter:focusDistance2",
        0.0,
        "Second Focus Distance",
        "Distance that is sharp through the second half lens.",
        unit="scene units, as focusDistance",
        usd_type="float",
        hard=(0, None),
    )
