"""A lens set to a focus distance and an f-number: the whole of it, or the group that its file names, moves until it is sharp.

Distances are measured from the centre of the entrance pupil, which moves along; the film stands still.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from render.disk_cache import ArrayCache
from render.errors import InputError, SettingsError
from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.prescription.focus_mechanism import FocusMechanism
from render.optics.prescription.paraxial import FirstOrder, first_order, stop_index

FocusCriterion = Literal["spot", "paraxial"]
_cache = ArrayCache("spot-focus", ("model", "optics"))


@dataclass(frozen=True, eq=False)
class FocusedLens:
    """A lens set to a focus distance and an f-number.

    Attributes:
        prescription: with the thicknesses as focused; the last one reaches to the film.
        vertices_mm: ``(n,)`` z of each surface; 0 is the front vertex of the lens focused at infinity.
        film_mm: z of the film.
        stop: index of the aperture stop.
        stop_radius_mm: of the iris at the f-number.
        entrance_pupil_mm: z.
        entrance_pupil_radius_mm: at the f-number.
        exit_pupil_mm: z; infinite for a telecentric lens.
        exit_pupil_radius_mm: at the f-number.
        f_stop: as reached: no less than wide open.
        image_scale_mm: paraxial height on the film per unit of slope in object space, through the entrance pupil's centre; at
            infinity the focal length.
        first: first-order properties of the lens as focused.
    """

    prescription: Prescription
    vertices_mm: DoubleArray
    film_mm: float
    stop: int
    stop_radius_mm: float
    entrance_pupil_mm: float
    entrance_pupil_radius_mm: float
    exit_pupil_mm: float
    exit_pupil_radius_mm: float
    f_stop: float
    image_scale_mm: float
    first: FirstOrder


def focus_lens(
    prescription: Prescription, focus_distance_m: float, f_stop: float, *, by: FocusCriterion = "spot"
) -> FocusedLens:
    """Set a lens to a focus distance and an f-number.

    Args:
        prescription: complete (`render.optics.prescription.completion.complete_prescription`).
        focus_distance_m: from the centre of the entrance pupil; infinity (or 0, as USD has it) focuses at infinity.
        f_stop: requested f-number; a lens that does not open so far is wide open.
        by: what is sharpest: ``spot`` where the rays at the d line, on the axis and at that f-number, have the least
            root-mean-square distance from their centre on the film; ``paraxial`` where those close to the axis meet.

    Raises:
        SettingsError: the distance or f-number is no positive number, or the lens does not reach so near.
        InputError: the prescription is not complete.
    """
    if not (f_stop > 0 and np.isfinite(f_stop)):
        raise SettingsError(f"the f-number of a lens must be a positive number, got {f_stop}")
    if np.isnan(focus_distance_m) or focus_distance_m < 0:
        raise SettingsError(f"focus distance must be 0 (infinity) or more, got {focus_distance_m} m")
    _check_complete(prescription)
    nearness = 1 / (1000 * focus_distance_m) if focus_distance_m > 0 else 0.0
    stop_radius_mm = _stop_radius_mm(prescription, f_stop)
    mechanism = FocusMechanism.from_prescription(prescription)
    shift_mm = mechanism.paraxial_shift(nearness)
    if by == "spot":
        shift_mm = _spot_shift_mm(mechanism, nearness, shift_mm, stop_radius_mm)
    return _assemble(prescription, mechanism, shift_mm, stop_radius_mm)


def _spot_shift_mm(mechanism: FocusMechanism, nearness: float, shift_mm: float, stop_radius_mm: float) -> float:
    """Load or compute `FocusMechanism.spot_shift`."""
    kept = _cache.get(
        lambda: {"shift_mm": np.asarray(mechanism.spot_shift(nearness, shift_mm, stop_radius_mm))},
        mechanism.prescription,
        nearness,
        shift_mm,
        stop_radius_mm,
    )
    return float(kept["shift_mm"])


def _check_complete(prescription: Prescription) -> None:
    """Raise `InputError` for a prescription that `render.optics.prescription.completion.complete_prescription` has not seen."""
    missing = [i + 1 for i, surface in enumerate(prescription.surfaces) if surface.semi_diameter_mm <= 0]
    if missing or not prescription.surfaces or prescription.surfaces[-1].thickness_mm <= 0:
        what = f"the clear diameter of surface {missing[0]}" if missing else "the back focal distance"
        raise InputError(f"{prescription.name or 'the lens'} is not complete: {what} is missing", code="bad_lens")


def _stop_radius_mm(prescription: Prescription, f_stop: float) -> float:
    """Radius of the stop; the f-number refers to the lens focused at infinity."""
    first = first_order(prescription)
    wide_open = prescription.surfaces[stop_index(prescription)].semi_diameter_mm
    return min(wide_open, first.focal_length_mm / (2 * f_stop * abs(first.entrance_pupil_magnification)))


def _assemble(
    prescription: Prescription, mechanism: FocusMechanism, shift_mm: float, stop_radius_mm: float
) -> FocusedLens:
    """The lens with what focuses it moved by ``shift_mm``."""
    moved = mechanism.shifted_vertices(shift_mm)
    gaps = np.diff([*moved, mechanism.film_mm])
    surfaces = tuple(
        replace(surface, thickness_mm=float(gap)) for surface, gap in zip(prescription.surfaces, gaps, strict=True)
    )
    as_focused, at_infinity = replace(prescription, surfaces=surfaces), first_order(prescription)
    first, front_mm = first_order(as_focused), float(moved[0])
    wide_open_mm = 2 * stop_radius_mm * abs(at_infinity.entrance_pupil_magnification)
    return FocusedLens(
        prescription=as_focused,
        vertices_mm=moved,
        film_mm=mechanism.film_mm,
        stop=mechanism.stop,
        stop_radius_mm=stop_radius_mm,
        entrance_pupil_mm=front_mm + first.entrance_pupil_mm,
        entrance_pupil_radius_mm=stop_radius_mm * abs(first.entrance_pupil_magnification),
        exit_pupil_mm=front_mm + first.exit_pupil_mm,
        exit_pupil_radius_mm=stop_radius_mm * abs(first.exit_pupil_magnification),
        f_stop=at_infinity.focal_length_mm / wide_open_mm,
        image_scale_mm=mechanism.film_through_lens(shift_mm).scale_mm,
        first=first,
    )
