"""The lens library: every lens with families, year and source, what the source states, and how that is checked."""

from __future__ import annotations

from docs._site.markdown import plain, table
from usd_schemas import LibraryLens, library_lenses
from usd_schemas.lens_search import FAMILIES

INTRODUCTION = """# Lens library

`usd_schemas/libraries/lenses.usda` has these lenses. Numbers of patents are facts; each lens names its source. The year is
that in which the patent was granted or laid open, else that of the publication. What the source states of focal length,
f-number and full field is for the size that the lens has here: patents are scaled to the focal length that the lens was
sold with.

"""

CHECKS = """
## Checks

`tests/render/optics/corpus` holds each lens with surfaces against its source and against rayoptics 0.9.8, an independent
package that has traced the same surfaces (`scripts/lens_corpus` writes its numbers anew):

- Focal length: within 1 % of what the source states.
- f-number: the real beam is within 1 % of the stated one for all of these lenses, and within 0.1 % but for three whose
  clear diameters by Smith (1992) cut it: `double_gauss_50` (f/2.018), `gauss_werfel_100` (f/1.252), `telephoto_400`
  (f/5.63).
- Field: the chief ray of the stated field comes through the rims. `hologon_15` covers 110° here, full frame's corner, of
  its 120°.
- Against rayoptics: focal length, back focal distance, real f-number, place and diameter of the entrance pupil, image
  height, distortion, sagittal and tangential focus and lateral colour (lines F and C) at 0.7 of the field and at its edge,
  and axial colour, each within a millionth or 10 nm.

Most patents have neither clear diameters nor, within its air space, the place of the iris: the first are solved for, so
that about half of the beam gets to full frame's corner; the second is an estimate. Lenses with floating groups focus as a
whole. Mirror lenses are ideal ones with a ring for an iris: folded light is not traced.

Left out, because the numbers at hand do not reproduce what their patents state: Biogon 21 mm (US 2,721,499, example 2: the
numbers give a focal length 9.5 % short), Takumar 18 mm (US 3,841,736: 22 % long).
"""


def page() -> str:
    """The lenses and their families."""
    lenses = table(("name", "lens", "year", "families", "stated", "source"), (_row(lens) for lens in library_lenses()))
    families = table(("word", "meaning"), ((word, plain(meaning)) for word, meaning in FAMILIES.items()))
    return f"{INTRODUCTION}{lenses}\n## Families\n\n{families}{CHECKS}"


def _row(lens: LibraryLens) -> tuple[str, ...]:
    maker = f"{lens.lens.manufacturer}: " if lens.lens.manufacturer else ""
    return (
        f"`{lens.name}`",
        plain(f"{maker}{lens.lens.name}. {lens.description}"),
        str(lens.year or ""),
        ", ".join(lens.families),
        _stated(lens),
        plain(lens.source),
    )


def _stated(lens: LibraryLens) -> str:
    if lens.stated is None:
        return ""
    field = f", {lens.stated.field_deg:g}°" if lens.stated.field_deg else ""
    return f"{lens.stated.focal_length_mm:g} mm, f/{lens.stated.f_stop:g}{field}"
