"""Numbers of a lens at its setting: its data-sheet values, and those that follow from its surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import SettingsError
from render.model.lens import Prescription, SeidelErrors
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focus_mechanism import FocusMechanism
from render.optics.prescription.focus_path import FocusPath, MovingGroup
from render.optics.prescription.focusing import FocusedLens, focus_across
from render.optics.prescription.seidel_sums import seidel_sums

_BISECTIONS = 30
_FARTHEST_LOOKED_AT_M, _NEAREST_LOOKED_AT_M = 1e4, 1e-3


@dataclass(frozen=True)
class Barrel:
    """Positions and sizes inside the barrel at the lens's setting. Lengths are mm.

    Attributes:
        length: from the front vertex to the rear one.
        back_focus: from the rear vertex to the focal point.
        film: from the rear vertex to the film: as focused.
        front_principal: behind the front vertex.
        rear_principal: behind the rear vertex: negative inside the lens.
        entrance_pupil: behind the front vertex.
        entrance_pupil_diameter: at the f-number.
        exit_pupil: before the film; infinite for a telecentric lens.
        exit_pupil_diameter: at the f-number.
        stop_diameter: at the f-number.
        petzval_radius: of the surface that the image would lie on without astigmatism; infinite where it is flat.
        surfaces: number of surfaces.
        focus_group: first and last index of the surfaces that move to focus; None where the whole lens does, or several groups.
        floating_groups: groups that move each in its own way to focus, with their travels; none where one moves.
        focus_group_across: of those that move to focus from side to side too; None where none does.
    """

    length: float
    back_focus: float
    film: float
    front_principal: float
    rear_principal: float
    entrance_pupil: float
    entrance_pupil_diameter: float
    exit_pupil: float
    exit_pupil_diameter: float
    stop_diameter: float
    petzval_radius: float
    surfaces: int
    focus_group: tuple[int, int] | None
    focus_group_across: tuple[int, int] | None
    floating_groups: tuple[MovingGroup, ...] = ()


@dataclass(frozen=True)
class ThirdOrder:
    """Third-order errors as wavefront coefficients, in wavelengths of the d line, at the f-number and the gate's corner.

    Attributes:
        w040: spherical aberration.
        w131: coma.
        w222: astigmatism.
        w220: field curvature, measured from the sagittal focus.
        w311: distortion.
        axial_colour: of the lines F and C.
        lateral_colour: lateral colour.
    """

    w040: float
    w131: float
    w222: float
    w220: float
    w311: float
    axial_colour: float | None = None
    lateral_colour: float | None = None


def barrel(lens: FocusedLens) -> Barrel:
    """Places and sizes of a focused lens."""
    path = FocusPath.from_prescription(lens.prescription)
    first, front, rear = lens.first, float(lens.vertices_mm[0]), float(lens.vertices_mm[-1])
    return Barrel(
        length=first.length_mm,
        back_focus=first.back_focal_mm,
        film=lens.film_mm - rear,
        front_principal=first.front_principal_mm,
        rear_principal=first.rear_principal_mm - first.length_mm,
        entrance_pupil=lens.entrance_pupil_mm - front,
        entrance_pupil_diameter=2 * lens.entrance_pupil_radius_mm,
        exit_pupil=lens.film_mm - lens.exit_pupil_mm,
        exit_pupil_diameter=2 * lens.exit_pupil_radius_mm,
        stop_diameter=2 * lens.stop_radius_mm,
        petzval_radius=-1 / first.petzval_sum if first.petzval_sum else float("inf"),
        surfaces=sum(not surface.is_stop or surface.radius_mm != 0 for surface in lens.prescription.surfaces),
        focus_group=lens.prescription.focus_group if path is None else None,
        floating_groups=() if path is None else path.groups(),
        focus_group_across=lens.prescription.focus_group_across,
    )


def third_order_of_glass(prescription: Prescription, f_stop: float, corner_mm: float) -> ThirdOrder:
    """From the Seidel sums: W040 = S_I/8, W131 = S_II/2, W222 = S_III/2, W220 = (S_III + S_IV)/4, W311 = S_V/2 (Welford 1986)."""
    sums = seidel_sums(prescription, f_stop, corner_mm)
    total = {name: float(values.sum()) / (D_LINE_NM * 1e-6) for name, values in vars(sums).items()}
    return ThirdOrder(
        total["spherical"] / 8,
        total["coma"] / 2,
        total["astigmatism"] / 2,
        (total["astigmatism"] + total["petzval"]) / 4,
        total["distortion"] / 2,
        total["axial_colour"] / 2,
        total["lateral_colour"],
    )


def third_order_of_errors(errors: SeidelErrors, f_stop: float, corner_mm: float) -> ThirdOrder:
    """Coefficients at another aperture and image height than those that they are given for."""
    rho, eta = errors.reference_f_stop / f_stop, corner_mm / errors.reference_height_mm
    return ThirdOrder(
        errors.w040 * rho**4,
        errors.w131 * rho**3 * eta,
        errors.w222 * rho**2 * eta**2,
        errors.w220 * rho**2 * eta**2,
        errors.w311 * rho * eta**3,
    )


def nearest_m(lens: FocusedLens, focus_distance_m: float) -> float:
    """The nearest distance from the entrance pupil that the lens or its focusing group reaches; infinite for a fixed focus.

    Args:
        lens: as focused.
        focus_distance_m: at which it is; infinity or 0 for infinity.
    """
    mechanism = FocusMechanism.from_prescription(lens.prescription)

    def reaches(nearness_per_m: float) -> bool:
        nearness = nearness_per_m / 1000
        try:
            moved_mm = mechanism.shifted_vertices(mechanism.paraxial_shift(nearness))
            if lens.prescription.focus_group_across is not None:
                focus_across(mechanism, moved_mm, nearness, lens.stop_radius_mm, by="paraxial")
        except SettingsError:
            return False
        return True

    reached_m = focus_distance_m or float("inf")
    far, near = 1 / min(reached_m, _FARTHEST_LOOKED_AT_M), 1 / _NEAREST_LOOKED_AT_M
    if not reaches(far):
        return reached_m
    for _ in range(_BISECTIONS):
        middle = float(np.sqrt(far * near))
        far, near = (middle, near) if reaches(middle) else (far, middle)
    return 1 / far
