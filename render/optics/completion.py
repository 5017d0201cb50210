"""A prescription made complete: checked, and what its file leaves out solved for and said so."""

from __future__ import annotations

from dataclasses import replace

from render.errors import SettingsError
from render.lens import Prescription, Surface
from render.optics.paraxial import first_order, focal_points, paraxial_system, stop_index
from render.optics.validation import bad_lens, check_prescription


def completed(prescription: Prescription, *, image_height_mm: float = 21.6) -> Prescription:
    """Check a prescription and solve for what is missing: the back focus and the wide-open aperture.

    Args:
        prescription: as a file has it.
        image_height_mm: half the diagonal that the lens is to cover.

    Returns:
        A prescription that `render.optics.focusing.focused` and the tracers take; ``notes`` say what was solved for. A complete
        one is returned as it is.

    Raises:
        InputError: there is no such lens; the message names the surface.
    """
    check_prescription(prescription)
    if not any(surface.is_stop for surface in prescription.surfaces):
        raise bad_lens(prescription, "no surface is the aperture stop")
    return _with_back_focus(_with_aperture(prescription))


def scaled(prescription: Prescription, factor: float) -> Prescription:
    """The same lens larger or smaller: every length times ``factor``; the f-number stays.

    Raises:
        SettingsError: the factor is no positive number.
    """
    if not 0 < factor < float("inf"):
        raise SettingsError(f"a lens can be scaled by a positive number only, got {factor}")
    return replace(prescription, surfaces=tuple(_scaled_surface(surface, factor) for surface in prescription.surfaces))


def _scaled_surface(surface: Surface, factor: float) -> Surface:
    return replace(
        surface,
        radius_mm=surface.radius_mm * factor,
        thickness_mm=surface.thickness_mm * factor,
        semi_diameter_mm=surface.semi_diameter_mm * factor,
        aspheric=tuple(term * factor ** -(2 * i + 3) for i, term in enumerate(surface.aspheric)),
    )


def with_surface(prescription: Prescription, index: int, **changes: float) -> Prescription:
    """The prescription with numbers of one surface replaced."""
    surfaces = list(prescription.surfaces)
    surfaces[index] = replace(surfaces[index], **changes)  # type: ignore[arg-type]
    return replace(prescription, surfaces=tuple(surfaces))


def _with_aperture(prescription: Prescription) -> Prescription:
    """Stop diameter from f-number, or f-number from stop diameter: the paraxial pupil joins them."""
    first, stop = first_order(prescription), stop_index(prescription)
    scale = abs(first.entrance_pupil_magnification)
    radius = prescription.surfaces[stop].semi_diameter_mm
    if radius > 0:
        return replace(prescription, f_stop=first.focal_length_mm / (2 * radius * scale))
    if prescription.f_stop == 0:
        raise bad_lens(prescription, "neither the clear diameter of the aperture stop nor the f-number is known", stop)
    radius = first.focal_length_mm / (2 * prescription.f_stop * scale)
    note = f"The stop's diameter of {2 * radius:.4g} mm was solved for from f/{prescription.f_stop:g}."
    solved = with_surface(prescription, stop, semi_diameter_mm=radius)
    return replace(solved, notes=(*prescription.notes, note))


def _with_back_focus(prescription: Prescription) -> Prescription:
    """The film at the paraxial focus of parallel light."""
    if prescription.surfaces[-1].thickness_mm > 0:
        return prescription
    back = focal_points(paraxial_system(prescription))[1]
    note = f"The back focal distance of {back:.4g} mm was solved for."
    solved = with_surface(prescription, len(prescription.surfaces) - 1, thickness_mm=back)
    return replace(solved, notes=(*prescription.notes, note))
