"""A hand that follows, over shots of any length and at times of any kind: a time has one focus, whatever was looked at before."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd

from render.shot import Shot
from render.shot.focus import tracker
from render.shot.focus.inputs import FocusInputs
from render.shot.focus.track import FocusTrack, solve_track
from tests.render.kits.table_shot import CAMERA, on_table, write_table
from usd_schemas import LensCamera, LensData

NEAR, FAR = (0.0, 0.0, 0.5), (0.0, 0.0, -2.2)


def racked_shot(folder: Path, start: float, end: float, *, first: float = 1, last: float = 24) -> Shot:
    """The focus goes from the near point to the far one from a start to an end, in a shot from a first frame to a last."""
    path = write_table(folder / "table.usda")
    stage = Usd.Stage.Open(str(path))
    stage.SetStartTimeCode(first)
    stage.SetEndTimeCode(last)
    stage.Save()
    shot = Shot.open(path)
    for name, place, before in (("near", NEAR, 1.0), ("far", FAR, 0.0)):
        shot.focus.add_point(CAMERA, name, on_table(name, place))
        shot.focus.set_key(CAMERA, name, "weight", start, before)
        shot.focus.set_key(CAMERA, name, "weight", end, 1 - before)
    shot.focus.set(CAMERA, mode="points")
    return shot


def distances_m(shot: Shot, times: list[float]) -> np.ndarray:
    return np.array([shot.focus.read(CAMERA, time).focus_distance_m for time in times])


def test_the_first_frames_of_a_long_shot_are_followed_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("MAX_FOLLOWED_FRAMES", 60), ("_PART", 30), ("_BEFORE", 60), ("_AFTER", 10)):
        monkeypatch.setattr(tracker, name, value)
    shot = racked_shot(tmp_path, 6, 12, last=150)
    first_frames = [1.0, 6.0, 140.0]
    level = distances_m(shot, first_frames)
    shot.focus.set(CAMERA, lag_s=0.3)
    assert distances_m(shot, first_frames) == pytest.approx(level, rel=1e-6)
    in_one = shot.focus.curve(CAMERA, list(range(1, 151))).focus_distance_m
    monkeypatch.setattr(tracker, "MAX_FOLLOWED_FRAMES", 1000)
    shot.focus.set(CAMERA, lag_s=0.3001)
    shot.focus.set(CAMERA, lag_s=0.3)
    assert in_one == pytest.approx(shot.focus.curve(CAMERA, list(range(1, 151))).focus_distance_m, rel=1e-6)


def test_what_was_looked_at_beyond_the_shot_changes_nothing_in_it(tmp_path: Path) -> None:
    shot = racked_shot(tmp_path, -20, -10)
    shot.focus.set(CAMERA, lag_s=3.0)
    before = distances_m(shot, [2.0, 20.0])
    assert before[0] == pytest.approx(before[1], rel=1e-6)  # the hand is settled at the shot's first frame
    beyond = distances_m(shot, [-15.0, -30.0, 40.0])
    assert distances_m(shot, [2.0, 20.0]).tolist() == before.tolist()
    assert distances_m(shot, [40.0, -30.0, -15.0]).tolist() == beyond[::-1].tolist()


def test_a_time_far_beyond_the_shot_is_solved_from_frames_near_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shot = racked_shot(tmp_path, 6, 12)
    shot.focus.set(CAMERA, lag_s=0.3)
    frames: list[int] = []

    def counted(inputs: FocusInputs) -> FocusTrack:
        frames.append(len(inputs.times))
        return solve_track(inputs)

    monkeypatch.setattr(tracker, "solve_track", counted)
    near, far = distances_m(shot, [1.0, 1e7])
    assert far > near
    assert max(frames) < 5000


@pytest.mark.parametrize("seconds_off", [0.0, 0.5])
def test_smoothing_is_exact_at_keys_between_frames(tmp_path: Path, seconds_off: float) -> None:
    shot = racked_shot(tmp_path, 6 + seconds_off, 12 + seconds_off)
    shot.focus.set_key(CAMERA, "far", "weight", 9 + seconds_off, 0.9)
    key_times = [6 + seconds_off, 9 + seconds_off, 12 + seconds_off]
    expected_m = distances_m(shot, key_times)
    shot.focus.set(CAMERA, smoothing_s=0.3)
    assert distances_m(shot, key_times) == pytest.approx(expected_m, rel=1e-9)


def test_a_range_that_is_turned_about_has_its_first_frame(tmp_path: Path) -> None:
    shot = racked_shot(tmp_path, 6, 12, first=24, last=1)
    shot.focus.set(CAMERA, lag_s=0.3)
    assert all(math.isfinite(distance) for distance in distances_m(shot, [1.0, 10.0, 24.0]))


def test_what_the_lens_could_not_do_is_flagged_and_nothing_else(tmp_path: Path) -> None:
    """A ring of 300 degrees from 0.5 m on, turned by 60 degrees in a second, takes longer than 6 frames."""
    shot = racked_shot(tmp_path, 6, 12)
    frames = list(range(1, 200))
    shot.focus.set(CAMERA, lag_s=0.1)
    assert not shot.focus.curve(CAMERA, frames).limited.any()  # to come late is what was asked for
    with Usd.EditContext(shot.stage, shot.edits.layer):
        LensCamera(shot.stage.GetPrimAtPath(CAMERA)).lens.author(LensData(close_focus=500.0, focus_throw=300.0))
    shot.focus.set(CAMERA, lag_s=0.0, max_speed_deg_s=60.0)
    limited = shot.focus.curve(CAMERA, frames).limited
    assert limited[12]
    assert not limited[:5].any()
    assert not limited[-1]
    assert "slower" in shot.focus.read(CAMERA, 13).note


def test_points_that_fix_less_than_a_plane_are_reported_and_no_limit(tmp_path: Path) -> None:
    shot = racked_shot(tmp_path, 6, 12)
    shot.focus.set(CAMERA, mode="tiltPlane")
    readout = shot.focus.read(CAMERA, 9)
    assert "on one line of the picture" in readout.reason
    assert not readout.note
    assert not shot.focus.curve(CAMERA, [9.0]).limited[0]


def test_the_circles_of_a_curve_are_those_of_the_points(tmp_path: Path) -> None:
    shot = racked_shot(tmp_path, 6, 12)
    shot.focus.add_point(CAMERA, "behind", on_table("behind", (0.0, 0.0, 5.0)))
    shot.focus.set(CAMERA, mode="surface", expressive=0.5)
    curve = shot.focus.curve(CAMERA, [1.0, 9.0])
    for i, time in enumerate((1.0, 9.0)):
        cocs_mm = [point.coc_mm for point in shot.focus.points(CAMERA, time)]
        assert [track.coc_mm[i] for track in curve.points] == pytest.approx(cocs_mm, nan_ok=True)
        assert math.isnan(cocs_mm[2])
        assert max(cocs_mm[:2]) > 0.01
