"""Long exposures: lights that move leave even trails without gaps, what stands still is as bright as in one frame, and the
shutter can be opened and closed at will."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pxr import Gf, Usd, UsdGeom

from render.errors import PullfocusError, SettingsError
from render.film import Grade
from render.film.light_accumulator import LightAccumulator
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.model.scene import Batch, Material
from render.model.shutter_intervals import ShutterInterval, parse_shutter_intervals
from render.pictures.long_exposure import LongExposure
from render.pictures.picture import make_picture
from render.pictures.travel import make_moment, measure_travel_px
from render.shot import Shot

WIDTH, HEIGHT = 240, 24
SETTINGS = FrameSettings(WIDTH, HEIGHT, engine="pinhole", shading="unlit", rays=16, supersample=4)
SECONDS = 10
CLOSES = 1 + 24 * SECONDS  # frames, from frame 1 on


def write_lights(path: Path, *, keyed_exposure: bool = False) -> Path:
    """Two lights, 4 pixels wide and as high as the picture, before a pinhole 2 m away that sees 2.4 by 0.24 m there: 10 mm a
    pixel. One stands still at pixel 20; the other goes from pixel 40 to pixel 200 in ten seconds, at one pace all the way."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, "Y")
    stage.SetTimeCodesPerSecond(24)
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(CLOSES)
    for name, begins, ends in (("still", 20, 20), ("moving", 40, 200)):
        card = UsdGeom.Mesh.Define(stage, f"/{name}")
        corners = ((-0.02, -0.12), (0.02, -0.12), (0.02, 0.12), (-0.02, 0.12))
        card.CreatePointsAttr([Gf.Vec3f(x, y, -2) for x, y in corners])
        card.CreateFaceVertexCountsAttr([4])
        card.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
        card.CreateDisplayColorAttr([Gf.Vec3f(1, 1, 1)])
        place = card.AddTranslateOp()
        place.Set(Gf.Vec3d(0.01 * begins - 1.2, 0, 0), 1)
        place.Set(Gf.Vec3d(0.01 * ends - 1.2, 0, 0), CLOSES)
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.CreateFocalLengthAttr(0.2)
    camera.CreateHorizontalApertureAttr(0.24)
    camera.CreateVerticalApertureAttr(0.024)
    camera.CreateShutterOpenAttr(0.0)
    camera.CreateShutterCloseAttr(0.5)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 10))
    if keyed_exposure:
        exposure = camera.CreateExposureAttr()
        exposure.Set(0.0, 1)
        exposure.Set(2.0, 3)
    stage.Save()
    return path


@pytest.fixture(scope="module")
def shot(tmp_path_factory: pytest.TempPathFactory) -> Shot:
    """The two lights."""
    return Shot.open(write_lights(tmp_path_factory.mktemp("lights") / "lights.usda"))


def exposed(
    renderer: FrameRenderer, shot: Shot, spec: str, settings: FrameSettings = SETTINGS, nd_stops: float | None = None
) -> LongExposure:
    openings = parse_shutter_intervals(spec)
    exposure = LongExposure(renderer, shot, "/cam", openings[0].first, settings, nd_stops=nd_stops, grade=Grade())
    for opening in openings:
        for begin, end in opening.intervals():
            exposure.expose(begin, end)
    return exposure


def line_of(exposure: LongExposure) -> np.ndarray:
    """The mean of all lines, which see the same: ``(WIDTH,)``."""
    return np.asarray(exposure.develop().frame.color[..., 0].mean(axis=0))


def share_of_time(begins: float, ends: float, half: float) -> np.ndarray:
    """``(WIDTH,)`` the share of the time for which a light that goes evenly covers each pixel: a box drawn along the way."""
    covered = np.linspace(0, 1, 20001)
    left = begins - half + (ends - begins) * covered
    pixels = np.arange(WIDTH)
    overlap = np.clip(np.minimum(pixels + 1, left[:, None] + 2 * half) - np.maximum(pixels, left[:, None]), 0, 1)
    return overlap.mean(axis=0)


def test_ten_seconds_of_lights_equal_their_sum_in_closed_form(renderer: FrameRenderer, shot: Shot) -> None:
    exposure = exposed(renderer, shot, f"1:{CLOSES}x4")
    line = line_of(exposure)
    expected = share_of_time(40, 200, 2)
    assert line[19:21] == pytest.approx(1.0, abs=1e-6)  # what stands still is as bright as in one frame
    assert line[30:].sum() == pytest.approx(4.0, rel=1e-3)  # all the light of the one that moves
    assert line[30:] == pytest.approx(expected[30:], abs=0.03 * expected.max())
    assert line[44:196].mean() == pytest.approx(4 / 160, rel=1e-3)
    state = exposure.state
    assert (state.open_seconds, state.intervals, state.gain) == (SECONDS, 60, 1.0)


def test_by_velocities_it_is_the_same_trail(renderer: FrameRenderer, shot: Shot) -> None:
    quick = replace(SETTINGS, motion_by="velocities", rays=64)
    line = line_of(exposed(renderer, shot, f"1:{CLOSES}x12", quick))
    expected = share_of_time(40, 200, 2)
    assert line[19:21] == pytest.approx(1.0, abs=1e-6)
    assert line[30:].sum() == pytest.approx(4.0, rel=5e-3)
    assert line[30:] == pytest.approx(expected[30:], abs=0.1 * expected.max())


def test_trails_have_no_gaps_however_fast_a_light_is(renderer: FrameRenderer, shot: Shot) -> None:
    """11 pixels an interval, by a light of 4; with two moments to each it would be beads."""
    trail = exposed(renderer, shot, f"1:{CLOSES}x17").develop().frame.color[:, 44:196, 0]
    assert trail.mean() == pytest.approx(4 / 160, rel=0.005)
    assert trail.mean(axis=0) == pytest.approx(4 / 160, rel=0.12)
    assert trail.min() > 0.75 * 4 / 160


def test_stopped_and_gone_on_with_it_is_the_same_picture(renderer: FrameRenderer, shot: Shot) -> None:
    settings = replace(SETTINGS, engine="lens", rays=4)
    at_once, stopped = (LongExposure(renderer, shot, "/cam", 1.0, settings, grade=Grade()) for _ in range(2))
    for begin in range(1, 7):
        at_once.expose(begin, begin + 1)
    for begin in range(1, 4):
        stopped.expose(begin, begin + 1)
    peeked = stopped.develop()
    assert peeked.frame.color[HEIGHT // 2, 19, 0] == pytest.approx(1.0, abs=1e-6)
    with pytest.raises(KeyboardInterrupt):
        stopped.expose(4, 5, on_progress=_interrupt)
    np.testing.assert_array_equal(stopped.develop().frame.color, peeked.frame.color)
    for begin in range(4, 7):
        stopped.expose(begin, begin + 1)
    np.testing.assert_array_equal(stopped.develop().graded, at_once.develop().graded)


def _interrupt(share: float) -> None:
    raise KeyboardInterrupt


def test_while_the_shutter_is_closed_nothing_is_exposed(renderer: FrameRenderer, shot: Shot) -> None:
    """Opened twice for two seconds: half the light on each of two pieces of the way, and none between."""
    line = line_of(exposed(renderer, shot, "1:49x4,193:241x4"))
    expected = 4 / 64  # of the time, for pixels of 64 that are passed over
    assert line[46:68] == pytest.approx(expected, rel=0.1)
    assert line[174:194] == pytest.approx(expected, rel=0.1)
    assert line[78:162].max() == 0
    assert line[20] == pytest.approx(1.0, abs=1e-6)


def test_without_a_filter_each_doubling_of_the_time_is_a_stop(renderer: FrameRenderer, shot: Shot) -> None:
    """A frame of the shot is open for half a frame."""
    single = make_picture(renderer, shot, "/cam", 1.0, SETTINGS, Grade()).frame.color[HEIGHT // 2, 20, 0]
    for frames, stops in ((1, 1), (2, 2), (8, 4)):
        exposure = exposed(renderer, shot, f"1:{1 + frames}", nd_stops=0.0)
        assert line_of(exposure)[20] == pytest.approx(single * 2**stops, rel=1e-6)
        assert exposed(renderer, shot, f"1:{1 + frames}").state.nd_stops == pytest.approx(stops)
    assert line_of(exposed(renderer, shot, "1:9", nd_stops=3.0))[20] == pytest.approx(2 * single, rel=1e-6)


@pytest.mark.parametrize(("frames", "pixels"), [(1, 160 / 240), (24, 16.0), (0, 0.0)])
def test_how_far_things_go_is_known(shot: Shot, frames: float, pixels: float) -> None:
    before, after = (
        make_moment(shot.scene_at(t), shot.camera_at("/cam", t, WIDTH, HEIGHT)) for t in (1.0, 1.0 + frames)
    )
    assert measure_travel_px(before, after, WIDTH, HEIGHT) == pytest.approx(pixels, rel=1e-5)


def test_what_comes_or_goes_hides_no_motion(shot: Shot) -> None:
    before, after = (make_moment(shot.scene_at(t), shot.camera_at("/cam", t, WIDTH, HEIGHT)) for t in (1.0, 25.0))
    sheet = Batch(rectangle((0, 0, -2), (0.1, 0, 0), (0, 0.1, 0), prim=99), Material(), np.eye(4)[None])
    gone = replace(before.scene, batches=(sheet, *before.scene.batches))
    assert measure_travel_px(replace(before, scene=gone), after, WIDTH, HEIGHT) == pytest.approx(16.0, rel=1e-5)


def test_what_is_out_of_the_picture_or_behind_the_camera_goes_nowhere(shot: Shot) -> None:
    own = shot.camera_at("/cam", 1.0, WIDTH, HEIGHT)
    turned, aside = np.diag([-1.0, 1.0, -1.0, 1.0]), np.eye(4)
    aside[0, 3] = 20.0
    for camera in (replace(own, world_from_camera=pose) for pose in (turned, aside)):
        before, after = (make_moment(shot.scene_at(t), camera) for t in (1.0, 25.0))
        assert measure_travel_px(before, after, WIDTH, HEIGHT) == 0


def test_a_keyed_exposure_counts_as_it_is_in_each_interval(renderer: FrameRenderer, tmp_path: Path) -> None:
    shot = Shot.open(write_lights(tmp_path / "keyed.usda", keyed_exposure=True))
    assert line_of(exposed(renderer, shot, "1:4"))[20] == pytest.approx((1 + 2 + 4) / 3, rel=1e-6)


def test_the_file_says_what_was_exposed(renderer: FrameRenderer, shot: Shot) -> None:
    metadata = exposed(renderer, shot, "1:7x3").develop().metadata
    attributes = {name: value for name, _, value in metadata.exr_attributes(WIDTH, HEIGHT)}
    assert attributes["pullfocus:longExposureSeconds"] == pytest.approx(0.25)
    assert attributes["pullfocus:intervals"] == 2
    assert attributes["expTime"] == pytest.approx(0.25)
    assert attributes["shutterAngle"] == pytest.approx(6 * 360)


@given(st.lists(st.tuples(st.floats(0.01, 100), st.floats(0, 1e4)), min_size=1, max_size=30))
def test_gathered_light_is_the_mean_over_the_time(parts: list[tuple[float, float]]) -> None:
    gathered = LightAccumulator()
    for frames, light in parts:
        gathered.add(np.full((1, 1, 4), light, np.float32), frames)
    total = sum(frames for frames, _ in parts)
    mean = sum(frames * float(np.float32(light)) for frames, light in parts) / total
    np.testing.assert_allclose(gathered.light, mean, rtol=1e-6, atol=1e-6)
    assert gathered.frames == pytest.approx(total)


def test_a_thousand_intervals_round_nothing_away() -> None:
    gathered = LightAccumulator()
    for i in range(1000):
        gathered.add(np.full((1, 1, 1), 60000.0 if i == 0 else 1e-4, np.float32), 1.0)
    assert gathered.light[0, 0, 0] == pytest.approx((60000 + 999e-4) / 1000, rel=1e-7)


@given(st.floats(-1e3, 1e3), st.floats(0.01, 500), st.floats(0.05, 20))
def test_intervals_join_without_gaps_and_fill_the_time(first: float, length: float, step: float) -> None:
    intervals = ShutterInterval(first, first + length, step).intervals()
    assert intervals[0][0] == first
    assert intervals[-1][1] == first + length
    assert all(end == begin for (_, end), (begin, _) in pairwise(intervals))
    assert all(0 < end - begin < step * 1.00001 + 1e-9 for begin, end in intervals)


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        ("1", "such as 1:241"),
        ("", "such as 1:241"),
        ("1:", "cannot be read"),
        ("9:1", "cannot close before it opens: it opens at 9 and closes at 1"),
        ("5:5", "cannot close before it opens"),
        ("1:5x0", "longer than 0 frames"),
        ("1:1e9", "cannot be read"),
        ("1:999999999", "more intervals than"),
        ("1:5,7:6", "it opens at 7 and closes at 6"),
    ],
)
def test_openings_that_make_no_sense_are_one_clear_error(typed: str, message: str) -> None:
    with pytest.raises(SettingsError, match=message):
        parse_shutter_intervals(typed)


def test_impossible_exposures_are_reported(renderer: FrameRenderer, shot: Shot) -> None:
    with pytest.raises(SettingsError, match="colour alone"):
        LongExposure(renderer, shot, "/cam", 1.0, replace(SETTINGS, aovs=("color", "depth")))
    for stops in (float("nan"), -1.0, 41.0):
        with pytest.raises(SettingsError, match="neutral density"):
            LongExposure(renderer, shot, "/cam", 1.0, SETTINGS, nd_stops=stops)
    exposure = LongExposure(renderer, shot, "/cam", 1.0, SETTINGS, grade=Grade())
    with pytest.raises(SettingsError, match="never open"):
        exposure.develop()
    with pytest.raises(SettingsError, match="opens at 2 and closes at 2"):
        exposure.expose(2.0, 2.0)
    with pytest.raises(PullfocusError, match="kodachrome_26"):
        LongExposure(renderer, shot, "/cam", 1.0, SETTINGS, stock="kodachrome_26")
