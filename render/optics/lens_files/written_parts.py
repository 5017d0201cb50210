"""Parts of lens files that are written: names, numbers, and how a medium can be stated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray
from render.model.lens import AIR, Glass, Prescription
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM
from render.optics.dispersion.names import find_in_catalogue
from render.optics.glass import refractive_index

_SAME_INDEX = 1e-7
_LINES_NM = (C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM)
_LONGEST_NAME = 100
BICONIC_TERMS = 4
"""Aspheric terms, from r⁴ on, that CODE V's biconic has."""


@dataclass(frozen=True)
class GlassForm:
    """Form in which a medium can be stated.

    Attributes:
        kind: by the name of a maker's catalogue, by index and Abbe number, or by its indices alone.
        name: the maker's; empty for a model glass.
        maker: empty for a model glass.
    """

    kind: Literal["air", "catalogue", "model", "own"]
    name: str = ""
    maker: str = ""


def plain_name(name: str) -> str:
    """A name without characters that part the words of a file."""
    return " ".join("".join(c if c.isprintable() and c not in "'\";&!" else " " for c in name).split())[:_LONGEST_NAME]


def glass_form(glass: Glass) -> GlassForm:
    """Form in which a medium can be stated, so that its indices stay within 1e-7."""
    if glass == AIR or all(refractive_index(glass, line) == 1 for line in _LINES_NM):
        return GlassForm("air")
    found = find_in_catalogue(glass.name) if glass.name else None
    if found is not None and _same(found.glass, glass):
        return GlassForm("catalogue", found.name, found.maker)
    if _same(Glass(glass.index, glass.abbe), glass):
        return GlassForm("model")
    return GlassForm("own", glass.name)


def unwritable_surface(index: int, lens: Prescription, what: str, suffixes: str) -> SettingsError:
    """The error of a surface that a format cannot hold.

    Args:
        index: from 0.
        lens: to be written.
        what: it has.
        suffixes: of the formats that hold it; empty where none does.
    """
    where = f"surface {index + 1} of {lens.name or 'the lens'} has {what}, which this format cannot hold"
    return SettingsError(f"{where}: {f'write {suffixes}' if suffixes else 'no lens file that is written can'}")


def index_change(glass: Glass) -> float:
    """Largest change of the index from C to g where index and Abbe number alone are written."""
    return float(np.abs(_indices(Glass(glass.index, glass.abbe)) - _indices(glass)).max())


def _same(one: Glass, other: Glass) -> bool:
    return bool(np.allclose(_indices(one), _indices(other), rtol=0, atol=_SAME_INDEX))


def _indices(glass: Glass) -> DoubleArray:
    return np.array([refractive_index(glass, line) for line in _LINES_NM])


def number(value: float) -> str:
    """A number with all of its digits; whole numbers without a point."""
    return f"{value:.0f}" if value == round(value) and abs(value) < 1e9 else repr(float(value)).upper()


def beam_diameter_mm(lens: Prescription, focal_length_mm: float) -> float:
    """Diameter of the beam that enters wide open."""
    return focal_length_mm / lens.f_stop
