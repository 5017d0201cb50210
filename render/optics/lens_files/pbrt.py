"""Reads `.dat` files, as pbrt's realistic camera takes them: a row of four numbers for each surface.

    # D-GAUSS F/2 22deg HFOV
    29.475   3.76   1.67   25.2        radius, thickness, index behind, diameter: millimetres, front to rear
    0        4.5    0      17.1        the stop

Pharr, Jakob & Humphreys, Physically Based Rendering (4th ed. 2023), section 5.7.
"""

from __future__ import annotations

from render.model.lens import AIR, Glass, Prescription
from render.optics.lens_files.drafts import Draft, DraftSurface, check_glass, finish
from render.optics.lens_files.lens_text import LensText


def read_pbrt(text: LensText) -> Prescription:
    """The lens of a `.dat` file.

    A radius of 0 is the stop, unless the medium changes there: then it is a plane of glass.

    Args:
        text: the file.

    Raises:
        InputError: it is no such file, or no lens.
    """
    draft = Draft(text)
    for line, raw in enumerate(text.lines, 1):
        row, _, comment = raw.partition("#")
        if not row.strip():
            draft.name = draft.name or comment.strip()
            continue
        before = draft.surfaces[-1].glass if draft.surfaces else AIR
        draft.surfaces.append(_surface(text, row.split(), line, str(len(draft.surfaces) + 1), before))
    if not draft.surfaces:
        raise text.error("there is no surface in it: expected rows of radius, thickness, index and diameter")
    if draft.surfaces[-1].thickness != 0:
        draft.surfaces[-1].thickness = 0.0
        draft.notes.append("The distance behind the last surface is solved for, as in pbrt.")
    return finish(draft)


def _surface(text: LensText, row: list[str], line: int, label: str, before: Glass) -> DraftSurface:
    if len(row) != 4:
        raise text.error(f"a row has radius, thickness, index and diameter, got {len(row)} words", line, label)
    radius = text.radius(row[0], "radius", line, label)
    index = text.number(row[2], "refractive index", line, label)
    # pbrt's own files give the stop an index of 0, others 1.
    is_stop = radius == 0 and before == AIR and index in (0, 1)
    return DraftSurface(
        label,
        line,
        radius,
        text.number(row[1], "thickness", line, label),
        AIR if is_stop else check_glass(text, Glass(index), line, label),
        text.number(row[3], "diameter", line, label, at_least=0) / 2,
        is_stop=is_stop,
    )
