"""Writes Zemax's sequential `.zmx` files; `render.optics.lens_files.zemax` describes them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from render.model.lens import Across, Glass, Outline, Prescription, Surface
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM
from render.optics.dispersion.names import find_in_catalogue
from render.optics.glass import refractive_index
from render.optics.lens_files.written_parts import (
    BICONIC_TERMS,
    beam_diameter_mm,
    glass_form,
    index_change,
    number,
    unwritable_surface,
)
from render.optics.prescription.outlines import is_circle, reach_mm, spider_arms
from render.optics.prescription.paraxial import first_order

_SAME = 1e-6
_HIGHEST_OF_TORUS = 14
_HIGHEST_EVEN, _HIGHEST_ODD = 16, 8  # powers of EVENASPH and ODDASPHE; the extended types have all of them
_NORMAL_LINE = (0.6438, -0.001682)  # of P_gF over V_d, through K7 and F2 (Schott, TIE-29)


def zemax_text(lens: Prescription, notes: list[str]) -> str:
    """The text of a `.zmx` file.

    Args:
        lens: complete, with a plain name.
        notes: takes what the format cannot say.

    Raises:
        SettingsError: a surface has a shape that no type of Zemax's has.
    """
    makers = list(
        dict.fromkeys(form.maker.upper() for form in (glass_form(s.glass) for s in lens.surfaces) if form.maker)
    )
    lines = [
        "VERS 140124 258 36214",
        "MODE SEQ",
        f"NAME {lens.name}",
        "UNIT MM X W X CM MR CPMM",
        f"ENPD {number(beam_diameter_mm(lens, first_order(lens).focal_length_mm))}",
        f"GCAT {' '.join(makers)}",
        "FTYP 0 0 1 3 0 0 0",
        "XFLN 0",
        "YFLN 0",
        *(f"WAVM {i} {nm / 1000!r} 1" for i, nm in enumerate((F_LINE_NM, D_LINE_NM, C_LINE_NM), 1)),
        "PWAV 2",
        "SURF 0",
        "  TYPE STANDARD",
        "  CURV 0.0",
        "  DISZ INFINITY",
        "  DIAM 0 0 0 0 1",
    ]
    for index in range(len(lens.surfaces)):
        lines += _surface(index + 1, lens, makers, notes)
    lines += [
        f"SURF {len(lens.surfaces) + 1}",
        "  TYPE STANDARD",
        "  CURV 0.0",
        "  DISZ 0",
        "  DIAM 0 0 0 0 1",
        "MNUM 1 1",
    ]
    if lens.focus_group is not None:
        notes.append("The group that moves to focus is not written.")
    return "\n".join(lines) + "\n"


def _surface(index: int, lens: Prescription, makers: list[str], notes: list[str]) -> Iterator[str]:
    surface = lens.surfaces[index - 1]
    yield f"SURF {index}"
    if surface.is_stop:
        yield "  STOP"
    shape = list(_shape(index - 1, lens))
    yield f"  TYPE {shape.pop(0)}"
    yield f"  CURV {number(1 / surface.radius_mm if surface.radius_mm else 0.0)}"
    if surface.conic:
        yield f"  CONI {number(surface.conic)}"
    yield from shape
    yield f"  DISZ {number(surface.thickness_mm)}"
    glass = _glass(index, surface.glass, makers, notes)
    if glass:
        yield f"  GLAS {glass}"
    yield f"  DIAM {number(surface.semi_diameter_mm)} 1 0 0 1"
    yield from _aperture(index, surface, notes)


def _aperture(index: int, surface: Surface, notes: list[str]) -> Iterator[str]:
    """Lines of the one aperture that a surface has here: an opening and an obscuration are one where they make a ring."""
    opening, obscuration = surface.opening, surface.obscuration
    if opening is None and obscuration is not None and is_circle(obscuration):
        rim = Outline("ellipse", (surface.semi_diameter_mm, surface.semi_diameter_mm))
        opening = rim if obscuration.centre_mm == rim.centre_mm else None
    written = opening or obscuration
    if written is None:
        return
    sizes, centre = written.half_mm, written.centre_mm
    if written.kind == "polygon":
        arms = spider_arms(written) if opening is None else None
        if arms is None:
            name = "opening" if opening else "obscuration"
            notes.append(f"The {name} of surface {index} is not written: it is a polygon that is no spider.")
            return
        kind, sizes, centre = "SPID", (arms.width, arms.arms), arms.centre
    elif is_circle(written):
        kind, sizes = "CLAP" if opening else "OBSC", (0.0, sizes[0])
    else:
        kind = f"{'SQ' if written.kind == 'rectangle' else 'EL'}{'AP' if opening else 'OB'}"
    if opening is not None and obscuration is not None:
        if kind == "CLAP" and is_circle(obscuration) and obscuration.centre_mm == opening.centre_mm:
            sizes = obscuration.half_mm[0], sizes[1]
        else:
            notes.append(f"The obscuration of surface {index} is not written: it has an opening too.")
    yield f"  {kind} {number(sizes[0])} {number(sizes[1])} 0"
    if centre != (0.0, 0.0):
        yield f"  OBDC {number(centre[0])} {number(centre[1])}"
    if opening is not None and surface.semi_diameter_mm < reach_mm(opening) * (1 - _SAME):
        notes.append(f"The clear diameter of surface {index} cuts its opening, which is written without that.")


def _shape(index: int, lens: Prescription) -> Iterator[str]:
    """The type of a surface, and its lines."""
    surface = lens.surfaces[index]
    if surface.phase:
        yield from _diffractive(index, lens)
    elif surface.across is not None:
        yield from _two_curves(index, lens, surface.across)
    else:
        yield from _asphere(surface)


def _diffractive(index: int, lens: Prescription) -> Iterator[str]:
    surface = lens.surfaces[index]
    terms = {power: term for power, term in surface.aspheric_terms.items() if term}
    if surface.across is not None:
        raise unwritable_surface(index, lens, "two curves and diffraction", ".seq")
    if any(power % 2 for power in terms) or max(terms, default=0) > _HIGHEST_EVEN:
        what = f"diffraction and aspheric terms of odd powers or beyond r^{_HIGHEST_EVEN}"
        raise unwritable_surface(index, lens, what, ".seq")
    yield "BINARY_2"
    yield "  PARM 0 1"
    yield from (f"  PARM {power // 2} {number(term)}" for power, term in sorted(terms.items()))
    yield from _extra_data([len(surface.phase), 1.0, *surface.phase])


def _extra_data(values: Sequence[float]) -> Iterator[str]:
    yield from (f'  XDAT {place} {number(value)} 0 0 1.0 0.0 0 ""' for place, value in enumerate(values, 1))


def _asphere(surface: Surface) -> Iterator[str]:
    """The type of a surface, and the lines of its terms."""
    terms = {power: term for power, term in surface.aspheric_terms.items() if term}
    step, highest = (1, _HIGHEST_ODD) if surface.odd else (2, _HIGHEST_EVEN)
    last = max(terms, default=0)
    if not terms:
        yield "STANDARD"
    elif last <= highest:
        yield "ODDASPHE" if step == 1 else "EVENASPH"
        yield from (f"  PARM {power // step} {number(term)}" for power, term in sorted(terms.items()))
    else:
        yield "XOSPHERE" if step == 1 else "XASPHERE"
        yield from _extra_data([last // step, 1.0, *(terms.get(power, 0.0) for power in range(step, last + 1, step))])


def _two_curves(index: int, lens: Prescription, across: Across) -> Iterator[str]:
    """The type of a surface with two curves, and its lines."""
    surface = lens.surfaces[index]
    if not surface.torus:
        if any(surface.aspheric_terms.values()):
            suffixes = ".seq" if not surface.odd and len(surface.aspheric) <= BICONIC_TERMS else ""
            raise unwritable_surface(index, lens, "two curves and aspheric terms of r", suffixes)
        yield "BICONICX"
        yield f"  PARM 1 {number(across.radius_mm)}"
        yield f"  PARM 2 {number(across.conic)}"
        return
    terms = {power: term for power, term in surface.aspheric_terms.items() if term}
    if surface.torus == "across":
        raise unwritable_surface(index, lens, "a curve from side to side that is turned to make a torus", ".seq")
    if any(power % 2 for power in terms):
        raise unwritable_surface(index, lens, "aspheric terms of odd powers on a torus", "")
    if max(terms, default=0) > _HIGHEST_OF_TORUS:
        raise unwritable_surface(index, lens, f"aspheric terms beyond y^{_HIGHEST_OF_TORUS} on a torus", ".seq")
    yield "TOROIDAL"
    yield f"  PARM 1 {number(across.radius_mm)}"
    yield from (f"  PARM {power // 2 + 1} {number(term)}" for power, term in sorted(terms.items()))


def _glass(index: int, glass: Glass, makers: list[str], notes: list[str]) -> str:
    form = glass_form(glass)
    if form.kind == "air":
        return ""
    if form.kind == "catalogue":
        found = find_in_catalogue(form.name, makers)
        if found is not None and found.maker == form.maker:
            return f"{form.name} 0 0 {number(round(glass.index, 6))} {number(round(glass.abbe, 3))} 0 0 0 0 0 0"
    deviation = 0.0
    if form.kind != "model" and glass.abbe:
        g, f, c = (refractive_index(glass, line) for line in (G_LINE_NM, F_LINE_NM, C_LINE_NM))
        deviation = (g - f) / (f - c) - _NORMAL_LINE[0] - _NORMAL_LINE[1] * glass.abbe
        name = glass.name or "without name"
        notes.append(
            f"Glass {name} of surface {index} is written by n_d, V_d and dP_gF: its index changes by up to"
            f" {index_change(glass):.1g} without the last."
        )
    return f"___BLANK 1 0 {number(glass.index)} {number(glass.abbe)} {number(deviation)} 0 0 0 0 0"
