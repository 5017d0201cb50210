"""Surfaces as they are read, and the prescription that is made of them: what all file formats have in common."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from render.errors import InputError
from render.model.lens import AIR, Glass, Prescription, Surface
from render.optics.dispersion.formulas import index_at
from render.optics.lens_files.configurations import (
    DraftConfigurations,
    configurations_note,
    place_variations,
    to_configurations,
)
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.file_shapes import shape_in_mm
from render.optics.lens_files.lens_text import LensText
from render.optics.lens_files.rims import with_trimmed_rims, without_negative_gaps
from render.optics.prescription.outlines import scaled
from render.optics.prescription.surface_shape import conic_extent_mm

MAX_SURFACES = 200
FAR_AWAY_MM = 1e7  # an object beyond it is at infinity: CODE V writes 1e13
_MAX_LENGTH_MM = 1e5
_INDEX_RANGE, _LEAST_ABBE = (1.0, 5.0), 5.0
_EDGE_OF_CONIC = 0.995
_HIGHEST_PHASE = 20
_VISIBLE_NM = np.linspace(400.0, 700.0, 31)


@dataclass
class Draft:
    """A lens as it is read.

    Attributes:
        text: the file.
        name: of the lens.
        surfaces: front to rear, without object and image.
        unit_mm: the file's unit of length.
        f_stop: wide open; 0 where it is unknown.
        focus_group: the first and the last surface that move to focus.
        film_is_solved: whether the file does not give the distance to the film with the object at infinity.
        configurations: positions of zoom and focus; the surfaces are those of the first.
        notes: approximations and choices, one sentence each.
    """

    text: LensText
    name: str = ""
    surfaces: list[DraftSurface] = field(default_factory=list)
    unit_mm: float = 1.0
    f_stop: float = 0.0
    focus_group: tuple[DraftSurface, DraftSurface] | None = None
    film_is_solved: bool = False
    configurations: DraftConfigurations = field(default_factory=DraftConfigurations)
    notes: list[str] = field(default_factory=list)


def check_glass(text: LensText, glass: Glass, line: int, surface: str) -> Glass:
    """A medium whose numbers are possible; AIR for one of index 1.

    Raises:
        InputError: no medium has such an index or Abbe number.
    """
    low, high = _INDEX_RANGE
    if not low <= glass.index <= high:
        raise text.error(f"the refractive index must be from {low:g} to {high:g}, got {glass.index:g}", line, surface)
    if glass.abbe != 0 and not glass.abbe >= _LEAST_ABBE:
        expected = f"the Abbe number must be 0 (no dispersion) or at least {_LEAST_ABBE:g}"
        raise text.error(f"{expected}, got {glass.abbe:g}", line, surface)
    if glass.dispersion is not None:
        indices = index_at(glass.dispersion, _VISIBLE_NM)
        if not ((indices >= low) & (indices <= high)).all():
            wanted = f"expected one from {low:g} to {high:g} from {_VISIBLE_NM[0]:g} to {_VISIBLE_NM[-1]:g} nm"
            raise text.error(f"glass {glass.name} has an impossible refractive index: {wanted}", line, surface)
    return AIR if glass.index == 1 else glass


def finish(draft: Draft) -> Prescription:
    """Make the prescription, in millimetres.

    Planes of air before the first glass and behind the last are dropped; they are where a designer counts from.

    Raises:
        InputError: no lens is made of such surfaces; the message names the surface.
    """
    text = draft.text
    if len(draft.surfaces) > MAX_SURFACES:
        raise text.error(f"a lens has at most {MAX_SURFACES} surfaces, got {len(draft.surfaces)}")
    stops = [surface for surface in draft.surfaces if surface.is_stop]
    if len(stops) > 1:
        raise text.error(f"surface {stops[0].label} is the stop already", stops[1].line, stops[1].label)
    surfaces, behind = _without_marks(draft.surfaces)
    surfaces, draft.focus_group, notes = without_negative_gaps(
        surfaces, draft.focus_group, draft.configurations, draft.unit_mm
    )
    draft.notes += notes
    variations = place_variations(draft.configurations, draft.surfaces, surfaces, draft.unit_mm)
    surfaces[-1].thickness = 0.0 if draft.film_is_solved else sum(each.thickness for each in [surfaces[-1], *behind])
    if all(surface.glass == AIR for surface in surfaces):
        raise text.error("no surface has glass behind it: expected at least one")
    if surfaces[-1].glass != AIR:
        raise _error(surfaces[-1], draft, "it is the last one, and has glass behind it where the film must be")
    if all(surface.glass.abbe == 0 for surface in surfaces):
        draft.notes.append("The file has no Abbe numbers, so the lens has no chromatic aberration.")
    group = draft.focus_group
    if group is not None and not all(any(each is surface for surface in surfaces) for each in group):
        raise text.error("the group that moves to focus begins or ends with a plane of air outside the glass")
    shaped = tuple(_in_mm(surface, draft) for surface in surfaces)
    lens = Prescription(
        shaped,
        focus_group=None if group is None else (_place(surfaces, group[0]), _place(surfaces, group[1])),
        f_stop=draft.f_stop,
        name=draft.name or text.name.rsplit(".", 1)[0],
        notes=tuple(draft.notes),
    )
    lens = replace(lens, configurations=to_configurations(lens, variations, draft.configurations.count))
    note = configurations_note(lens, variations, draft.configurations)
    return with_trimmed_rims(replace(lens, notes=(*lens.notes, note)) if note else lens)


def is_object_near(draft: Draft, distance: float, surfaces: Sequence[DraftSurface]) -> bool:
    """Whether a file's object is near.

    Args:
        draft: that has the unit.
        distance: from the object to the first surface; infinity where it is far.
        surfaces: all of the lens; a designer's planes of air before the glass add their distances.
    """
    planes = surfaces[: next((i for i, each in enumerate(surfaces) if not _is_mark(each, AIR)), 0)]
    return (distance + sum(plane.thickness for plane in planes)) * draft.unit_mm < FAR_AWAY_MM


def _without_marks(surfaces: Sequence[DraftSurface]) -> tuple[list[DraftSurface], list[DraftSurface]]:
    """The surfaces without planes of air at either end, and the planes behind them."""
    kept = list(surfaces)
    while len(kept) > 1 and _is_mark(kept[0], AIR):
        kept.pop(0)
    behind: list[DraftSurface] = []
    while len(kept) > 1 and _is_mark(kept[-1], kept[-2].glass):
        behind.append(kept.pop())
    return kept, behind


def _place(surfaces: Sequence[DraftSurface], wanted: DraftSurface) -> int:
    """Index of that very surface; two may be equal."""
    return next(index for index, surface in enumerate(surfaces) if surface is wanted)


def _is_mark(surface: DraftSurface, before: Glass) -> bool:
    is_plain = surface.opening is None and surface.obscuration is None
    return surface.is_flat and is_plain and surface.glass == before and not surface.is_stop


def _in_mm(surface: DraftSurface, draft: Draft) -> Surface:
    thickness, semi_diameter = surface.thickness * draft.unit_mm, surface.semi_diameter * draft.unit_mm
    for name, length in (("thickness", thickness), ("semi-diameter", semi_diameter)):
        if abs(length) > _MAX_LENGTH_MM:
            raise _error(surface, draft, f"the {name} must be at most {_MAX_LENGTH_MM:g} mm, got {length:g} mm")
    shape = shape_in_mm(surface, draft.unit_mm, draft.text)
    if shape.note:
        draft.notes.append(shape.note)
    made = Surface(
        shape.radius_mm,
        thickness,
        surface.glass,
        semi_diameter,
        shape.conic,
        shape.aspheric,
        surface.is_stop,
        across=shape.across,
        opening=scaled(surface.opening, draft.unit_mm),
        obscuration=scaled(surface.obscuration, draft.unit_mm),
        odd=shape.odd,
        phase=_phase_in_mm(surface, draft),
    )
    if made.opening is not None and semi_diameter > conic_extent_mm(made):  # corners that no glass can have
        made = replace(made, semi_diameter_mm=_EDGE_OF_CONIC * conic_extent_mm(made))
    return made


def _phase_in_mm(surface: DraftSurface, draft: Draft) -> tuple[float, ...]:
    highest = max((power for power, term in surface.phase.items() if term), default=0)
    if highest > _HIGHEST_PHASE:
        raise _error(surface, draft, f"terms of the phase are supported up to r^{_HIGHEST_PHASE}, got r^{highest}")
    return tuple(surface.phase.get(power, 0.0) / draft.unit_mm**power for power in range(2, highest + 1, 2))


def _error(surface: DraftSurface, draft: Draft, what: str) -> InputError:
    return draft.text.error(what, surface.line, surface.label)
