"""Reads rayoptics' `.roa` files: JSON of its objects.

    optical_model.attributes
      system_spec.attributes          title, _dimensions (mm, cm, inches, ...)
      seq_model.attributes
        ifcs[i].attributes            the object, the surfaces, the image: interact_mode, profile or profile_id, clear_apertures,
                                      max_aperture
        gaps[i].attributes            thi and medium between two of them
        stop_surface                  index among the ifcs; null for a stop that floats
      profile_dict                    profiles by their id: cv (curvature), cc (conic constant) or ec = cc + 1, coefs
      optical_spec.attributes         pupil: what sets the beam; defocus: shift of the film

Mirrors, thin lenses, tilts and diffractive surfaces are refused.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np

from render.model.lens import AIR, Glass, Prescription
from render.optics.lens_files.code_v_glass import fit_indices
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.drafts import MAX_SURFACES, Draft, check_glass, finish, is_object_near
from render.optics.lens_files.file_glasses import FileGlasses
from render.optics.lens_files.json_text import JsonPart, read_json
from render.optics.lens_files.lens_text import LensText
from render.optics.lens_files.speed import SystemAperture, with_system_aperture

_UNITS_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "inch": 25.4, "inches": 25.4, "ft": 304.8, "feet": 304.8}
_UNSET_APERTURE = 1.0  # what rayoptics gives a surface before it computes clear diameters
_MOST_COEFFICIENTS = 40


def read_rayoptics(text: LensText, glasses: FileGlasses) -> Prescription:
    """The lens of a `.roa` file.

    Args:
        text: the file.
        glasses: finds those that the file names.

    Raises:
        InputError: the file is not of this format, or has unsupported features.
    """
    model = read_json(text).part("optical_model", "attributes")
    sequence = model.part("seq_model", "attributes")
    faces = sequence.entries("ifcs", at_most=MAX_SURFACES + 2)
    gaps = sequence.entries("gaps", at_most=MAX_SURFACES + 1)
    if len(faces) < 3 or len(gaps) != len(faces) - 1:
        raise text.error("expected an object, at least one surface and an image, and a gap between each two of them")
    system = model.part("system_spec", "attributes")
    draft = Draft(text, name=system.word("title"), unit_mm=_unit(system))
    profiles = model.part("profile_dict")
    stop = sequence.part("stop_surface")
    stop_index = int(sequence.number("stop_surface")) if stop else -1
    for index, (face, gap) in enumerate(zip(faces[1:-1], gaps[1:], strict=True), 1):
        draft.surfaces.append(_surface(text, face, gap, profiles, glasses, index))
        draft.surfaces[-1].is_stop = index == stop_index
    if any(surface.semi_diameter for surface in draft.surfaces):
        draft.notes.append("Clear diameters are those that rayoptics computed for its fields.")
    optics = model.part("optical_spec", "attributes")
    shift = optics.part("defocus", "attributes").number("focus_shift", 0.0)
    draft.surfaces[-1].thickness += shift
    is_near = is_object_near(draft, gaps[0].part("attributes").number("thi", math.inf, infinite=True), draft.surfaces)
    if is_near:
        draft.film_is_solved = True
        draft.notes.append("The file's object is near; the distance to the film is solved for with it at infinity.")
    aperture = _aperture(optics.part("pupil", "attributes"))
    return with_system_aperture(finish(draft), aperture, draft.unit_mm, text, object_is_near=is_near)


def _unit(system: JsonPart) -> float:
    name = system.word("_dimensions").lower() or "mm"
    if name not in _UNITS_MM:
        raise system.error(f"the unit must be one of {', '.join(_UNITS_MM)}, got {name}")
    return _UNITS_MM[name]


def _surface(
    text: LensText, face: JsonPart, gap: JsonPart, profiles: JsonPart, glasses: FileGlasses, index: int
) -> DraftSurface:
    label, kind, face = str(index), _kind(face), face.part("attributes")
    surface = DraftSurface(label, 0, thickness=gap.part("attributes").number("thi", infinite=True))
    if kind == "ThinLens":
        raise face.error("ideal lenses without glass (ThinLens) are not supported", label)
    if face.word("interact_mode") == "reflect":
        raise face.error("mirrors (reflect) are not supported", label)
    if face.part("decenter"):
        raise face.error("tilts and decentres (decenter) are not supported", label)
    if face.part("phase_element"):
        raise face.error("diffractive surfaces (phase_element) are not supported", label)
    own = face.part("profile")
    _shape(surface, own if own else profiles.part(face.word("profile_id")), label)
    surface.semi_diameter = _clear(face, label)
    surface.glass = check_glass(text, _medium(gap.part("attributes", "medium"), glasses, label), 0, label)
    return surface


def _kind(part: JsonPart) -> str:
    return (part.words("__instance_type__") or [""])[-1]


def _shape(surface: DraftSurface, profile: JsonPart, label: str) -> None:
    kind, numbers = _kind(profile), profile.part("attributes")
    powers: dict[str, Callable[[int], int]] = {
        "Spherical": lambda i: 0,
        "Conic": lambda i: 0,
        "EvenPolynomial": lambda i: 2 * i + 2,
        "RadialPolynomial": lambda i: i + 1,
    }
    if kind not in powers:
        raise profile.error(f"surfaces of profile {', '.join(powers)} are supported, got {kind or 'none'}", label)
    curvature = numbers.number("cv", 0.0)
    surface.radius = 1 / curvature if abs(curvature) > 1e-12 else 0.0
    if kind != "Spherical":
        surface.conic = numbers.number("ec", 1 + numbers.number("cc", 0.0)) - 1
    if powers[kind](1):
        values = numbers.numbers("coefs", at_most=_MOST_COEFFICIENTS)
        surface.terms = {powers[kind](i): value for i, value in enumerate(values) if value}


def _clear(face: JsonPart, label: str) -> float:
    """Half of the clear diameter; 0 where it is unknown."""
    for aperture in face.entries("clear_apertures", at_most=MAX_SURFACES):
        if _kind(aperture) != "Circular":
            raise aperture.error(f"clear apertures of the kind {_kind(aperture) or 'none'} are not supported", label)
        numbers = aperture.part("attributes")
        if numbers.number("x_offset", 0.0) or numbers.number("y_offset", 0.0):
            raise aperture.error("clear apertures beside the axis are not supported", label)
        return abs(numbers.number("radius", 0.0))
    computed = face.number("max_aperture", 0.0)
    return 0.0 if computed == _UNSET_APERTURE else abs(computed)


def _medium(medium: JsonPart, glasses: FileGlasses, label: str) -> Glass:
    kind, numbers = _kind(medium), medium.part("attributes")
    if kind in ("", "Air"):
        return AIR
    name = numbers.word("gname") or numbers.word("label")
    if numbers.part("gname"):
        glasses.makers = (re.sub(r"Glass$", "", kind),)
        return glasses.find(name, 0, label)
    if numbers.part("n") and kind in ("ModelGlass", "Glass", "Medium", "ConstantIndex"):
        return glasses.agreeing(Glass(numbers.number("n"), numbers.number("v", 0.0), name=name))
    if kind == "InterpolatedMedium":
        values = [numbers.numbers(key, at_most=_MOST_COEFFICIENTS) for key in ("wvls", "rndx")]
        if not values[0] or len(values[0]) != len(values[1]) or len(set(values[0])) != len(values[0]):
            raise medium.error("expected one index (rndx) for each of its wavelengths (wvls)", label)
        if min(values[0]) < 100 or max(values[0]) > 1e5:
            raise medium.error("its wavelengths (wvls) must be from 100 to 100000 nm", label)
        return fit_indices(name, np.array(values[0]), np.array(values[1]))
    raise medium.error(f"media of the kind {kind} are not supported", label)


def _aperture(pupil: JsonPart) -> SystemAperture:
    key = pupil.words("_key") or pupil.words("key")
    value = pupil.number("value", 0.0)
    if key[-2:] == ["object", "epd"] or key[-2:] == ["object", "pupil"]:
        return SystemAperture("pupil", value)
    if key[-2:] == ["image", "f/#"]:
        return SystemAperture("f_number", value, is_working=True)
    if key[-2:] == ["image", "NA"]:
        return SystemAperture("image_na", value, is_working=True)
    return SystemAperture()
