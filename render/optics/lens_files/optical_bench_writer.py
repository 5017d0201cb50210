"""Writes the `.txt` files of the Optical Bench; `render.optics.lens_files.optical_bench` describes them."""

from __future__ import annotations

from render.errors import SettingsError
from render.model.lens import Glass, Prescription, Surface
from render.optics.lens_files.written_parts import glass_form, index_change, number, unwritable_surface
from render.optics.prescription.focusing import FocusedLens, focus_lens
from render.optics.prescription.paraxial import first_order

_NEAR = (20.0, 50.0, 200.0)  # focus distances of the second position, in focal lengths; the first that is reached
_LEAST_MOVE_MM = 0.02  # patents round to a hundredth, and readers to half of it


def optical_bench_text(lens: Prescription, notes: list[str]) -> str:
    """The text of an Optical Bench file.

    Args:
        lens: complete, with a plain name.
        notes: takes what the format cannot say.

    Raises:
        SettingsError: it has cylinders or diffractive surfaces.
    """
    for index, surface in enumerate(lens.surfaces):
        if surface.across is not None:
            raise unwritable_surface(index, lens, "another curve from side to side", ".zmx or .seq")
        if surface.phase:
            raise unwritable_surface(index, lens, "diffraction", ".zmx or .seq")
    near = _near(lens, notes)
    moving = _moving(lens, near)
    rows = [row for index in range(len(lens.surfaces)) for row in _rows(lens, index, moving, notes)]
    odd = max(len(surface.odd) for surface in lens.surfaces)
    aspheric = [
        "\t".join(
            [
                str(index),
                number(s.radius_mm) if s.radius_mm else "Infinity",
                number(s.conic),
                *map(number, _terms(s, odd)),
            ]
        )
        for index, s in enumerate(lens.surfaces, 1)
        if s.conic or s.is_aspheric
    ]
    lines = [
        "[descriptive data]",
        f"title\t{lens.name}",
        "[constants]",
        *([f"AsphericalOddCount\t{odd}"] if odd else []),
        "[variable distances]",
        *_positions(lens, near, moving),
        "[lens data]",
        *rows,
        *(["[aspherical data]", *aspheric] if aspheric else []),
    ]
    return "\n".join(lines) + "\n"


def _terms(surface: Surface, odd: int) -> list[float]:
    """Coefficients by rising power: those from r⁴ on, and the given number of odd powers from r³ on among them."""
    terms = surface.aspheric_terms
    powers = sorted([*range(3, 3 + 2 * odd, 2), *range(4, max(2 * odd, *terms, 2) + 1, 2)])
    return [terms.get(power, 0.0) for power in powers]


def _near(lens: Prescription, notes: list[str]) -> FocusedLens | None:
    """The lens focused near by its group; None where the whole lens moves, or the group does not fit the format."""
    if lens.focus_group is None:
        return None
    focal_length_m = first_order(lens).focal_length_mm / 1000
    for distance in _NEAR if lens.focus_group[0] > 0 else ():
        try:
            focused = focus_lens(lens, distance * focal_length_m, lens.f_stop, by="paraxial")
        except SettingsError:
            continue
        if len(_moving(lens, focused)) == 2:
            return focused
    notes.append("The group that moves to focus is not written.")
    return None


def _moving(lens: Prescription, near: FocusedLens | None) -> list[int]:
    """Indices of the surfaces behind which the distance changes."""
    if near is None:
        return []
    pairs = zip(lens.surfaces, near.prescription.surfaces, strict=True)
    return [i for i, (far, close) in enumerate(pairs) if abs(far.thickness_mm - close.thickness_mm) > _LEAST_MOVE_MM]


def _positions(lens: Prescription, near: FocusedLens | None, moving: list[int]) -> list[str]:
    last, last_surface = len(lens.surfaces), lens.surfaces[-1]
    rows = [["Focal Length", number(first_order(lens).focal_length_mm)], ["F-Number", number(lens.f_stop)]]
    if near is not None:
        rows[0].append(rows[0][1])
        rows[1].append("undefined")
        distance_mm = 1 / near.nearness_per_mm
        rows.append(["Magnification", "0", number(-near.image_scale_mm / distance_mm)])
        rows.append(["d0", "Infinity", number(distance_mm - near.entrance_pupil_mm)])
        for i in moving:
            if i + 1 != last:
                thicknesses = lens.surfaces[i].thickness_mm, near.prescription.surfaces[i].thickness_mm
                rows.append([f"d{i + 1}", *map(number, thicknesses)])
    film = [number(last_surface.thickness_mm)]
    if near is not None:
        film.append(number(near.prescription.surfaces[-1].thickness_mm))
    rows.append(["Bf", *film])
    return ["\t".join(row) for row in rows]


def _rows(lens: Prescription, index: int, moving: list[int], notes: list[str]) -> list[str]:
    surface, label = lens.surfaces[index], str(index + 1)
    diameter = number(2 * surface.semi_diameter_mm)
    thickness = f"d{label}" if index in moving else number(surface.thickness_mm)
    thickness = "Bf" if index + 1 == len(lens.surfaces) else thickness
    before = lens.surfaces[index - 1].glass if index else Glass()
    is_iris = surface.is_stop and _is_window(surface, before)
    radius = "AS" if is_iris else number(surface.radius_mm) if surface.radius_mm else "Infinity"
    rows = []
    if surface.is_stop and not is_iris:
        rows.append("\t".join(["S", "AS", "0", *_glass(index - 1, before, diameter, notes)]))
        notes.append(f"The stop, surface {label}, is glass; it is written as a plane before it.")
    rows.append("\t".join([label, radius, thickness, *_glass(index, surface.glass, diameter, notes)]))
    return rows


def _is_window(surface: Surface, before: Glass) -> bool:
    return surface.radius_mm == 0 and not any(surface.aspheric_terms.values()) and surface.glass == before == Glass()


def _glass(index: int, glass: Glass, diameter: str, notes: list[str]) -> list[str]:
    form = glass_form(glass)
    if form.kind == "air":
        return ["", diameter]
    if form.kind == "own":
        notes.append(
            f"Glass {glass.name or 'without name'} of surface {index + 1} is written by n_d and V_d: its index changes by"
            f" up to {index_change(glass):.1g}."
        )
    name = glass.name if form.kind == "catalogue" else ""
    return [number(glass.index), diameter, number(glass.abbe), name]
