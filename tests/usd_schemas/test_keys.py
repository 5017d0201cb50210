"""Keys over time: native splines for numbers, held or linear samples for the rest, and never both in one layer."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pxr import Sdf, Usd, UsdGeom

from usd_schemas import FocusPoint, FocusPointView, Key, LensCamera, SchemaError, Tangents, keys


@pytest.fixture
def stage() -> Usd.Stage:
    return Usd.Stage.CreateInMemory()


@pytest.fixture
def point(stage: Usd.Stage) -> FocusPointView:
    camera = LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())
    return camera.add_focus_point("hero", FocusPoint("hero", ("/subject",)))


def weights(point: FocusPointView, times: np.ndarray) -> np.ndarray:
    return np.array([point.read(float(time)).weight for time in times])


def test_linear_keys_join_in_straight_lines_and_hold_beyond(point: FocusPointView) -> None:
    point.set_key("weight", 10, 0.0)
    point.set_key("weight", 20, 1.0)
    np.testing.assert_allclose(weights(point, np.array([0.0, 10, 12.5, 20, 99])), [0, 0, 0.25, 1, 1])


def test_held_keys_jump(point: FocusPointView) -> None:
    point.set_key("weight", 10, 0.25, "held")
    point.set_key("weight", 20, 1.0, "held")
    np.testing.assert_allclose(weights(point, np.array([10, 19.99, 20])), [0.25, 0.25, 1])


def test_auto_keys_ease(point: FocusPointView) -> None:
    point.set_key("weight", 10, 0.0, "auto")
    point.set_key("weight", 20, 1.0, "auto")
    eased = weights(point, np.array([11.0, 15.0, 19.0]))
    assert eased[0] < 0.05
    assert eased[1] == pytest.approx(0.5)
    assert eased[2] > 0.95


@given(
    times=st.lists(st.integers(0, 1000), min_size=2, max_size=8, unique=True).map(sorted),
    values=st.lists(st.floats(0, 100), min_size=8, max_size=8),
    order=st.randoms(use_true_random=False),
)
def test_auto_keys_never_overshoot(times: list[int], values: list[float], order: st.DataObject) -> None:
    """Between two keys the value stays between theirs, in whatever order they were set."""
    stage = Usd.Stage.CreateInMemory()
    camera = LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())
    pairs = list(zip(times, values, strict=False))
    shuffled = pairs[:]
    order.shuffle(shuffled)  # type: ignore[attr-defined]
    for time, value in shuffled:
        camera.set_key("focusDistance", time, value, "auto")
    attribute = camera.prim.GetAttribute("focusDistance")
    for (start, low), (end, high) in pairwise(pairs):
        between = np.array([attribute.Get(float(time)) for time in np.linspace(start, end, 9)])
        slack = 1e-5 * max(low, high) + 1e-12  # focusDistance is single precision
        assert between.min() >= min(low, high) - slack
        assert between.max() <= max(low, high) + slack


def test_bezier_keys_keep_their_tangents(point: FocusPointView) -> None:
    tangents = Tangents(in_slope=0.0, in_width=2.0, out_slope=0.1, out_width=3.0)
    point.set_key("weight", 10, 0.0, "bezier", tangents)
    point.set_key("weight", 20, 1.0, "linear")
    point.set_key("weight", 14, 0.9, "linear")
    assert point.keys("weight")[0] == Key(10, 0.0, "bezier", tangents)


def test_bezier_keys_without_tangents_ease_to_later_neighbours(point: FocusPointView) -> None:
    point.set_key("weight", 10, 0.0, "bezier")
    point.set_key("weight", 20, 1.0, "bezier")
    eased = weights(point, np.array([11.0, 15.0, 19.0]))
    assert eased[0] < 0.05
    assert eased[1] == pytest.approx(0.5)
    assert eased[2] > 0.95


def test_keys_come_back_as_they_were_set(point: FocusPointView) -> None:
    point.set_key("weight", 30, 0.25, "held")
    point.set_key("weight", 10, 0.0, "linear")
    point.set_key("weight", 20, 1.0, "auto")
    assert point.keys("weight") == [Key(10, 0.0, "linear"), Key(20, 1.0, "auto"), Key(30, 0.25, "held")]


def test_a_key_replaces_the_one_at_its_time(point: FocusPointView) -> None:
    point.set_key("weight", 10, 0.0, "auto")
    point.set_key("weight", 10, 0.5, "linear")
    assert point.keys("weight") == [Key(10, 0.5, "linear")]


def test_a_switch_holds_until_the_next_key(point: FocusPointView) -> None:
    point.set_key("enabled", 10, False)
    point.set_key("enabled", 20, True)
    assert [point.read(time).enabled for time in (10, 19.9, 20, 30)] == [False, False, True, True]
    assert point.keys("enabled") == [Key(10, False, "held"), Key(20, True, "held")]


def test_an_offset_moves_in_straight_lines(point: FocusPointView) -> None:
    point.set_key("offset", 10, (0.0, 0.0, 0.0))
    point.set_key("offset", 20, (1.0, 2.0, 4.0))
    assert point.read(15).offset == (0.5, 1.0, 2.0)


def test_the_property_may_be_named_as_python_or_as_usd_has_it(point: FocusPointView) -> None:
    point.set_key("surface_offset", 1, 2.0)
    assert point.keys("surfaceOffset") == point.keys("surface_offset") == [Key(1, 2.0, "linear")]


def test_removing_keys_leaves_the_others_and_at_last_the_value(point: FocusPointView) -> None:
    for time, value in ((10, 0.25), (20, 0.5), (30, 1.0)):
        point.set_key("weight", time, value)
    point.remove_key("weight", 20)
    assert [key.time for key in point.keys("weight")] == [10, 30]
    point.remove_key("weight", 30)
    point.remove_key("weight", 10)
    assert point.keys("weight") == []
    assert point.read(99).weight == 0.25


@pytest.mark.parametrize("attribute", ["weight", "enabled"])
def test_a_key_that_is_not_there_is_named(point: FocusPointView, attribute: str) -> None:
    point.set_key(attribute, 10, True if attribute == "enabled" else 1.0)
    with pytest.raises(SchemaError, match="no key at time 11; its keys are at: 10"):
        point.remove_key(attribute, 11)


@pytest.mark.parametrize(
    ("attribute", "value", "interpolation", "message"),
    [
        ("weight", 1.0, "wobbly", "must be one of linear, held, bezier, auto"),
        ("weight", -1.0, "linear", "must be at least 0"),
        ("weight", float("nan"), "linear", "is of type double, got nan"),
        ("weight", "heavy", "linear", "is of type double, got 'heavy'"),
        ("enabled", True, "auto", "takes held keys alone, got auto"),
        ("offset", (0.0, 0.0, 0.0), "bezier", "takes linear keys alone, got bezier"),
        ("offset", (0.0, 0.0), "linear", "is of type double3"),
        ("kind", "soft", "linear", "is uniform"),
    ],
)
def test_keys_that_cannot_be_are_refused(
    point: FocusPointView, attribute: str, value: object, interpolation: keys.Interpolation, message: str
) -> None:
    with pytest.raises(SchemaError, match=message):
        point.set_key(attribute, 10, value, interpolation)


@pytest.mark.parametrize("time", [float("nan"), float("inf")])
def test_a_time_must_be_one(point: FocusPointView, time: float) -> None:
    with pytest.raises(SchemaError, match="time code must be a finite number"):
        point.set_key("weight", time, 1.0)


# Layers ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("attribute", "values"), [("weight", (0.0, 1.0, 0.5)), ("enabled", (True, False, True))])
def test_an_edit_layer_takes_the_keys_below_with_it(
    stage: Usd.Stage, point: FocusPointView, attribute: str, values: tuple[object, ...]
) -> None:
    point.set_key(attribute, 10, values[0])
    point.set_key(attribute, 20, values[1])
    below = stage.GetRootLayer().ExportToString()
    stage.SetEditTarget(stage.GetSessionLayer())
    point.set_key(attribute, 15, values[2])
    assert [key.time for key in point.keys(attribute)] == [10, 15, 20]
    point.remove_key(attribute, 10)
    assert [key.time for key in point.keys(attribute)] == [15, 20]
    assert stage.GetRootLayer().ExportToString() == below


def test_keying_baked_samples_makes_a_spline_through_them(stage: Usd.Stage, point: FocusPointView) -> None:
    attribute = stage.GetAttributeAtPath("/cam.focusPoint:hero:weight")
    for time in range(5):
        attribute.Set(time / 4, time)
    point.set_key("weight", 10, 2.0)
    spec = stage.GetRootLayer().GetAttributeAtPath(attribute.GetPath())
    assert spec.HasInfo("spline")
    assert not spec.HasInfo("timeSamples"), "samples would hide the spline"
    np.testing.assert_allclose(weights(point, np.array([0, 2.5, 4, 10])), [0, 0.625, 1, 2])


def test_keys_follow_the_offset_of_the_layer_they_are_in(stage: Usd.Stage) -> None:
    """A key set at stage time 24 is read at stage time 24, though its layer runs at half the pace."""
    sub = Sdf.Layer.CreateAnonymous(".usda")
    stage.GetRootLayer().subLayerPaths.append(sub.identifier)
    stage.GetRootLayer().subLayerOffsets[0] = Sdf.LayerOffset(10, 2)
    stage.SetEditTarget(stage.GetEditTargetForLocalLayer(sub))
    camera = LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())
    camera.set_key("focusDistance", 24, 3.0)
    camera.set_key("focusDistance", 34, 5.0)
    assert camera.keys("focusDistance") == [Key(24, 3.0, "linear"), Key(34, 5.0, "linear")]
    assert camera.prim.GetAttribute("focusDistance").Get(29) == 4.0


@pytest.mark.parametrize(
    ("interpolation", "header"),
    [("linear", "#usda 1.0"), ("held", "#usda 1.0"), ("bezier", "#usda 1.0"), ("auto", "#usda 1.1")],
)
def test_only_auto_keys_need_a_newer_file_version(
    stage: Usd.Stage, point: FocusPointView, interpolation: keys.Interpolation, header: str
) -> None:
    """USD's easing algorithm is the one thing that older readers of splines do not know."""
    point.set_key("weight", 1, 0.0, interpolation)
    point.set_key("weight", 9, 1.0, interpolation)
    assert stage.GetRootLayer().ExportToString().splitlines()[0] == header
