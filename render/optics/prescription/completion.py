"""Completion of a prescription: checks, and computation of values that its file leaves out, with notes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray
from render.model.lens import Configuration, Prescription, Surface
from render.optics.prescription.beams import axial_beam, axial_edge
from render.optics.prescription.clear_diameters import with_clear_diameters
from render.optics.prescription.f_numbers import (
    f_number,
    iris_radius_mm,
    marginal_height_mm,
    paraxial_f_number,
    widest_f_number,
    without_rims,
)
from render.optics.prescription.meridians import turned
from render.optics.prescription.outlines import scaled, without_outlines
from render.optics.prescription.paraxial import first_order, focal_points, paraxial_system, stop_index
from render.optics.prescription.stop_placement import with_stop
from render.optics.prescription.surface_shape import extent_mm
from render.optics.prescription.tracing import Fate, TracedRays, trace_forward
from render.optics.prescription.validation import FASTEST_F_STOP, bad_lens, check_overlaps, check_prescription
from render.optics.prescription.zooming import in_first_position

_WAYS_TO_FAIL = {
    Fate.BLOCKED: "its rim blocks",
    Fate.MISSES: "its surface is missed by",
    Fate.REFLECTED: "total internal reflection turns back",
}
_FAN = 201
_ACROSS = 101
_NOTICED = 0.01  # share of the f-number or of the focal length
_ROUNDED = 5e-4  # share of a length that no note shows
_SAME = 1e-6  # share of an f-number or of a radius


def complete_prescription(prescription: Prescription, *, image_height_mm: float = 21.6) -> Prescription:
    """Check a prescription and compute missing values: stop, aperture, back focus, clear diameters.

    A zoom that is not set to a focal length is set to that of its surfaces. Then, in this order: the stop's place
    (`render.optics.prescription.stop_placement`); the stop's diameter, by the real ray of the stated f-number
    (`render.optics.prescription.f_numbers`), which a stop that is given narrower cuts, or without one by the widest beam on the
    axis that all rims let through; the back focal distance at the d line; the clear diameters
    (`render.optics.prescription.clear_diameters`); the f-number of the beam that comes through all of it.

    Args:
        prescription: as read from a file.
        image_height_mm: half the diagonal that the lens is to cover.

    Returns:
        A prescription that `render.optics.prescription.focusing.focus_lens` and the tracers take, with ``f_stop`` that of the
        real beam. ``notes`` say what was solved for, and where stop and rims leave less of the beam than the file states.

    Raises:
        SettingsError: the image height is no positive number.
        InputError: there is no such lens; the message names the surface.
    """
    if not 0 < image_height_mm < float("inf"):
        raise SettingsError(f"the image height that a lens covers must be a positive number, got {image_height_mm} mm")
    check_prescription(prescription)
    prescription = in_first_position(prescription)
    placed = _with_side_noted(_with_back_focus(_with_aperture(with_stop(prescription))))
    whole = with_clear_diameters(placed, image_height_mm)
    check_overlaps(whole)
    return _with_real_f_number(_check_light(whole), prescription.f_stop)


def scale_prescription(prescription: Prescription, factor: float) -> Prescription:
    """Scale a lens: every length times ``factor``; the f-number stays.

    Notes with lengths in them are joined by one that says which lengths they are.

    Raises:
        SettingsError: the factor is no positive number.
    """
    if not 0 < factor < float("inf"):
        raise SettingsError(f"a lens can be scaled by a positive number only, got {factor}")
    notes = prescription.notes
    if abs(factor - 1) > _ROUNDED and any(" mm" in note for note in notes):
        notes = (*notes, f"Lengths in these notes are from before the lens was scaled by {factor:.4g}.")
    surfaces = tuple(_scale_surface(surface, factor) for surface in prescription.surfaces)
    configurations = tuple(_scale_configuration(each, factor) for each in prescription.configurations)
    return replace(prescription, surfaces=surfaces, notes=notes, configurations=configurations)


def _scale_configuration(configuration: Configuration, factor: float) -> Configuration:
    return replace(
        configuration,
        thicknesses_mm=tuple(thickness * factor for thickness in configuration.thicknesses_mm),
        object_mm=configuration.object_mm * factor,
        focal_length_mm=configuration.focal_length_mm * factor,
    )


def _scale_surface(surface: Surface, factor: float) -> Surface:
    return replace(
        surface,
        radius_mm=surface.radius_mm * factor,
        thickness_mm=surface.thickness_mm * factor,
        semi_diameter_mm=surface.semi_diameter_mm * factor,
        aspheric=tuple(term * factor ** -(2 * i + 3) for i, term in enumerate(surface.aspheric)),
        odd=tuple(term * factor ** -(2 * i + 2) for i, term in enumerate(surface.odd)),
        across=surface.across and replace(surface.across, radius_mm=surface.across.radius_mm * factor),
        phase=tuple(term * factor ** -(2 * i + 1) for i, term in enumerate(surface.phase)),
        opening=scaled(surface.opening, factor),
        obscuration=scaled(surface.obscuration, factor),
    )


def _with_surface(prescription: Prescription, index: int, note: str, **changes: float) -> Prescription:
    """Replace numbers of one surface, and add a note."""
    surfaces = list(prescription.surfaces)
    surfaces[index] = replace(surfaces[index], **changes)  # type: ignore[arg-type]
    return replace(prescription, surfaces=tuple(surfaces), notes=(*prescription.notes, note))


def _with_aperture(prescription: Prescription) -> Prescription:
    """Complete the stop's diameter: a stated f-number sets the beam, and a given stop can only cut it."""
    stop = _stop_with_image(prescription)
    radius, stated = prescription.surfaces[stop].semi_diameter_mm, prescription.f_stop
    if not stated:
        return _with_aperture_by_rims(prescription, stop, radius)
    solved = iris_radius_mm(prescription, stated)
    if radius == 0:
        _check_marginal_ray(prescription)
        note = f"The stop's diameter of {2 * solved:.4g} mm was solved for from f/{stated:.3g}."
        return _with_surface(prescription, stop, note, semi_diameter_mm=solved)
    if radius <= solved * (1 + _SAME):
        return prescription
    by_stop, by_rims = (f_number(prescription, radius, clip=clip) for clip in (False, True))
    if by_stop >= stated * (1 - _SAME) or abs(by_rims / stated - 1) < _SAME:  # completed: what its rims leave is stated
        return prescription
    closed = replace(prescription.surfaces[stop], semi_diameter_mm=solved)
    surfaces = (*prescription.surfaces[:stop], closed, *prescription.surfaces[stop + 1 :])
    notes = prescription.notes
    if by_stop < stated * (1 - _NOTICED):
        notes = (
            *notes,
            f"The iris opens to f/{stated:.3g} as is stated; its clear diameter would let f/{by_stop:.3g} through.",
        )
    return replace(prescription, surfaces=surfaces, notes=notes)


def _with_aperture_by_rims(prescription: Prescription, stop: int, radius: float) -> Prescription:
    """Complete stop and f-number without a stated one; radius 0 is solved for too."""
    if radius == 0:
        radius = _stop_radius_by_rims(prescription)
        how = "the widest beam on the axis that all rims let through"
        note = f"The stop's diameter of {2 * radius:.4g} mm was solved for: {how}."
        prescription = _with_surface(prescription, stop, note, semi_diameter_mm=radius)
    f_stop = paraxial_f_number(prescription, radius) if radius > 0 else 0.0
    if f_stop < FASTEST_F_STOP:
        what = f"as the stop, its clear semi-diameter of {radius:g} mm makes it f/{f_stop:.3g}, which is impossible"
        raise bad_lens(prescription, f"{what}: expected f/{FASTEST_F_STOP:g} or slower", stop)
    return replace(prescription, f_stop=f_number(prescription, radius, clip=False))


def _stop_with_image(prescription: Prescription) -> int:
    """Index of the stop of a lens that has an entrance pupil."""
    first, stop = first_order(prescription), stop_index(prescription)
    if not abs(first.entrance_pupil_mm) < 1e3 * first.focal_length_mm:
        what = "it is the stop, and its image is infinitely far off: no entrance pupil to measure distances from"
        raise bad_lens(prescription, what, stop)
    return stop


def _stop_radius_by_rims(prescription: Prescription) -> float:
    """Height at the stop of the outermost ray along the axis that no rim blocks."""
    stop = stop_index(prescription)
    unknown = [i for i, s in enumerate(prescription.surfaces) if s.semi_diameter_mm == 0 and i != stop]
    if unknown:
        what = "neither the f-number nor the stop's clear diameter is known, and for want of this surface's neither can be found"
        raise bad_lens(prescription, what, unknown[0])
    low, high = 0.0, extent_mm(prescription.surfaces[0 if stop else 1])
    for _ in range(3):
        heights = np.linspace(low, high, _FAN)
        passes = _parallel_rays(prescription, heights).passes
        lost = int(np.argmin(passes)) if not passes.all() else _FAN - 1
        low, high = float(heights[max(lost - 1, 0)]), float(heights[lost])
    return float(_parallel_rays(prescription, np.array([low])).points_mm[stop, 0, 1])


def _parallel_rays(prescription: Prescription, heights_mm: DoubleArray, *, clip: bool = True) -> TracedRays:
    points = np.stack([0 * heights_mm, heights_mm, 0 * heights_mm], axis=1)
    along = np.tile([0.0, 0.0, 1.0], (len(heights_mm), 1))
    return trace_forward(without_outlines(prescription), points, along, clip=clip)


def _check_marginal_ray(prescription: Prescription) -> None:
    """Raise `InputError` where glass does not bring the marginal ray of the f-number through: rims are yet to be looked at."""
    heights = marginal_height_mm(prescription, prescription.f_stop) * np.array([1.0, 1.002])
    edge = _parallel_rays(without_rims(prescription), heights, clip=False)
    if not edge.passes.all():
        ray = int(np.argmin(edge.passes))
        what = f"f/{prescription.f_stop:.3g} wide open is impossible: {_WAYS_TO_FAIL[Fate(edge.fates[ray])]} the edge of the beam"
        raise bad_lens(prescription, what, int(edge.stopped_by[ray]))


def _check_light(prescription: Prescription) -> Prescription:
    """Raise `InputError` where no light on the axis gets through; say where a rim limits it more than the stop."""
    heights = np.linspace(0, 1, _FAN)[1:]
    stop_radius = prescription.surfaces[stop_index(prescription)].semi_diameter_mm
    beam = axial_beam(prescription, -np.inf, heights, stop_radius)
    if not beam.passes[0]:
        what = f"no light gets through: {_WAYS_TO_FAIL[Fate(beam.fates[0])]} all rays along the axis"
        raise bad_lens(prescription, what, int(beam.stopped_by[0]))
    _check_outlines(prescription, stop_radius)
    if beam.passes[heights <= 1 - _NOTICED].all():
        return prescription
    by = int(beam.stopped_by[int(np.argmin(beam.passes))]) + 1
    note = f"Surface {by} cuts the beam on the axis to f/{widest_f_number(prescription):.3g}."
    return prescription if note in prescription.notes else replace(prescription, notes=(*prescription.notes, note))


def _check_outlines(prescription: Prescription, stop_radius_mm: float) -> None:
    """Raise `InputError` where openings and obscurations leave nothing of the light on the axis."""
    if not prescription.outlines:
        return
    line = np.linspace(-1, 1, _ACROSS) * axial_edge(prescription, -np.inf, stop_radius_mm).height_mm
    points = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    rays = trace_forward(
        prescription,
        np.column_stack([points, np.zeros(len(points))]),
        np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        stop_radius_mm=stop_radius_mm,
    )
    if not rays.passes.any():
        last = max(i for i, s in enumerate(prescription.surfaces) if s.opening is not None or s.obscuration is not None)
        what = "no light gets through: its opening or obscuration, with those of other surfaces, stops all rays along the axis"
        raise bad_lens(prescription, what, last)


def _with_real_f_number(prescription: Prescription, stated: float) -> Prescription:
    """Set the f-number to that of the real beam; add a note where it is not what is stated."""
    f_stop, stop = widest_f_number(prescription), stop_index(prescription)
    if not FASTEST_F_STOP <= f_stop < np.inf:
        what = f"its light makes it f/{f_stop:.3g}, which is impossible: expected f/{FASTEST_F_STOP:g} or slower"
        raise bad_lens(prescription, what, stop)
    if stated and abs(f_stop / stated - 1) < _SAME:
        return replace(prescription, f_stop=stated)
    notes = prescription.notes
    if stated and f_stop > stated * (1 + _NOTICED):
        paraxial = paraxial_f_number(prescription, prescription.surfaces[stop].semi_diameter_mm)
        said = f"It is said to be f/{stated:.3g}, but its stop and rims let f/{f_stop:.3g} through"
        notes = (*notes, f"{said} (f/{paraxial:.3g} by the stop's paraxial image).")
    return replace(prescription, f_stop=f_stop, notes=notes)


def _with_back_focus(prescription: Prescription) -> Prescription:
    """Place the film at the paraxial focus of parallel light where the file gives none; add a note where it gives
    another place.
    """
    focal, back, _ = focal_points(paraxial_system(prescription))
    stated, last = prescription.surfaces[-1].thickness_mm, len(prescription.surfaces) - 1
    if stated == 0:
        note = f"The back focal distance of {back:.4g} mm was solved for."
        return _with_surface(prescription, last, note, thickness_mm=back)
    note = f"Parallel light meets {back:.4g} mm behind the last surface, not at the film, which stands {stated:.4g} mm behind it."
    if abs(back - stated) < _NOTICED * focal or note in prescription.notes:
        return prescription
    return replace(prescription, notes=(*prescription.notes, note))


def _with_side_noted(prescription: Prescription) -> Prescription:
    """Add a note where parallel light does not meet on the film from side to side, and no cylinders move to make it."""
    if not prescription.is_anamorphic or prescription.focus_group_across is not None:
        return prescription
    focal, back, _ = focal_points(paraxial_system(turned(prescription)), prescription.name)
    film = prescription.surfaces[-1].thickness_mm
    note = (
        f"From side to side parallel light meets {back:.4g} mm behind the last surface, not at the film: {film:.4g} mm."
    )
    if abs(back - film) < _NOTICED * abs(focal) or note in prescription.notes:
        return prescription
    return replace(prescription, notes=(*prescription.notes, note))
