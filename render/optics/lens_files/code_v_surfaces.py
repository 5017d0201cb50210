"""CODE V's surfaces beyond ASP: odd powers, Forbes's polynomials, cylinders and biconics.

    SPS ODD 0.0; SCO K -1; SCO AR3 1e-5     coefficients of r, r², ... r³⁰ over the normalisation radius, 0 for none;
                                            or by number: C1 is K, C2 AR1, C3 AR2, ... C33 NRADIUS
    SPS QCN 12.0; SCO QC4 1e-2              Forbes's Qcon: a_0 is QC4, a_1 QC6, ...; C1 is K, C2 NRADIUS, C3 QC4, ...
    SPS QBF 12.0; SCO QB4 1e-2              Qbfs, with the same numbers
    CYL; RDX 50                             cylinder: RDY (the radius behind S) and RDX, one of them 0
    YTO; RDX 50; K -1; A 1e-6               the curve in y, with K, A, B, ..., turned about an axis parallel to y; XTO: that in x
    AAS; RDX 50; KX -1; AR 1e-6             biconic, with K in y and terms AR, BR, CR, DR of r⁴, r⁶, r⁸, r¹⁰

The terms of a cylinder (CYL) are those of its curve. All other special surfaces (SPS) are refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from render.errors import InputError
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.forbes import MOST_TERMS, ForbesTerms
from render.optics.lens_files.lens_text import LensText

_SPECIAL = ("ODD", "QCN", "QBF")
_CURVES = ("CYL", "YTO", "XTO", "AAS")
_FORBES: dict[str, Literal["Qcon", "Qbfs"]] = {"QCN": "Qcon", "QBF": "Qbfs"}
_RADIAL = {"AR": 4, "BR": 6, "CR": 8, "DR": 10}  # powers of r
_ASYMMETRIC = ("AP", "BP", "CP", "DP")
_HIGHEST_POWER = 30
_CONIC, _RADIUS = "K", "NRADIUS"


@dataclass
class _Read:
    surface: DraftSurface
    kind: str
    line: int
    values: dict[str, float] = field(default_factory=dict)


class CodeVSurfaces:
    """Surfaces of these types, as they are read."""

    def __init__(self, text: LensText) -> None:
        self._text = text
        self._read: dict[int, _Read] = {}  # by the id of the surface, which lives as long

    def takes(self, surface: DraftSurface, name: str, words: Sequence[str], line: int) -> bool:
        """Take a command about a surface, if it is one of these.

        Raises:
            InputError: a special surface is of another kind, or a value is no number.
        """
        if name == "SPS":
            self._begin_special(surface, words, line)
        elif name == "SCO":
            self._coefficients(surface, words, line)
        elif name in _CURVES:
            self._read[id(surface)] = _Read(surface, name, line)
        else:
            return self._takes_curve(surface, name, words, line)
        return True

    def finish(self) -> None:
        """Set the shapes of all surfaces.

        Raises:
            InputError: a surface has values that its type has not, or lacks one that it needs.
        """
        for each in self._read.values():
            if each.kind in _CURVES:
                self._finish_curves(each)
                continue
            if _CONIC in each.values:
                each.surface.conic = each.values[_CONIC]
            if each.kind == "ODD":
                self._finish_odd(each)
            else:
                self._finish_forbes(each)

    def _begin_special(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        kind = words[0].upper() if words else "nothing"
        if kind not in _SPECIAL:
            what = f"special surfaces of the kinds {', '.join(_SPECIAL)} are supported (SPS), got {kind[:20]}"
            raise self._text.error(what, line, surface.label)
        radius = self._text.number(words[1], "normalisation radius (SPS)", line, surface.label) if words[1:] else 0.0
        self._read[id(surface)] = _Read(surface, kind, line, {_RADIUS: radius})

    def _coefficients(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        """Take pairs of a coefficient's name and its value."""
        each = self._find(surface)
        if each is None or each.kind in _CURVES:
            raise self._text.error("SCO stands at a surface without SPS", line, surface.label)
        for name, word in zip(words[::2], (*words[1::2], ""), strict=False):
            value = self._text.number(word, f"coefficient {name[:20]} (SCO)", line, surface.label)
            plain = self._plain_name(each, name.upper())
            if plain is not None:
                each.values[plain] = value
            elif value:
                what = f"a special surface {each.kind} has no coefficient {name[:20]} (SCO)"
                raise self._text.error(what, line, surface.label)

    def _plain_name(self, each: _Read, name: str) -> str | None:
        """Name of a coefficient: K, NRADIUS, or the number of its power or term; None where the surface has none such."""
        if name in (_CONIC, _RADIUS):
            return name
        found = re.fullmatch(r"([A-Z]+)(\d{1,2})", name, re.ASCII)
        if found is None:
            return None
        letters, number = found[1], int(found[2])
        if each.kind == "ODD":
            if letters == "C":
                names = {1: _CONIC, 33: _RADIUS}
                return names.get(number) or (str(number - 1) if number - 1 <= _HIGHEST_POWER else None)
            return str(number) if letters == "AR" and 1 <= number <= _HIGHEST_POWER else None
        if letters == "C":
            return {1: _CONIC, 2: _RADIUS}.get(number) or (str(number - 3) if number >= 3 else None)
        if letters == each.kind[:2] and number % 2 == 0 and number >= 4:
            return str((number - 4) // 2)
        return None

    def _takes_curve(self, surface: DraftSurface, name: str, words: Sequence[str], line: int) -> bool:
        """Take the curve in x, and the terms of a biconic."""
        each = self._find(surface)
        if each is None or each.kind not in _CURVES or not words:
            return False
        if name == "RDX":
            radius = self._text.radius(words[0], "radius in x (RDX)", line, surface.label)
            each.values["CUX"] = 1 / radius if radius else 0.0
        elif name in ("CUX", "KX", "KY") or (each.kind == "AAS" and name in (*_RADIAL, *_ASYMMETRIC)):
            each.values[name] = self._text.number(words[0], f"value of {name}", line, surface.label)
        else:
            return False
        return True

    def _finish_odd(self, each: _Read) -> None:
        radius = each.values[_RADIUS] or 1.0  # 0 is not normalised
        if not radius > 0:
            raise self._error(each, f"the normalisation radius (NRADIUS) must be 0 or more, got {radius:g}")
        for name, value in each.values.items():
            if name.isdecimal():
                try:
                    each.surface.terms[int(name)] = value / radius ** int(name)
                except (OverflowError, ZeroDivisionError):
                    raise self._error(each, f"the normalisation radius of {radius:g} is out of reach") from None

    def _finish_forbes(self, each: _Read) -> None:
        terms = {int(name): value for name, value in each.values.items() if name.isdecimal() and value}
        if not terms:
            return
        if not each.values[_RADIUS] > 0:
            what = f"the normalisation radius (NRADIUS) must be above 0, got {each.values[_RADIUS]:g}"
            raise self._error(each, what)
        if max(terms) >= MOST_TERMS:
            raise self._error(each, f"at most {MOST_TERMS} Forbes terms are supported, got {max(terms) + 1}")
        coefficients = tuple(terms.get(m, 0.0) for m in range(max(terms) + 1))
        each.surface.forbes = ForbesTerms(_FORBES[each.kind], coefficients, each.values[_RADIUS])

    def _finish_curves(self, each: _Read) -> None:
        surface, curvature = each.surface, each.values.get("CUX", 0.0)
        radius = 1 / curvature if abs(curvature) > 1e-12 else 0.0
        if left := [name for name in _ASYMMETRIC if each.values.get(name)]:
            raise self._error(each, f"{left[0]} of a biconic must be 0: terms without symmetry are not supported")
        surface.conic = each.values.get("KY", surface.conic)
        if each.kind == "AAS":
            if "CUX" not in each.values:
                raise self._error(each, "a biconic (AAS) needs its radius in x (RDX) or curvature (CUX)")
            if any(surface.terms.values()):
                raise self._error(each, "a biconic (AAS) has the terms AR, BR, CR and DR, got others")
            surface.terms = {power: each.values.get(name, 0.0) for name, power in _RADIAL.items()}
            surface.across = radius, each.values.get("KX", 0.0)
        else:
            self._finish_torus(each, radius)

    def _finish_torus(self, each: _Read, radius: float) -> None:
        """Set the curve in x of a torus or cylinder; K and the terms are those of the curve that is turned."""
        surface, kind = each.surface, each.kind
        if each.values.get("KX"):
            raise self._error(each, f"KX of a cylinder or torus ({kind}) must be 0")
        if kind == "CYL" and radius and surface.radius:
            what = f"a cylinder (CYL) is straight one way, got the radii {surface.radius:g} and {radius:g}: a torus is YTO or XTO"
            raise self._error(each, what)
        if kind == "CYL" and radius and (surface.conic or any(surface.terms.values())):
            what = "K and aspheric terms of a cylinder (CYL) that is straight in y are not supported"
            raise self._error(each, f"{what}: those of its curve in x are read of a toroid (XTO)")
        lies = kind == "XTO"
        surface.torus = "across" if lies else "upright"
        surface.across, surface.conic = (radius, surface.conic if lies else 0.0), 0.0 if lies else surface.conic

    def _find(self, surface: DraftSurface) -> _Read | None:
        return self._read.get(id(surface))

    def _error(self, each: _Read, what: str) -> InputError:
        return self._text.error(what, each.line, each.surface.label)
