"""Focusing a prescription: what is asked to be sharp is sharp on the film."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lens_kit import DISTAGON, PLANAR, SIX_LENSES, KnownLens

from render.errors import SettingsError
from render.lens import Prescription
from render.optics.completion import completed
from render.optics.focusing import FocusedLens, focused
from render.optics.tracing import TracedRays, trace_forward

NAMES = [lens.prescription.name for lens in SIX_LENSES]


def rays_from_axis(lens: FocusedLens, distance_m: float, pupil_shares: list[float]) -> TracedRays:
    """Rays in the y-z plane from a point on the axis to shares of the entrance pupil's radius."""
    heights = np.array(pupil_shares) * lens.entrance_pupil_radius_mm
    directions = np.stack([0 * heights, heights / (1000 * distance_m), 1 + 0 * heights], axis=1)
    points = np.stack([0 * heights, heights, lens.entrance_pupil_mm + 0 * heights], axis=1)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return trace_forward(lens.prescription, points, directions, vertices_mm=lens.vertices_mm, clip=False)


@pytest.mark.parametrize("distance_m", [np.inf, 5.0, 0.6])
@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_rays_close_to_the_axis_meet_on_the_film(lens: KnownLens, distance_m: float) -> None:
    set_lens = focused(completed(lens.prescription), distance_m, lens.f_stop, by="paraxial")
    traced = rays_from_axis(set_lens, distance_m, [1e-3])
    assert abs(traced.at(set_lens.film_mm)[0, 1]) < 1e-6


@pytest.mark.parametrize("focal_lengths", [np.inf, 15])
@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_no_other_place_of_the_lens_has_a_smaller_spot(lens: KnownLens, focal_lengths: float) -> None:
    distance_m = focal_lengths * lens.focal_length_mm / 1000
    set_lens = focused(completed(lens.prescription), distance_m, 1.5 * lens.f_stop)
    shares = np.sqrt((np.arange(40) + 0.5) / 40)
    traced = rays_from_axis(set_lens, distance_m, list(shares))
    step_mm = 0.01 * lens.f_stop  # defocus that adds a hundredth of a millimetre to the blur
    spots = [np.sqrt(np.mean(traced.at(set_lens.film_mm + off)[:, 1] ** 2)) for off in (-step_mm, 0.0, step_mm)]
    assert spots[1] < spots[0]
    assert spots[1] < spots[2]


def test_the_film_stands_still_and_the_whole_lens_moves() -> None:
    far, near = (focused(completed(PLANAR.prescription), distance, 2.0) for distance in (np.inf, 1.0))
    assert near.film_mm == far.film_mm
    assert np.diff(near.vertices_mm) == pytest.approx(np.diff(far.vertices_mm))
    assert near.vertices_mm[0] < far.vertices_mm[0] - 1


def test_only_the_focus_group_moves_where_the_file_names_one() -> None:
    group = replace(completed(DISTAGON.prescription), focus_group=(0, 3))
    far, near = (focused(group, distance, 2.0, by="paraxial") for distance in (np.inf, 0.5))
    moved = near.vertices_mm - far.vertices_mm
    assert moved[:4] == pytest.approx(np.full(4, moved[0]))
    assert moved[0] < 0
    assert moved[4:] == pytest.approx(np.zeros(len(moved) - 4))
    assert rays_from_axis(near, 0.5, [1e-3]).at(near.film_mm)[0, 1] == pytest.approx(0, abs=1e-6)


def test_the_f_number_is_that_of_the_lens_at_infinity_and_no_wider_than_it_opens() -> None:
    lens = completed(PLANAR.prescription)
    stopped_down = focused(lens, np.inf, 4.0, by="paraxial")
    assert 2 * stopped_down.entrance_pupil_radius_mm == pytest.approx(stopped_down.first.focal_length_mm / 4)
    assert focused(lens, 1.0, 0.7).f_stop == pytest.approx(lens.f_stop)


def test_the_image_scale_at_infinity_is_the_focal_length() -> None:
    lens = focused(completed(PLANAR.prescription), np.inf, 4.0, by="paraxial")
    assert lens.image_scale_mm == pytest.approx(lens.first.focal_length_mm)


@pytest.mark.parametrize(
    ("prescription", "distance_m", "words"),
    [
        (PLANAR.prescription, 0.03, "cannot focus at 0.03 m: the nearest that it reaches is 0.0384 m"),
        (PLANAR.prescription, 0.001, "where surface 1 of the lens stands"),
        (replace(DISTAGON.prescription, focus_group=(13, 17)), 0.3, "where surface 13 and surface 14 touch"),
    ],
)
def test_a_focus_too_near_says_how_near_the_lens_reaches(
    prescription: Prescription, distance_m: float, words: str
) -> None:
    with pytest.raises(SettingsError, match=words):
        focused(completed(prescription), distance_m, 4.0)


@pytest.mark.parametrize(
    ("distance_m", "f_stop"), [(-1.0, 2.0), (np.nan, 2.0), (1.0, 0.0), (1.0, np.inf), (1.0, np.nan)]
)
def test_impossible_settings_are_refused(distance_m: float, f_stop: float) -> None:
    with pytest.raises(SettingsError):
        focused(completed(PLANAR.prescription), distance_m, f_stop)
