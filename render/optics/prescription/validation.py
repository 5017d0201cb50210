"""Validation of prescriptions. A fault names its surface, counted from 1, front to rear."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from render.errors import InputError
from render.model.lens import Prescription, Surface
from render.optics.glass import C_LINE_NM, D_LINE_NM, F_LINE_NM, refractive_index
from render.optics.prescription.outlines import is_closed
from render.optics.prescription.paraxial import ParaxialSystem, focal_points, paraxial_ray, paraxial_system
from render.optics.prescription.surface_shape import clearance_mm, conic_extent_mm

MAX_SURFACES = 200
MAX_ASPHERIC_TERMS = 10
MAX_CONFIGURATIONS = 64
MAX_CORNERS = 64
_LARGEST_INDEX = 5.0  # germanium has 4
_LEAST_ABBE = 1.0  # the densest flints have about 15
_LARGEST_NUMBER = 1e5  # mm, for lengths along the axis and across it: a hundred metres
_LEAST_RADIUS_MM = 1e-3
_OVERLAP_SLACK_MM = 1e-6
_RIM_SLACK = 1 + 1e-6
FASTEST_F_STOP = 0.5  # in air: the marginal ray leaves at right angles to the axis (Welford 1986, ch. 6)


def check_prescription(prescription: Prescription) -> None:
    """Raise `InputError` for an impossible lens; missing values (0) are accepted."""
    surfaces = prescription.surfaces
    if not 1 <= len(surfaces) <= MAX_SURFACES:
        raise bad_lens(prescription, f"expected 1 to {MAX_SURFACES} surfaces, got {len(surfaces)}")
    for i, surface in enumerate(surfaces):
        _check_numbers(prescription, i, surface)
        _check_glass(prescription, i, surface)
        _check_extent(prescription, i, surface)
        _check_outlines(prescription, i, surface)
    _check_whole(prescription)
    check_configurations(prescription)
    check_overlaps(prescription)


def check_configurations(prescription: Prescription) -> None:
    """Raise `InputError` for positions of zoom and focus that no lens has."""
    configurations, count = prescription.configurations, len(prescription.surfaces)
    if len(configurations) > MAX_CONFIGURATIONS:
        raise bad_lens(prescription, f"expected at most {MAX_CONFIGURATIONS} configurations, got {len(configurations)}")
    for number, configuration in enumerate(configurations, 1):
        begin = f"configuration {number}"
        if len(configuration.thicknesses_mm) != count:
            got = f"{begin} must have {count} thicknesses, one for each surface"
            raise bad_lens(prescription, f"{got}, got {len(configuration.thicknesses_mm)}")
        for i, thickness in enumerate(configuration.thicknesses_mm):
            if not 0 <= thickness <= _LARGEST_NUMBER:
                what = f"its thickness in {begin} must be from 0 to {_LARGEST_NUMBER:g} mm, got {thickness:g} mm"
                raise bad_lens(prescription, what, i)
        if not configuration.object_mm > 0:
            what = f"the object of {begin} must be before the lens"
            raise bad_lens(prescription, f"{what}, got {configuration.object_mm:g} mm")
        if not 0 <= configuration.focal_length_mm <= _LARGEST_NUMBER:
            what = f"the focal length of {begin} must be from 0 (unknown) to {_LARGEST_NUMBER:g} mm"
            raise bad_lens(prescription, f"{what}, got {configuration.focal_length_mm:g} mm")
        if not (configuration.f_stop == 0 or FASTEST_F_STOP <= configuration.f_stop < np.inf):
            what = f"the f-number of {begin} must be 0 (unknown) or from {FASTEST_F_STOP:g} up"
            raise bad_lens(prescription, f"{what}, got {configuration.f_stop:g}")


def bad_lens(prescription: Prescription, what: str, surface: int | None = None) -> InputError:
    """The error that names the lens, and the surface by its index."""
    name = prescription.name or "the lens"
    return InputError(f"{f'surface {surface + 1} of ' if surface is not None else ''}{name}: {what}", code="bad_lens")


def check_overlaps(prescription: Prescription) -> None:
    """Raise `InputError` where two neighbours run into each other within their clear diameters."""
    for i, j in solid_neighbours(prescription):
        thickness = sum(surface.thickness_mm for surface in prescription.surfaces[i:j])
        overlap = -clearance_mm(prescription.surfaces[i], prescription.surfaces[j], thickness)
        if overlap > _OVERLAP_SLACK_MM:
            what = f"it overlaps surface {j + 1} by {overlap:.3g} mm within their clear diameters"
            raise bad_lens(prescription, f"{what}, {thickness:g} mm apart on the axis", i)


def solid_neighbours(prescription: Prescription) -> list[tuple[int, int]]:
    """Pairs of surfaces that follow each other and must keep apart.

    A stop in the air is passed over: glass may bulge through the opening of an iris.
    """
    solid = [i for i, s in enumerate(prescription.surfaces) if not (s.is_stop and _is_window(prescription, i))]
    return list(pairwise(solid))


def _is_window(prescription: Prescription, index: int) -> bool:
    """Whether a surface has the same medium on both sides."""
    before = prescription.surfaces[index - 1].glass.index if index else 1.0
    return before == prescription.surfaces[index].glass.index


def _check_numbers(prescription: Prescription, index: int, surface: Surface) -> None:
    numbers = {
        "radius": surface.radius_mm,
        "thickness": surface.thickness_mm,
        "clear semi-diameter": surface.semi_diameter_mm,
        "conic constant": surface.conic,
        **{f"aspheric coefficient of r^{power}": term for power, term in surface.aspheric_terms.items()},
        **(
            {"radius across": surface.across.radius_mm, "conic constant across": surface.across.conic}
            if surface.across
            else {}
        ),
    }
    numbers |= {f"phase coefficient of r^{2 * i + 2}": term for i, term in enumerate(surface.phase)}
    for what, number in numbers.items():
        if not np.isfinite(number):
            raise bad_lens(prescription, f"its {what} must be a finite number, got {number}", index)
        if not what.startswith("radius") and abs(number) > _LARGEST_NUMBER:
            raise bad_lens(prescription, f"its {what} must be at most {_LARGEST_NUMBER:g}, got {number:g}", index)
    for what in ("radius", "radius across"):
        if 0 < abs(radius := numbers.get(what, 0.0)) < _LEAST_RADIUS_MM:
            what = f"its {what} must be 0 (a plane) or at least {_LEAST_RADIUS_MM:g} mm, got {radius:g} mm"
            raise bad_lens(prescription, what, index)
    for what in ("thickness", "clear semi-diameter"):
        if numbers[what] < 0:
            raise bad_lens(prescription, f"its {what} must be 0 or more, got {numbers[what]:g} mm", index)
    if surface.across is not None and surface.torus:
        conic = surface.across.conic if surface.torus == "upright" else surface.conic
        if conic:
            curve = "from side to side" if surface.torus == "upright" else "from top to bottom"
            what = f"a torus whose curve {curve} is a circle has no conic constant there: it must be 0, got {conic:g}"
            raise bad_lens(prescription, what, index)
    for kind, terms in (("aspheric", surface.aspheric), ("odd aspheric", surface.odd), ("phase", surface.phase)):
        if len(terms) > MAX_ASPHERIC_TERMS:
            what = f"expected at most {MAX_ASPHERIC_TERMS} {kind} coefficients, got {len(terms)}"
            raise bad_lens(prescription, what, index)


def _check_glass(prescription: Prescription, index: int, surface: Surface) -> None:
    glass = surface.glass
    if glass.abbe != 0 and not _LEAST_ABBE <= glass.abbe < np.inf:
        what = f"the Abbe number behind it must be 0 (no dispersion) or at least {_LEAST_ABBE:g}, got {glass.abbe:g}"
        raise bad_lens(prescription, what, index)
    if not np.isfinite([glass.index, *(glass.sellmeier_b or ()), *(glass.sellmeier_c or ())]).all():
        raise bad_lens(prescription, "the glass behind it must have finite numbers", index)
    for line_nm in (D_LINE_NM, F_LINE_NM, C_LINE_NM):
        n = refractive_index(glass, line_nm)
        if not 1 <= n <= _LARGEST_INDEX:
            what = f"the refractive index behind it must be from 1 to {_LARGEST_INDEX:g}, got {n:g} at {line_nm:.1f} nm"
            raise bad_lens(prescription, what, index)


def _check_extent(prescription: Prescription, index: int, surface: Surface) -> None:
    extent = conic_extent_mm(surface)
    if surface.semi_diameter_mm > extent * _RIM_SLACK:
        what = f"its clear semi-diameter of {surface.semi_diameter_mm:g} mm exceeds the {extent:g} mm"
        radii = f"radii of {surface.radius_mm:g} and {surface.across.radius_mm:g} mm let" if surface.across else ""
        radii = radii or f"radius of {surface.radius_mm:g} mm lets"
        raise bad_lens(prescription, f"{what} to which its {radii} it reach", index)


def _check_outlines(prescription: Prescription, index: int, surface: Surface) -> None:
    for name, outline in (("opening", surface.opening), ("obscuration", surface.obscuration)):
        if outline is None:
            continue
        if outline.kind == "polygon" and not 3 <= len(outline.corners_mm) <= MAX_CORNERS:
            what = f"its {name} must have from 3 to {MAX_CORNERS} corners, got {len(outline.corners_mm)}"
            raise bad_lens(prescription, what, index)
        if not all(_LEAST_RADIUS_MM <= half <= _LARGEST_NUMBER for half in outline.half_mm):
            wide, high = (2 * half for half in outline.half_mm)
            size = f"from {2 * _LEAST_RADIUS_MM:g} to {2 * _LARGEST_NUMBER:g} mm wide and high"
            raise bad_lens(prescription, f"its {name} must be {size}, got {wide:g} and {high:g} mm", index)
        if not all(abs(place) <= _LARGEST_NUMBER for place in outline.centre_mm):
            x, y = outline.centre_mm
            what = f"the centre of its {name} must be within {_LARGEST_NUMBER:g} mm of the axis, got {x:g} and {y:g} mm"
            raise bad_lens(prescription, what, index)
    if is_closed(surface):
        raise bad_lens(prescription, "its clear diameter, opening and obscuration leave nothing open", index)


def _check_whole(prescription: Prescription) -> None:
    surfaces, last = prescription.surfaces, len(prescription.surfaces) - 1
    if all(_is_window(prescription, i) for i in range(len(surfaces))) and not prescription.is_diffractive:
        raise bad_lens(prescription, "no surface refracts: expected one with another index behind it than before it")
    stops = [i for i, surface in enumerate(surfaces) if surface.is_stop]
    if len(stops) > 1:
        raise bad_lens(prescription, f"it is a second aperture stop: surface {stops[0] + 1} is one already", stops[1])
    if abs(refractive_index(surfaces[-1].glass, D_LINE_NM) - 1) > 1e-9:
        raise bad_lens(prescription, "behind the last surface there must be air (index 1)", last)
    if not (np.isfinite(prescription.f_stop) and (prescription.f_stop == 0 or prescription.f_stop >= FASTEST_F_STOP)):
        what = f"f/{prescription.f_stop:g} wide open is impossible: expected 0 (unknown) or from {FASTEST_F_STOP:g} up"
        raise bad_lens(prescription, what)
    for group in (prescription.focus_group, prescription.focus_group_across):
        if group is not None and not 0 <= group[0] <= group[1] <= last:
            what = f"its focus group must be surfaces between 1 and {last + 1} in order"
            raise bad_lens(prescription, f"{what}, got {group[0] + 1} to {group[1] + 1}")
    if prescription.focus_group_across is not None:
        _check_cylinders(prescription, *prescription.focus_group_across)
    system = paraxial_system(prescription)
    focal, back, _ = focal_points(system, prescription.name)
    if focal <= 0:
        raise _not_converging(prescription, system, focal)
    if back <= 0:
        raise bad_lens(
            prescription, f"its focal point lies {-back:.4g} mm before its last surface, where no film can be", last
        )


def _check_cylinders(prescription: Prescription, first: int, last: int) -> None:
    """Check that a group can focus from side to side alone: moving it changes nothing from top to bottom."""
    surfaces = prescription.surfaces
    ends = [surfaces[first - 1].glass.index if first else 1.0, surfaces[last].glass.index]
    if ends != [1.0, 1.0]:
        raise bad_lens(prescription, "the group that focuses from side to side must begin and end in the air", first)
    for i in range(first, last + 1):
        has_terms = surfaces[i].is_aspheric and surfaces[i].torus != "across"
        if surfaces[i].radius_mm or has_terms or surfaces[i].phase or surfaces[i].is_stop:
            what = "it focuses from side to side, and must be a cylinder without power from top to bottom"
            raise bad_lens(prescription, what, i)


def _not_converging(prescription: Prescription, system: ParaxialSystem, focal_length_mm: float) -> InputError:
    """The error of a lens whose focal length is not positive, at the surface that has most to do with it."""
    wanted = (
        f"makes the focal length {focal_length_mm:.4g} mm, expected a positive one: light must converge behind the lens"
    )
    crossed = np.flatnonzero(paraxial_ray(system, 0.0, 1.0, 0.0).heights_mm <= 0)
    if len(crossed):
        return bad_lens(prescription, f"parallel light meets before it already, which {wanted}", int(crossed[0]))
    most = int(np.argmin(system.powers))
    what = f"its power of {1000 * system.powers[most]:.4g} dioptres spreads light the most, which"
    return bad_lens(prescription, f"{what} {wanted}", most)
