"""Writes CODE V's `.seq` files; `render.optics.lens_files.code_v` describes them."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from render.model.lens import Across, Glass, Outline, Prescription, Surface
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM
from render.optics.dispersion.names import glass_of_code
from render.optics.glass import refractive_index
from render.optics.lens_files.written_parts import (
    BICONIC_TERMS,
    beam_diameter_mm,
    glass_form,
    number,
    unwritable_surface,
)
from render.optics.prescription.diffraction import reduced_mm
from render.optics.prescription.paraxial import first_order

_LETTERS = "ABCDEFGHJ"  # of r⁴, r⁶, ... r²⁰
# Wavelengths of a private glass: enough for a curve, within what lenses are used for.
_PRIVATE_NM = (404.66, 435.83, 486.13, 546.07, D_LINE_NM, 656.27, 706.52)
_SAME_INDEX = 1e-7


def code_v_text(lens: Prescription, notes: list[str]) -> str:
    """The text of a `.seq` file.

    Args:
        lens: complete, with a plain name.
        notes: takes what the format cannot say.

    Raises:
        SettingsError: a surface has a shape that CODE V does not have.
    """
    private: dict[Glass, str] = {}
    surfaces: list[str] = []
    for index in range(len(lens.surfaces)):
        surfaces += _surface(index, lens, private)
        polygons = {"opening": lens.surfaces[index].opening, "obscuration": lens.surfaces[index].obscuration}
        for name, outline in polygons.items():
            if outline is not None and outline.kind == "polygon":
                notes.append(f"The {name} of surface {index + 1} is not written: it is a polygon.")
    lines = [
        "RDM;LEN",
        f"TITLE '{lens.name}'",
        f"EPD   {number(beam_diameter_mm(lens, first_order(lens).focal_length_mm))}",
        "DIM   M",
        f"WL    {C_LINE_NM!r} {D_LINE_NM!r} {F_LINE_NM!r}",
        "REF   2",
        "XAN   0.0",
        "YAN   0.0",
        *_catalogue(private),
        "SO    0.0 0.1E14",
        *surfaces,
        "SI    0.0 0.0",
        "GO",
    ]
    if lens.focus_group is not None:
        notes.append("The group that moves to focus is not written.")
    return "\n".join(lines) + "\n"


def _surface(index: int, lens: Prescription, private: dict[Glass, str]) -> Iterator[str]:
    surface = lens.surfaces[index]
    glass = _glass(surface.glass, private)
    yield f"S     {number(surface.radius_mm)} {number(surface.thickness_mm)} {glass}".rstrip()
    if surface.is_stop:
        yield "  STO"
    yield f"  CIR {number(surface.semi_diameter_mm)}"
    yield from _aperture(surface.opening, "L'OPENING'")
    yield from _aperture(surface.obscuration, "OBS")
    yield from _shape(surface) if surface.across is None else _two_curves(index, lens, surface.across)
    if surface.phase:
        yield "  DIF DOE"
        yield "  HOR 1"
        yield f"  HWL {D_LINE_NM!r}"
        yield "  HCT R"
        path = (number(term * float(reduced_mm(D_LINE_NM))) for term in surface.phase)
        yield from (f"  HCO C{place} {value}" for place, value in enumerate(path, 1))


def _shape(surface: Surface) -> Iterator[str]:
    if surface.odd or any(surface.aspheric[len(_LETTERS) :]):  # which has all powers up to r³⁰
        yield "  SPS ODD 0.0"
        yield f"  SCO K {number(surface.conic)}"
        yield from (f"  SCO AR{power} {number(term)}" for power, term in sorted(surface.aspheric_terms.items()) if term)
    elif surface.aspheric:
        yield "  ASP"
        yield f"  K {number(surface.conic)}"
        yield from _letters(surface)
    elif surface.conic:
        yield "  CON"
        yield f"  K {number(surface.conic)}"


def _letters(surface: Surface) -> Iterator[str]:
    yield from (f"  {letter} {number(term)}" for letter, term in zip(_LETTERS, surface.aspheric, strict=False))


def _two_curves(index: int, lens: Prescription, across: Across) -> Iterator[str]:
    surface, torus = lens.surfaces[index], across.torus
    most = len(_LETTERS) if torus else BICONIC_TERMS
    if any(surface.odd):
        raise unwritable_surface(index, lens, "two curves and aspheric terms of odd powers", "")
    if any(surface.aspheric[most:]):
        raise unwritable_surface(index, lens, f"two curves and aspheric terms beyond r^{2 + 2 * most}", "")
    yield f"  {'XTO' if torus == 'across' else 'YTO' if torus else 'AAS'}"
    yield f"  RDX {number(across.radius_mm)}"
    if torus:
        yield f"  K {number(across.conic if torus == 'across' else surface.conic)}"
        yield from _letters(surface)
        return
    yield f"  KX {number(across.conic)}"
    yield f"  K {number(surface.conic)}"
    names = ("AR", "BR", "CR", "DR")
    yield from (f"  {name} {number(term)}" for name, term in zip(names, surface.aspheric, strict=False))


def _aperture(outline: Outline | None, which: str) -> Iterator[str]:
    if outline is None or outline.kind == "polygon":
        return
    half, centre = outline.half_mm, outline.centre_mm
    if outline.kind == "ellipse" and half[0] == half[1]:
        yield f"  CIR {which} {number(half[0])}"
    else:
        begin = "EL" if outline.kind == "ellipse" else "RE"
        yield from (f"  {begin}{axis} {which} {number(size)}" for axis, size in zip("XY", half, strict=True))
    yield from (f"  AD{axis} {which} {number(place)}" for axis, place in zip("XY", centre, strict=True) if place)


def _glass(glass: Glass, private: dict[Glass, str]) -> str:
    form = glass_form(glass)
    if form.kind == "air":
        return ""
    if form.kind == "catalogue":
        return f"{re.sub('[^A-Z0-9]', '', form.name.upper())}_{form.maker.upper()}"
    if form.kind == "model" and glass.abbe:
        code = f"{round((glass.index - 1) * 1e6):06d}.{round(glass.abbe * 1e4):06d}"
        found = glass_of_code(code)
        if found is not None and abs(found.index - glass.index) < _SAME_INDEX and abs(found.abbe - glass.abbe) < 1e-6:
            return code
    return f"'{private.setdefault(glass, f'GLASS{len(private) + 1}')}'"


def _catalogue(private: dict[Glass, str]) -> Iterator[str]:
    """The private catalogue; a medium without dispersion has its index at one wavelength."""
    if not private:
        return
    yield "PRV"
    for is_even in (False, True):
        glasses = {glass: name for glass, name in private.items() if _is_even(glass) == is_even}
        wavelengths = _PRIVATE_NM[4:5] if is_even else _PRIVATE_NM
        if glasses:
            yield f"  PWL {' '.join(repr(nm) for nm in wavelengths)}"
        for glass, name in glasses.items():
            indices = (f"{float(refractive_index(glass, nm)):.9f}" for nm in wavelengths)
            yield f"  '{name}' {' '.join(indices)}"
    yield "END"


def _is_even(glass: Glass) -> bool:
    return bool(np.ptp([refractive_index(glass, nm) for nm in _PRIVATE_NM]) < _SAME_INDEX)
