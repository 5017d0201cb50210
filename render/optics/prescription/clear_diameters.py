"""Clear diameters of a lens whose file leaves them out: as wide as its light needs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.prescription.beams import axial_beam, oblique_beam
from render.optics.prescription.meridians import turned
from render.optics.prescription.paraxial import focal_points, paraxial_system
from render.optics.prescription.surface_shape import clearance_mm, conic_extent_mm
from render.optics.prescription.validation import bad_lens, solid_neighbours

# At the field's corner a photographic lens passes about half of its wide-open pupil: one stop of vignetting. Two rims, one before
# and one behind the stop, that each cut the beam at this share of the pupil's radius leave the area that two unit circles
# have in common whose centres are 2·(1 − share) apart: 55 % of one.
_CORNER_PUPIL = 0.64
_CORNER_RAYS = 9
_MARGIN = 1.01  # so that on the axis the stop limits the light, and not a rim
_EDGE_OF_CONIC = 0.995


def with_clear_diameters(prescription: Prescription, image_height_mm: float) -> Prescription:
    """The prescription with the clear diameters that are missing.

    A surface becomes as wide as the whole beam on the axis and the vignetted beam at the field's corner need (as lens-design
    programs set apertures from vignetting factors), but no wider than its conic reaches or than where it meets its neighbour.

    Args:
        prescription: with a stop of known diameter and a back focal distance.
        image_height_mm: of the field's corner.

    Raises:
        InputError: two neighbours meet inside the beam on the axis.
    """
    surfaces = prescription.surfaces
    missing = [i for i, surface in enumerate(surfaces) if surface.semi_diameter_mm == 0]
    if not missing:
        return prescription
    axial, needed, reached_mm = _needed(prescription, image_height_mm)
    if prescription.is_anamorphic:
        sideways = turned(prescription)
        squeeze = _focal_mm(prescription) / _focal_mm(sideways)
        axial_across, needed_across, _ = _needed(sideways, image_height_mm / abs(squeeze))
        axial, needed = np.fmax(axial, axial_across), np.fmax(needed, needed_across)
    widths = {i: min(float(needed[i]), _EDGE_OF_CONIC * conic_extent_mm(surfaces[i])) for i in missing}
    widened = _with_widths(prescription, widths)
    notes = [*prescription.notes, _note(widths, len(surfaces), reached_mm)]
    if reached_mm < 0.99 * image_height_mm:
        notes.append(
            f"Its light reaches {reached_mm:.4g} mm from the axis, not the {image_height_mm:.4g} mm of the field."
        )
    return replace(_trim(widened, widths, axial), notes=tuple(notes))


def _needed(prescription: Prescription, image_height_mm: float) -> tuple[DoubleArray, DoubleArray, float]:
    """Half widths in the y-z plane of the beam on the axis, and of all that is to get through; and the image height of that."""
    radius = next(surface.semi_diameter_mm for surface in prescription.surfaces if surface.is_stop)
    axial = np.abs(axial_beam(prescription, -np.inf, np.ones(1), radius, clip=False).points_mm[:, 0, 1])
    heights = np.linspace(-_CORNER_PUPIL, _CORNER_PUPIL, _CORNER_RAYS) * radius
    beam = oblique_beam(prescription, image_height_mm, heights)
    needed = np.fmax(axial, np.fmax.reduce(np.abs(beam.heights_mm), axis=1)) * _MARGIN
    return axial, needed, beam.image_height_mm


def _focal_mm(prescription: Prescription) -> float:
    return focal_points(paraxial_system(prescription), prescription.name)[0]


def _with_widths(prescription: Prescription, widths: dict[int, float]) -> Prescription:
    surfaces = [
        replace(s, semi_diameter_mm=widths.get(i, s.semi_diameter_mm)) for i, s in enumerate(prescription.surfaces)
    ]
    return replace(prescription, surfaces=tuple(surfaces))


def _trim(prescription: Prescription, widths: dict[int, float], axial_mm: DoubleArray) -> Prescription:
    """Limit neighbours to the radius at which they meet."""
    trimmed = dict(widths)
    for i, j in solid_neighbours(prescription):
        meeting = meeting_mm(prescription, i, j)
        for k in (i, j):
            if k not in trimmed or meeting >= trimmed[k]:
                continue
            if meeting < axial_mm[k]:
                what = (
                    f"it meets surface {j + 1} {meeting:.4g} mm from the axis, inside the beam of {axial_mm[k]:.4g} mm"
                )
                raise bad_lens(prescription, f"{what} that f/{prescription.f_stop:.3g} needs", i)
            trimmed[k] = meeting
    return _with_widths(prescription, trimmed)


def meeting_mm(prescription: Prescription, i: int, j: int) -> float:
    """Distance from the axis to which two neighbours keep apart; infinite where they do so over their whole width."""
    front, behind = prescription.surfaces[i], prescription.surfaces[j]
    thickness = sum(surface.thickness_mm for surface in prescription.surfaces[i:j])
    low, high = 0.0, min(front.semi_diameter_mm, behind.semi_diameter_mm)
    if clearance_mm(front, behind, thickness) >= 0:
        return float("inf")
    for _ in range(50):
        middle = (low + high) / 2
        narrow = replace(front, semi_diameter_mm=middle)
        low, high = (middle, high) if clearance_mm(narrow, behind, thickness) >= 0 else (low, middle)
    return low


def _note(widths: dict[int, float], count: int, image_height_mm: float) -> str:
    which = "all surfaces" if len(widths) >= count - 1 else "surfaces " + ", ".join(str(i + 1) for i in sorted(widths))
    return (
        f"The clear diameters of {which} were solved for: the whole beam on the axis and about 55 % of it "
        f"{image_height_mm:.4g} mm off the axis get through."
    )
