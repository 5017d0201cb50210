"""Focusing a prescription: what is asked to be sharp is sharp on the film."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import InputError, SettingsError
from render.model.lens import Prescription
from render.optics.prescription.completion import complete_prescription, scale_prescription
from render.optics.prescription.focusing import FocusedLens, focus_lens
from render.optics.prescription.tracing import TracedRays, trace_forward
from tests.render.kits.lenses import DISTAGON, FISHEYE, PLANAR, SIX_LENSES, KnownLens

NAMES = [lens.prescription.name for lens in SIX_LENSES]


@functools.cache
def whole_planar() -> Prescription:
    return complete_prescription(PLANAR.prescription)


def rays_from_axis(lens: FocusedLens, distance_m: float, pupil_shares: list[float]) -> TracedRays:
    """Rays in the y-z plane from a point on the axis to shares of the entrance pupil's radius."""
    heights = np.array(pupil_shares) * lens.entrance_pupil_radius_mm
    directions = np.stack([0 * heights, heights / (1000 * distance_m), 1 + 0 * heights], axis=1)
    points = np.stack([0 * heights, heights, lens.entrance_pupil_mm + 0 * heights], axis=1)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return trace_forward(lens.prescription, points, directions, vertices_mm=lens.vertices_mm, clip=False)


def with_film_at(prescription: Prescription, back_mm: float, group: tuple[int, int]) -> Prescription:
    *others, last = prescription.surfaces
    return replace(prescription, surfaces=(*others, replace(last, thickness_mm=back_mm)), focus_group=group)


@pytest.mark.parametrize("distance_m", [np.inf, 5.0, 0.6])
@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_rays_close_to_the_axis_meet_on_the_film(lens: KnownLens, distance_m: float) -> None:
    set_lens = focus_lens(complete_prescription(lens.prescription), distance_m, lens.f_stop, by="paraxial")
    traced = rays_from_axis(set_lens, distance_m, [1e-3])
    assert abs(traced.at(set_lens.film_mm)[0, 1]) < 1e-6


@pytest.mark.parametrize("focal_lengths", [np.inf, 15])
@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_no_other_place_of_the_lens_has_a_smaller_spot(lens: KnownLens, focal_lengths: float) -> None:
    distance_m = focal_lengths * lens.focal_length_mm / 1000
    set_lens = focus_lens(complete_prescription(lens.prescription), distance_m, 1.5 * lens.f_stop)
    shares = np.sqrt((np.arange(40) + 0.5) / 40)
    traced = rays_from_axis(set_lens, distance_m, list(shares))
    step_mm = 0.01 * lens.f_stop  # defocus that adds a hundredth of a millimetre to the blur
    spots = [np.sqrt(np.mean(traced.at(set_lens.film_mm + off)[:, 1] ** 2)) for off in (-step_mm, 0.0, step_mm)]
    assert spots[1] < spots[0]
    assert spots[1] < spots[2]


def test_the_film_stands_still_and_the_whole_lens_moves() -> None:
    far, near = (focus_lens(complete_prescription(PLANAR.prescription), distance, 2.0) for distance in (np.inf, 1.0))
    assert near.film_mm == far.film_mm
    assert np.diff(near.vertices_mm) == pytest.approx(np.diff(far.vertices_mm))
    assert near.vertices_mm[0] < far.vertices_mm[0] - 1


def test_only_the_focus_group_moves_where_the_file_names_one() -> None:
    group = replace(complete_prescription(DISTAGON.prescription), focus_group=(0, 3))
    far, near = (focus_lens(group, distance, 2.0, by="paraxial") for distance in (np.inf, 0.5))
    moved = near.vertices_mm - far.vertices_mm
    assert moved[:4] == pytest.approx(np.full(4, moved[0]))
    assert moved[0] < 0
    assert moved[4:] == pytest.approx(np.zeros(len(moved) - 4))
    assert rays_from_axis(near, 0.5, [1e-3]).at(near.film_mm)[0, 1] == pytest.approx(0, abs=1e-6)


def test_the_f_number_is_that_at_infinity_up_to_wide_open() -> None:
    lens = complete_prescription(PLANAR.prescription)
    stopped_down = focus_lens(lens, np.inf, 4.0, by="paraxial")
    assert 2 * stopped_down.entrance_pupil_radius_mm == pytest.approx(stopped_down.first.focal_length_mm / 4)
    assert focus_lens(lens, 1.0, 0.7).f_stop == pytest.approx(lens.f_stop)


def test_the_image_scale_at_infinity_is_the_focal_length() -> None:
    lens = focus_lens(complete_prescription(PLANAR.prescription), np.inf, 4.0, by="paraxial")
    assert lens.image_scale_mm == pytest.approx(lens.first.focal_length_mm)


@pytest.mark.parametrize(
    ("prescription", "distance_m", "words"),
    [
        (PLANAR.prescription, 0.03, "cannot focus at 0.03 m: the nearest that it reaches is 0.0384 m"),
        (
            PLANAR.prescription,
            0.001,
            "nearest .* 0.0384 m, 14.3 mm before surface 1: nearer than the front focal point",
        ),
        (FISHEYE.prescription, 0.001, "where surface 1 of the lens stands"),
        (
            replace(DISTAGON.prescription, focus_group=(13, 17), f_stop=2.0),
            0.3,
            "nearest .* where surface 13 and surface 14 touch",
        ),
        (
            replace(DISTAGON.prescription, focus_group=(10, 10)),
            3.0,
            "moving surfaces 11 to 11 leaves it sharp at infinity",
        ),
        (with_film_at(DISTAGON.prescription, 60.0, (0, 3)), 30.0, "the farthest that it reaches is"),
        (
            with_film_at(DISTAGON.prescription, 5.0, (13, 13)),
            1.0,
            "wherever surfaces 14 to 14 are moved, no object is sharp",
        ),
    ],
)
def test_a_focus_out_of_reach_says_how_far_the_lens_reaches(
    prescription: Prescription, distance_m: float, words: str
) -> None:
    with pytest.raises(SettingsError, match=words):
        focus_lens(complete_prescription(prescription), distance_m, 4.0)


@pytest.mark.parametrize(
    ("distance_m", "f_stop"), [(-1.0, 2.0), (np.nan, 2.0), (1.0, 0.0), (1.0, np.inf), (1.0, np.nan)]
)
def test_impossible_settings_are_refused(distance_m: float, f_stop: float) -> None:
    with pytest.raises(SettingsError):
        focus_lens(complete_prescription(PLANAR.prescription), distance_m, f_stop)


def test_a_lens_whose_film_stands_elsewhere_is_moved_to_infinity() -> None:
    lens = complete_prescription(with_film_at(PLANAR.prescription, 40.0, (0, 13)))
    assert any("Parallel light meets 35.5 mm behind" in note for note in lens.notes)
    assert focus_lens(lens, np.inf, 4.0, by="paraxial").vertices_mm[0] == pytest.approx(
        40.0 - PLANAR.back_focal_mm, abs=1e-3
    )


def test_a_group_moving_before_the_stop_moves_the_entrance_pupil() -> None:
    # a group before the stop moves: the stop's image moves, and the object stays as far from it as was asked
    lens = focus_lens(
        replace(complete_prescription(DISTAGON.prescription), focus_group=(0, 3)), 0.4, 4.0, by="paraxial"
    )
    far = focus_lens(
        replace(complete_prescription(DISTAGON.prescription), focus_group=(0, 3)), np.inf, 4.0, by="paraxial"
    )
    assert lens.entrance_pupil_mm < far.entrance_pupil_mm - 1
    assert rays_from_axis(lens, 0.4, [1e-3]).at(lens.film_mm)[0, 1] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("distance_m", [np.inf, 2.0, 0.5])
def test_the_image_scale_is_that_of_rays_through_the_pupils_middle(distance_m: float) -> None:
    lens = focus_lens(complete_prescription(PLANAR.prescription), distance_m, 4.0)
    slope = 1e-4
    point = np.array([[0.0, 0.0, lens.entrance_pupil_mm]])
    traced = trace_forward(lens.prescription, point, np.array([[0.0, slope, 1.0]]), vertices_mm=lens.vertices_mm)
    assert traced.at(lens.film_mm)[0, 1] / slope == pytest.approx(lens.image_scale_mm, rel=1e-6)


@pytest.mark.parametrize(
    ("prescription", "words"),
    [
        (DISTAGON.prescription, "Distagon 35/1.4 is not complete: the clear diameter of surface 1 is missing"),
        (PLANAR.prescription, "Planar 50/1.4 is not complete: the back focal distance is missing"),
        (Prescription(()), "the lens is not complete"),
    ],
)
def test_a_lens_that_lacks_something_is_not_focused(prescription: Prescription, words: str) -> None:
    with pytest.raises(InputError, match=words):
        focus_lens(prescription, 2.0, 4.0)


@given(distance_m=st.floats(0.3, 1e5), f_stop=st.floats(1.0, 32.0), scale=st.floats(0.2, 5.0))
def test_scaling_a_lens_and_its_distance_scales_the_focused_lens(
    distance_m: float, f_stop: float, scale: float
) -> None:
    lens = whole_planar()
    one = focus_lens(lens, distance_m, f_stop, by="paraxial")
    other = focus_lens(scale_prescription(lens, scale), distance_m * scale, f_stop, by="paraxial")
    assert other.vertices_mm == pytest.approx(one.vertices_mm * scale, abs=1e-6)
    assert other.entrance_pupil_radius_mm == pytest.approx(one.entrance_pupil_radius_mm * scale)
    assert other.f_stop == pytest.approx(one.f_stop)


def test_the_nearer_the_object_the_farther_the_lens_moves_out() -> None:
    lens = complete_prescription(PLANAR.prescription)
    fronts = [focus_lens(lens, distance, 4.0).vertices_mm[0] for distance in (np.inf, 20.0, 5.0, 1.0, 0.5, 0.2)]
    assert (np.diff(fronts) < 0).all()


def test_zero_distance_is_infinity_as_in_usd() -> None:
    lens = complete_prescription(PLANAR.prescription)
    assert focus_lens(lens, 0.0, 4.0).vertices_mm[0] == focus_lens(lens, np.inf, 4.0).vertices_mm[0]
