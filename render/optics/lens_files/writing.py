"""Lens files of a prescription: Zemax `.zmx`, CODE V `.seq`, Optical Bench `.txt`. To be read again gives the same lens."""

from __future__ import annotations

from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path
from typing import Literal

import numpy as np

from render.errors import SettingsError
from render.model.lens import AIR, Glass, Prescription, Surface
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM
from render.optics.dispersion.names import find_in_catalogue
from render.optics.glass import refractive_index

WRITTEN_SUFFIXES = (".zmx", ".seq", ".txt")
_SAME_INDEX = 1e-7
_LINES_NM = (C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM)
_WRITTEN = frozenset(  # fields of the model that the writers know
    {"radius_mm", "thickness_mm", "glass", "semi_diameter_mm", "conic", "aspheric", "is_stop", "coating_nm"}
    | {"surfaces", "focus_group", "f_stop", "name", "notes"}
)
_LONGEST_NAME = 100


@dataclass(frozen=True)
class WrittenLens:
    """A lens file that is to be written.

    Attributes:
        content: all of its bytes.
        notes: what the format cannot say, one sentence each.
    """

    content: bytes
    notes: tuple[str, ...]


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


def write_lens(lens: Prescription, suffix: str) -> WrittenLens:
    """The lens file of a prescription.

    Args:
        lens: complete.
        suffix: of the file, which selects the format.

    Raises:
        SettingsError: there is no such format, or none of them can hold what the lens has.
    """
    suffix = suffix.lower()
    if suffix not in WRITTEN_SUFFIXES:
        raise SettingsError(f"lens files are written as {', '.join(WRITTEN_SUFFIXES)}, got {suffix or 'no suffix'}")
    why = unwritable(lens)
    if why:
        raise SettingsError(f"{lens.name or 'the lens'} cannot be written as a lens file: {why}")
    if suffix == ".zmx":
        from render.optics.lens_files.zemax_writer import zemax_text as text_of
    elif suffix == ".seq":
        from render.optics.lens_files.code_v_writer import code_v_text as text_of
    else:
        from render.optics.lens_files.optical_bench_writer import optical_bench_text as text_of
    lens = replace(lens, name=plain_name(lens.name))
    notes: list[str] = []
    text = text_of(lens, notes)
    if any(surface.coating_nm for surface in lens.surfaces):
        notes.append("Coatings are not written.")
    # OpticStudio writes UTF-16; what is ASCII every program reads.
    encoding = "utf-16" if suffix == ".zmx" and not text.isascii() else "utf-8"
    return WrittenLens(text.replace("\n", "\r\n" if suffix == ".zmx" else "\n").encode(encoding), tuple(notes))


def unwritable(lens: Prescription) -> str:
    """Why a prescription cannot be written: it has what no writer knows; "" where it can."""
    parts: list[tuple[str, Prescription | Surface]] = [
        ("the lens", lens),
        *((f"surface {i + 1}", surface) for i, surface in enumerate(lens.surfaces)),
    ]
    for name, part in parts:
        for each in fields(part):
            if each.name not in _WRITTEN and getattr(part, each.name) != _default(each):
                return f"{name} has values of {each.name}"
    return ""


def _default(each: object) -> object:
    default, factory = getattr(each, "default", MISSING), getattr(each, "default_factory", MISSING)
    return factory() if callable(factory) else default


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


def index_change(glass: Glass) -> float:
    """Largest change of the index from C to g where index and Abbe number alone are written."""
    return float(np.abs(_indices(Glass(glass.index, glass.abbe)) - _indices(glass)).max())


def _same(one: Glass, other: Glass) -> bool:
    return bool(np.allclose(_indices(one), _indices(other), rtol=0, atol=_SAME_INDEX))


def _indices(glass: Glass) -> np.ndarray:
    return np.array([refractive_index(glass, line) for line in _LINES_NM])


def number(value: float) -> str:
    """A number with all of its digits; whole numbers without a point."""
    return f"{value:.0f}" if value == round(value) and abs(value) < 1e9 else repr(float(value)).upper()


def beam_diameter_mm(lens: Prescription, focal_length_mm: float) -> float:
    """Diameter of the beam that enters wide open."""
    return focal_length_mm / lens.f_stop


def target_suffix(path: Path) -> str:
    """Suffix of a file that is to be written.

    Raises:
        SettingsError: no lens file has it.
    """
    if path.suffix.lower() not in WRITTEN_SUFFIXES:
        raise SettingsError(f"a lens file is written as {', '.join(WRITTEN_SUFFIXES)}, got {path}")
    return path.suffix.lower()
