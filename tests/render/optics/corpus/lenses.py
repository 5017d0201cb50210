"""The corpus: lenses of the library that have surfaces of patents and books, wide open and focused at infinity."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from render.model.lens import Prescription
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.paraxial import FirstOrder, first_order, stop_index
from render.stage.camera.lenses import make_lens
from usd_schemas import LibraryLens, StatedNumbers, library_lens, library_lenses

FILE = Path(__file__).with_name("rayoptics.json")
_CORNER_MM = 21.6
_WIDEST_DEG = 80.0  # a fisheye's last rays graze its front, where their place on it is ill-conditioned


@dataclass(frozen=True, eq=False)
class CorpusLens:
    """One lens of the corpus.

    Attributes:
        entry: of the library.
        prescription: complete, wide open.
    """

    entry: LibraryLens
    prescription: Prescription

    @property
    def name(self) -> str:
        """In the library."""
        return self.entry.name

    @property
    def stated(self) -> StatedNumbers:
        """Numbers that its source states."""
        assert self.entry.stated is not None
        return self.entry.stated

    @cached_property
    def first(self) -> FirstOrder:
        """First-order properties at the d line."""
        return first_order(self.prescription)

    @property
    def stop(self) -> int:
        """Index of the stop."""
        return stop_index(self.prescription)

    @property
    def stop_radius_mm(self) -> float:
        """Radius of the iris, wide open."""
        return self.prescription.surfaces[self.stop].semi_diameter_mm

    @cached_property
    def half_field_deg(self) -> float:
        """Half of the stated field, at most 80°; else that of full frame's corner by an ideal lens."""
        if self.stated.field_deg is None:
            return math.degrees(math.atan(_CORNER_MM / self.first.focal_length_mm))
        return min(self.stated.field_deg / 2, _WIDEST_DEG)


def corpus_names() -> list[str]:
    """Names of the lenses, in the library's order."""
    return [lens.name for lens in library_lenses() if lens.lens.model == "prescription" and lens.stated]


@cache
def corpus_lens(name: str) -> CorpusLens:
    """One lens."""
    entry = library_lens(name)
    prescription = make_lens(entry.lens, entry.name).prescription
    assert prescription is not None
    return CorpusLens(entry, complete_prescription(prescription))


def corpus_lenses() -> list[CorpusLens]:
    """All of them."""
    return [corpus_lens(name) for name in corpus_names()]


@cache
def independent_numbers() -> dict[str, Any]:
    """Numbers of rayoptics, as `scripts/lens_corpus` has written it."""
    found: dict[str, Any] = json.loads(FILE.read_text())
    return found
