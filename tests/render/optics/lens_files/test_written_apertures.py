"""Openings and obscurations that are written as lens files and read again."""

from __future__ import annotations

from dataclasses import replace

import pytest

from render.model.lens import Outline, Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.lens_files.writing import write_lens
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.outlines import polygon, reach_mm, spider, spider_arms
from tests.render.kits.lens_files import TRIPLET_ZMX


def with_outlines(opening: Outline | None, obscuration: Outline | None) -> Prescription:
    lens = complete_prescription(parse_lens_file(TRIPLET_ZMX.encode(), "a.zmx"))
    semi = lens.surfaces[0].semi_diameter_mm if opening is None else reach_mm(opening)
    first = replace(lens.surfaces[0], opening=opening, obscuration=obscuration, semi_diameter_mm=semi)
    return complete_prescription(replace(lens, surfaces=(first, *lens.surfaces[1:])))


RECTANGLE, CIRCLE = Outline("rectangle", (6.0, 4.5)), Outline("ellipse", (2.0, 2.0))
BESIDE = Outline("ellipse", (2.0, 2.0), (1.0, -0.5))


@pytest.mark.parametrize("arms", [1, 3, 4])
def test_a_spider_comes_back_from_zemax(arms: int) -> None:
    made = spider(0.5, arms, 10.5, (0.25, 0.0))
    lens = with_outlines(None, made)
    again = parse_lens_file(write_lens(lens, ".zmx").content, "again.zmx").surfaces[0].obscuration
    assert again is not None
    width, count, _, centre = spider_arms(again) or (0.0, 0, 0.0, ())
    assert (width, count, centre) == (pytest.approx(0.5), arms, pytest.approx((0.25, 0.0)))


def test_polygons_are_named_where_they_are_not_written() -> None:
    both = with_outlines(polygon([(0.0, 6.0), (4.0, -5.0), (-4.0, -5.0)]), None)
    assert (
        "The opening of surface 1 is not written: it is a polygon that is no spider." in write_lens(both, ".zmx").notes
    )
    assert "The opening of surface 1 is not written: it is a polygon." in write_lens(both, ".seq").notes


@pytest.mark.parametrize("suffix", [".zmx", ".seq"])
@pytest.mark.parametrize(
    ("opening", "obscuration"),
    [
        (None, CIRCLE),
        (None, BESIDE),
        (None, Outline("ellipse", (2.0, 3.0), (0.25, 0.0))),
        (None, Outline("rectangle", (2.0, 3.0))),
        (RECTANGLE, None),
        (replace(RECTANGLE, centre_mm=(0.5, 0.25)), None),
        (Outline("ellipse", (6.0, 4.5)), None),
        (Outline("ellipse", (6.0, 6.0), (1.0, -0.5)), BESIDE),
    ],
)
def test_apertures_come_back(opening: Outline | None, obscuration: Outline | None, suffix: str) -> None:
    lens = with_outlines(opening, obscuration)
    written = write_lens(lens, suffix)
    again = parse_lens_file(written.content, f"again{suffix}")
    assert not any("not written" in note or "without that" in note for note in written.notes)
    for here, there in zip(lens.surfaces, again.surfaces, strict=True):
        assert (there.opening, there.obscuration) == (here.opening, here.obscuration)
        assert there.semi_diameter_mm == pytest.approx(here.semi_diameter_mm)
    assert complete_prescription(again).f_stop == pytest.approx(lens.f_stop, rel=1e-5)


def test_what_a_format_cannot_hold_is_named() -> None:
    both = with_outlines(RECTANGLE, CIRCLE)
    assert "The obscuration of surface 1 is not written: it has an opening too." in write_lens(both, ".zmx").notes
    assert any(note.startswith("Openings and obscurations are not") for note in write_lens(both, ".txt").notes)
    again = parse_lens_file(write_lens(both, ".seq").content, "again.seq")
    assert again.surfaces[0] == both.surfaces[0]
    narrow = replace(both.surfaces[0], semi_diameter_mm=6.5, obscuration=None)
    cut = replace(both, surfaces=(narrow, *both.surfaces[1:]))
    assert any("of surface 1 cuts its opening" in note for note in write_lens(cut, ".zmx").notes)
