"""A zoom between the positions of its file, and a lens whose groups float."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from render.errors import InputError, SettingsError
from render.model.lens import Configuration, Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.prescription.completion import complete_prescription, scale_prescription
from render.optics.prescription.f_numbers import widest_f_number
from render.optics.prescription.focus_path import FocusPath
from render.optics.prescription.focusing import focus_lens
from render.optics.prescription.monotone_curve import MonotoneCurve
from render.optics.prescription.mounting import scale_to
from render.optics.prescription.paraxial import first_order
from render.optics.prescription.zooming import marked_close_focus_m, set_focal_length, zoom_of, zoom_positions
from tests.render.kits.lens_files import ZOOM_TXT
from tests.render.kits.zoom_files import FLOATING_TXT, TELE_ZOOM_TXT

STATED_MM = (72.10, 135.00, 194.01)
"""Focal lengths that US 5,537,259 states of its example."""
SPACES = (5, 9, 16, 21)
PATENT_MM = ((8.78, 1.64, 30.32, 14.7), (26.15, 12.89, 15.72, 0.69), (32.85, 17.23, 1.32, 4.05))


@cache
def tele_zoom() -> Prescription:
    return parse_lens_file(TELE_ZOOM_TXT.encode(), "zoom.txt")


@cache
def floating() -> Prescription:
    return parse_lens_file(FLOATING_TXT.encode(), "floating.txt")


def at_close_focus() -> Prescription:
    """The lens with floating groups where the file has them at close focus."""
    near = floating().configurations[1].thicknesses_mm
    surfaces = [replace(s, thickness_mm=t) for s, t in zip(floating().surfaces, near, strict=True)]
    return replace(floating(), surfaces=tuple(surfaces), configurations=())


def spaces(lens: Prescription) -> list[float]:
    return [lens.surfaces[i].thickness_mm for i in SPACES]


def focus_shift_mm(lens: Prescription) -> float:
    return first_order(lens).back_focal_mm - lens.surfaces[-1].thickness_mm


def test_each_position_of_the_zoom_has_the_patents_numbers() -> None:
    zoom = zoom_of(tele_zoom())
    assert zoom is not None
    focal_lengths = [position.focal_length_mm for position in zoom.positions]
    assert focal_lengths == pytest.approx(STATED_MM, rel=2e-4)
    assert [position.far.f_stop for position in zoom.positions] == [2.8] * 3
    assert max(abs(position.focus_shift_mm) for position in zoom.positions) < 0.02  # spaces to a hundredth
    assert zoom.keeps_focus


@pytest.mark.parametrize("index", range(3))
def test_at_a_position_the_groups_stand_where_the_file_has_them(index: int) -> None:
    position = zoom_positions(tele_zoom())[index]
    lens = set_focal_length(tele_zoom(), position.focal_length_mm)
    assert spaces(lens) == pytest.approx(PATENT_MM[index], abs=0.02)  # as far as the file's focus is off
    assert widest_f_number(complete_prescription(lens)) == pytest.approx(2.8, rel=0.01)


@pytest.mark.parametrize("focal_mm", [72.5, 85, 100, 120, 150, 180, 193.9])
def test_between_them_focal_length_and_focus_are_exact(focal_mm: float) -> None:
    lens = set_focal_length(tele_zoom(), focal_mm)
    assert first_order(lens).focal_length_mm == pytest.approx(focal_mm, rel=1e-9)
    assert abs(focus_shift_mm(lens)) < 1e-8
    assert scale_to(tele_zoom(), focal_mm, 21.6).surfaces[0].radius_mm == pytest.approx(311.919, rel=1e-8)  # not scaled


def test_the_zoom_moves_smoothly_and_never_overshoots() -> None:
    focal_lengths = np.geomspace(72.2, 193.9, 120)
    moved = np.array([spaces(set_focal_length(tele_zoom(), float(f))) for f in focal_lengths])
    assert moved.min() > 0.6
    turns = np.diff(np.sign(np.diff(moved, axis=0)), axis=0)
    assert (np.count_nonzero(turns, axis=0) <= 1).all()  # one space shrinks and grows again: that behind group 4
    steps = np.diff(moved, n=2, axis=0)
    assert np.abs(steps).max() < 0.1  # of spaces that change by 30 mm over 120 steps


def test_a_pulled_zoom_keeps_the_focus_of_its_front_group() -> None:
    # Focused by its front group at the long end, and pulled: the group stays, and the focus does.
    long_end = replace(set_focal_length(tele_zoom(), 193.0), focus_group=(0, 5))
    front = focus_lens(complete_prescription(long_end), 6.0, 8.0, by="paraxial")
    film_to_object_mm = front.film_mm - front.object_mm
    shift_mm = front.vertices_mm[0]
    for focal_mm in (80.0, 110.0, 150.0):
        lens = complete_prescription(replace(set_focal_length(tele_zoom(), focal_mm), focus_group=(0, 5)))
        at = focus_lens(lens, film_to_object_mm / 1000, 8.0, by="paraxial")
        pupil_mm = at.film_mm - at.entrance_pupil_mm
        for _ in range(4):  # the pupil moves with the zoom, and the object stays
            at = focus_lens(lens, (film_to_object_mm - pupil_mm) / 1000, 8.0, by="paraxial")
            pupil_mm = at.film_mm - at.entrance_pupil_mm
        assert at.vertices_mm[0] == pytest.approx(shift_mm, abs=2e-3)


def test_a_zoom_whose_positions_do_not_focus_drifts() -> None:
    apart = tuple(
        replace(each, thicknesses_mm=(*each.thicknesses_mm[:-1], 52.49 + off))
        for each, off in zip(tele_zoom().configurations, (0.0, 0.4, 0.0), strict=True)
    )
    zoom = zoom_of(replace(tele_zoom(), configurations=apart))
    assert zoom is not None
    assert not zoom.keeps_focus
    assert zoom.drift_mm == pytest.approx(0.4, abs=0.03)
    lens = set_focal_length(replace(tele_zoom(), configurations=apart), 134.985)
    assert focus_shift_mm(lens) == pytest.approx(-0.4, abs=0.02)
    assert any("vari-focal" in note and "drifts by 0.4" in note for note in lens.notes)


def test_beyond_its_range_a_zoom_is_its_nearer_end_scaled() -> None:
    lens = scale_to(tele_zoom(), 50.0, 21.6)
    assert first_order(lens).focal_length_mm == pytest.approx(50)
    assert lens.surfaces[0].radius_mm == pytest.approx(311.919 * 50 / 72.092, rel=1e-4)
    assert any("50 mm is beyond its range" in note for note in lens.notes)


def test_what_focuses_is_the_front_group_where_the_file_is_silent() -> None:
    lens = set_focal_length(tele_zoom(), 100.0)
    assert lens.focus_group == (0, 5)
    assert any("does not say what moves to focus" in note for note in lens.notes)


def test_the_iris_between_positions_keeps_the_f_number() -> None:
    f_stops = [widest_f_number(scale_to(tele_zoom(), f, 21.6)) for f in (72.2, 90.0, 110.0, 160.0, 193.9)]
    assert f_stops == pytest.approx([2.8] * 5, rel=0.015)


def test_near_positions_belong_to_zoom_positions_by_their_spaces() -> None:
    bare = ZOOM_TXT.replace("Focal Length\t48\t70\t48\t70", "Focal Length\t48\t70\tundefined\tundefined")
    for text in (ZOOM_TXT, bare):
        lens = parse_lens_file(text.encode(), "zoom.txt")
        wide, tele = zoom_positions(lens)
        assert [each.thicknesses_mm[1] for each in (*wide.near, *tele.near)] == [3.5, 1.5]
        assert [len(wide.near), len(tele.near)] == [1, 1]
    middle = math.sqrt(wide.focal_length_mm * tele.focal_length_mm)
    far, near = set_focal_length(lens, middle).configurations
    moves = np.subtract(near.thicknesses_mm, far.thicknesses_mm)
    assert moves[[4, 6]] == pytest.approx(
        [-(1.05 + 1.1) / 2, (1.05 + 1.1) / 2], abs=0.01
    )  # halfway between both ends' travels


def test_floating_groups_stand_at_close_focus_where_the_file_has_them() -> None:
    lens = complete_prescription(floating())
    close_mm = 803.34 + sum(floating().configurations[1].thicknesses_mm)
    assert marked_close_focus_m(floating()) == pytest.approx(close_mm / 1000)
    close = first_order(at_close_focus())
    at = focus_lens(lens, (803.34 + close.entrance_pupil_mm) / 1000, 2.8)
    found = [at.prescription.surfaces[i].thickness_mm for i in (7, 11, 20)]
    # The patent's own places put the paraxial image 0.19 mm before the film, which a fortieth of the travel makes good.
    assert found == pytest.approx([1.10, 10.843, 20.359], abs=0.35)


def test_floating_focus_has_the_focal_lengths_of_the_patent() -> None:
    lens = complete_prescription(floating())
    assert first_order(lens).focal_length_mm == pytest.approx(99.80, rel=1e-4)
    assert first_order(lens).back_focal_mm == pytest.approx(40.123, abs=2e-3)
    assert lens.f_stop == pytest.approx(1.24, rel=1e-4)
    close = first_order(at_close_focus())
    assert -close.focal_length_mm / (803.34 + close.front_focal_mm) == pytest.approx(-0.112, abs=1e-4)


@pytest.mark.parametrize("distance_m", [20.0, 3.0, 1.2, 0.9])
def test_floating_groups_focus_at_any_distance(distance_m: float) -> None:
    at = focus_lens(complete_prescription(floating()), distance_m, 4.0, by="paraxial")
    film = first_order(replace(at.prescription, configurations=()))
    object_mm = at.object_mm - at.vertices_mm[0]
    image_mm = film.back_focal_mm + film.focal_length_mm**2 / (film.front_focal_mm - object_mm)  # Newton's equation
    assert image_mm == pytest.approx(at.prescription.surfaces[-1].thickness_mm, abs=1e-6)
    assert at.prescription.surfaces[-1].thickness_mm == pytest.approx(40.123, abs=1e-6)  # the rear pair stands still


def test_floating_focus_ends_where_glass_touches() -> None:
    with pytest.raises(
        SettingsError, match=r"nearest that it reaches is 0.81.* m, where surface 8 and surface 9 touch"
    ):
        focus_lens(complete_prescription(floating()), 0.6, 4.0)


def test_the_path_passes_through_every_configuration() -> None:
    rows = [each.thicknesses_mm for each in floating().configurations]
    between = tuple(np.mean(rows, axis=0) + np.eye(len(rows[0]))[7] * 0.5)
    three = replace(
        floating(),
        configurations=(
            floating().configurations[0],
            Configuration(between, 2000.0),
            floating().configurations[1],
        ),
    )
    path = FocusPath.from_prescription(three)
    assert path is not None
    for station, row in zip(path.curve.x, (rows[0], between, rows[1]), strict=True):
        assert np.diff([*path.places(float(station)), 0.0]) == pytest.approx(row)
    assert [(group.first, group.last) for group in path.groups()] == [(8, 11), (12, 20)]


def test_scaling_scales_the_positions_too() -> None:
    small = zoom_of(scale_prescription(tele_zoom(), 0.5))
    assert small is not None
    assert small.longest_mm == pytest.approx(194.004 / 2, rel=1e-4)


def test_curves_are_those_of_an_independent_package() -> None:
    x, y = np.array([0.0, 0.4, 1.3, 2.0]), np.array([[1.0, 5.0], [2.0, 4.9], [2.1, 1.0], [0.5, 1.2]])
    curve, other = MonotoneCurve.through(x, y), PchipInterpolator(x, y)
    for place in np.linspace(0, 2, 41):
        assert curve.at(float(place)) == pytest.approx(other(place), abs=1e-12)


def _with(lens: Prescription, *configurations: Configuration) -> Prescription:
    return replace(lens, configurations=configurations)


GOOD = Configuration((1.0,) * 34)


@pytest.mark.parametrize(
    ("configurations", "message"),
    [
        ((GOOD,) * 10_000, "expected at most 64 configurations, got 10000"),
        ((Configuration((1.0, 2.0)),), "configuration 1 must have 34 thicknesses, one for each surface, got 2"),
        (
            (Configuration((-0.5, *[1.0] * 33)),),
            "surface 1 of .*: its thickness in configuration 1 must be from 0 .* got -0.5",
        ),
        ((Configuration((math.nan, *[1.0] * 33)),), "its thickness in configuration 1 must be"),
        ((replace(GOOD, object_mm=-3.0),), "the object of configuration 1 must be before the lens, got -3 mm"),
        ((replace(GOOD, object_mm=math.nan),), "the object of configuration 1"),
        ((replace(GOOD, f_stop=0.1),), "the f-number of configuration 1 must be 0 .unknown. or from 0.5 up, got 0.1"),
        ((replace(GOOD, focal_length_mm=-1.0),), "the focal length of configuration 1"),
        ((Configuration((500.0,) * 34),), "configuration 1 has the focal length .* expected positive ones"),
    ],
)
def test_impossible_positions_are_one_clear_error(configurations: tuple[Configuration, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        complete_prescription(_with(tele_zoom(), *configurations))
    with pytest.raises(InputError, match=message):
        scale_to(_with(tele_zoom(), *configurations), 100.0, 21.6)


def test_a_negative_space_of_a_file_is_an_error() -> None:
    text = TELE_ZOOM_TXT.replace("d22\t14.7\t0.69", "d22\t14.7\t-0.69")
    with pytest.raises(InputError, match=r"surface 22 of .*: its thickness in configuration 2 must be from 0"):
        complete_prescription(parse_lens_file(text.encode(), "zoom.txt"))
