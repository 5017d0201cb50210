"""Reads Zemax's sequential `.zmx` files.

    UNIT MM X W X CM MR CPMM            or CM, IN, M
    FNUM 2.1 0                          or ENPD, the entrance beam's diameter; FLOA: that of the stop's DIAM
    SURF 4                              0 is the object, the last one the image
      STOP
      TYPE EVENASPH                     or STANDARD
      CURV 1.117818019226E-001 0 0 0 0 ""   1/radius
      PARM 2 1.10721E-5                 PARM i: coefficient of r^(2i)
      DISZ 4.25                         thickness
      GLAS N-BK7 0 0 1.5168 64.17 0 …   name, kind, catalogue, n_d, V_d; kind 1 is a model glass without name, ___BLANK
      CONI 2.0E-2
      DIAM 5.58 1 0 0 1 ""              semi-diameter

What is not listed has no say in how light goes through a lens, or is refused: other surface types, mirrors, and
non-sequential systems. Of several configurations the first is read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from render.errors import InputError
from render.model.lens import AIR, Glass, Prescription
from render.optics.lens_files.drafts import FAR_AWAY_MM, Draft, DraftSurface, check_glass, finish
from render.optics.lens_files.glass_names import find_glass
from render.optics.lens_files.lens_text import LensText
from render.optics.lens_files.speed import SystemAperture, with_system_aperture

_UNITS_MM = {"MM": 1.0, "CM": 10.0, "IN": 25.4, "INCH": 25.4, "INCHES": 25.4, "M": 1000.0, "METER": 1000.0}
_TYPES = ("STANDARD", "EVENASPH")
_PARAMETERS = tuple("12345678")
_MODEL_GLASS = "___BLANK"
# Placeholder behind the name of a catalogue glass: not its own index, as files written by OpticStudio show.
_NO_INDEX = (1.5, 40.0)


def read_zemax(text: LensText) -> Prescription:
    """The lens of a `.zmx` file.

    Args:
        text: the file.

    Raises:
        InputError: the file is not of this format, is cut off, or has unsupported features.
    """
    reader = _Reader(text)
    for line, raw in enumerate(text.lines, 1):
        command, _, rest = raw.strip().partition(" ")
        reader.take(command.upper(), rest.split(), rest.strip(), line)
    return reader.finish()


class _Reader:
    """Takes one line after the other."""

    def __init__(self, text: LensText) -> None:
        self._text = text
        self._draft = Draft(text)
        self._surfaces: list[DraftSurface] = []
        self._aperture = SystemAperture()
        self._floats_by_stop = False
        self._object_is_far = True
        self._is_asphere = False  # the surface that is being read
        self._of_system: dict[str, Callable[[list[str], str, int], None]] = {
            "MODE": self._mode,
            "NAME": self._name,
            "UNIT": self._unit,
            "FNUM": self._f_number,
            "ENPD": self._pupil,
            "FLOA": self._float_by_stop,
            "MNUM": self._configurations,
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
        }

    def take(self, command: str, words: list[str], rest: str, line: int) -> None:
        """Read one line; unknown commands are ignored."""
        if command in self._of_system:
            self._of_system[command](words, rest, line)
        elif command in self._of_surface:
            if not self._surfaces:
                raise self._text.error(f"{command} stands before the first SURF", line)
            self._of_surface[command](self._surfaces[-1], words, line)

    def finish(self) -> Prescription:
        """The lens between the object and the image."""
        if len(self._surfaces) < 3:
            got = f"got {len(self._surfaces)}"
            raise self._text.error(f"expected SURF sections for the object, at least one surface and the image, {got}")
        draft, image = self._draft, self._surfaces[-1]
        if image.glass != AIR or image.thickness:
            why = "the last one must be the image, without glass or thickness: the file is cut off"
            raise self._error(image, why, len(self._text.lines))
        draft.surfaces = self._surfaces[1:-1]
        if not self._object_is_far:
            draft.surfaces[-1].thickness = 0.0
            draft.notes.append("The file's object is near; the distance to the film is solved for with it at infinity.")
        aperture = SystemAperture() if self._floats_by_stop else self._aperture
        return with_system_aperture(
            finish(draft), aperture, draft.unit_mm, self._text, object_is_near=not self._object_is_far
        )

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

    def _f_number(self, words: list[str], rest: str, line: int) -> None:
        f_stop = self._text.number(_first(words), "f-number (FNUM)", line, at_least=0)
        self._aperture = SystemAperture("f_number", f_stop, is_working=words[1:2] == ["1"])

    def _pupil(self, words: list[str], rest: str, line: int) -> None:
        diameter = self._text.number(_first(words), "entrance pupil's diameter (ENPD)", line, at_least=0)
        self._aperture = SystemAperture("pupil", diameter)

    def _float_by_stop(self, words: list[str], rest: str, line: int) -> None:
        self._floats_by_stop = True

    def _configurations(self, words: list[str], rest: str, line: int) -> None:
        if words and words[0].isdecimal() and words[0] not in ("0", "1"):
            self._draft.notes.append(f"Of the file's {words[0]} configurations the first is used.")

    def _begin(self, words: list[str], rest: str, line: int) -> None:
        self._surfaces.append(DraftSurface(_first(words) or str(len(self._surfaces)), line))
        self._is_asphere = False

    def _stop(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        surface.is_stop = True

    def _type(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        if _first(words).upper() not in _TYPES:
            kind = _first(words) or "nothing"
            raise self._error(surface, f"surfaces of TYPE {' and '.join(_TYPES)} are supported, got {kind}", line)
        self._is_asphere = _first(words).upper() == "EVENASPH"

    def _curvature(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        curvature = self._number(surface, _first(words), "curvature (CURV)", line)
        surface.radius = 1 / curvature if abs(curvature) > 1e-12 else 0.0

    def _thickness(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        word = _first(words)
        if surface is self._surfaces[0]:  # the object's distance
            is_infinite = word.upper().startswith("INF")
            distance = 0.0 if is_infinite else self._number(surface, word, "distance of the object (DISZ)", line)
            self._object_is_far = is_infinite or distance * self._draft.unit_mm >= FAR_AWAY_MM
        else:
            surface.thickness = self._number(surface, word, "thickness (DISZ)", line)

    def _semi_diameter(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        if surface is not self._surfaces[0]:
            what = "semi-diameter (DIAM)"
            surface.semi_diameter = self._text.number(_first(words), what, line, surface.label, at_least=0)

    def _conic(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        surface.conic = self._number(surface, _first(words), "conic constant (CONI)", line)

    def _parameter(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        if not self._is_asphere:  # a sphere has parameters without meaning
            return
        if len(words) < 2 or words[0] not in _PARAMETERS:
            raise self._error(surface, "PARM must be followed by a number from 1 to 8 and by its value", line)
        surface.terms[2 * int(words[0])] = self._number(surface, words[1], f"parameter (PARM {words[0]})", line)

    def _glass(self, surface: DraftSurface, words: Sequence[str], line: int) -> None:
        name = _first(words)
        if name.upper() == "MIRROR":
            raise self._error(surface, "mirrors are not supported", line)
        known = None if name == _MODEL_GLASS else find_glass(name)
        surface.glass = check_glass(self._text, known or self._model(surface, words, line), line, surface.label)

    def _model(self, surface: DraftSurface, words: Sequence[str], line: int) -> Glass:
        """The glass by the index and the Abbe number that stand behind its name."""
        name = _first(words)
        numbers = words[3:5]
        if len(numbers) == 2:
            index, abbe = (
                self._number(surface, word, what, line)
                for word, what in zip(numbers, ("refractive index", "Abbe number"), strict=True)
            )
            if name == _MODEL_GLASS or (index, abbe) != _NO_INDEX:
                return Glass(index, abbe, name="" if name == _MODEL_GLASS else name)
        raise self._error(surface, f"glass {name or 'without name'} is not known, and has no index in the file", line)

    def _number(self, surface: DraftSurface, word: str, what: str, line: int) -> float:
        return self._text.number(word, what, line, surface.label)

    def _error(self, surface: DraftSurface, what: str, line: int) -> InputError:
        return self._text.error(what, line, surface.label)


def _first(words: Sequence[str]) -> str:
    return words[0] if words else ""
