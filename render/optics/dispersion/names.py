"""Media by the names and codes that people and lens files give them.

Case, hyphens, blanks and underscores do not count, and a maker may follow behind an underscore: N-BK7, NBK7 and nbk7_SCHOTT are
one. Codes are those of MIL-G-174: 517642 is the glass of n_d 1.517 and V_d 64.2.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

from render.model.lens import AIR, Glass
from render.near_names import near_names
from render.optics.dispersion.catalogue import CatalogueGlass, catalogue

_CODE = re.compile(r"(\d{3})[.:]?(\d{3})", re.ASCII)
_FINE_CODE = re.compile(r"(\d{3,7})\.(\d{2,7})", re.ASCII)
_LONGEST_NAME = 40
_AIR = ("AIR", "VACUUM")
_LEADING = re.compile(r"(?:[A-Z]{1,2}-)(.+)")  # the maker's prefix of a series: N-, S-, L-, H-, D-, J-, E-, Q-, K-, MC-
_LATER = re.compile(r"([A-Z]+?)N?(\d+)([A-Z]?)", re.ASCII)  # Schott's N for new, and the letter of a later melt
# Catalogues by the names that programs give them, beside the makers' own.
_MAKERS = {
    "NIKON": "HIKARI",
    "MISC": "OTHERS",
    "NHG": "CDGM",
    "NIKONHIKARI": "HIKARI",
    "CORNFR": "CORNING",
    "ZEON": "PLASTICS",
    "ZEONEX": "PLASTICS",
}
_INDEX_AGREES, _ABBE_AGREES = 5e-5, 5e-3  # of a name with the numbers beside it; that of the Abbe number is relative

ALIASES: Mapping[str, str] = {
    "FUSEDSILICA": "F_SILICA", "SIO2": "F_SILICA", "FUSEDQUARTZ": "F_SILICA", "LITHOSIL": "LITHOSIL-Q",
    "FLUORITE": "CAF2", "MAGNESIUMFLUORIDE": "MGF2", "AL2O3": "SAPPHIRE",
    "B270I": "B270", "SUPERWHITE": "B270", "BOROFLOAT": "BOROFLOAT33", "D263": "D263TECO", "D263T": "D263TECO",
    "K9": "H-K9L", "K9L": "H-K9L", "K9GL": "H-K9L", "LIGHTCROWN": "N-BK7",
    "PLEXIGLAS": "PMMA", "PERSPEX": "PMMA", "LUCITE": "PMMA",
    "POLYCARBONATE": "POLYCARB", "PC": "POLYCARB", "LEXAN": "POLYCARB", "MAKROLON": "POLYCARB",
    "POLYSTYRENE": "POLYSTYR", "PS": "POLYSTYR", "NAS": "NAS-21", "OPTOREZ": "OPTOREZ1330", "OZ1330": "OPTOREZ1330",
    "TOPAS": "COC", "TOPAS5013": "COC",
    "ZEONEX": "E48R", "ZEONEXE48R": "E48R", "ZEONEX480R": "480R", "ZEONEX330R": "330R",
}  # fmt: skip
"""Names that other catalogues and people use, and the catalogue's own."""


def find_glass(name: str, makers: Sequence[str] = ()) -> Glass | None:
    """The medium of a name or of a code, or None.

    Args:
        name: such as ``SF10``, ``NBK7_SCHOTT``, ``517642`` or ``516800.6417``.
        makers: catalogues that win, the first most, where several makers have glasses of that name.
    """
    if name.upper() in _AIR:
        return AIR
    return glass_of_code(name) or named_glass(find_in_catalogue(name, makers))


def find_in_catalogue(name: str, makers: Sequence[str] = ()) -> CatalogueGlass | None:
    """The glass of a catalogue by its name, an alias of it, or the name of its like in another maker's series.

    BK7, which nobody makes anymore, is N-BK7. Of glasses with one name that of the named maker is found, else that of the first
    maker of the catalogue.

    Args:
        name: with or without the maker behind an underscore.
        makers: as in `find_glass`.
    """
    if len(name) > _LONGEST_NAME:
        return None
    head, _, tail = name.rpartition("_")
    suffix = _maker(tail) if head else ""
    wanted = [maker for maker in (suffix, *map(_maker, makers)) if maker]
    plain_names = (
        [_plain(name)] if not head else [_plain(head), _plain(name)] if suffix else [_plain(name), _plain(head)]
    )
    for plain in plain_names:
        found = _lookup(_plain(ALIASES.get(plain, plain)), wanted, suffix)
        if found is not None:
            return found
    return None


def named_glass(found: CatalogueGlass | None) -> Glass | None:
    """The medium, with a name that finds it again: with the maker's where the name alone finds another maker's glass."""
    if found is None:
        return None
    alone = find_in_catalogue(found.name)
    return found.glass if alone is found else replace(found.glass, name=f"{found.name}_{found.maker}")


def agreeing_glass(name: str, index: float, abbe: float) -> Glass | None:
    """The catalogue's glass of that name, if index and Abbe number agree with it; else None."""
    found = find_in_catalogue(name) if name else None
    if found is None:
        return None
    glass = found.glass
    agrees = abs(glass.index - index) <= _INDEX_AGREES and abs(glass.abbe - abbe) <= _ABBE_AGREES * glass.abbe
    return replace(glass, name=name) if agrees else None


def is_its_name(name: str, found: CatalogueGlass) -> bool:
    """Whether a name is a glass's own or an alias, with or without the series' prefix: BK7 for N-BK7, not LAFN21 for LAF21."""
    head = _plain(name.rpartition("_")[0]) or _plain(name)
    names = {_plain(name), head}
    names |= {_plain(ALIASES[alias]) for alias in names if alias in ALIASES}
    leading = _LEADING.fullmatch(found.name.upper())
    return not names.isdisjoint({_plain(found.name), _plain(leading[1]) if leading else ""})


def near_glasses(name: str) -> list[str]:
    """Up to three names of the catalogue that are nearest to a name that it has not."""
    return near_names(name[:_LONGEST_NAME].split("_")[0], sorted({glass.name for glass in catalogue()}))


def glass_of_code(code: str) -> Glass | None:
    """The model glass of a six-digit code, or of one with more digits on either side of a point; None for anything else."""
    short = _CODE.fullmatch(code)
    if short:
        return Glass(1 + int(short[1]) / 1000, int(short[2]) / 10, name=code)
    fine = _FINE_CODE.fullmatch(code)
    if fine:  # as many digits as are given, the point of V_d behind the second
        return Glass(1 + int(fine[1]) / 10 ** len(fine[1]), int(fine[2]) / 10 ** (len(fine[2]) - 2), name=code)
    return None


def _lookup(plain: str, wanted: Sequence[str], only: str) -> CatalogueGlass | None:
    """The glass of a plain name, of the maker that is asked for before any other."""
    named, series = _by_name()
    same = [*named.get(plain, []), *series.get(plain, [])]
    alike = [glass for like in _likes(plain) for glass in (*named.get(like, []), *series.get(like, []))]
    for candidates in (same, alike):
        of_maker = [glass for glass in candidates if _maker(glass.maker) == only]
        if of_maker:
            return of_maker[0]
    order = {maker: place for place, maker in enumerate(dict.fromkeys((*wanted, *_makers())))}
    return min(same or alike, key=lambda glass: order[_maker(glass.maker)], default=None)


def _likes(plain: str) -> list[str]:
    """Names of the same type of glass: NSK99 is SK99, LAFN21 is LAF21, SSK4A is SSK4."""
    found = [plain[1:]] if plain.startswith("N") else []
    later = _LATER.fullmatch(plain)
    if later:
        found += [later[1] + later[2], *([later[1] + later[2] + later[3]] if later[3] else [])]
    return found


@cache
def _by_name() -> tuple[dict[str, list[CatalogueGlass]], dict[str, list[CatalogueGlass]]]:
    """Glasses by their plain names, and by these without the prefix of the maker's series."""
    named: dict[str, list[CatalogueGlass]] = {}
    series: dict[str, list[CatalogueGlass]] = {}
    for glass in catalogue():
        named.setdefault(_plain(glass.name), []).append(glass)
        leading = _LEADING.fullmatch(glass.name.upper())
        if leading:
            series.setdefault(_plain(leading[1]), []).append(glass)
    return named, series


@cache
def _makers() -> tuple[str, ...]:
    """The makers in capitals, in the order of the catalogue."""
    return tuple(dict.fromkeys(glass.maker.upper() for glass in catalogue()))


def _maker(name: str) -> str:
    """A maker in capitals; empty for a word that names none."""
    plain = re.sub(r"[^A-Z]", "", name.upper())
    plain = _MAKERS.get(plain, plain)
    return next((maker for maker in _makers() if plain.startswith(maker)), "")


def _plain(name: str) -> str:
    return re.sub(r"[-\s_]", "", name).upper()
