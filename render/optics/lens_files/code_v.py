"""Reads CODE V's sequence files, `.seq`.

    RDM; LEN                            radii are given; RDM N: curvatures
    TITLE 'Double Gauss F/2'
    EPD 25                              the entrance beam's diameter; or FNO, the f-number; or NA, in image space
    DIM M                               millimetres; C centimetres, I inches
    SO 0.0 0.1e14                       the object: radius and distance
    S 61.47 6.0 NBK7_SCHOTT             a surface: radius, thickness, glass (or a code such as 517642)
      STO; CIR 12.0                     it is the stop; half its clear diameter (`render.optics.lens_files.code_v_apertures`)
      ASP; K -1.0; A 1e-5; B 2e-8       conic constant, coefficients of r⁴, r⁶, ... (A to J, without I);
                                        `render.optics.lens_files.code_v_surfaces` has other surfaces
    SI 0.0 -0.4                         the image, and its shift
    GO

A command ends at `;` or at the end of its line, unless that ends in `&`; `!` begins a comment. What is not listed has no say
in how light goes through a lens, or is refused: mirrors, tilts, gratings, glass whose index varies within it.
`render.optics.lens_files.code_v_diffraction` has diffractive surfaces.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from render.model.lens import AIR, Glass, Prescription
from render.optics.lens_files.code_v_apertures import APERTURES, CodeVApertures
from render.optics.lens_files.code_v_diffraction import COMMANDS, CodeVDiffraction
from render.optics.lens_files.code_v_glass import PrivateGlasses
from render.optics.lens_files.code_v_surfaces import CodeVSurfaces
from render.optics.lens_files.code_v_zoom import CodeVZoom
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.drafts import Draft, check_glass, finish, is_object_near
from render.optics.lens_files.file_glasses import FileGlasses
from render.optics.lens_files.lens_text import LensText
from render.optics.lens_files.speed import SystemAperture, with_system_aperture

_UNITS_MM = {"M": 1.0, "MM": 1.0, "C": 10.0, "CM": 10.0, "I": 25.4, "IN": 25.4}
_POWERS = {letter: 4 + 2 * place for place, letter in enumerate("ABCDEFGHJ")}
_TILTS = ("XDE", "YDE", "ZDE", "ADE", "BDE", "CDE")
_APERTURES: dict[str, tuple[str, Literal["pupil", "f_number", "image_na"]]] = {
    "EPD": ("entrance pupil's diameter", "pupil"),
    "FNO": ("f-number", "f_number"),
    "NA": ("numerical aperture", "image_na"),
}
_UNSUPPORTED = ("GRT", "HOE", "GRX", "GRY")
_REFUSED = {
    "RMD": "mirrors",
    "GRN": "gradient-index glasses",
    "GRI": "gradient-index glasses",
    "URN": "gradient-index glasses",
    "SLN": "gradient-index glasses",
    "NSS": "non-sequential surfaces",
    "FRE": "Fresnel lenses",
    "BIR": "birefringent media",
}  # what it is, by the first three letters of its command
_TILT = "tilts and decentres"
_WORD = re.compile(r"'[^']*'?|\"[^\"]*\"?|;|[^\s;'\"]+")
_SURFACE = re.compile(r"S(\d{1,4}|O|I)?", re.ASCII)


@dataclass(frozen=True)
class _Command:
    line: int
    name: str
    words: tuple[str, ...]


def read_code_v(text: LensText, glasses: FileGlasses) -> Prescription:
    """The lens of a `.seq` file.

    Args:
        text: the file.
        glasses: finds those that the file names.

    Raises:
        InputError: the file is not of this format, is cut off, or has unsupported features.
    """
    reader = _Reader(text, glasses)
    for command in _commands(text):
        reader.take(command)
    return reader.finish()


def _commands(text: LensText) -> Iterator[_Command]:
    words: list[str] = []
    begin = 0
    for line, raw in enumerate(text.lines, 1):
        content = _without_comment(raw).rstrip()
        goes_on = content.endswith("&")
        for word in _WORD.findall(content.rstrip("&")):
            if word == ";":
                yield from _command(words, begin)
                words = []
            else:
                begin = begin if words else line
                words.append(word)
        if not goes_on:
            yield from _command(words, begin)
            words = []
    yield from _command(words, begin)


def _without_comment(line: str) -> str:
    return line if "'" in line or '"' in line else line.partition("!")[0]


def _command(words: Sequence[str], line: int) -> Iterator[_Command]:
    if words:
        yield _Command(line, words[0].upper(), tuple(words[1:]))


class _Reader:
    """Takes one command after the other."""

    def __init__(self, text: LensText, glasses: FileGlasses) -> None:
        self._text, self._glasses = text, glasses
        self._draft = Draft(text)
        self._has_radii: bool | None = None
        self._surfaces: list[DraftSurface] = []
        self._has_image = False
        self._aperture = SystemAperture()
        self._private = PrivateGlasses(text)
        self._zoom = CodeVZoom(text)
        self._apertures = CodeVApertures(text)
        self._special = CodeVSurfaces(text)
        self._diffraction = CodeVDiffraction(text)

    def take(self, command: _Command) -> None:
        """Read one command; unknown ones are ignored."""
        if self._private.takes(command.line, command.name, command.words):
            return
        if self._zoom.takes(command.line, command.name, command.words):
            return
        if _SURFACE.fullmatch(command.name):
            self._begin(command)
        elif command.name in (*_TILTS, *_UNSUPPORTED) or command.name[:3] in _REFUSED:
            self._refuse(command)
        elif command.name in _APERTURES:
            self._take_aperture(command)
        elif self._surfaces:
            self._of_surface(command)
        else:
            self._of_system(command)

    def finish(self) -> Prescription:
        """The lens between the object and the image."""
        if not self._has_image:
            raise self._text.error("it ends before the image surface (SI)")
        if len(self._surfaces) < 3:
            raise self._text.error("there is no surface (S) between the object (SO) and the image (SI)")
        self._special.finish()
        draft = self._draft
        self._diffraction.finish(draft.unit_mm)
        draft.surfaces = self._surfaces[1:-1]
        draft.notes += self._apertures.finish(draft.surfaces)
        self._zoom.finish(draft, self._surfaces)
        stated = self._zoom.first({"pupil": "EPD", "f_number": "FNO"}.get(self._aperture.kind, ""))
        aperture = self._aperture if stated is None else replace(self._aperture, value=stated)
        is_near = is_object_near(draft, self._surfaces[0].thickness, draft.surfaces)
        if is_near:
            draft.film_is_solved = True
            draft.notes.append("The file's object is near; the distance to the film is solved for with it at infinity.")
        else:
            draft.surfaces[-1].thickness += self._surfaces[-1].thickness
        if self._has_radii is None:
            draft.notes.append("The file does not say RDM, so its surfaces are taken to have curvatures, as in CODE V.")
        return with_system_aperture(finish(draft), aperture, draft.unit_mm, self._text, object_is_near=is_near)

    def _of_system(self, command: _Command) -> None:
        name, words, line = command.name[:3], command.words, command.line
        if name == "RDM":
            self._has_radii = not (words and words[0].upper().startswith("N"))
        elif name == "TIT" and words:
            self._draft.name = words[0].strip("'\" ")
        elif name == "DIM":
            unit = _first(words).upper()
            if unit not in _UNITS_MM:
                raise self._text.error(f"DIM must be M, C or I, got {unit or 'nothing'}", line)
            self._draft.unit_mm = _UNITS_MM[unit]

    def _take_aperture(self, command: _Command) -> None:
        what, kind = _APERTURES[command.name]
        value = self._text.number(_first(command.words), f"{what} ({command.name})", command.line, at_least=0)
        self._aperture = SystemAperture(kind, value, is_working=kind != "pupil")

    def _begin(self, command: _Command) -> None:
        line, words = command.line, command.words
        is_object, is_image = command.name in ("SO", "S0"), command.name == "SI"
        if is_object != (not self._surfaces):
            raise self._text.error("the surfaces must begin with the object's (SO), and have but one", line)
        if self._has_image:
            raise self._text.error("a surface stands behind the image (SI)", line)
        label = "O" if is_object else "I" if is_image else str(len(self._surfaces))
        surface = DraftSurface(label, line)
        self._surfaces.append(surface)
        self._has_image = is_image
        if self._has_radii:
            surface.radius = self._text.radius(_first(words), "radius", line, label)
        else:
            surface.radius = _inverse(self._text.number(_first(words), "curvature", line, label))
        surface.thickness = self._text.distance(words[1] if len(words) > 1 else "", "thickness", line, label)
        if len(words) > 2 and not (is_object or is_image):
            surface.glass = self._glass(words[2], line, label)

    def _of_surface(self, command: _Command) -> None:
        """A command about one surface: the last one that began, or the one that it names."""
        words = command.words
        named = words and _SURFACE.fullmatch(words[0].upper())
        surface = self._find(words[0].upper(), command.line) if named else self._surfaces[-1]
        if named:
            words = words[1:]
        name, line, label = command.name[:3], command.line, surface.label
        if self._special.takes(surface, command.name, words, line):
            return
        if name in _POWERS and words:
            surface.terms[_POWERS[name]] = self._text.number(words[0], f"coefficient {name}", line, label)
        elif name == "K" and words:
            surface.conic = self._text.number(words[0], "conic constant K", line, label)
        elif name == "STO":
            surface.is_stop = True
        elif name == "GLA":
            surface.glass = self._glass(_first(words), line, label)
        elif name in COMMANDS:
            self._diffraction.take(surface, name, words, line)
        elif name in APERTURES:
            self._apertures.take(name, surface, words, line)
        elif name in ("RDY", "CUY", "THI"):
            self._replace(surface, name, _first(words), line)

    def _replace(self, surface: DraftSurface, name: str, word: str, line: int) -> None:
        what = {"RDY": "radius (RDY)", "CUY": "curvature (CUY)", "THI": "thickness (THI)"}[name]
        if name == "THI":
            surface.thickness = self._text.distance(word, what, line, surface.label)
        elif name == "RDY":
            surface.radius = self._text.radius(word, what, line, surface.label)
        else:
            surface.radius = _inverse(self._text.number(word, what, line, surface.label))

    def _refuse(self, command: _Command) -> None:
        """Refuse unsupported commands. Tilts of 0 are accepted, and surfaces that refract."""
        named = [word.upper() for word in command.words if _SURFACE.fullmatch(word.upper())]
        label = self._surfaces[-1].label if self._surfaces else ""
        label = self._find(named[0], command.line).label if named else label
        words = [word for word in command.words if not _SURFACE.fullmatch(word.upper())]
        if command.name in _TILTS:
            if not any(self._text.number(word, f"tilt ({command.name})", command.line, label) for word in words):
                return
            raise self._text.error(f"{_TILT} ({command.name} {words[0]}) are not supported", command.line, label)
        if command.name == "RMD" and not (words and words[0].upper().startswith("REFL")):
            return
        what = _REFUSED.get(command.name[:3])
        raise self._text.error(
            f"{what} ({command.name}) are not supported" if what else f"{command.name} is not supported",
            command.line,
            label,
        )

    def _find(self, name: str, line: int) -> DraftSurface:
        number = {"SO": 0, "SI": len(self._surfaces) - 1, "S": len(self._surfaces) - 1}.get(name)
        number = int(name[1:]) if number is None else number
        if number >= len(self._surfaces):
            raise self._text.error(f"there is no surface {number}", line)
        return self._surfaces[number]

    def _glass(self, name: str, line: int, label: str) -> Glass:
        if name.upper() in ("", "AIR"):
            return AIR
        if name.upper().startswith("REFL"):
            raise self._text.error("mirrors (REFL) are not supported", line, label)
        plain = name.strip("'\"")
        glass = self._private.find(plain) or self._glasses.find(plain, line, label)
        return check_glass(self._text, glass, line, label)


def _inverse(curvature: float) -> float:
    return 1 / curvature if abs(curvature) > 1e-12 else 0.0


def _first(words: Sequence[str]) -> str:
    return words[0] if words else ""
