"""Reads optiland's `.json` files, of `Optic.to_dict`; lengths are millimetres.

    name
    aperture                          type EPD, imageFNO, objectNA or float_by_stop_size; value
    surface_group.surfaces[i]         the object, the surfaces, the image
      geometry                        type, radius, conic, coefficients, cs (place and tilts)
      thickness                       to the next; files of older versions have places (cs.z) alone
      material_post                   the medium behind it: IdealMaterial, AbbeMaterial, Material (a name and its maker)
      is_stop, aperture               clear radius r_max
      interaction_model               is_reflective

`render.optics.lens_files.optiland_shapes` has the geometries. Mirrors, tilts and other geometries are refused.
"""

from __future__ import annotations

import math

from render.model.lens import AIR, Glass, Prescription
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.drafts import MAX_SURFACES, Draft, check_glass, finish, is_object_near
from render.optics.lens_files.file_glasses import FileGlasses
from render.optics.lens_files.json_text import JsonPart, read_json
from render.optics.lens_files.lens_text import LensText
from render.optics.lens_files.optiland_shapes import TYPES, set_shape
from render.optics.lens_files.speed import SystemAperture, with_system_aperture

_OFFSETS = ("x", "y", "rx", "ry")


def read_optiland(text: LensText, glasses: FileGlasses) -> Prescription:
    """The lens of a file of optiland.

    Args:
        text: the file.
        glasses: finds those that the file names.

    Raises:
        InputError: the file is not of this format, or has unsupported features.
    """
    whole = read_json(text)
    parts = whole.part("surface_group").entries("surfaces", at_most=MAX_SURFACES + 2)
    if len(parts) < 3:
        raise text.error("expected an object, at least one surface and an image (surface_group.surfaces)")
    draft = Draft(text, name=whole.word("name"))
    places = [part.part("geometry", "cs").number("z", 0.0, infinite=True) for part in parts]
    for index, part in enumerate(parts[1:-1], 1):
        surface = _surface(text, part, places[index + 1] - places[index], glasses, str(index))
        behind = set_shape(part.part("geometry"), surface)
        if draft.surfaces:
            draft.surfaces[-1].thickness += behind
        surface.thickness -= behind
        draft.surfaces.append(surface)
    _check_image(parts[-1], str(len(parts) - 1))
    distance = parts[0].number("thickness", places[1] - places[0], infinite=True)
    is_near = is_object_near(draft, distance, draft.surfaces)
    if is_near:
        draft.film_is_solved = True
        draft.notes.append("The file's object is near; the distance to the film is solved for with it at infinity.")
    aperture = _aperture(whole.part("aperture"), draft)
    return with_system_aperture(finish(draft), aperture, 1.0, text, object_is_near=is_near)


def _surface(text: LensText, part: JsonPart, gap: float, glasses: FileGlasses, label: str) -> DraftSurface:
    geometry = part.part("geometry")
    kind = geometry.word("type")
    if kind not in TYPES:
        raise geometry.error(f"surfaces of type {', '.join(TYPES)} are supported, got {kind[:40] or 'none'}", label)
    if part.flag("is_reflective") or part.part("interaction_model").flag("is_reflective"):
        raise part.error("mirrors (is_reflective) are not supported", label)
    if (model := part.part("interaction_model").word("type")) not in ("", "RefractiveReflectiveModel"):
        raise part.error(f"surfaces that refract are supported, got {model[:40]}", label)
    _check_axis(geometry.part("cs"), label)
    return DraftSurface(
        label,
        0,
        thickness=part.number("thickness", gap, infinite=True),
        glass=check_glass(text, _medium(part.part("material_post"), glasses, label), 0, label),
        semi_diameter=_clear(part.part("aperture"), label),
        is_stop=part.flag("is_stop"),
    )


def _check_axis(place: JsonPart, label: str) -> None:
    for name in _OFFSETS:
        if place.number(name, 0.0):
            raise place.error(f"tilts and decentres ({name}) are not supported", label)


def _check_image(image: JsonPart, label: str) -> None:
    _check_axis(image.part("geometry", "cs"), label)


def _medium(material: JsonPart, glasses: FileGlasses, label: str) -> Glass:
    kind = material.word("type")
    if kind == "Material":
        glasses.makers = tuple(word for word in (material.word("reference"), material.word("catalog")) if word)
        return glasses.find(material.word("name"), 0, label)
    if kind in ("IdealMaterial", "AbbeMaterial"):
        index, abbe = material.number("index"), material.number("abbe", 0.0)
        return AIR if index == 1 else Glass(index, abbe if kind == "AbbeMaterial" else 0.0)
    raise material.error(
        f"media of the types IdealMaterial, AbbeMaterial and Material are supported, got {kind[:40] or 'none'}", label
    )


def _clear(aperture: JsonPart, label: str) -> float:
    """Half of the clear diameter; 0 where it is unknown."""
    if not aperture:
        return 0.0
    if aperture.word("type") != "RadialAperture":
        raise aperture.error(f"apertures of type RadialAperture are supported, got {aperture.word('type')[:40]}", label)
    if aperture.number("r_min", 0.0) > 0:
        raise aperture.error("obscurations (r_min) are not supported", label)
    widest = aperture.number("r_max", math.inf, infinite=True)
    return 0.0 if math.isinf(widest) else abs(widest)


def _aperture(aperture: JsonPart, draft: Draft) -> SystemAperture:
    kind, value = aperture.word("type") or aperture.word("ap_type"), aperture.number("value", 0.0)
    if kind == "EPD":
        return SystemAperture("pupil", value)
    if kind == "imageFNO":
        return SystemAperture("f_number", value)
    for surface in draft.surfaces:  # the value is the stop's diameter
        if kind == "float_by_stop_size" and surface.is_stop:
            surface.semi_diameter = value / 2
    return SystemAperture()
