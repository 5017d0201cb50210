"""What the schemas say, as frozen dataclasses: one for each schema, in the units of schema.usda.

Each field names the USD property that it stands for; schema.usda documents them. Defaults are the schema's fallbacks
(a test holds them equal). Lens and film lengths are millimetres, scene lengths scene units, angles degrees.
"""

# ruff: noqa: RUF009  (usd() and group() are dataclasses.field with the property's name)

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

LensModel = Literal["pinhole", "thin", "seidel", "spherical", "heightField", "prescription", "dataSheet"]
FocusMode = Literal["manual", "points", "tiltPlane", "surface"]
FilmProcess = Literal["none", "negative", "reversal", "monochrome", "digital"]
FocusPointKind = Literal["sharp", "soft"]

Floats = tuple[float, ...]
Pair = tuple[float, float]
Triple = tuple[float, float, float]
Pairs = tuple[Pair, ...]
Triples = tuple[Triple, ...]


@dataclass(frozen=True)
class Asset:
    """A file that a property names.

    Attributes:
        path: as it is authored.
        resolved: where the asset resolver finds it; empty where it does not. Not compared, never authored.
    """

    path: str = ""
    resolved: str = field(default="", compare=False)


def usd(name: str, default: Any) -> Any:
    """A dataclass field that stands for the USD property ``name``."""
    return field(default=default, metadata={"usd": name})


def group(kind: type) -> Any:
    """A dataclass field that holds further properties in a dataclass of its own."""
    return field(default_factory=kind, metadata={"group": kind})


@dataclass(frozen=True)
class Prescription:
    """The surfaces of a lens, front to rear: each array has one entry for each surface, or none."""

    radius: Floats = usd("lens:prescription:radius", ())
    thickness: Floats = usd("lens:prescription:thickness", ())
    index: Floats = usd("lens:prescription:index", ())
    abbe: Floats = usd("lens:prescription:abbe", ())
    sellmeier_b: Triples = usd("lens:prescription:sellmeierB", ())
    sellmeier_c: Triples = usd("lens:prescription:sellmeierC", ())
    glass: tuple[str, ...] = usd("lens:prescription:glass", ())
    clear_diameter: Floats = usd("lens:prescription:clearDiameter", ())
    conic: Floats = usd("lens:prescription:conic", ())
    aspheric4: Floats = usd("lens:prescription:aspheric4", ())
    aspheric6: Floats = usd("lens:prescription:aspheric6", ())
    aspheric8: Floats = usd("lens:prescription:aspheric8", ())
    aspheric10: Floats = usd("lens:prescription:aspheric10", ())
    aspheric12: Floats = usd("lens:prescription:aspheric12", ())
    aspheric14: Floats = usd("lens:prescription:aspheric14", ())
    aspheric16: Floats = usd("lens:prescription:aspheric16", ())
    aspheric18: Floats = usd("lens:prescription:aspheric18", ())
    aspheric20: Floats = usd("lens:prescription:aspheric20", ())
    coating_wavelength: Floats = usd("lens:prescription:coatingWavelength", ())
    stop_surface: int = usd("lens:prescription:stopSurface", -1)
    focus_group: tuple[int, int] = usd("lens:prescription:focusGroup", (-1, -1))


@dataclass(frozen=True)
class Seidel:
    """Third-order wavefront coefficients, in wavelengths of the d line."""

    w040: float = usd("lens:seidel:w040", 0.0)
    w131: float = usd("lens:seidel:w131", 0.0)
    w222: float = usd("lens:seidel:w222", 0.0)
    w220: float = usd("lens:seidel:w220", 0.0)
    w311: float = usd("lens:seidel:w311", 0.0)
    axial_color: float = usd("lens:seidel:axialColor", 0.0)
    lateral_color: float = usd("lens:seidel:lateralColor", 0.0)
    reference_f_stop: float = usd("lens:seidel:referenceFStop", 2.8)
    reference_height: float = usd("lens:seidel:referenceHeight", 21.6)


@dataclass(frozen=True)
class HeightField:
    """Heights that are added to the two surfaces of a thick lens."""

    front: Asset = usd("lens:heightField:front", Asset())
    back: Asset = usd("lens:heightField:back", Asset())
    scale: Pair = usd("lens:heightField:scale", (0.0, 0.0))


@dataclass(frozen=True)
class DataSheet:
    """Measured errors of a lens against image height: each array has one entry for each height, or none."""

    height: Floats = usd("lens:table:height", ())
    distortion: Floats = usd("lens:table:distortion", ())
    vignetting: Floats = usd("lens:table:vignetting", ())
    sagittal_blur: Floats = usd("lens:table:sagittalBlur", ())
    tangential_blur: Floats = usd("lens:table:tangentialBlur", ())
    spherical_aberration: Floats = usd("lens:table:sphericalAberration", ())
    coma: Floats = usd("lens:table:coma", ())
    field_curvature: Floats = usd("lens:table:fieldCurvature", ())
    lateral_color: Floats = usd("lens:table:lateralColor", ())
    axial_color: Floats = usd("lens:table:axialColor", ())
    f_stop: float = usd("lens:table:fStop", 0.0)


@dataclass(frozen=True)
class AberrationScales:
    """Factors on the errors of whatever lens there is: 0 none, 1 as the lens has them."""

    spherical: float = usd("lens:aberration:spherical", 1.0)
    coma: float = usd("lens:aberration:coma", 1.0)
    astigmatism: float = usd("lens:aberration:astigmatism", 1.0)
    field_curvature: float = usd("lens:aberration:fieldCurvature", 1.0)
    distortion: float = usd("lens:aberration:distortion", 1.0)
    chromatic: float = usd("lens:aberration:chromatic", 1.0)
    vignetting: float = usd("lens:aberration:vignetting", 1.0)


@dataclass(frozen=True)
class HydraDistortion:
    """Lens distortion as Hydra's cameras have it; `lensDistortion:*`."""

    type: Literal["standard", "fisheye"] = usd("lensDistortion:type", "standard")
    k1: float = usd("lensDistortion:k1", 0.0)
    k2: float = usd("lensDistortion:k2", 0.0)
    center: Pair = usd("lensDistortion:center", (0.0, 0.0))
    ana_sq: float = usd("lensDistortion:anaSq", 1.0)
    asym: Pair = usd("lensDistortion:asym", (0.0, 0.0))
    scale: float = usd("lensDistortion:scale", 1.0)
    ior: float = usd("lensDistortion:ior", 0.0)


@dataclass(frozen=True)
class SplitDiopter:
    """Half lenses before the lens, as Hydra's cameras have them; `splitDiopter:*`."""

    count: int = usd("splitDiopter:count", 0)
    angle: float = usd("splitDiopter:angle", 0.0)
    offset1: float = usd("splitDiopter:offset1", 0.0)
    width1: float = usd("splitDiopter:width1", 0.0)
    focus_distance1: float = usd("splitDiopter:focusDistance1", 0.0)
    offset2: float = usd("splitDiopter:offset2", 0.0)
    width2: float = usd("splitDiopter:width2", 0.0)
    focus_distance2: float = usd("splitDiopter:focusDistance2", 0.0)


@dataclass(frozen=True)
class LensData:
    """LensAPI: the glass in front of the film."""

    model: LensModel = usd("lens:model", "thin")
    name: str = usd("lens:name", "")
    manufacturer: str = usd("lens:manufacturer", "")
    serial_number: str = usd("lens:serialNumber", "")
    breathing: bool = usd("lens:breathing", False)
    transmittance: float = usd("lens:transmittance", 1.0)
    neutral_density: float = usd("lens:neutralDensity", 0.0)
    stop_marking: Literal["f", "t"] = usd("lens:stopMarking", "f")
    natural_vignetting: bool = usd("lens:naturalVignetting", False)
    squeeze: float = usd("lens:squeeze", 1.0)
    close_focus: float = usd("lens:closeFocus", 0.0)
    focus_throw: float = usd("lens:focusThrow", 0.0)
    f_stop_range: Pair = usd("lens:fStopRange", (0.0, 0.0))
    pupil_magnification: float = usd("lens:pupilMagnification", 1.0)
    entrance_pupil_offset: float = usd("lens:entrancePupilOffset", 0.0)
    pupil_power: Floats = usd("lens:expressive:pupilPower", ())
    expressive_blend: float = usd("lens:expressive:blend", 0.0)
    flare_ghosts: float = usd("lens:flare:ghosts", 0.0)
    flare_star: float = usd("lens:flare:star", 0.0)
    prescription: Prescription = group(Prescription)
    seidel: Seidel = group(Seidel)
    height_field: HeightField = group(HeightField)
    data_sheet: DataSheet = group(DataSheet)
    aberration: AberrationScales = group(AberrationScales)
    hydra_distortion: HydraDistortion = group(HydraDistortion)
    split_diopter: SplitDiopter = group(SplitDiopter)


@dataclass(frozen=True)
class ApertureData:
    """ApertureAPI: the shape and weighting of the iris."""

    blades: int = usd("aperture:blades", 0)
    roundness: float = usd("aperture:roundness", 0.0)
    rotation: float = usd("aperture:rotation", 0.0)
    mask: Asset = usd("aperture:mask", Asset())
    radial_weights: Floats = usd("aperture:radialWeights", ())


@dataclass(frozen=True)
class TiltShiftData:
    """TiltShiftAPI: the lens's movements against the film."""

    tilt: float = usd("tiltShift:tilt", 0.0)
    swing: float = usd("tiltShift:swing", 0.0)
    rise: float = usd("tiltShift:rise", 0.0)
    shift: float = usd("tiltShift:shift", 0.0)
    from_focus_points: bool = usd("tiltShift:fromFocusPoints", True)
    max_angle: float = usd("tiltShift:maxAngle", 15.0)


@dataclass(frozen=True)
class FocusData:
    """FocusAPI: how the focus is found."""

    mode: FocusMode = usd("focus:mode", "manual")
    solve_stop: bool = usd("focus:solveStop", False)
    circle_of_confusion: float = usd("focus:circleOfConfusion", 0.0)
    smoothing: float = usd("focus:smoothing", 0.0)
    lag: float = usd("focus:lag", 0.0)
    dead_zone: float = usd("focus:deadZone", 0.0)
    max_speed: float = usd("focus:maxSpeed", 0.0)
    near_priority: float = usd("focus:nearPriority", 0.0)
    off_screen: Literal["ignore", "keep"] = usd("focus:offScreen", "ignore")
    occluded: Literal["ignore", "keep", "fade"] = usd("focus:occluded", "keep")
    surface_exponent: float = usd("focus:surfaceExponent", 3.0)
    expressive: float = usd("focus:expressive", 1.0)
    field_offsets: Triples = usd("focus:fieldOffsets", ())


@dataclass(frozen=True)
class FocusPoint:
    """One instance of FocusPointAPI: a thing that must be sharp, or soft.

    Attributes:
        name: the instance name, an identifier.
        target: one prim path, or for a PointInstancer its path and the prototype mesh's.
        face: index of the authored face, -1 for the origin of the target's space.
        fan_triangle: which triangle of that face's fan: corners 0, i + 1, i + 2 in authored order.
        barycentric: weights of those corners, in that order.
        instance: id in the PointInstancer (its index where it has no ids), else -1.
        offset: from the surface, in scene units in the target's own space.
        kind: sharp or soft.
        blur: wanted diameter of the circle of confusion on the film, in millimetres.
        weight: importance among the points; 0 equals absence.
        falloff: screen distance, in frame widths, at which its influence ends; 0 for nowhere.
        enabled: whether it counts at all.
        surface_offset: for a soft point without blur, how far behind the target the focal surface lies, in scene units.
        extent: depth of field around it in surface mode, relative to the lens's own.
        topology: fingerprint of the mesh when the point was placed; empty if none was taken.
    """

    name: str
    target: tuple[str, ...] = ()
    face: int = usd("face", -1)
    fan_triangle: int = usd("fanTriangle", 0)
    barycentric: Triple = usd("barycentric", (1.0, 0.0, 0.0))
    instance: int = usd("instance", -1)
    offset: Triple = usd("offset", (0.0, 0.0, 0.0))
    kind: FocusPointKind = usd("kind", "sharp")
    blur: float = usd("blur", 0.0)
    weight: float = usd("weight", 1.0)
    falloff: float = usd("falloff", 0.0)
    enabled: bool = usd("enabled", True)
    surface_offset: float = usd("surfaceOffset", 0.0)
    extent: float = usd("extent", 1.0)
    topology: str = usd("topology", "")
