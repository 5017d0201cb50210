"""Clear diameters and places as files round them: rims that are a little too wide, and planes before their neighbours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from render.model.lens import AIR, Across, Glass, Prescription, Surface
from render.optics.lens_files.configurations import DraftConfigurations, join_gaps
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.prescription.clear_diameters import meeting_mm
from render.optics.prescription.surface_shape import clearance_mm, conic_extent_mm
from render.optics.prescription.validation import solid_neighbours

Group = tuple[DraftSurface, DraftSurface] | None

_ROUNDED = 0.05  # share of a clear diameter that is trimmed without an error
_WITHOUT_NOTE = 1e-6
_BULGE = 0.25  # share of its clear diameter by which a stop may stand before the glass that bulges through it


def with_trimmed_rims(lens: Prescription) -> Prescription:
    """The lens with rims trimmed that reach a little beyond their sphere, or into their neighbour; a note names each.

    Rims that reach farther stay, for `render.optics.prescription.validation` to refuse. Neighbours keep apart at every position
    of zoom and focus.
    """
    lens = _with_trimmed_rims(lens)
    for each in lens.configurations:
        if min(each.thicknesses_mm) >= 0:
            pairs = zip(lens.surfaces, each.thicknesses_mm, strict=True)
            placed = replace(lens, surfaces=tuple(replace(surface, thickness_mm=gap) for surface, gap in pairs))
            trimmed = _with_trimmed_rims(placed)
            widths = [surface.semi_diameter_mm for surface in trimmed.surfaces]
            narrowed = [replace(s, semi_diameter_mm=w) for s, w in zip(lens.surfaces, widths, strict=True)]
            lens = replace(lens, surfaces=tuple(narrowed), notes=trimmed.notes)
    return lens


def _with_trimmed_rims(lens: Prescription) -> Prescription:
    """Trim at the position of the surfaces."""
    with np.errstate(all="ignore"):
        for index, surface in enumerate(lens.surfaces):
            lens = _trimmed(lens, index, conic_extent_mm(surface), "its sphere ends there")
        for i, j in solid_neighbours(lens):
            narrow, other = (i, j) if _width(lens, i) <= _width(lens, j) else (j, i)
            if 0 < _width(lens, narrow) < float("inf"):
                lens = _trimmed(lens, narrow, meeting_mm(lens, i, j), f"it meets surface {other + 1} there")
    return lens


def _width(lens: Prescription, index: int) -> float:
    return lens.surfaces[index].semi_diameter_mm or float("inf")


def _trimmed(lens: Prescription, index: int, limit_mm: float, why: str) -> Prescription:
    surface = lens.surfaces[index]
    width = surface.semi_diameter_mm
    if not width * (1 - _ROUNDED) <= limit_mm < width:
        return lens
    surfaces = (*lens.surfaces[:index], replace(surface, semi_diameter_mm=limit_mm), *lens.surfaces[index + 1 :])
    note = (
        f"The clear diameter of surface {index + 1} was trimmed from {2 * width:.5g} to {2 * limit_mm:.5g} mm: {why}."
    )
    is_noted = limit_mm < width * (1 - _WITHOUT_NOTE)
    return replace(lens, surfaces=surfaces, notes=(*lens.notes, note) if is_noted else lens.notes)


def without_negative_gaps(
    surfaces: Sequence[DraftSurface], group: Group, configurations: DraftConfigurations, unit_mm: float
) -> tuple[list[DraftSurface], Group, list[str]]:
    """The surfaces without planes of air that stand before their neighbours, or that glass bulges through.

    A plane that is not the stop is left out, so that light goes from neighbour to neighbour over the sum of both gaps. A stop
    that glass bulges through is moved to the glass. Other negative gaps stay, for `render.optics.prescription.validation` to
    refuse.

    Args:
        surfaces: front to rear; their thicknesses change.
        group: first and last surface that move to focus.
        configurations: of the lens; gaps that are joined are joined in each.
        unit_mm: the file's unit of length.

    Returns:
        The surfaces, the group without what was left out, and a note for each change.
    """
    kept: list[DraftSurface] = []
    notes: list[str] = []
    before: Glass = AIR
    for place, surface in enumerate(surfaces):
        gap_before = kept[-1].thickness if kept else 0.0
        is_window = surface.is_flat and surface.glass == before == AIR
        is_between = is_window and len(kept) > 0 and place < len(surfaces) - 1
        is_before = gap_before < 0 or surface.thickness < 0
        if not (is_between and (is_before or _is_cut(kept[-1], surface, surfaces[place + 1]))):
            before = surface.glass
            kept.append(surface)
            continue
        whole = gap_before + surface.thickness
        if whole < 0:
            kept.append(surface)
        elif not surface.is_stop:
            join_gaps(configurations, kept[-1], surface)
            kept[-1].thickness = whole
            group = _without(group, surface, kept[-1], surfaces[place + 1])
            where = (
                "is cut by the glass beside it"
                if not is_before
                else f"stands {-min(gap_before, surface.thickness) * unit_mm:.4g} mm before its neighbour"
            )
            notes.append(f"Surface {surface.label}, a plane of air, {where}; it is left out.")
        else:
            if not (configurations.varies(kept[-1]) or configurations.varies(surface)):
                notes += _move_to_glass(kept[-1], surface, whole, unit_mm)
            kept.append(surface)
    return kept, group, notes


def _is_cut(front: DraftSurface, plane: DraftSurface, behind: DraftSurface) -> bool:
    """Whether glass beside a plane that is not the stop reaches through it, by more than rounding."""
    if plane.is_stop:
        return False
    one, other, third = (_shape(each) for each in (front, plane, behind))
    with np.errstate(all="ignore"):
        return clearance_mm(one, other, front.thickness) < 0 or clearance_mm(other, third, plane.thickness) < 0


def _shape(surface: DraftSurface) -> Surface:
    """The surface in the file's unit, a little narrower than it is."""
    highest = max(surface.terms, default=2)
    even, odd = (tuple(surface.terms.get(power, 0.0) for power in range(i, highest + 1, 2)) for i in (4, 3))
    width = (1 - _ROUNDED) * surface.semi_diameter
    across = surface.across and Across(*surface.across, surface.torus)
    return Surface(
        surface.radius, 0.0, semi_diameter_mm=width, conic=surface.conic, aspheric=even, across=across, odd=odd
    )


def _without(group: Group, dropped: DraftSurface, front: DraftSurface, behind: DraftSurface) -> Group:
    """A group without a plane at one of its ends."""
    if group is None or group[0] is group[1]:
        return group
    first, last = group
    return behind if first is dropped else first, front if last is dropped else last


def _move_to_glass(front: DraftSurface, stop: DraftSurface, whole: float, unit_mm: float) -> list[str]:
    """Move a stop that stands before the vertex of a neighbour to that vertex, where the distance is small; a note on it."""
    shift = -min(front.thickness, stop.thickness)
    if stop.semi_diameter and shift > 2 * _BULGE * stop.semi_diameter:
        return []
    front.thickness, stop.thickness = (0.0, whole) if front.thickness < 0 else (whole, 0.0)
    return [f"Glass bulges {shift * unit_mm:.4g} mm through the stop, surface {stop.label}; it is moved to the glass."]
