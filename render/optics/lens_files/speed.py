"""The system aperture of a lens file: what sets the beam that enters, as lens-design programs have it.

A program launches the beam that its aperture states and sizes the iris to it; a clear diameter, that of the iris too, can only
cut the beam. Where the iris itself is the aperture ("float by stop size"), its clear diameter is the beam's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from render.errors import InputError
from render.model.lens import Configuration, Prescription
from render.optics.lens_files.lens_text import LensText
from render.optics.prescription.paraxial import focal_points, paraxial_system


@dataclass(frozen=True)
class SystemAperture:
    """Aperture that a file states.

    Attributes:
        kind: diameter of the entrance beam, f-number or numerical aperture in image space, or the stop's own clear diameter.
        value: a diameter in the file's unit; 0 where the file gives none.
        is_working: whether it is that of the cone from the file's object, near or far.
    """

    kind: Literal["stop", "pupil", "f_number", "image_na"] = "stop"
    value: float = 0.0
    is_working: bool = False


def with_system_aperture(
    lens: Prescription, aperture: SystemAperture, unit_mm: float, text: LensText, *, object_is_near: bool
) -> Prescription:
    """The lens with its f-number wide open; unknown where the file gives none, or where the stop's diameter has to tell it.

    Args:
        lens: as read.
        aperture: of the file.
        unit_mm: the file's unit of length.
        text: the file.
        object_is_near: whether the file's object is; then a working f-number is taken for that at infinity, and a note says so.

    Raises:
        InputError: the lens has no focal length.
    """
    if aperture.kind == "stop" or aperture.value <= 0:
        return lens
    if aperture.is_working and object_is_near:
        note = "The file's f-number is that of its near object; it is taken for the one at infinity."
        lens = replace(lens, notes=(*lens.notes, note))
    if aperture.kind == "f_number":
        return replace(lens, f_stop=aperture.value)
    if aperture.kind == "image_na":
        return replace(lens, f_stop=1 / (2 * aperture.value))
    try:
        with np.errstate(all="ignore"):  # numbers beyond all measure are refused below
            focal_length_mm, _, _ = focal_points(paraxial_system(lens))
    except InputError as error:
        raise text.error(error.detail) from error
    f_stop = abs(focal_length_mm) / (aperture.value * unit_mm)
    if not (math.isfinite(f_stop) and f_stop > 0):
        raise text.error("the lens has no focal length, its numbers are beyond all measure")
    return replace(lens, f_stop=f_stop, configurations=_of_beam(lens, aperture.value * unit_mm))


def _of_beam(lens: Prescription, diameter_mm: float) -> tuple[Configuration, ...]:
    """Configurations of a lens with f-numbers, where they are not stated, of a beam of one diameter."""
    found = []
    for each in lens.configurations:
        placed = [replace(s, thickness_mm=t) for s, t in zip(lens.surfaces, each.thicknesses_mm, strict=True)]
        focal_length_mm, _, _ = focal_points(paraxial_system(replace(lens, surfaces=tuple(placed))), lens.name)
        found.append(replace(each, f_stop=each.f_stop or abs(focal_length_mm) / diameter_mm))
    return tuple(found)
