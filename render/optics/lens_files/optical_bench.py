"""Reads the `.txt` files of PhotonsToPhotos' Optical Bench, by William Claff; words are parted by tabs, lengths are millimetres.

    [descriptive data]
    title  US 2016/0070086 Example 1
    [constants]
    AsphericalOddCount  1               coefficients begin with r³; AsphericalA2: with r²; else with r⁴
    [variable distances]
    Focal Length  28  undefined         one column for each position of zoom and focus
    F-Number  1.4  undefined
    Magnification  0  -0.0433
    d10  9.20  8.15
    Bf  0.5  0.5
    [lens data]
    1  115.0  3.0  1.51633  38.74  64.21    surface, radius, thickness, n_d, diameter, V_d
    10  AS  d10    25.292               the aperture stop; FS is a field stop, CG the cover glass: both are planes
    [aspherical data]
    11  51.27  0  1.2e-6  …             surface, radius, K, coefficients

Of several positions the first is read. Where the file has the same zoom position at a nearer focus too, and one group alone moves
between the two, that group is the lens's focus group.
"""

from __future__ import annotations

from collections.abc import Sequence

from render.model.lens import AIR, Glass, Prescription
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.drafts import Draft, check_glass, finish
from render.optics.lens_files.file_glasses import FileGlasses
from render.optics.lens_files.lens_text import LensText
from render.optics.lens_files.optical_bench_positions import Positions

_PLANES = ("AS", "FS", "CG", "")
_SECTIONS = ("descriptive data", "constants", "variable distances", "lens data", "aspherical data")

Row = tuple[int, list[str]]  # line and words


def read_optical_bench(text: LensText, glasses: FileGlasses) -> Prescription:
    """The lens of an Optical Bench `.txt` file.

    Args:
        text: the file.
        glasses: finds those whose name stands behind the Abbe number.

    Raises:
        InputError: the file is not of this format, is cut off, or has unsupported features.
    """
    sections = _sections(text)
    positions = Positions(text, {words[0].lower(): (line, words[1:]) for line, words in sections["variable distances"]})
    draft = Draft(text, name=_title(sections["descriptive data"]), f_stop=positions.first("f-number") or 0.0)
    thickness_names: list[str] = []
    for line, words in sections["lens data"]:
        draft.surfaces.append(_surface(text, words, line, positions, glasses))
        thickness_names.append(_word(words, 2).lower())
    if not draft.surfaces:
        raise text.error("there is no surface in it: expected rows below [lens data]")
    _add_aspheres(draft, sections)
    _finish_focus(draft, positions, thickness_names)
    return finish(draft)


def _sections(text: LensText) -> dict[str, list[Row]]:
    found: dict[str, list[Row]] = {name: [] for name in _SECTIONS}
    rows: list[Row] = []
    for line, raw in enumerate(text.lines, 1):
        if not raw.strip() or raw.startswith("#"):
            continue
        if raw.lstrip().startswith("["):
            rows = found.setdefault(raw.strip().lower().strip("[]"), [])
        else:
            rows.append((line, [word.strip() for word in raw.split("\t")]))
    return found


def _title(rows: Sequence[Row]) -> str:
    return next((_word(words, 1) for _, words in rows if words[0].lower() == "title"), "")


def _word(words: Sequence[str], place: int) -> str:
    return words[place] if place < len(words) else ""


def _surface(
    text: LensText, words: Sequence[str], line: int, positions: Positions, glasses: FileGlasses
) -> DraftSurface:
    label, radius = words[0], _word(words, 1)
    if len(words) < 3:
        expected = "expected surface, radius and thickness, parted by tabs"
        raise text.error(f"{expected}; got {len(words)} words", line)
    is_plane = radius.upper() in _PLANES
    return DraftSurface(
        label,
        line,
        0.0 if is_plane else text.radius(radius, "radius", line, label),
        positions.length(words[2], "thickness", line, label) if words[2] else 0.0,
        _glass(text, words, line, label, glasses),
        abs(positions.length(_word(words, 4), "diameter", line, label)) / 2 if _word(words, 4) else 0.0,
        is_stop=radius.upper() == "AS",
    )


def _glass(text: LensText, words: Sequence[str], line: int, label: str, glasses: FileGlasses) -> Glass:
    if not _word(words, 3):
        return AIR
    index = text.number(words[3], "refractive index", line, label)
    abbe = text.number(words[5], "Abbe number", line, label) if _word(words, 5) else 0.0
    described = check_glass(text, Glass(index, abbe, name=_word(words, 6)), line, label)
    return glasses.agreeing(described)


def _add_aspheres(draft: Draft, sections: dict[str, list[Row]]) -> None:
    powers = _powers(draft.text, sections["constants"])
    by_label = {surface.label: surface for surface in draft.surfaces}
    for line, words in sections["aspherical data"]:
        surface = by_label.get(words[0])
        if surface is None:
            raise draft.text.error(f"[aspherical data] names surface {words[0]}, which [lens data] has not", line)
        if len(words) < 3:
            raise draft.text.error("expected surface, radius, K and coefficients", line, surface.label)
        surface.conic = draft.text.number(words[2], "conic constant K", line, surface.label) if words[2] else 0.0
        for power, word in zip(powers, words[3:], strict=False):
            if word:
                surface.terms[power] = draft.text.number(word, f"coefficient of r^{power}", line, surface.label)


def _powers(text: LensText, constants: Sequence[Row]) -> list[int]:
    """Which power of r each coefficient belongs to."""
    of_name = {words[0].lower(): (line, _word(words, 1)) for line, words in constants}
    if "asphericaloddcount" in of_name:
        line, word = of_name["asphericaloddcount"]
        if not (word.isdecimal() and len(word) <= 2):
            raise text.error(f"AsphericalOddCount must be a count, got {word or 'nothing'}", line)
        odd = [3 + 2 * place for place in range(int(word))]
        return sorted([*odd, *range(4, 60, 2)])
    return list(range(2 if "asphericala2" in of_name else 4, 60, 2))


def _finish_focus(draft: Draft, positions: Positions, thickness_names: Sequence[str]) -> None:
    """Set the last distance and the focusing group from the file's positions, and note which position was chosen."""
    last = draft.surfaces[-1]
    if positions.object_is_near() or last.thickness < 0:
        draft.film_is_solved = True
        draft.notes.append("The distance to the film is solved for, with the object at infinity.")
    draft.configurations = positions.configurations(draft.surfaces, thickness_names)
    group = positions.focus_group(thickness_names)
    if group is not None:
        draft.focus_group = draft.surfaces[group[0]], draft.surfaces[group[1]]
