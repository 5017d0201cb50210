"""A lens set to a focus distance and an f-number: the whole of it, or the group that its file names, moves until it is sharp.

Distances are measured from the centre of the entrance pupil, which moves along; the film stands still.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from render.disk_cache import ArrayCache
from render.errors import InputError, SettingsError
from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.prescription.beams import axial_edge
from render.optics.prescription.f_numbers import (
    iris_radius_mm,
    paraxial_f_number,
    widest_f_number,
    working_f_number,
)
from render.optics.prescription.focus_mechanism import FocusMechanism
from render.optics.prescription.focusing_across import FocusAcross
from render.optics.prescription.meridians import turned
from render.optics.prescription.paraxial import FirstOrder, first_order

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
        nearness_per_mm: 1 over the focus distance; 0 is infinity.
        entrance_pupil_mm: z.
        exit_pupil_mm: z; infinite for a telecentric lens.
        exit_pupil_radius_mm: of the image of the iris by rays close to the axis.
        f_stop: as reached, of the real beam from infinity: no less than wide open.
        paraxial_f_stop: by the paraxial pupil in place of the real beam.
        image_scale_mm: paraxial height on the film per unit of slope in object space, through the entrance pupil's centre; at
            infinity the focal length.
        image_scale_across_mm: the same from side to side, for what is in focus as seen from that same pupil's centre.
        first: first-order properties of the lens as focused.
    """

    prescription: Prescription
    vertices_mm: DoubleArray
    film_mm: float
    stop: int
    stop_radius_mm: float
    nearness_per_mm: float
    entrance_pupil_mm: float
    exit_pupil_mm: float
    exit_pupil_radius_mm: float
    f_stop: float
    paraxial_f_stop: float
    image_scale_mm: float
    image_scale_across_mm: float
    first: FirstOrder

    @property
    def object_mm(self) -> float:
        """z of what is in focus on the axis; minus infinity is infinity."""
        return self.entrance_pupil_mm - 1 / self.nearness_per_mm if self.nearness_per_mm else -np.inf

    @property
    def squeeze(self) -> float:
        """Squeeze of the picture in the plane of focus, to first order; 1 for a lens without cylinders."""
        return self.image_scale_mm / self.image_scale_across_mm

    @property
    def pupil_magnification(self) -> float:
        """Diameter of the exit pupil over the entrance pupil's, to first order."""
        return abs(self.first.exit_pupil_magnification / self.first.entrance_pupil_magnification)

    @cached_property
    def entrance_pupil_radius_mm(self) -> float:
        """Radius, in the plane of the entrance pupil, of the real beam from what is in focus on the axis.

        Raises:
            InputError: no ray but the axis itself gets to the iris.
        """
        return axial_edge(self.prescription, self.object_mm, self.stop_radius_mm, self.vertices_mm).height_mm

    @cached_property
    def working_f_stop(self) -> float:
        """F-number as focused: ``1 / (2·sin u′)`` of the real marginal ray (`f_numbers.working_f_number`).

        Raises:
            InputError: no ray but the axis itself gets to the iris.
        """
        return working_f_number(self.prescription, self.object_mm, self.stop_radius_mm, self.vertices_mm)


def focus_lens(
    prescription: Prescription, focus_distance_m: float, f_stop: float, *, by: FocusCriterion = "spot"
) -> FocusedLens:
    """Set a lens to a focus distance and an f-number.

    Args:
        prescription: complete (`render.optics.prescription.completion.complete_prescription`).
        focus_distance_m: from the centre of the entrance pupil; infinity (or 0, as USD has it) focuses at infinity.
        f_stop: requested f-number, of the real beam from infinity (`render.optics.prescription.f_numbers`); a lens that does
            not open so far is wide open.
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
    mechanism = FocusMechanism.from_prescription(prescription)
    wide_open_mm = prescription.surfaces[mechanism.stop].semi_diameter_mm
    radius_mm = min(wide_open_mm, iris_radius_mm(prescription, f_stop))
    shift_mm = mechanism.paraxial_shift(nearness)
    if by == "spot":
        shift_mm = _spot_shift_mm(mechanism, nearness, shift_mm, radius_mm)
    moved_mm = mechanism.shifted_vertices(shift_mm)
    if prescription.focus_group_across is not None:
        moved_mm = focus_across(mechanism, moved_mm, nearness, radius_mm, by)
    f_number = max(f_stop, widest_f_number(prescription))
    return _assemble(mechanism, nearness, shift_mm, moved_mm, radius_mm, f_number)


def focus_across(
    mechanism: FocusMechanism, moved_mm: DoubleArray, nearness: float, radius_mm: float, by: FocusCriterion
) -> DoubleArray:
    """Move the cylinders that focus from side to side.

    Args:
        mechanism: of a lens that has such cylinders.
        moved_mm: ``(n,)`` its vertices as it is focused from top to bottom.
        nearness: 1 over the focus distance, 1/mm; 0 is infinity.
        radius_mm: of the iris.
        by: as for `focus_lens`.

    Returns:
        The vertices with the cylinders moved too.

    Raises:
        SettingsError: they do not move so far.
    """
    focused = _with_gaps(mechanism, moved_mm)
    front_mm = float(moved_mm[0])
    pupil_mm = first_order(focused).entrance_pupil_mm  # from top to bottom, where the cylinders leave it
    across = FocusAcross.of_lens(focused, pupil_mm - 1 / nearness if nearness else -np.inf)
    shift_mm = across.paraxial_shift()
    if by == "spot":
        kept = _cache.get(
            lambda: {"shift_mm": np.asarray(across.spot_shift(shift_mm, radius_mm))},
            focused,
            across.object_mm,
            shift_mm,
            radius_mm,
        )
        shift_mm = float(kept["shift_mm"])
    return front_mm + across.vertices_mm(shift_mm)


def _with_gaps(mechanism: FocusMechanism, moved_mm: DoubleArray) -> Prescription:
    """The prescription with the distances between moved vertices, the last one to the film."""
    gaps = np.diff([*moved_mm, mechanism.film_mm])
    surfaces = tuple(
        replace(surface, thickness_mm=float(gap))
        for surface, gap in zip(mechanism.prescription.surfaces, gaps, strict=True)
    )
    return replace(mechanism.prescription, surfaces=surfaces)


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


def _assemble(
    mechanism: FocusMechanism,
    nearness: float,
    shift_mm: float,
    moved: DoubleArray,
    stop_radius_mm: float,
    f_stop: float,
) -> FocusedLens:
    """The lens with what focuses it moved by ``shift_mm``, and its vertices at ``moved``."""
    prescription, as_focused = mechanism.prescription, _with_gaps(mechanism, moved)
    first, front_mm = first_order(as_focused), float(moved[0])
    scale_mm = mechanism.film_through_lens(shift_mm).scale_mm
    entrance_mm = front_mm + first.entrance_pupil_mm
    object_mm = entrance_mm - 1 / nearness if nearness else -np.inf
    return FocusedLens(
        prescription=as_focused,
        vertices_mm=moved,
        film_mm=mechanism.film_mm,
        stop=mechanism.stop,
        stop_radius_mm=stop_radius_mm,
        nearness_per_mm=nearness,
        entrance_pupil_mm=entrance_mm,
        exit_pupil_mm=front_mm + first.exit_pupil_mm,
        exit_pupil_radius_mm=stop_radius_mm * abs(first.exit_pupil_magnification),
        f_stop=f_stop,
        paraxial_f_stop=paraxial_f_number(prescription, stop_radius_mm),
        image_scale_mm=scale_mm,
        image_scale_across_mm=(
            _scale_across_mm(as_focused, front_mm, object_mm, entrance_mm) if prescription.is_anamorphic else scale_mm
        ),
        first=first,
    )


def _scale_across_mm(focused: Prescription, front_mm: float, object_mm: float, entrance_mm: float) -> float:
    """Image scale from side to side of what stands at ``object_mm``, per unit of slope from ``entrance_mm``."""
    sideways = FocusMechanism.from_prescription(turned(focused)).film_through_lens(0.0)
    if not np.isfinite(object_mm):
        return sideways.scale_mm
    own_pupil_mm = front_mm + sideways.pupil_depth_mm
    return sideways.scale_mm * (entrance_mm - object_mm) / (own_pupil_mm - object_mm)
