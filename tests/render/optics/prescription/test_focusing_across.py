"""Anamorphic lenses in both meridians: focal lengths, squeeze, and focus that is found from side to side too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import InputError, SettingsError
from render.model.camera import Camera
from render.model.lens import Across, Glass, Lens, Prescription, Surface
from render.optics.focus_law import focus_law
from render.optics.prescription.beams import best_focus_mm
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import FocusedLens, focus_lens
from render.optics.prescription.meridians import turned, upright
from render.optics.prescription.paraxial import first_order

N, PLATE_MM = 1.5, 3.0
GLASS = Glass(N)
NEARER_MM = PLATE_MM * (1 - 1 / N)  # by which a plate brings nearer what is seen through it
NEGATIVE_MM, POSITIVE_MM, PRIME_MM = -60.0, 120.0, 100.0
NEGATIVE, POSITIVE, PRIME = 1, 2, 5  # surfaces that have the power: each of one side of a plate, flat on the other

AFOCAL = Prescription(  # negative and positive, as far apart as the sum of their focal lengths: a squeeze of two
    (
        Surface(0.0, PLATE_MM, GLASS, 12.0),
        Surface(0.0, NEGATIVE_MM + POSITIVE_MM, semi_diameter_mm=12.0, across=Across(-NEGATIVE_MM * (N - 1))),
        Surface(0.0, PLATE_MM, GLASS, 12.0, across=Across(POSITIVE_MM * (N - 1))),
        Surface(0.0, 20.0, semi_diameter_mm=12.0),
        Surface(0.0, 0.5, semi_diameter_mm=2.5, is_stop=True),
        Surface(PRIME_MM * (N - 1), PLATE_MM, GLASS, 10.0),
        Surface(0.0, 0.0, semi_diameter_mm=10.0),
    ),
    focus_group=(4, 6),
    f_stop=20.0,
    name="afocal",
    focus_group_across=(0, 1),
)


@pytest.fixture(scope="module")
def lens() -> Prescription:
    return complete_prescription(AFOCAL, image_height_mm=8.0)


def test_the_focal_lengths_are_in_the_ratio_of_the_squeeze(lens: Prescription) -> None:
    upright_mm, sideways_mm = (first_order(part).focal_length_mm for part in (lens, turned(lens)))
    assert upright_mm == pytest.approx(PRIME_MM, rel=1e-4)
    assert upright_mm / sideways_mm == pytest.approx(-POSITIVE_MM / NEGATIVE_MM, rel=1e-4)
    assert focus_lens(lens, 0.0, 20.0, by="paraxial").squeeze == pytest.approx(2.0, rel=1e-4)


def test_an_upright_lens_has_no_cylinders(lens: Prescription) -> None:
    plain = upright(lens)
    assert not plain.is_anamorphic
    assert first_order(plain) == first_order(lens)
    assert focus_lens(plain, 2.0, 20.0).squeeze == 1.0


def sharp_at(focused: FocusedLens) -> tuple[float, float]:
    """z at which light of the object in focus meets, from top to bottom and from side to side, less the film's."""
    found = [
        best_focus_mm(glass, focused.object_mm, focused.stop_radius_mm, focused.vertices_mm) - focused.film_mm
        for glass in (focused.prescription, turned(focused.prescription))
    ]
    return found[0], found[1]


@pytest.mark.parametrize("distance_m", [0.0, 5.0, 1.2])
def test_both_meridians_are_sharp_at_the_set_distance(lens: Prescription, distance_m: float) -> None:
    focused = focus_lens(lens, distance_m, 20.0)
    np.testing.assert_allclose(sharp_at(focused), 0.0, atol=1e-6)


def test_cylinders_that_stand_still_leave_the_sides_blurred(lens: Prescription) -> None:
    focused = focus_lens(replace(lens, focus_group_across=None), 1.2, 80.0)
    upright_mm, sideways_mm = sharp_at(focused)
    assert abs(upright_mm) < 1e-6
    # what each cylinder makes of the object's distance, by the lens equation
    negative, positive, prime = (float(focused.vertices_mm[i]) for i in (NEGATIVE, POSITIVE, PRIME))
    place = focused.object_mm + NEARER_MM
    for vertex, focal_mm, plate_mm in ((negative, NEGATIVE_MM, 0.0), (positive, POSITIVE_MM, NEARER_MM)):
        place = vertex + 1 / (1 / focal_mm + 1 / (place - vertex)) + plate_mm
    image = prime + 1 / (1 / PRIME_MM + 1 / (place - prime)) + NEARER_MM
    assert sideways_mm == pytest.approx(image - focused.film_mm, rel=1e-2)
    assert abs(sideways_mm) > 1.0


def test_the_gap_and_the_squeeze_are_those_of_thin_cylinders(lens: Prescription) -> None:
    """Sharp from side to side where both cylinders together leave the object in its place, smaller."""
    focused = focus_lens(lens, 1.2, 20.0, by="paraxial")
    gap = float(focused.vertices_mm[POSITIVE] - focused.vertices_mm[NEGATIVE])
    object_mm = float(focused.vertices_mm[POSITIVE]) - focused.object_mm - NEARER_MM
    before = 1 / (1 / (object_mm - gap) - 1 / NEGATIVE_MM)  # the first image's distance from the negative cylinder
    assert 1 / (before + gap) == pytest.approx(1 / object_mm + 1 / POSITIVE_MM, rel=1e-5)
    smaller = before / (object_mm - gap) * object_mm / (before + gap)
    assert 1 / focused.squeeze == pytest.approx(smaller, rel=1e-5)
    assert gap < NEGATIVE_MM + POSITIVE_MM
    assert focused.squeeze < 1.95  # the squeeze falls as the focus comes nearer


def test_cylinders_that_cannot_focus_say_so(lens: Prescription) -> None:
    """Two plates in place of the positive cylinder: there is no place where the light meets on the film from side to side."""
    surfaces = tuple(replace(s, across=None) if i == POSITIVE else s for i, s in enumerate(lens.surfaces))
    with pytest.raises(SettingsError, match=r"cannot focus at .* m before its front: its cylinders move by"):
        focus_lens(replace(lens, surfaces=surfaces), 1.2, 20.0)


@pytest.mark.parametrize(
    ("group", "message"),
    [
        ((1, 1), "must begin and end in the air"),
        ((5, 6), "surface 6 of afocal: .* power from top to bottom"),
        ((3, 9), "must be surfaces between 1 and 7"),
    ],
)
def test_only_cylinders_focus_from_side_to_side(lens: Prescription, group: tuple[int, int], message: str) -> None:
    with pytest.raises(InputError, match=message):
        complete_prescription(replace(lens, focus_group_across=group))


def test_a_lens_that_is_not_sharp_from_side_to_side_says_so(lens: Prescription) -> None:
    gap = replace(lens.surfaces[NEGATIVE], thickness_mm=50.0)
    shorter = replace(lens, surfaces=(lens.surfaces[0], gap, *lens.surfaces[2:]), focus_group_across=None)
    assert any("From side to side parallel light meets" in note for note in complete_prescription(shorter).notes)
    assert not any("side" in note for note in lens.notes)


def test_clear_diameters_are_solved_for_in_both_meridians(lens: Prescription) -> None:
    """The beam is as much narrower from side to side at the front as the cylinders make it; behind them it is round."""
    bare = tuple(replace(s, semi_diameter_mm=0.0) for s in AFOCAL.surfaces)
    solved = complete_prescription(replace(AFOCAL, surfaces=bare), image_height_mm=8.0)
    one, other = (
        complete_prescription(part, image_height_mm=8.0 / scale)
        for part, scale in (
            (upright(replace(AFOCAL, surfaces=bare)), 1),
            (upright(turned(replace(AFOCAL, surfaces=bare))), 2),
        )
    )
    for got, first, second in zip(solved.surfaces, one.surfaces, other.surfaces, strict=True):
        assert got.semi_diameter_mm == pytest.approx(max(first.semi_diameter_mm, second.semi_diameter_mm), rel=1e-2)


def test_the_focus_law_ends_where_the_cylinders_do(lens: Prescription) -> None:
    """A plate before the positive cylinder leaves the negative one 6 mm: the prime could focus nearer than that allows."""
    room_mm, thick_mm = 6.0, 50.0
    left_mm = NEGATIVE_MM + POSITIVE_MM - room_mm - thick_mm / N
    plate = Surface(0.0, thick_mm, GLASS, 12.0), Surface(0.0, left_mm, semi_diameter_mm=12.0)
    first = AFOCAL.surfaces[0], replace(AFOCAL.surfaces[NEGATIVE], thickness_mm=room_mm)
    held = replace(AFOCAL, surfaces=(*first, *plate, *AFOCAL.surfaces[POSITIVE:]), focus_group=(6, 8))
    nearest_w = []
    for glass in (AFOCAL, held):
        mounted = Lens("prescription", prescription=glass)
        nearest_w.append(float(focus_law(Camera(np.eye(4), 100.0, 24.0, 8.0, f_stop=20.0, lens=mounted)).near_w[0]))
    assert nearest_w[1] < 0.6 * nearest_w[0]
    whole = complete_prescription(held)
    focus_lens(whole, 1 / nearest_w[1], 20.0, by="paraxial")
    with pytest.raises(SettingsError, match="its cylinders move by"):
        focus_lens(whole, 0.85 / nearest_w[1], 20.0, by="paraxial")
