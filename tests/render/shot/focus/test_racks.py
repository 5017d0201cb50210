"""Racks of the lens: eased in the ring's turn, never faster than the hand, the same as the keys that say them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pxr import Usd

from render.errors import SettingsError
from render.focus import racks
from render.focus.racks import EASES, ease_progress, rack
from render.focus.tracking import FocusRing
from render.model.camera import Camera
from render.model.lens import Lens
from render.shot.focus.rack import pull_rack
from render.shot.focus.ring import close_focus_depth_m, focus_ring
from render.stage import AnchorReader, read_camera
from tests.render.kits.focus_shot import CAMERA, FAR, NEAR, write_shot
from usd_schemas import FocusPoint, LensCamera
from usd_schemas import racks as keyed_racks
from usd_schemas.racks import WeightRack

RING = FocusRing(math.radians(300), 0.5)
CENTRE = {"face": 0, "fan_triangle": 0, "barycentric": (0.5, 0.0, 0.5)}
inverse_depths = st.floats(0, 2)


@given(st.sampled_from(EASES), inverse_depths, inverse_depths, st.floats(0.1, 4), st.floats(0.5, 10))
def test_the_ring_never_turns_faster_than_the_hand(ease, start_w, end_w, length, speed):
    authored = rack(1.0, start_w, 1.0 + length, end_w, ease, ring=RING, max_speed_rad_s=speed)
    times = np.linspace(0, authored.end_s + 1, 4001)
    turns = RING.turn_rad(authored.at(times))
    assert np.abs(np.diff(turns)).max() <= speed * (times[1] - times[0]) * (1 + 1e-9)
    assert authored.at(1.0) == pytest.approx(start_w)
    assert authored.at(authored.end_s) == pytest.approx(end_w)
    assert authored.is_stretched == (authored.end_s > 1.0 + length)
    moves = np.diff(turns) * np.sign(end_w - start_w)
    assert (moves >= -1e-12).all()


@pytest.mark.parametrize("ease", EASES)
def test_a_stretched_rack_is_as_fast_as_the_hand_can_be(ease):
    authored = rack(0.0, 0.0, 0.1, 2.0, ease, ring=RING, max_speed_rad_s=2.0)
    times = np.linspace(0, authored.end_s, 20_001)
    fastest = np.abs(np.diff(RING.turn_rad(authored.at(times)))).max() / (times[1] - times[0])
    assert fastest == pytest.approx(2.0, rel=1e-3)


def test_without_a_ring_or_a_bound_a_rack_keeps_its_length():
    for bounds in ({}, {"ring": RING}, {"max_speed_rad_s": 0.001}):
        assert not rack(0.0, 0.0, 0.1, 2.0, **bounds).is_stretched


def test_the_eases_of_the_lens_and_of_the_keys_are_the_same():
    assert racks.EASES == keyed_racks.EASES
    u = np.linspace(0, 1, 33)
    for ease, (start, end) in keyed_racks.END_SLOPES.items():
        hermite = (u**3 - 2 * u**2 + u) * start + (3 * u**2 - 2 * u**3) + (u**3 - u**2) * end
        np.testing.assert_allclose(ease_progress(ease, u), hermite, atol=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: rack(1, 0, 1, 1), "end after its start"),
        (lambda: rack(0, -1, 1, 1), "in front of the lens"),
        (lambda: rack(0, 0, 1, math.nan), "in front of the lens"),
        (lambda: rack(0, 0, 1, 1, "hop"), "one of linear"),
        (lambda: rack(0, 0, 1, 1, max_speed_rad_s=-1), "fastest turn"),
    ],
)
def test_what_is_no_rack_is_refused(call, message):
    with pytest.raises(SettingsError, match=message):
        call()


@pytest.fixture
def stage(tmp_path):
    stage = Usd.Stage.Open(str(write_shot(tmp_path / "shot.usda")))
    camera = LensCamera(stage.GetPrimAtPath(CAMERA))
    camera.add_focus_point("near", FocusPoint("near", target=(NEAR,), **CENTRE))
    camera.add_focus_point("far", FocusPoint("far", target=(FAR,), **CENTRE))
    return stage


def set_lens(stage, throw_deg, close_mm, speed_deg_s):
    camera = LensCamera(stage.GetPrimAtPath(CAMERA))
    camera.lens.author(type(camera.lens.read())(focus_throw=throw_deg, close_focus=close_mm))
    camera.focus.author(type(camera.focus.read())(max_speed_deg_s=speed_deg_s))


def test_a_slow_hand_makes_the_rack_longer_in_the_shot_too(stage):
    """4 m to about 9.9 m is 0.149 1/m, of 2 1/m that 180 degrees are: about 13 degrees, at 30 in a second with ease."""
    set_lens(stage, 180, 550, 30)
    requested = WeightRack("near", "far", 1, 5)
    authored, lens = pull_rack(stage, AnchorReader(stage), CAMERA, requested)
    camera = read_camera(stage, CAMERA, 1)
    far_depth_m = 10 - 2 * (authored.end - 1) / 23
    turn_deg = 180 * (1 / 4 - 1 / far_depth_m) * close_focus_depth_m(camera)
    assert lens.is_stretched
    assert authored.end == pytest.approx(1 + 24 * 1.5 * turn_deg / 30, rel=1e-5)
    weights = [LensCamera(stage.GetPrimAtPath(CAMERA)).focus_point("far").read(t).weight for t in (1, authored.end)]
    assert weights == [0, 1]


def test_a_hand_that_is_fast_enough_keeps_the_racks_length(stage):
    set_lens(stage, 180, 550, 1000)
    requested = WeightRack("near", "far", 1, 5)
    authored, lens = pull_rack(stage, AnchorReader(stage), CAMERA, requested)
    assert authored == requested
    assert lens.at([0.0, 1.0]) == pytest.approx([1 / 4, 1 / (10 - 8 / 23)], rel=1e-5)


def test_a_rack_to_what_is_behind_the_camera_is_refused(stage):
    camera = LensCamera(stage.GetPrimAtPath(CAMERA))
    camera.add_focus_point("behind", FocusPoint("behind", target=(FAR,), offset=(0, 0, 50)))
    before = stage.GetRootLayer().ExportToString()
    with pytest.raises(SettingsError, match="behind is not at time 5"):
        pull_rack(stage, AnchorReader(stage), CAMERA, WeightRack("near", "behind", 1, 5))
    with pytest.raises(SettingsError, match="got near twice"):
        pull_rack(stage, AnchorReader(stage), CAMERA, WeightRack("near", "near", 1, 5))
    assert stage.GetRootLayer().ExportToString() == before


def test_close_focus_counts_from_the_film_and_the_ring_from_the_pupil():
    marked = 0.55
    camera = Camera(np.eye(4), focal_length_mm=50.0, lens=Lens(close_focus_m=marked))
    depth_m = close_focus_depth_m(camera)
    assert depth_m + 1 / (1 / 0.05 - 1 / depth_m) == pytest.approx(marked)
    ring = focus_ring(camera, 180)
    assert ring is not None
    assert ring.turn_rad(1 / depth_m) == pytest.approx(math.pi)
    assert focus_ring(camera, 0) is None
