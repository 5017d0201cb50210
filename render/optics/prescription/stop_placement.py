"""Placement of the aperture stop of a lens whose file does not give it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Configuration, Prescription, Surface
from render.optics.prescription.paraxial import ParaxialSystem, paraxial_ray, paraxial_system, transfer
from render.optics.prescription.seidel_sums import fourth_power_terms, third_order

_SHARES = np.linspace(0.05, 0.95, 37)  # of an air gap: an iris has some thickness


def with_stop(prescription: Prescription) -> Prescription:
    """Prescription with an aperture stop, which is added where it has none.

    Designers bend surfaces about the stop: the gap is the one from whose best place the chief ray meets all surfaces most nearly
    at right angles (least sum of squares of its refraction invariants n·i). They balance coma about it: in the gap, the stop
    stands where third-order coma is least (Welford 1986, ch. 8: it changes linearly as the stop moves). Of the six published
    lenses that the tests measure by, this finds the gap of each, and the place in it within a fifth of its width. A lens without
    air gaps has its stop at its front rim.
    """
    surfaces = prescription.surfaces
    if any(surface.is_stop for surface in surfaces):
        return prescription
    gaps = [i for i, s in enumerate(surfaces[:-1]) if s.thickness_mm > 0 and s.glass.index == 1]
    if not gaps:
        note = "No surface was the aperture stop: the front rim is, as the lens has no air gap."
        marked = (replace(surfaces[0], is_stop=True), *surfaces[1:])
        return replace(prescription, surfaces=marked, notes=(*prescription.notes, note))
    system = paraxial_system(prescription)
    tried = np.array([_trial_stops(prescription, system, gap) for gap in gaps])
    gap = int(np.argmin(tried[:, 0].min(axis=1)))
    return _with_stop_in(prescription, gaps[gap], float(_SHARES[np.argmin(tried[gap, 1])]))


def _trial_stops(prescription: Prescription, system: ParaxialSystem, gap: int) -> DoubleArray:
    """``(2, n)`` squared incidences of the chief ray, and size of the third-order coma, with the stop at shares of an air gap."""
    departures, no_dispersion = fourth_power_terms(prescription.surfaces), np.zeros(len(system.indices))
    marginal = paraxial_ray(system, 0.0, 1.0, 0.0)
    tried = np.full((2, len(_SHARES)), np.inf)
    for i, share in enumerate(_SHARES):
        z_mm = float(system.vertices_mm[gap]) + share * prescription.surfaces[gap].thickness_mm
        (a, b), _ = transfer(system, 0, gap + 1, to_mm=z_mm)
        if abs(a) < 1e-9:  # the stop's image is infinitely far off
            continue
        chief = paraxial_ray(system, 0.0, -b / a, 1.0)
        incidences = system.indices[:-1] * (chief.slopes[:-1] + chief.heights_mm * system.curvatures)
        coma = third_order(system, marginal, chief, departures, no_dispersion).coma.sum()
        tried[:, i] = np.sum(incidences**2), abs(coma)
    return tried


def _with_stop_in(prescription: Prescription, gap: int, share: float) -> Prescription:
    """Insert a flat stop in the air gap behind a surface; later indices and a focus group are shifted."""
    before = prescription.surfaces[gap]
    near, far = share * before.thickness_mm, (1 - share) * before.thickness_mm
    surfaces = list(prescription.surfaces)
    surfaces[gap : gap + 1] = [replace(before, thickness_mm=near), Surface(0.0, far, is_stop=True)]
    group = prescription.focus_group
    if group is not None:
        group = (group[0] + (group[0] > gap), group[1] + (group[1] > gap))
    note = (
        f"No surface was the aperture stop: one was put {near:.4g} mm behind surface {gap + 1}, where third-order coma is least; "
        f"it is surface {gap + 2} now."
    )
    return replace(
        prescription,
        surfaces=tuple(surfaces),
        focus_group=group,
        configurations=tuple(_with_gap_split(each, gap, share) for each in prescription.configurations),
        notes=(*prescription.notes, note),
    )


def _with_gap_split(configuration: Configuration, gap: int, share: float) -> Configuration:
    """Configuration with a stop at that share of a gap."""
    lengths = configuration.thicknesses_mm
    parts = share * lengths[gap], (1 - share) * lengths[gap]
    return replace(configuration, thicknesses_mm=(*lengths[:gap], *parts, *lengths[gap + 1 :]))
