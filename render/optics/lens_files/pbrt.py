"""Reads `.dat` files, as pbrt's realistic camera and ISET take them: a row of four numbers for each surface.

    # D-GAUSS F/2 22deg HFOV
    29.475   3.76   1.67   25.2        radius, thickness, index behind, diameter: millimetres, front to rear
    0        4.5    0      17.1        the stop

ISET's have a row with the focal length in millimetres above. It is what their makers call the lens, and is not used.

Pharr, Jakob & Humphreys, Physically Based Rendering (4th ed. 2023), section 5.7.
"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from render.errors import InputError
from render.model.lens import AIR, Glass, Prescription
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.drafts import Draft, check_glass, finish
from render.optics.lens_files.lens_text import LensText
from render.optics.prescription.paraxial import focal_points, paraxial_system

_NOTICED = 0.02  # share of a focal length


def read_pbrt(text: LensText) -> Prescription:
    """The lens of a `.dat` file.

    A radius of 0 is the stop, unless the medium changes there: then it is a plane of glass.

    Args:
        text: the file.

    Raises:
        InputError: it is no such file, or no lens.
    """
    draft = Draft(text)
    stated = 0.0
    for line, raw in enumerate(text.lines, 1):
        row, _, comment = raw.partition("#")
        words = row.split()
        if not words:
            draft.name = draft.name or re.sub(r"^name:", "", comment.strip(), flags=re.IGNORECASE).strip()
        elif len(words) == 1 and not draft.surfaces and not stated:
            stated = text.number(words[0], "focal length", line, at_least=1e-6)
        else:
            before = draft.surfaces[-1].glass if draft.surfaces else AIR
            draft.surfaces.append(_surface(text, words, line, str(len(draft.surfaces) + 1), before))
    if not draft.surfaces:
        raise text.error("there is no surface in it: expected rows of radius, thickness, index and diameter")
    if draft.surfaces[-1].thickness != 0:
        draft.surfaces[-1].thickness = 0.0
        draft.notes.append("The distance behind the last surface is solved for, as in pbrt.")
    lens = finish(draft)
    return _with_stated_focal_length(lens, stated) if stated else lens


def _with_stated_focal_length(lens: Prescription, stated_mm: float) -> Prescription:
    """The lens with a note where its focal length is not the stated one."""
    try:
        with np.errstate(all="ignore"):
            focal_length_mm, _, _ = focal_points(paraxial_system(lens))
    except InputError:  # an impossible lens is refused elsewhere
        return lens
    if abs(focal_length_mm / stated_mm - 1) < _NOTICED:
        return lens
    note = f"The file says {stated_mm:.4g} mm; the focal length of its surfaces is {focal_length_mm:.4g} mm."
    return replace(lens, notes=(*lens.notes, note))


def _surface(text: LensText, row: list[str], line: int, label: str, before: Glass) -> DraftSurface:
    if len(row) != 4:
        raise text.error(f"a row has radius, thickness, index and diameter, got {len(row)} words", line, label)
    radius = text.radius(row[0], "radius", line, label)
    index = text.number(row[2], "refractive index", line, label)
    # pbrt's own files give the stop an index of 0, others 1; in a medium it is 0.
    is_stop = radius == 0 and (index == 0 or (before == AIR and index == 1))
    return DraftSurface(
        label,
        line,
        radius,
        text.number(row[1], "thickness", line, label),
        before if is_stop else check_glass(text, Glass(index), line, label),
        text.number(row[3], "diameter", line, label, at_least=0) / 2,
        is_stop=is_stop,
    )
