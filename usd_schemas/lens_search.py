"""The words that lenses of the library are sorted by, and the search for a lens by what cinematographers ask for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from usd_schemas.errors import SchemaError
from usd_schemas.lens_library import LibraryLens
from usd_schemas.lookup import hint

FAMILIES = {
    "normal": "sees about as the eye does on its format",
    "wide": "a wide angle",
    "telephoto": "long, whether or not it is shorter than its focal length",
    "portrait": "a short telephoto for faces",
    "macro": "corrected for near distances",
    "fisheye": "bends straight lines to see up to half of the world",
    "zoom": "changes its focal length",
    "anamorphic": "squeezes the picture",
    "mirror": "folds its light by mirrors",
    "cinema": "made for motion pictures",
    "fast": "f/1.5 or faster",
    "aspheric": "with aspheric surfaces",
    "singlet": "one lens element",
    "petzval": "two positive achromats apart: sharp in the middle, with a curved field",
    "triplet": "positive, negative, positive: Cooke's triplet, Tessar, Heliar, and Ernostar",
    "tessar": "a triplet with a cemented rear pair",
    "heliar": "a triplet with cemented outer pairs",
    "sonnar": "an Ernostar with thick cemented groups, few surfaces to air",
    "double gauss": "two negative menisci about the iris, between positive ones",
    "biogon": "negative menisci at both ends: wide, nearly without distortion",
    "retrofocus": "a negative front and a long back focus",
    "soft focus": "a sharp core in a halo",
    "bubbles": "discs of blur with bright rims",
    "swirl": "a background that turns about the middle",
    "ideal": "no errors of its own",
}
"""Families and characters, and what each means."""


@dataclass(frozen=True)
class LensSearch:
    """A search; fields that are left at their defaults let every lens pass.

    Attributes:
        focal_length_mm: shortest and longest, in millimetres, both included; a zoom passes where its range has some of them.
        faster_than: largest f-number wide open, which is included; pinholes have none and do not pass.
        family: one of `FAMILIES`.
        years: first and last, both included; lenses without a year do not pass unless all do.
        words: all of them occur in the name, title, maker, description, source or families, whatever the case.
    """

    focal_length_mm: tuple[float, float] = (0.0, math.inf)
    faster_than: float = math.inf
    family: str = ""
    years: tuple[float, float] = (-math.inf, math.inf)
    words: str = ""

    def __post_init__(self) -> None:
        """Check the ranges and the family.

        Raises:
            SchemaError: a range ends before it begins, or nothing is of that family.
        """
        for what, (least, most) in (("focal length", self.focal_length_mm), ("year", self.years)):
            if not least <= most:
                raise SchemaError(f"a range of {what}s ends before it begins: {least:g} to {most:g}")
        if self.family and self._family not in FAMILIES:
            raise SchemaError(f"there is no family {self.family[:40]!r} of lenses: {hint(self._family, FAMILIES)}")

    @property
    def _family(self) -> str:
        return self.family.lower().replace("_", " ").replace("-", " ")

    def finds(self, lens: LibraryLens) -> bool:
        """Whether a lens is what is searched for."""
        return (
            self._has_focal_length(lens)
            and (0 < lens.f_stop <= self.faster_than or self.faster_than == math.inf)
            and (not self.family or self._family in lens.families)
            and (self.years == LensSearch.years or (lens.year is not None and _within(lens.year, self.years)))
            and all(word in _text(lens) for word in self.words.lower().split())
        )

    def _has_focal_length(self, lens: LibraryLens) -> bool:
        """Whether a lens, or some of a zoom's range, is within the focal lengths."""
        shortest, longest = lens.focal_length_range_mm or (lens.focal_length_mm, lens.focal_length_mm)
        return shortest <= self.focal_length_mm[1] and longest >= self.focal_length_mm[0]


def _within(number: float, limits: tuple[float, float]) -> bool:
    return limits[0] <= number <= limits[1]


def _text(lens: LibraryLens) -> str:
    parts = (lens.name, lens.lens.name, lens.lens.manufacturer, lens.description, lens.source, *lens.families)
    return "\n".join(parts).lower()
