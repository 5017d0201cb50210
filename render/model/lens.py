"""Lenses as plain data: surfaces, glass, wavefront errors, iris. Scenes are in `render.model.scene`.

Conventions: lengths in millimetres. Along the axis light goes from the scene to the film, and surfaces are listed in that
order. A radius is positive where the centre of curvature lies toward the film, 0 for a plane. The sag of a surface at distance r
from the axis is

    z(r) = c·r² / (1 + √(1 − (1 + K)·c²·r²)) + Σ A_i·r^(2i + 4) + Σ B_i·r^(2i + 3),        c = 1/radius

with the conic constant K, the aspheric coefficients A_0 (of r⁴), A_1 (of r⁶) and so on, and those of odd powers B_0 (of r³), B_1
(of r⁵) and so on. A surface with another curve from side
to side than from top to bottom is biconic, as cylinders are:

    z(x, y) = (cₓ·x² + c·y²) / (1 + √(1 − (1 + Kₓ)·cₓ²·x² − (1 + K)·c²·y²)) + Σ A_i·r^(2i + 4) + Σ B_i·r^(2i + 3)

with x across the picture and y up. A torus is made by turning one of its two curves about an axis that lies across it, at the
distance of the other one's radius. With the curve from top to bottom, f(y), a conic with aspheric terms of y in place of r:

    z(x, y) = f + cₓ·x² / (u + √(u² − cₓ²·x²)),        u = 1 − cₓ·f(y)

A diffractive surface adds the phase Σ P_i·r^(2i), i from 1, in radians, to light of every wavelength.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from render.errors import SettingsError
from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet

LensModel = Literal["pinhole", "thin", "seidel", "spherical", "heightField", "prescription", "dataSheet"]


@dataclass(frozen=True)
class Dispersion:
    """Refractive index over the wavelength by a formula of a glass catalogue.

    Attributes:
        formula: name in `render.optics.dispersion.formulas`.
        coefficients: of the formula, with wavelengths in micrometres.
    """

    formula: str
    coefficients: tuple[float, ...]


@dataclass(frozen=True)
class Glass:
    """An optical medium; its index at a wavelength is `render.optics.glass.refractive_index`.

    Attributes:
        index: refractive index at the d line (587.56 nm); 1 is air.
        abbe: Abbe number V_d; 0 for a medium without dispersion.
        sellmeier_b: B1, B2, B3 of Sellmeier's equation; where given they win over all else.
        sellmeier_c: C1, C2, C3 in square micrometres.
        name: catalogue name.
        dispersion: formula that wins over index and Abbe number.
        channels: indices for red, green and blue light; where given they win over all else.
    """

    index: float = 1.0
    abbe: float = 0.0
    sellmeier_b: tuple[float, float, float] | None = None
    sellmeier_c: tuple[float, float, float] | None = None
    name: str = ""
    dispersion: Dispersion | None = None
    channels: tuple[float, float, float] | None = None


AIR = Glass()


@dataclass(frozen=True)
class Across:
    """Curve of a surface from side to side, where it is another one than from top to bottom.

    Attributes:
        radius_mm: of curvature in the x-z plane; 0 is none: with a radius from top to bottom, a cylinder that lies on its side.
        conic: conic constant in that plane.
        torus: the curve that is turned about an axis across it, from top to bottom or from side to side, which is also the one
            that has the aspheric terms; the other one has no conic constant. Empty for a biconic.
    """

    radius_mm: float = 0.0
    conic: float = 0.0
    torus: Literal["", "upright", "across"] = ""


@dataclass(frozen=True)
class Outline:
    """Edge of an opening or of an obscuration on a surface, as it is seen along the axis.

    Attributes:
        kind: a circle is an ellipse of equal half axes.
        half_mm: half width, from side to side, and half height; of a polygon those of the box around it.
        centre_mm: x across the picture and y up, from the axis; of a polygon that of the box around it.
        corners_mm: of a polygon, from the axis, in order around it; its edges do not cross.
    """

    kind: Literal["ellipse", "rectangle", "polygon"]
    half_mm: tuple[float, float]
    centre_mm: tuple[float, float] = (0.0, 0.0)
    corners_mm: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Surface:
    """One surface of a lens, or its stop.

    Attributes:
        radius_mm: of curvature; 0 is a plane. In the y-z plane, from top to bottom, where the surface has two.
        thickness_mm: along the axis to the next surface; of the last one, to the film with the lens focused at infinity (0 where
            it is to be solved for).
        glass: the medium behind the surface.
        semi_diameter_mm: half the clear diameter; 0 where it is unknown. At the stop: wide open.
        conic: conic constant K.
        aspheric: coefficients of r⁴, r⁶, ...
        is_stop: whether this is the aperture stop.
        coating_nm: wavelength that its quarter-wave coating is made for; 0 for bare glass. Cemented surfaces have none.
        across: curve from side to side; None where it is that from top to bottom.
        opening: within which light passes, as well as within the clear diameter; None where that alone limits it.
        obscuration: within which no light passes; None where there is none. With a clear diameter, a round one makes a ring.
        odd: coefficients of r³, r⁵, ...
        phase: coefficients of r², r⁴, ... of the phase that it adds by diffraction in the order that is used, radians; empty
            for a surface without diffraction.
    """

    radius_mm: float
    thickness_mm: float
    glass: Glass = AIR
    semi_diameter_mm: float = 0.0
    conic: float = 0.0
    aspheric: tuple[float, ...] = ()
    is_stop: bool = False
    coating_nm: float = 0.0
    across: Across | None = None
    opening: Outline | None = None
    obscuration: Outline | None = None
    odd: tuple[float, ...] = ()
    phase: tuple[float, ...] = ()

    @property
    def is_aspheric(self) -> bool:
        """Whether it has aspheric coefficients, be they of even or of odd powers."""
        return bool(self.aspheric or self.odd)

    @property
    def torus(self) -> Literal["", "upright", "across"]:
        """The curve that is turned to make it, of a torus."""
        return self.across.torus if self.across is not None else ""

    @property
    def aspheric_terms(self) -> dict[int, float]:
        """All aspheric coefficients by their power of r."""
        even = {4 + 2 * i: term for i, term in enumerate(self.aspheric)}
        return even | {3 + 2 * i: term for i, term in enumerate(self.odd)}


@dataclass(frozen=True)
class Configuration:
    """Places of a lens's groups at one position of zoom and focus.

    Attributes:
        thicknesses_mm: along the axis from each surface to the next; of the last one, to the film (0 where it is
            solved for).
        object_mm: distance from the object in focus to surface 1; infinite for infinity.
        focal_length_mm: of the zoom position, focused at infinity, as it is stated; 0 where it is not.
        f_stop: wide open; 0 where it is unknown.
    """

    thicknesses_mm: tuple[float, ...]
    object_mm: float = math.inf
    focal_length_mm: float = 0.0
    f_stop: float = 0.0


@dataclass(frozen=True)
class Prescription:
    """The surfaces of a lens from front to rear.

    Attributes:
        surfaces: at least one that refracts; once completed (`render.optics.prescription.completion`), one is the stop and
            neither a clear diameter nor the back focal distance is missing.
        focus_group: first and last index of the surfaces that move to focus; None moves the whole lens.
        f_stop: f-number of the real beam wide open; 0 where it is unknown. It limits the stop, whose own diameter may cut it.
        name: for messages.
        notes: values that were computed or approximated, one sentence each.
        configurations: positions of zoom and focus (`render.optics.prescription.zooming`). Those that are focused nearer than
            infinity say how the groups move to focus, and win over ``focus_group``. Empty for a lens of one position.
        focus_group_across: first and last index of the surfaces, without power from top to bottom, that move to focus from side
            to side too; None where nothing moves for that.
    """

    surfaces: tuple[Surface, ...]
    focus_group: tuple[int, int] | None = None
    f_stop: float = 0.0
    name: str = ""
    notes: tuple[str, ...] = ()
    configurations: tuple[Configuration, ...] = ()
    focus_group_across: tuple[int, int] | None = None

    @property
    def is_anamorphic(self) -> bool:
        """Whether a surface has another curve from side to side than from top to bottom."""
        return any(surface.across is not None for surface in self.surfaces)

    @property
    def has_tori(self) -> bool:
        """Whether a surface is a torus."""
        return any(surface.torus for surface in self.surfaces)

    @property
    def is_diffractive(self) -> bool:
        """Whether a surface adds a phase."""
        return any(surface.phase for surface in self.surfaces)

    @property
    def outlines(self) -> tuple[Outline, ...]:
        """All openings and obscurations: edges that stop light besides clear diameters and the iris."""
        both = [outline for surface in self.surfaces for outline in (surface.opening, surface.obscuration)]
        return tuple(outline for outline in both if outline is not None)

    @property
    def polygons(self) -> tuple[Outline, ...]:
        """Those of its outlines that are polygons."""
        return tuple(outline for outline in self.outlines if outline.kind == "polygon")

    @property
    def has_odd_powers(self) -> bool:
        """Whether a surface has aspheric coefficients of odd powers."""
        return any(surface.odd for surface in self.surfaces)


@dataclass(frozen=True)
class SeidelErrors:
    """Third-order wavefront errors of a thin lens (Welford 1986, ch. 8), in wavelengths of the d line.

    ``W = w040·ρ⁴ + w131·η·ρ³·cos φ + w222·η²·ρ²·cos² φ + w220·η²·ρ² + w311·η³·ρ·cos φ`` with ρ the pupil's radius over that of
    the reference f-number, η the image height over the reference height and φ the angle from the image point's direction on
    the film. Positive spherical aberration focuses the edge of the pupil short, positive distortion is barrel-shaped. On the
    film a ray lands off by ``-v·∂W/∂X`` (v the image distance, X on the pupil), so in the picture, which is upright, the
    object-space slope of the ray that a pixel sees is off by ``-∂W/∂X`` with φ counted from the pixel's opposite direction.

    Attributes:
        w040: spherical aberration.
        w131: coma.
        w222: astigmatism.
        w220: field curvature.
        w311: distortion.
        axial_color_mm: focus at 475 nm less focus at 650 nm, along the axis behind the lens.
        lateral_color_mm: image height at 475 nm less that at 650 nm, at the reference height.
        reference_f_stop: f-number at whose pupil's edge the coefficients hold.
        reference_height_mm: image height for which they hold.
    """

    w040: float = 0.0
    w131: float = 0.0
    w222: float = 0.0
    w220: float = 0.0
    w311: float = 0.0
    axial_color_mm: float = 0.0
    lateral_color_mm: float = 0.0
    reference_f_stop: float = 2.8
    reference_height_mm: float = 21.6


@dataclass(frozen=True, eq=False)
class HeightField:
    """Heights that are added to the two surfaces of a thick lens, over the square that circumscribes the clear aperture.

    Attributes:
        front: ``(h, w)`` float64, row 0 at the top and column 0 on the left as seen from the film, through the lens; mm toward
            the film are positive, and stay so many mm whatever the camera's focal length. None for none.
        back: the same for the second surface.
    """

    front: DoubleArray | None = None
    back: DoubleArray | None = None


@dataclass(frozen=True)
class AberrationScales:
    """Factors on a lens's errors: 0 none, 1 as the lens has them, more exaggerates."""

    spherical: float = 1.0
    coma: float = 1.0
    astigmatism: float = 1.0
    field_curvature: float = 1.0
    distortion: float = 1.0
    chromatic: float = 1.0
    vignetting: float = 1.0


@dataclass(frozen=True, eq=False)
class IrisShape:
    """The opening of the iris, of unit radius, as seen in the picture's bokeh.

    Attributes:
        blades: 0 for a round iris, else its number of edges, 3 or more.
        roundness: 0 straight blades to 1 round.
        rotation_rad: counter-clockwise.
        mask: ``(h, w)`` float64 transmission over the square that circumscribes the pupil, row 0 at the top; None for clear.
        radial_weights: transmission at even steps of the radius from centre to edge, joined linearly; empty for even.
    """

    blades: int = 0
    roundness: float = 0.0
    rotation_rad: float = 0.0
    mask: DoubleArray | None = None
    radial_weights: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Raises `SettingsError` where no iris has such a shape."""
        if self.blades != 0 and not 3 <= self.blades <= 64:
            raise SettingsError(f"an iris has 0 blades (round) or from 3 to 64, got {self.blades}")
        if not 0 <= self.roundness <= 1:
            raise SettingsError(f"iris roundness must be from 0 to 1, got {self.roundness}")


@dataclass(frozen=True, eq=False)
class Lens:
    """A lens.

    Attributes:
        model: which of the fields below hold.
        name: name, such as "Zeiss Planar 50/1.4".
        prescription: for the models spherical, heightField (two surfaces) and prescription. A zoom is set to the camera's focal
            length; any other lens is scaled to it, so that the field of view stays what the camera says.
        seidel: for the model seidel.
        data_sheet: for the model dataSheet.
        height_field: for the model heightField.
        scales: factors on the errors of whatever model it is.
        squeeze: anamorphic squeeze: the bokeh is that many times narrower than high. Of a prescription with cylinders it is the
            nominal squeeze, by which the picture is stretched back; the glass itself squeezes.
        transmittance: share of the light that passes, 0 to 1.
        pupil_magnification: diameter of the exit pupil over the entrance pupil's, of a lens without surfaces.
        natural_vignetting: whether a lens without surfaces darkens the picture's corners by cos⁴; one with surfaces always does.
        close_focus_m: nearest marked distance, from the film; 0 where none is marked. The glass may focus nearer.
        pupil_power: refractive power at even steps of the pupil's radius from centre to edge, drawn by hand: it counts relative
            to the centre's and replaces the lens's own spherical aberration. Empty keeps the lens's own.
        expressive_blend: from the lens's own (0) to the drawn power (1).
        ghosts: strength of the reflections between pairs of surfaces: 0 off, 1 as the surfaces have them.
        star: strength of the diffraction at the iris: 0 off, 1 as it is.
    """

    model: LensModel = "thin"
    name: str = ""
    prescription: Prescription | None = None
    seidel: SeidelErrors | None = None
    height_field: HeightField | None = None
    scales: AberrationScales = field(default_factory=AberrationScales)
    squeeze: float = 1.0
    transmittance: float = 1.0
    pupil_magnification: float = 1.0
    natural_vignetting: bool = False
    close_focus_m: float = 0.0
    pupil_power: tuple[float, ...] = ()
    expressive_blend: float = 0.0
    ghosts: float = 0.0
    star: float = 0.0
    data_sheet: DataSheet | None = None

    @property
    def drawn_squeeze(self) -> float:
        """Squeeze by which the rays of a lens without cylinders are narrowed; 1 where cylinders do that."""
        return 1.0 if self.has_cylinders else self.squeeze

    @property
    def has_cylinders(self) -> bool:
        """Whether its surfaces squeeze the picture themselves."""
        return self.model == "prescription" and self.prescription is not None and self.prescription.is_anamorphic

    @property
    def has_outlines(self) -> bool:
        """Whether a surface has an opening or an obscuration besides its clear diameter."""
        return self.model == "prescription" and self.prescription is not None and bool(self.prescription.outlines)

    @property
    def has_thin_errors(self) -> bool:
        """Whether it is a thin lens with errors of its own, from wavefronts or from a data sheet."""
        if self.model == "dataSheet":
            return self.data_sheet is not None
        return self.model == "seidel" and self.seidel is not None


THIN_LENS = Lens()
