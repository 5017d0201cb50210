"""Focus over time: exact at keys, never overshooting, late by what was asked, no faster than the hand, without pops."""

import math
import time
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.focus.smoothing import fade_weights, points_share, smooth
from render.focus.timeline import drive
from render.focus.tracking import FocusRing, limit_speed, limits, track

FPS = 24.0
SECONDS = np.arange(121) / FPS
RING = FocusRing(throw_rad=math.radians(270), close_focus_m=0.5)


@st.composite
def curves(draw):
    """Times that rise, not evenly, and inverse depths at them."""
    w = draw(st.lists(st.floats(0, 3), min_size=1, max_size=40))
    steps = draw(st.lists(st.floats(0.005, 0.5), min_size=len(w), max_size=len(w)))
    return np.cumsum(steps), np.array(w)


def step_at(seconds, before=0.2, after=1.0):
    return np.where(seconds < 2.5, before, after)


hands = st.fixed_dictionaries(
    {
        "smoothing_s": st.sampled_from([0.0, 0.1, 1.0]),
        "lag_s": st.sampled_from([0.0, 0.05, 0.6]),
        "dead_zone_w": st.sampled_from([0.0, 0.02, 0.5]),
        "ring": st.sampled_from([None, RING]),
        "max_speed_rad_s": st.sampled_from([0.0, 0.5, 20.0]),
        "close_focus_m": st.sampled_from([0.0, 0.5]),
    }
)


@given(curves(), hands)
def test_nothing_overshoots(curve, hand):
    times, w = curve
    reached = limits(w, hand["close_focus_m"])
    focus = drive(times, w, **hand)
    assert focus.min() >= reached.min() - 1e-9
    assert focus.max() <= reached.max() + 1e-9


@given(curves(), hands)
def test_a_target_that_only_approaches_is_only_approached(curve, hand):
    times, w = curve
    assert (np.diff(drive(times, np.sort(w), **hand)) >= -1e-9).all()


@given(curves(), hands)
def test_what_stands_still_is_left_alone(curve, hand):
    times, _ = curve
    np.testing.assert_allclose(drive(times, np.full(len(times), 0.7), **hand), 0.7, rtol=1e-12)


@given(curves())
def test_a_hand_without_limits_follows_exactly(curve):
    times, w = curve
    np.testing.assert_array_equal(drive(times, w), w)


@given(curves(), st.floats(0.05, 3), st.data())
def test_smoothing_is_exact_at_keys_and_ends_and_keeps_between_them(curve, width, data):
    times, w = curve
    keys = sorted(data.draw(st.sets(st.integers(0, len(w) - 1), max_size=4)) | {0, len(w) - 1})
    result = smooth(times, w, width, exact_at_s=times[keys])
    np.testing.assert_allclose(result[keys], w[keys], rtol=1e-9, atol=1e-12)
    for first, last in pairwise(keys):
        part = slice(first, last + 1)
        assert w[part].min() - 1e-9 <= result[part].min()
        assert result[part].max() <= w[part].max() + 1e-9


@given(curves(), st.floats(0.05, 3), st.data())
def test_smoothing_rises_where_the_values_rise_between_keys(curve, width, data):
    """Also where the window opens and closes, and where its width is keyed."""
    times, w = curve
    keys = times[sorted(data.draw(st.sets(st.integers(0, len(w) - 1), max_size=4)))]
    widths = width * np.array(data.draw(st.lists(st.floats(0, 1), min_size=len(w), max_size=len(w))))
    for asked in (width, widths):
        assert (np.diff(smooth(times, np.sort(w), asked, exact_at_s=keys)) >= -1e-9).all()


def test_a_steady_move_is_not_changed_by_smoothing():
    np.testing.assert_allclose(smooth(SECONDS, 0.1 * SECONDS, 0.8), 0.1 * SECONDS, atol=1e-12)


def test_smoothing_removes_wobble_and_eases_a_step_over_its_time():
    wobble = 0.5 + 0.01 * np.where(np.arange(121) % 2, 1.0, -1.0)
    inner = slice(24, -24)
    assert np.abs(smooth(SECONDS, wobble, 1.0)[inner] - 0.5).max() < 1e-4
    eased = smooth(SECONDS, step_at(SECONDS), 1.0)
    middle = 2.5 - 0.5 / FPS
    assert (eased[middle - 0.5 - 1 / FPS > SECONDS] == 0.2).all()
    assert (eased[middle + 0.5 + 1 / FPS < SECONDS] == 1.0).all()
    assert np.abs(np.diff(eased)).max() < 1.1 * 2 * 0.8 / FPS  # Hann's bell is twice as high as it is wide
    assert np.interp(middle, SECONDS, eased) == pytest.approx(0.6, abs=1e-3)


def test_a_key_between_two_frames_is_kept_too():
    """The frames on either side of it come ever closer to their own values as the key comes closer to them."""
    frame = 60
    near = smooth(SECONDS, step_at(SECONDS), 1.0, exact_at_s=[SECONDS[frame] + 1e-4])
    assert near[frame] == pytest.approx(1.0, abs=1e-2)
    assert smooth(SECONDS, step_at(SECONDS), 1.0)[frame] < 0.7


@pytest.mark.parametrize("lag", [0.1, 0.5])
def test_a_steady_target_is_followed_by_just_the_lag(lag):
    target = 0.1 + 0.2 * SECONDS
    late = track(SECONDS, target, lag_s=lag)
    settled = 8 * lag < SECONDS
    np.testing.assert_allclose(late[settled], target[settled] - 0.2 * lag, rtol=1e-4)


def test_a_target_that_stops_is_reached_and_not_passed():
    focus = track(SECONDS, step_at(SECONDS), lag_s=0.3)
    assert (np.diff(focus) >= 0).all()
    assert focus.max() <= 1.0
    assert focus[-1] == pytest.approx(1.0, rel=1e-3)


def test_the_hand_starts_softly():
    """Its first frame of a move is much shorter than its fastest: no jerk."""
    moves = np.diff(track(SECONDS, np.minimum(0.2 * SECONDS, 0.5), lag_s=0.5))
    assert moves[0] < 0.05 * moves.max()


@given(st.integers(1, 7), st.floats(0.05, 1.0))
def test_what_the_hand_does_does_not_hang_on_how_finely_time_is_cut(cuts, lag):
    fine = np.linspace(0, 5, 120 * cuts + 1)
    target = np.interp(fine, SECONDS, step_at(SECONDS))
    coarse = track(SECONDS, step_at(SECONDS), lag_s=lag)
    np.testing.assert_allclose(track(fine, target, lag_s=lag)[::cuts], coarse, atol=1e-9)


@given(curves(), st.floats(0.01, 1))
def test_the_dead_zone_is_never_left(curve, zone):
    times, w = curve
    assert np.abs(track(times, w, dead_zone_w=zone) - w).max() <= zone + 1e-12


def test_small_wandering_is_let_go_and_a_move_is_followed():
    wandering = 0.5 + 0.009 * np.sin(9 * SECONDS)
    still = track(SECONDS, wandering, lag_s=0.2, dead_zone_w=0.01)
    assert np.ptp(still) == 0
    moved = track(SECONDS, wandering + np.clip(SECONDS - 2, 0, 1), lag_s=0.2, dead_zone_w=0.01)
    assert np.ptp(moved[SECONDS < 2]) < 0.01
    assert moved[-1] == pytest.approx(1.5, abs=0.02)


@given(curves(), st.floats(0.1, 5))
def test_no_frame_turns_the_ring_faster_than_the_hand_can(curve, speed):
    times, w = curve
    ring = limit_speed(times, w, speed)
    assert (np.abs(np.diff(ring)) <= speed * np.diff(times) + 1e-12).all()


def test_a_hand_that_is_too_slow_comes_late_and_then_stands():
    ring = limit_speed(SECONDS, 100 * step_at(SECONDS), 40.0)  # 80 degrees at 40 in a second: two seconds
    start = 2.5 - 1 / FPS
    np.testing.assert_allclose(ring, np.clip(20 + 40 * (SECONDS - start), 20, 100), atol=1e-9)


def test_the_ring_is_at_its_stops_at_infinity_and_at_close_focus():
    assert RING.turn_rad(0.0) == 0
    assert RING.turn_rad(1 / 0.5) == pytest.approx(math.radians(270))
    assert RING.w_at(RING.turn_rad(0.37)) == pytest.approx(0.37)


def test_a_drive_turns_the_ring_no_faster_than_its_limit():
    focus = drive(SECONDS, step_at(SECONDS), ring=RING, max_speed_rad_s=math.radians(45))
    assert np.abs(np.diff(RING.turn_rad(focus))).max() * FPS == pytest.approx(math.radians(45))


def test_a_hand_behind_a_stop_is_not_late_in_coming_back():
    """For an object nearer than close focus the hand waits at the stop, not beyond it."""
    w = np.where(SECONDS < 2.5, 5.0, 1.0)
    focus = drive(SECONDS, w, lag_s=0.2, close_focus_m=0.5)
    np.testing.assert_allclose(focus[SECONDS < 2.5], 2.0)
    np.testing.assert_array_equal(focus, track(SECONDS, np.minimum(w, 2.0), lag_s=0.2))


def test_infinity_and_close_focus_are_the_ends():
    np.testing.assert_array_equal(limits([-0.1, 0, 1, 9], 0.5), [0, 0, 1, 2])
    np.testing.assert_array_equal(limits([-0.1, 0, 1, 9]), [0, 0, 1, 9])


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.2, 0.5, 2.0]))
def test_no_switch_pops_however_fast_it_is_thrown(seed, crossing):
    on = np.random.default_rng(seed).random((121, 3)) < 0.5
    fades = fade_weights(on, SECONDS, crossing)
    assert np.abs(np.diff(fades, axis=0)).max() <= 1.02 * 2 / crossing / FPS
    assert fades.min() >= 0
    assert fades.max() <= 1


def test_a_switch_from_one_point_to_another_crosses_without_a_gap():
    first = SECONDS < 2.5
    fades = fade_weights(np.stack([first, ~first], axis=1), SECONDS, 1.0)
    np.testing.assert_allclose(fades.sum(axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(points_share(fades), 1.0, atol=1e-12)
    assert fades[0].tolist() == [1, 0]
    assert fades[-1].tolist() == [0, 1]


def test_the_last_point_gives_the_focus_back_to_the_camera_bit_by_bit():
    share = points_share(fade_weights((SECONDS < 2.5)[:, None], SECONDS, 1.0))
    assert share[0] == 1
    assert share[-1] == 0
    assert np.abs(np.diff(share)).max() < 0.1


def test_without_a_time_a_switch_is_a_switch():
    on = np.stack([SECONDS < 2.5, SECONDS > 1], axis=1)
    np.testing.assert_array_equal(fade_weights(on, SECONDS, 0.0), on.astype(float))


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.2, 0.5, 2.0]))
def test_a_point_has_faded_before_it_loses_its_place(seed, crossing):
    rng = np.random.default_rng(seed)
    on, usable = rng.random((121, 4)) < 0.8, np.repeat(rng.random((11, 4)) < 0.7, 11, axis=0)
    fades = fade_weights(on, SECONDS, crossing, usable=usable)
    assert (fades[~usable] == 0).all()
    assert np.abs(np.diff(fades, axis=0)).max() <= 1.02 * 2 / crossing / FPS


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: drive([], []), "at least one"),
        (lambda: drive([0, 0], [1, 1]), "rise"),
        (lambda: drive([0, math.nan], [1, 1]), "finite"),
        (lambda: drive([0, 1], [1.0]), "as many values"),
        (lambda: drive([0, 1], [1.0, math.nan]), "not at 1 s"),
        (lambda: drive([0, 1], [1, 1], lag_s=-1), "lag in seconds must be finite and 0 or more"),
        (lambda: drive([0, 1], [1, 1], smoothing_s=[0.1, math.nan]), "time of smoothing must be finite"),
        (lambda: drive([0, 1], [1, 1], dead_zone_w=[0.1]), "one number or 2"),
        (lambda: drive([0, 1], [1, 1], ring=RING, max_speed_rad_s=-1), "fastest turn"),
        (lambda: drive([0, 1], [1, 1], close_focus_m=-1), "close focus"),
        (lambda: fade_weights([[2.0], [1.0]], [0, 1], 1.0), "from 0 to 1"),
        (lambda: FocusRing(0.0, 1.0), "throw"),
        (lambda: FocusRing(1.0, math.inf), "close focus"),
    ],
)
def test_what_makes_no_sense_is_refused(call, message):
    with pytest.raises(SettingsError, match=message):
        call()


def test_an_hour_is_driven_in_seconds():
    times = np.arange(86_400) / FPS
    w = 0.5 + 0.2 * np.sin(times)
    before = time.process_time()
    drive(times, w, smoothing_s=0.5, lag_s=0.2, dead_zone_w=0.01, ring=RING, max_speed_rad_s=2.0, close_focus_m=0.5)
    assert time.process_time() - before < 5
