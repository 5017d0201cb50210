"""Configurations of a lens file: positions of zoom and focus, as quantities that have a value at each.

Zemax calls them configurations, CODE V zoom positions, Optical Bench variable distances. A prescription is that of the first.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from render.errors import InputError
from render.model.lens import Configuration, Prescription
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.prescription.paraxial import focal_points, paraxial_system

Quantity = Literal[
    # of a surface
    "thickness",
    "radius",
    "semi_diameter",
    "conic",
    # of the whole lens
    "object_distance",
    "f_number",
    "pupil_diameter",
    "focal_length",
    "magnification",
]
"""Names a quantity: a focal length, an f-number and a magnification are as the file states them; an object's distance is before
the first surface of the file, infinity where the object is far."""

_OF_FIRST = ("radius", "semi_diameter", "conic")
_LENGTHS = ("thickness", "radius", "semi_diameter", "object_distance", "pupil_diameter", "focal_length")


@dataclass(frozen=True)
class DraftVariation:
    """A quantity over the configurations, as it is read.

    Attributes:
        surface: that it belongs to; None for one of the whole lens.
        quantity: which.
        values: one for each configuration, in the file's unit; None where the file does not say.
    """

    surface: DraftSurface | None
    quantity: Quantity
    values: tuple[float | None, ...]


@dataclass
class DraftConfigurations:
    """Configurations of a lens as it is read.

    Attributes:
        count: number of configurations.
        kind: what the file calls them, in the plural.
        names: of the configurations; empty where the file gives none.
        variations: what differs between them.
    """

    count: int = 1
    kind: str = "configurations"
    names: tuple[str, ...] = ()
    variations: list[DraftVariation] = field(default_factory=list)

    def varies(self, surface: DraftSurface) -> bool:
        """Whether the thickness behind a surface differs between configurations."""
        return any(_is_gap(each, surface) for each in self.variations)

    def thicknesses(self, surface: DraftSurface) -> tuple[float | None, ...]:
        """Thickness behind a surface at each configuration; None where the file does not say."""
        constant: tuple[float | None, ...] = (surface.thickness,) * self.count
        return next((each.values for each in self.variations if _is_gap(each, surface)), constant)

    def set_thicknesses(self, surface: DraftSurface, values: tuple[float | None, ...]) -> None:
        """Replace the thickness behind a surface at each configuration."""
        self.variations[:] = [each for each in self.variations if not _is_gap(each, surface)]
        self.variations.append(DraftVariation(surface, "thickness", values))


def _is_gap(variation: DraftVariation, surface: DraftSurface) -> bool:
    return variation.surface is surface and variation.quantity == "thickness"


def join_gaps(configurations: DraftConfigurations, front: DraftSurface, dropped: DraftSurface) -> None:
    """Let the gap behind a surface take in that behind the next one, which is left out, at each configuration."""
    if configurations.varies(front) or configurations.varies(dropped):
        gaps = configurations.thicknesses(front), configurations.thicknesses(dropped)
        configurations.set_thicknesses(front, tuple(map(_sum, zip(*gaps, strict=True))))


@dataclass(frozen=True)
class Variation:
    """A quantity over the configurations of a prescription.

    Attributes:
        surface: index in the prescription; None for a quantity of the whole lens.
        quantity: which.
        values: one for each configuration, lengths in millimetres; None where the file does not say.
    """

    surface: int | None
    quantity: Quantity
    values: tuple[float | None, ...]


def place_variations(
    configurations: DraftConfigurations, surfaces: Sequence[DraftSurface], kept: Sequence[DraftSurface], unit_mm: float
) -> tuple[Variation, ...]:
    """Variations of a prescription.

    Args:
        configurations: as read.
        surfaces: all of the draft, front to rear.
        kept: those of them that are the prescription's. Thicknesses of dropped ones behind them add to the last one's.
        unit_mm: the file's unit of length.

    Returns:
        What varies, without thicknesses of surfaces that were dropped in front.
    """
    place_of = {id(surface): place for place, surface in enumerate(kept)}
    rear = surfaces[next(i for i, surface in enumerate(surfaces) if surface is kept[-1]) :]
    film: dict[int, tuple[float | None, ...]] = {}
    placed: list[Variation] = []
    for variation in configurations.variations:
        unit = unit_mm if variation.quantity in _LENGTHS else 1.0
        values = tuple(None if value is None else value * unit for value in variation.values)
        if variation.surface is None:
            placed.append(Variation(None, variation.quantity, values))
        elif variation.quantity == "thickness" and any(variation.surface is surface for surface in rear):
            film[id(variation.surface)] = values
        elif id(variation.surface) in place_of:
            placed.append(Variation(place_of[id(variation.surface)], variation.quantity, values))
    if film:
        constant = (surface.thickness * unit_mm for surface in rear if id(surface) not in film)
        parts = [*film.values(), (sum(constant),) * configurations.count]
        placed.append(Variation(len(kept) - 1, "thickness", tuple(map(_sum, zip(*parts, strict=True)))))
    return tuple(placed)


def _sum(lengths: Sequence[float | None]) -> float | None:
    known = [length for length in lengths if length is not None]
    return sum(known) if len(known) == len(lengths) else None


def prescription_at(lens: Prescription, variations: Sequence[Variation], index: int) -> Prescription:
    """The prescription at a configuration.

    Args:
        lens: at the first configuration.
        variations: of it.
        index: of the configuration, from 0.
    """
    surfaces = list(lens.surfaces)
    for variation in variations:
        value = variation.values[index]
        if value is None:
            continue
        if variation.surface is not None:
            name = variation.quantity + ("" if variation.quantity == "conic" else "_mm")
            surfaces[variation.surface] = replace(surfaces[variation.surface], **{name: value})  # type: ignore[arg-type]
        elif variation.quantity == "f_number":
            lens = replace(lens, f_stop=value)
    return replace(lens, surfaces=tuple(surfaces))


def focal_lengths_mm(lens: Prescription, variations: Sequence[Variation], count: int) -> tuple[float, ...] | None:
    """Focal length at each configuration, as the file states it, else of paraxial rays; None where one has none.

    Args:
        lens: at the first configuration.
        variations: of it.
        count: number of configurations.
    """
    stated = next((each.values for each in variations if each.quantity == "focal_length"), (None,) * count)
    lengths: list[float] = []
    for index in range(count):
        value = stated[index]
        if value is None:
            try:
                with np.errstate(all="ignore"):
                    value, _, _ = focal_points(paraxial_system(prescription_at(lens, variations, index)))
            except InputError:
                return None
        lengths.append(value)
    return tuple(lengths) if np.isfinite(lengths).all() else None


def to_configurations(lens: Prescription, variations: Sequence[Variation], count: int) -> tuple[Configuration, ...]:
    """Configurations of a prescription, of those whose object is before the lens; none where no space differs between them.

    Args:
        lens: at the first configuration.
        variations: of it.
        count: number of configurations.
    """
    stated = {each.quantity: each.values for each in variations if each.surface is None}
    found: list[Configuration] = []
    for index in range(count):
        at = prescription_at(lens, variations, index)
        film_mm = at.surfaces[-1].thickness_mm
        thicknesses = (*(surface.thickness_mm for surface in at.surfaces[:-1]), max(film_mm, 0.0))
        focal_mm, f_number, pupil_mm, object_mm, magnification = (
            stated.get(name, (None,) * count)[index] for name in _OF_CONFIGURATION
        )
        if object_mm is None:
            object_mm = _object_mm(at, film_mm) if magnification else math.inf
        if f_number is None and pupil_mm:
            f_number = _focal_mm(at) / pupil_mm
        if object_mm > 0:
            found.append(Configuration(thicknesses, object_mm, focal_mm or 0.0, f_number or 0.0))
    return tuple(found) if len({each.thicknesses_mm for each in found}) > 1 else ()


_OF_CONFIGURATION: tuple[Quantity, ...] = (
    "focal_length",
    "f_number",
    "pupil_diameter",
    "object_distance",
    "magnification",
)


def _object_mm(lens: Prescription, film_mm: float) -> float:
    """Distance of the film's paraxial image before surface 1; 0 where it is not before the lens (Newton's equation)."""
    try:
        focal, back, front_focal_mm = focal_points(paraxial_system(lens))
    except InputError:
        return 0.0
    return focal**2 / (film_mm - back) - front_focal_mm if film_mm > back else 0.0


def _focal_mm(lens: Prescription) -> float:
    try:
        return max(focal_points(paraxial_system(lens))[0], 0.0)
    except InputError:
        return 0.0


def configurations_note(
    lens: Prescription, variations: Sequence[Variation], configurations: DraftConfigurations
) -> str:
    """A sentence that says how many configurations a file has, and of which focal lengths; "" for one alone.

    Args:
        lens: at the first configuration, with those that are used.
        variations: of it.
        configurations: of the file.
    """
    if configurations.count < 2:
        return ""
    begin = f"Of the file's {configurations.count} {configurations.kind} the first is used"
    if lens.configurations:
        begin = f"The file has {configurations.count} {configurations.kind}"
        if any(each.quantity in _OF_FIRST for each in variations):
            begin += ", whose radii, conic constants and diameters are those of the first"
    lengths = focal_lengths_mm(lens, variations, configurations.count)
    if lengths is None:
        return f"{begin}."
    texts = [f"{length:.4g}" for length in lengths]
    if len(set(texts)) == 1:
        return f"{begin}; all have a focal length of {texts[0]} mm."
    return f"{begin}; their focal lengths are {', '.join(texts)} mm."
