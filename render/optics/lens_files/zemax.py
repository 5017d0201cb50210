"""Reads Zemax's sequential `.zmx` files.

    UNIT MM X W X CM MR CPMM            or CM, IN, M
    GCAT SCHOTT OHARA                   catalogues, the first wins
    FNUM 2.1 0                          or ENPD, the entrance beam's diameter; FLOA: that of the stop's DIAM
    SURF 4                              0 is the object, the last one the image
      STOP
      TYPE EVENASPH                     or STANDARD; `zemax_cylinders` and `zemax_aspheres` have the others
      CURV 1.117818019226E-001 0 0 0 0 ""   1/radius
      PARM 2 1.10721E-5                 PARM i: coefficient of r^(2i)
      DISZ 4.25                         thickness
      GLAS N-BK7 0 0 1.5168 64.17 0 …   name, kind, pickup, n_d, V_d, ΔP_gF; kind 1 is a model glass without name, ___BLANK
      CONI 2.0E-2
      DIAM 5.58 1 0 0 1 ""              semi-diameter; CLAP and others: `render.optics.lens_files.zemax_apertures`

What is not listed has no say in how light goes through a lens, or is refused: other surface types, mirrors, tilts,
and non-sequential systems. A COORDBRK whose decentres and tilts are all 0 is left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from render.errors import InputError
from render.model.lens import AIR, Glass, Prescription
from render.optics.dispersion.model_glass import deviating_glass
from render.optics.lens_files import zemax_aspheres, zemax_cylinders
from render.optics.lens_files.configurations import Quantity, join_gaps
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.drafts import Draft, check_glass, finish, is_object_near
from render.optics.lens_files.file_glasses import FileGlasses
from render.optics.lens_files.lens_text import LensText
from render.optics.lens_files.speed import SystemAperture, with_system_aperture
from render.optics.lens_files.zemax_apertures import APERTURES, ZemaxApertures
from render.optics.lens_files.zemax_configurations import OPERANDS, SOLVES, ZemaxConfigurations, object_distance

_UNITS_MM = {"MM": 1.0, "CM": 10.0, "IN": 25.4, "INCH": 25.4, "INCHES": 25.4, "M": 1000.0, "METER": 1000.0}
_TYPES = ("STANDARD", "EVENASPH", *zemax_aspheres.TYPES, *zemax_cylinders.TYPES)
_PARAMETERS = tuple("12345678")
_REFUSED_TYPES = {
    "GRAD": "gradient-index glasses",
    "GRIN": "gradient-index glasses",
    "NONSEQ": "non-sequential components",
    "TILTSURF": "tilted surfaces",
    "IRREGULA": "tilts and decentres of a surface",
    "BIREFRIN": "birefringent media",
    "PARAXIAL": "ideal lenses without glass",
    "CHEB": "surfaces of Chebyshev polynomials",
}  # what it is, by the beginning of the type's name
_BREAK = "COORDBRK"
_TILTS = {"1": "decentre in x", "2": "decentre in y", "3": "tilt about x", "4": "tilt about y", "5": "tilt about z"}
_MODEL_GLASS = "___BLANK"
_MODEL_KIND = "1"
_LARGEST_DEVIATION = 0.1  # of glasses; KZFS has -0.01


def read_zemax(text: LensText, glasses: FileGlasses) -> Prescription:
    """The lens of a `.zmx` file.

    Args:
        text: the file.
        glasses: finds those that the file names.

    Raises:
        InputError: the file is not of this format, is cut off, or has unsupported features.
    """
    reader = _Reader(text, glasses)
    for line, raw in enumerate(text.lines, 1):
        command, *rest = raw.split(maxsplit=1) or [""]
        reader.take(command.upper(), " ".join(rest).split(), " ".join(rest).strip(), line)
    return reader.finish()


class _Reader:
    """Takes one line after the other."""

    def __init__(self, text: LensText, glasses: FileGlasses) -> None:
        self._text, self._glasses = text, glasses
        self._draft = Draft(text)
        self._surfaces: list[DraftSurface] = []
        self._aperture = SystemAperture()
        self._configurations = ZemaxConfigurations(text)
        self._floats_by_stop = False
        self._breaks: list[DraftSurface] = []
        self._two_curves = zemax_cylinders.TwoCurves(text)
        self._apertures = ZemaxApertures(text)
        self._aspheres = zemax_aspheres.ZemaxAspheres(text)
        self._is_asphere = False  # the surface that is being read
        self._of_system: dict[str, Callable[[list[str], str, int], None]] = {
            "MODE": self._mode,
            "NAME": self._name,
            "UNIT": self._unit,
            "GCAT": self._catalogues,
            "FNUM": self._f_number,
            "ENPD": self._pupil,
            "FLOA": self._float_by_stop,
            "SURF": self._begin,
        }
        self._of_surface: dict[str, Callable[[DraftSurface, Sequence[str], int], None]] = {
            "STOP": self._stop,
            "TYPE": self._type,
            "CURV": self._curvature,
            "DISZ": self._thickness,
            "GLAS": self._glass,
            "DIAM": self._semi_diameter,
            "CONI": self._conic,
            "PARM": self._parameter,
            "XDAT": self._extra_data,
        }

    def take(self, command: str, words: list[str], rest: str, line: int) -> None:
        """Read one line; unknown commands are ignored."""
        if command in self._of_system:
            self._of_system[command](words, rest, line)
        elif command in self._of_surface:
            if not self._surfaces:
                raise self._text.error(f"{command} stands before the first SURF", line)
            self._of_surface[command](self._surfaces[-1], words, line)
        elif command in APERTURES and self._surfaces:
            self._apertures.take(command, self._surfaces[-1], words, line)
        elif command == "MNUM":
            self._configurations.begin(words, line)
        elif command in OPERANDS:
            self._configurations.take(command, words, line)
        elif command in SOLVES and self._surfaces:
            self._configurations.solve(command, len(self._surfaces) - 1, words, line)

    def finish(self) -> Prescription:
        """The lens between the object and the image."""
        if len(self._surfaces) < 3:
            got = f"got {len(self._surfaces)}"
            raise self._text.error(f"expected SURF sections for the object, at least one surface and the image, {got}")
        self._two_curves.finish()
        self._aspheres.finish()
        self._draft.notes += self._apertures.finish(self._surfaces[1:-1])
        draft, image = self._draft, self._surfaces[-1]
        if image.glass != AIR or image.thickness:
            why = "the last one must be the image, without glass or thickness: the file is cut off"
            raise self._error(image, why, len(self._text.lines))
        aperture = SystemAperture() if self._floats_by_stop else self._aperture
        kinds: dict[str, Quantity] = {"pupil": "pupil_diameter", "f_number": "f_number"}
        value = self._configurations.finish(draft, self._surfaces, kinds.get(aperture.kind))
        draft.surfaces = self._without_breaks()
        if value is not None and aperture.kind != "stop":
            aperture = replace(aperture, value=value)
        distance = object_distance(draft.configurations)
        distance = self._surfaces[0].thickness if distance is None else distance
        is_near = is_object_near(draft, distance, draft.surfaces)
        if is_near:
            draft.film_is_solved = True
            draft.notes.append("The file's object is near; the distance to the film is solved for with it at infinity.")
        return with_system_aperture(finish(draft), aperture, draft.unit_mm, self._text, object_is_near=is_near)

    def _without_breaks(self) -> list[DraftSurface]:
        """The surfaces between object and image without breaks that do nothing; one that is the stop stays a plane."""
        kept = self._surfaces[:1]
        for surface in self._surfaces[1:-1]:
            is_break = any(surface is each for each in self._breaks)
            if is_break and not surface.is_stop:
                join_gaps(self._draft.configurations, kept[-1], surface)
                kept[-1].thickness += surface.thickness
                continue
            surface.glass = kept[-1].glass if is_break else surface.glass
            kept.append(surface)
        return kept[1:]

    def _mode(self, words: list[str], rest: str, line: int) -> None:
        if words and words[0].upper() != "SEQ":
            raise self._text.error(f"the MODE must be SEQ (sequential), got {words[0]}", line)

    def _name(self, words: list[str], rest: str, line: int) -> None:
        self._draft.name = rest.strip('"')

    def _unit(self, words: list[str], rest: str, line: int) -> None:
        unit = words[0].upper() if words else ""
        if unit not in _UNITS_MM:
            raise self._text.error(f"the UNIT must be one of {', '.join(_UNITS_MM)}, got {unit or 'nothing'}", line)
        self._draft.unit_mm = _UNITS_MM[unit]

    def _catalogues(self, words: list[str], rest: str, line: int) -> None:
        self._glasses.makers = tuple(words)

    def _f_number(self, words: list[str], rest: str, line: int) -> None:
        f_stop = self._text.number(_first(words), "f-number (FNUM)", line, at_least=0)
        self._aperture = SystemAperture("f_number", f_stop, is_working=words[1:2] == ["1"])

    def _pupil(self, words: list[str], rest: str, line: int) -> None:
        diameter = self._text.number(_first(words), "entrance pupil's diameter (ENPD)", line, at_least=0)
        self._aperture = SystemAperture("pupil", diameter)

    def _float_by_stop(self, words: list[str], rest: str, line: int) -> None:
        self._floats_by_stop = True

    def _begin(self, words: list[str], rest: str, line: int) -> None:
        thickness = 0.0 if self._surfaces else math.inf  # an object without a distance is far
        self._surfaces.append(DraftSurface(_first(words) or str(len(self._surfaces)), line, thickness=thickness))
        self._is_asphere = False

    def _stop(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        surface.is_stop = True

    def _type(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        self._is_asphere = False
        if _first(words).upper() == _BREAK:
            self._breaks.append(surface)
            return
        for begin, what in _REFUSED_TYPES.items():
            if _first(words).upper().startswith(begin):
                raise self._error(surface, f"{what} (TYPE {words[0][:20]}) are not supported", line)
        if zemax_aspheres.is_asphere(_first(words).upper()):
            self._aspheres.begin(surface, _first(words).upper(), line)
            return
        if _first(words).upper() not in _TYPES:
            kind = _first(words) or "nothing"
            raise self._error(surface, f"surfaces of TYPE {' and '.join(_TYPES)} are supported, got {kind}", line)
        self._is_asphere = _first(words).upper() == "EVENASPH"
        if _first(words).upper() in zemax_cylinders.TYPES:
            self._two_curves.begin(surface, _first(words).upper(), line)

    def _curvature(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        curvature = self._number(surface, _first(words), "curvature (CURV)", line)
        surface.radius = 1 / curvature if abs(curvature) > 1e-12 else 0.0

    def _thickness(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        word = _first(words)
        what = "distance of the object (DISZ)" if surface is self._surfaces[0] else "thickness (DISZ)"
        surface.thickness = self._text.distance(word, what, line, surface.label)

    def _semi_diameter(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        if surface is not self._surfaces[0]:
            what = "semi-diameter (DIAM)"
            surface.semi_diameter = self._text.number(_first(words), what, line, surface.label, at_least=0)

    def _conic(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        surface.conic = self._number(surface, _first(words), "conic constant (CONI)", line)

    def _parameter(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        if any(surface is each for each in self._breaks):
            self._break(surface, words, line)
            return
        if len(words) > 1 and self._two_curves.holds(surface):
            parameter = self._number(surface, words[1], f"parameter (PARM {words[0][:9]})", line)
            self._two_curves.take(surface, words[0], parameter)
            return
        if self._aspheres.holds(surface):
            self._aspheres.take(surface, "PARM", list(words), line)
            return
        if not self._is_asphere:  # a sphere has parameters without meaning
            return
        number, value = _first(words), words[1] if len(words) > 1 else ""
        if not number.isdecimal():
            raise self._error(surface, "PARM must be followed by its number and by its value", line)
        term = self._number(surface, value, f"parameter (PARM {number[:9]})", line)
        if number in _PARAMETERS:
            surface.terms[2 * int(number)] = term
        elif term:
            raise self._error(surface, f"PARM {number[:9]} must be 0: an even asphere has those from 1 to 8", line)

    def _extra_data(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        """Take extra data (XDAT), which spheres and even aspheres have left over from another type."""
        if self._aspheres.holds(surface):
            self._aspheres.take(surface, "XDAT", list(words), line)
        elif len(words) > 1 and self._two_curves.holds(surface):
            extra = self._number(surface, words[1], f"extra data (XDAT {words[0][:9]})", line)
            self._two_curves.take_extra(surface, words[0], extra)

    def _break(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        """Refuse a decentre (PARM 1 and 2) or a tilt (3 to 5)."""
        number, value = _first(words), words[1] if len(words) > 1 else ""
        if number in _TILTS and self._number(surface, value, f"{_TILTS[number]} (PARM {number})", line):
            what = f"{_TILTS[number]} of {value}"
            raise self._error(surface, f"decentres and tilts ({_BREAK}) are not supported, got a {what}", line)

    def _glass(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        name = _first(words)
        if name.upper() == "MIRROR":
            raise self._error(surface, "mirrors (GLAS MIRROR) are not supported", line)
        if name == _MODEL_GLASS or words[1:2] == [_MODEL_KIND]:
            surface.glass = self._model(surface, words, line)
            return
        # Numbers behind the name of a catalogue's glass are left over from another one, as files by OpticStudio show.
        glass = self._glasses.find(name, line, surface.label, lambda: self._described(surface, words, line))
        surface.glass = check_glass(self._text, glass, line, surface.label)

    def _model(self, surface: DraftSurface, words: Sequence[str], line: int) -> Glass:
        """The glass by index, Abbe number and deviation from the normal line."""
        described = self._described(surface, words, line)
        if described is None:
            raise self._error(surface, "a model glass has no index and Abbe number in the file", line)
        glass = check_glass(self._text, described, line, surface.label)
        deviation = self._number(surface, words[5], "deviation of P_gF", line) if len(words) > 5 else 0.0
        if abs(deviation) > _LARGEST_DEVIATION:
            limits = f"from {-_LARGEST_DEVIATION:g} to {_LARGEST_DEVIATION:g}"
            raise self._error(surface, f"the deviation of P_gF must be {limits}, got {deviation:g}", line)
        # 0 is what is written where nobody chose a deviation.
        return deviating_glass(glass, deviation) if deviation and glass.abbe else glass

    def _described(self, surface: DraftSurface, words: Sequence[str], line: int) -> Glass | None:
        """The glass by the index and the Abbe number that stand behind its name."""
        if len(words) < 5:
            return None
        index = self._number(surface, words[3], "refractive index", line)
        abbe = self._number(surface, words[4], "Abbe number", line)
        return Glass(index, abbe, name="" if words[0] == _MODEL_GLASS else words[0])

    def _number(self, surface: DraftSurface, word: str, what: str, line: int) -> float:
        return self._text.number(word, what, line, surface.label)

    def _error(self, surface: DraftSurface, what: str, line: int) -> InputError:
        return self._text.error(what, line, surface.label)


def _first(words: Sequence[str]) -> str:
    return words[0] if words else ""
