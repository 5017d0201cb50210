"""Completing a prescription: what is missing is solved for and said so; what cannot be is named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import InputError, SettingsError
from render.model.lens import AIR, Glass, Prescription, Surface
from render.optics.prescription.beams import oblique_beam
from render.optics.prescription.completion import complete_prescription, scale_prescription
from render.optics.prescription.paraxial import first_order, stop_index, vertices
from render.optics.prescription.surface_shape import sag_mm
from render.optics.prescription.tracing import trace_forward
from tests.render.kits.lenses import DISTAGON, DOUBLE_GAUSS, FISHEYE, PLANAR, SIX_LENSES, TELEPHOTO, WIDE, KnownLens

NAMES = [lens.prescription.name for lens in SIX_LENSES]
SINGLET = Prescription(
    (Surface(50.0, 5.0, Glass(1.5), 10.0, is_stop=True), Surface(-50.0, 0.0, semi_diameter_mm=10.0)), name="Singlet"
)


def changed(prescription: Prescription, index: int, **changes: object) -> Prescription:
    surfaces = list(prescription.surfaces)
    surfaces[index] = replace(surfaces[index], **changes)  # type: ignore[arg-type]
    return replace(prescription, surfaces=tuple(surfaces))


def unstopped(prescription: Prescription) -> Prescription:
    surfaces = tuple(replace(surface, is_stop=False) for surface in prescription.surfaces)
    return replace(prescription, surfaces=surfaces)


def without_diameters(lens: KnownLens) -> Prescription:
    bare = tuple(replace(surface, semi_diameter_mm=0.0) for surface in lens.prescription.surfaces)
    return replace(lens.prescription, surfaces=bare, f_stop=lens.f_stop)


def without_stop(prescription: Prescription) -> Prescription:
    stop, surfaces = stop_index(prescription), list(prescription.surfaces)
    gap = surfaces[stop - 1].thickness_mm + surfaces[stop].thickness_mm
    surfaces[stop - 1 : stop + 1] = [replace(surfaces[stop - 1], thickness_mm=gap)]
    return replace(prescription, surfaces=tuple(surfaces))


def share_past_rims(lens: Prescription, image_height_mm: float) -> float:
    """Share of the parallel light toward an image height, as the stop alone would let it through, that rims leave."""
    first, beam = first_order(lens), oblique_beam(lens, image_height_mm, np.zeros(1))
    front = beam.heights_mm[0, 0]
    middle = front + (first.entrance_pupil_mm - sag_mm(lens.surfaces[0], front**2)) * beam.slope
    side = np.linspace(-0.8, 0.8, 161) * first.focal_length_mm / lens.f_stop
    x, y = (grid.ravel() for grid in np.meshgrid(side, middle + side))
    points = np.stack([x, y, 0 * x + first.entrance_pupil_mm], axis=1)
    directions = np.tile(np.array([0.0, beam.slope, 1.0]) / np.hypot(1.0, beam.slope), (len(x), 1))
    rimless = tuple(replace(s, semi_diameter_mm=s.semi_diameter_mm * s.is_stop) for s in lens.surfaces)
    by_stop = trace_forward(replace(lens, surfaces=rimless), points, directions).passes
    return float(trace_forward(lens, points, directions).passes.sum() / by_stop.sum())


@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_a_completed_lens_lacks_nothing(lens: KnownLens) -> None:
    whole = complete_prescription(lens.prescription, image_height_mm=lens.field_mm)
    assert all(surface.semi_diameter_mm > 0 for surface in whole.surfaces)
    assert whole.surfaces[-1].thickness_mm == pytest.approx(lens.back_focal_mm, rel=1e-3)
    assert whole.f_stop == pytest.approx(lens.f_stop, rel=0.01)  # of the real beam: as the maker states it
    assert not any("It is said to be" in note for note in whole.notes)
    assert any("back focal distance" in note for note in whole.notes)
    assert complete_prescription(whole, image_height_mm=lens.field_mm) == whole


@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_a_stop_of_unknown_diameter_follows_from_the_f_number(lens: KnownLens) -> None:
    stop = stop_index(lens.prescription)
    whole = complete_prescription(replace(changed(lens.prescription, stop, semi_diameter_mm=0.0), f_stop=lens.f_stop))
    stated = lens.prescription.surfaces[stop].semi_diameter_mm
    assert whole.surfaces[stop].semi_diameter_mm == pytest.approx(stated, rel=0.01)
    assert any("stop's diameter" in note for note in whole.notes)


@pytest.mark.parametrize("lens", [DOUBLE_GAUSS, WIDE, FISHEYE, TELEPHOTO], ids=lambda lens: lens.prescription.name)
def test_rims_alone_tell_the_f_number(lens: KnownLens) -> None:
    whole = complete_prescription(changed(lens.prescription, stop_index(lens.prescription), semi_diameter_mm=0.0))
    assert whole.f_stop == pytest.approx(lens.f_stop, rel=0.03)


# The rule for missing clear diameters against lenses whose clear diameters are published.
@pytest.mark.parametrize("lens", [WIDE, FISHEYE], ids=lambda lens: lens.prescription.name)
def test_solved_clear_diameters_are_like_the_published_ones(lens: KnownLens) -> None:
    whole = complete_prescription(without_diameters(lens), image_height_mm=lens.field_mm)
    solved = np.array([surface.semi_diameter_mm for surface in whole.surfaces])
    published = np.array([surface.semi_diameter_mm for surface in lens.prescription.surfaces])
    assert np.median(np.abs(solved / published - 1)) < 0.05
    assert solved == pytest.approx(published, rel=0.25)


@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_solved_clear_diameters_let_the_stop_limit_the_axial_beam(lens: KnownLens) -> None:
    whole = complete_prescription(without_diameters(lens), image_height_mm=lens.field_mm)
    assert any("clear diameters of all surfaces were solved for" in note for note in whole.notes)
    assert not any("cuts the beam" in note for note in whole.notes)


# Photographic lenses vignette by about a stop at the corner, wide open; a telephoto of long back focus less.
@pytest.mark.parametrize("lens", [DOUBLE_GAUSS, PLANAR, DISTAGON, WIDE], ids=lambda lens: lens.prescription.name)
def test_solved_clear_diameters_pass_about_half_the_light_at_a_corner(lens: KnownLens) -> None:
    whole = complete_prescription(without_diameters(lens), image_height_mm=lens.field_mm)
    assert 0.5 < share_past_rims(whole, lens.field_mm) < 0.65


def test_a_field_without_light_is_reported() -> None:
    whole = complete_prescription(without_diameters(FISHEYE), image_height_mm=30.0)
    assert any("not the 30 mm of the field" in note for note in whole.notes)


@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_a_missing_stop_is_put_where_the_designer_had_it(lens: KnownLens) -> None:
    stop, first_mm = stop_index(lens.prescription), vertices(lens.prescription)
    bare = replace(without_stop(lens.prescription), f_stop=lens.f_stop)
    whole = complete_prescription(bare, image_height_mm=lens.field_mm)
    assert stop_index(whole) == stop
    gap_mm = first_mm[stop + 1] - first_mm[stop - 1]
    assert abs(vertices(whole)[stop] - first_mm[stop]) < 0.2 * gap_mm
    assert any("No surface was the aperture stop" in note for note in whole.notes)


def test_a_focus_group_counts_on_behind_a_stop_that_was_put_in() -> None:
    bare = replace(without_stop(PLANAR.prescription), f_stop=1.4, focus_group=(6, 12))
    assert complete_prescription(bare).focus_group == (7, 13)


def test_a_lens_without_air_gaps_has_its_stop_at_the_front_rim() -> None:
    whole = complete_prescription(changed(SINGLET, 0, is_stop=False))
    assert stop_index(whole) == 0
    assert len(whole.surfaces) == 2


def test_a_rim_that_limits_the_axial_beam_is_reported() -> None:
    whole = complete_prescription(changed(DOUBLE_GAUSS.prescription, 8, semi_diameter_mm=5.0))
    assert any("Surface 9 cuts the beam on the axis to f/" in note for note in whole.notes)


def test_solved_surfaces_end_where_they_meet_their_neighbours() -> None:
    lens = complete_prescription(without_diameters(DISTAGON), image_height_mm=21.6)
    for i, (front, behind) in enumerate(zip(lens.surfaces, lens.surfaces[1:], strict=False)):
        edge = min(front.semi_diameter_mm, behind.semi_diameter_mm) ** 2
        apart = front.thickness_mm + sag_mm(behind, edge) - sag_mm(front, edge)
        assert apart > -1e-6 or behind.is_stop or front.is_stop, i


@pytest.mark.parametrize(
    ("index", "changes", "words"),
    [
        (2, {"radius_mm": np.nan}, "surface 3 of Double Gauss 50 mm: its radius must be a finite number, got nan"),
        (2, {"thickness_mm": np.inf}, "surface 3 .* its thickness must be a finite number, got inf"),
        (2, {"thickness_mm": -1.0}, "surface 3 .* its thickness must be 0 or more, got -1 mm"),
        (4, {"semi_diameter_mm": -3.0}, "surface 5 .* its clear semi-diameter must be 0 or more, got -3 mm"),
        (4, {"conic": np.nan}, "surface 5 .* its conic constant must be a finite number"),
        (4, {"aspheric": (0.0, np.inf)}, r"surface 5 .* its aspheric coefficient of r\^6 must be a finite number"),
        (4, {"aspheric": (1e-9,) * 11}, "surface 5 .* at most 10 aspheric coefficients, got 11"),
        (0, {"glass": Glass(0.0)}, "surface 1 .* index behind it must be from 1 to 5, got 0 at 587.6 nm"),
        (0, {"glass": Glass(-1.5)}, "surface 1 .* index behind it must be from 1 to 5, got -1.5"),
        (0, {"glass": Glass(np.nan)}, "surface 1 .* the glass behind it must have finite numbers"),
        (
            0,
            {"glass": Glass(1.5, 0.0, (1.0, 1.0, np.inf), (0.01, 0.01, 0.01))},
            "surface 1 .* must have finite numbers",
        ),
        (
            0,
            {"glass": Glass(1.5, 0.0, (-1.0, -1.0, 0.0), (0.01, 0.01, 0.01))},
            "surface 1 .* index behind it must be .* got nan",
        ),
        (0, {"glass": Glass(1.67, -4.0)}, "surface 1 .* Abbe number behind it must be 0 .* or at least 1, got -4"),
        (3, {"radius_mm": 1e-9}, "surface 4 .* its radius must be 0 .a plane. or at least 0.001 mm, got 1e-09 mm"),
        (3, {"thickness_mm": 1e9}, r"surface 4 .* its thickness must be at most 100000, got 1e\+09"),
        (4, {"semi_diameter_mm": 13.0}, "surface 5 .* clear semi-diameter of 13 mm exceeds the 12.75 mm"),
        (7, {"is_stop": True}, "surface 8 .* second aperture stop: surface 6 is one already"),
        (10, {"glass": Glass(1.5)}, r"surface 11 .* behind the last surface there must be air"),
        (9, {"thickness_mm": 1.0}, "surface 10 of Double Gauss 50 mm: it overlaps surface 11 by .* mm within"),
    ],
)
def test_bad_numbers_are_named_by_surface(index: int, changes: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        complete_prescription(changed(DOUBLE_GAUSS.prescription, index, **changes))


@pytest.mark.parametrize(
    ("prescription", "words"),
    [
        (replace(SINGLET, surfaces=()), "Singlet: expected 1 to 200 surfaces, got 0"),
        (changed(SINGLET, 0, glass=Glass(1.0)), "Singlet: no surface refracts"),
        (
            changed(changed(SINGLET, 0, radius_mm=-40.0), 1, radius_mm=50.0),
            "surface 1 of Singlet: its power of -12.5 dioptres .* the focal length -43.* mm, expected a positive one",
        ),
        (
            replace(SINGLET, surfaces=(*changed(SINGLET, 1, thickness_mm=200.0).surfaces, *unstopped(SINGLET).surfaces)),
            "surface 3 of Singlet: parallel light meets before it already, which makes the focal length -.* mm, expected",
        ),
        (changed(changed(SINGLET, 0, radius_mm=0.0), 1, radius_mm=0.0), "Singlet has no focal length"),
        (changed(SINGLET, 0, thickness_mm=160.0), "surface 2 of Singlet: its focal point lies .* mm before its last surface"),
        (replace(SINGLET, f_stop=0.3), "Singlet: f/0.3 wide open is impossible"),
        (replace(SINGLET, f_stop=np.nan), "Singlet: f/nan wide open is impossible"),
        (replace(SINGLET, focus_group=(0, 2)), "focus group must be surfaces between 1 and 2 in order, got 1 to 3"),
        (replace(SINGLET, focus_group=(1, 0)), "focus group must be surfaces .* got 2 to 1"),
        (
            replace(changed(changed(SINGLET, 0, semi_diameter_mm=0.0), 1, semi_diameter_mm=0.0), f_stop=0.6),
            "surface 2 of Singlet: f/0.6 wide open is impossible",
        ),
        (
            changed(FISHEYE.prescription, 6, semi_diameter_mm=30.0),
            "surface 7 of Fisheye 10 mm: as the stop, its clear semi-diameter of 30 mm makes it f/0.4",
        ),
        (changed(changed(SINGLET, 0, semi_diameter_mm=0.0), 1, semi_diameter_mm=0.0), "neither the f-number nor the stop"),
    ],
)  # fmt: skip
def test_impossible_lenses_are_refused(prescription: Prescription, words: str) -> None:
    with pytest.raises(InputError, match=words):
        complete_prescription(prescription)


def test_total_internal_reflection_everywhere_is_named() -> None:
    # But for their rounded tips, the second and third surfaces are cones that light along the axis meets at 60° from the normal.
    surfaces = (
        Surface(0.0, 10.0, Glass(1.8), 5.0, is_stop=True),
        Surface(-0.01, 0.0, semi_diameter_mm=5.0, conic=-4 / 3),
        Surface(-0.01, 10.0, Glass(1.8), 5.0, conic=-4 / 3),
        Surface(-60.0, 0.0, semi_diameter_mm=5.0),
    )
    with pytest.raises(
        InputError, match="surface 2 of Trap: no light gets through: total internal reflection turns back"
    ):
        complete_prescription(Prescription(surfaces, name="Trap"))


numbers = st.floats(-1e3, 1e3) | st.sampled_from([0.0, np.nan, np.inf, -np.inf, 1e-300, 1e300])
surfaces = st.builds(
    Surface,
    radius_mm=st.floats(-60, 60) | numbers,
    thickness_mm=st.floats(0, 10) | numbers,
    glass=st.sampled_from([AIR, Glass(1.5), Glass(1.8, 25.0)]) | st.builds(Glass, numbers, numbers),
    semi_diameter_mm=st.sampled_from([0.0, 4.0]) | numbers,
    conic=st.just(0.0) | numbers,
    aspheric=st.just(()) | st.lists(st.floats(-1e-4, 1e-4) | numbers, max_size=3).map(tuple),
    is_stop=st.booleans(),
)


@given(
    surfaces=st.lists(surfaces, min_size=1, max_size=5).map(tuple),
    f_stop=st.sampled_from([0.0, 2.0]) | numbers,
    group=st.none() | st.tuples(st.integers(-1, 5), st.integers(-1, 5)),
)
def test_any_numbers_whatever_make_a_lens_or_one_clear_refusal(
    surfaces: tuple[Surface, ...], f_stop: float, group: tuple[int, int] | None
) -> None:
    try:
        whole = complete_prescription(Prescription(surfaces, group, f_stop))
    except InputError:
        return
    assert all(surface.semi_diameter_mm > 0 for surface in whole.surfaces)
    assert whole.f_stop >= 0.5
    assert complete_prescription(whole).surfaces == whole.surfaces


@pytest.mark.parametrize("height", [0.0, -1.0, np.nan, np.inf])
def test_a_field_must_have_a_height(height: float) -> None:
    with pytest.raises(SettingsError, match="image height"):
        complete_prescription(SINGLET, image_height_mm=height)


@given(factor=st.floats(0.05, 20))
def test_a_scaled_lens_has_all_lengths_scaled_and_the_same_f_number(factor: float) -> None:
    lens = DISTAGON.prescription
    before, after = first_order(lens), first_order(scale_prescription(lens, factor))
    for length in (
        "focal_length_mm",
        "back_focal_mm",
        "entrance_pupil_mm",
        "exit_pupil_mm",
        "length_mm",
        "rear_principal_mm",
    ):
        assert getattr(after, length) == pytest.approx(factor * getattr(before, length), rel=1e-9, abs=1e-9)
    assert after.petzval_sum == pytest.approx(before.petzval_sum / factor)
    assert after.entrance_pupil_magnification == pytest.approx(before.entrance_pupil_magnification)


def test_notes_of_a_scaled_lens_say_which_lengths_they_have() -> None:
    whole = complete_prescription(without_diameters(PLANAR))
    assert any(" mm" in note for note in whole.notes)
    assert scale_prescription(whole, 1.5).notes == (
        *whole.notes,
        "Lengths in these notes are from before the lens was scaled by 1.5.",
    )
    assert scale_prescription(whole, 1.0001).notes == whole.notes
    assert scale_prescription(replace(whole, notes=("No lengths.",)), 2).notes == ("No lengths.",)


@given(factor=st.floats(0.05, 20), height=st.floats(-12, 12), slope=st.floats(-0.2, 0.2))
def test_rays_scale_with_the_lens(factor: float, height: float, slope: float) -> None:
    points, directions = np.array([[1.0, height, 0.0]]), np.array([[0.0, slope, 1.0]]) / np.hypot(1, slope)
    lens = DISTAGON.prescription
    small = trace_forward(lens, points, directions)
    large = trace_forward(scale_prescription(lens, factor), points * factor, directions)
    assert large.directions == pytest.approx(small.directions, abs=1e-9, nan_ok=True)
    assert large.points_mm == pytest.approx(small.points_mm * factor, rel=1e-7, abs=1e-9, nan_ok=True)


@pytest.mark.parametrize("factor", [0.0, -1.0, np.nan, np.inf])
def test_a_lens_is_scaled_by_positive_numbers_only(factor: float) -> None:
    with pytest.raises(SettingsError, match="scaled by a positive number"):
        scale_prescription(SINGLET, factor)
