"""Curves of a camera: few knots, exact ends, within tolerance of every sample, no overshoot; spline or samples, never both."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pxr import Sdf, Ts, Usd, UsdGeom

from usd_schemas import SchemaError
from usd_schemas.curve_fit import fit_knots
from usd_schemas.curves import author_samples, author_splines, camera_layer, spline_from_knots

FRAMES = np.arange(1.0, 97.0)
SINGLE = 1e-6  # focusDistance and its spline are single precision


def rack(start: float = 2.0, end: float = 9.0) -> np.ndarray:
    """A smooth rack from frame 30 to frame 54."""
    u = np.clip((FRAMES - 30) / 24, 0, 1)
    return np.asarray(start + (end - start) * u * u * (3 - 2 * u))


@pytest.fixture
def stage() -> Usd.Stage:
    stage = Usd.Stage.CreateInMemory()
    stage.SetTimeCodesPerSecond(25)
    stage.SetFramesPerSecond(25)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.Camera.Define(stage, "/shot/cam")
    return stage


def focus(stage: Usd.Stage, times: np.ndarray = FRAMES) -> np.ndarray:
    attribute = stage.GetAttributeAtPath("/shot/cam.focusDistance")
    return np.array([attribute.Get(float(time)) for time in times])


def author_focus(stage: Usd.Stage, distance: np.ndarray, tolerance: float, times: np.ndarray = FRAMES) -> Ts.Spline:
    """The spline of a focus distance with a relative tolerance."""
    allowed = {"focusDistance": tolerance * distance}
    return author_splines(stage, "/shot/cam", times, {"focusDistance": distance}, allowed)["focusDistance"]


def spec_of(layer: Sdf.Layer) -> Sdf.AttributeSpec:
    return layer.GetAttributeAtPath("/shot/cam.focusDistance")


@st.composite
def samples(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    values = draw(st.lists(st.floats(0.1, 1000), min_size=1, max_size=60))
    steps = draw(st.lists(st.floats(0.01, 10), min_size=len(values), max_size=len(values)))
    return np.cumsum(steps), np.array(values)


@given(curve=samples(), tolerance=st.sampled_from([0.0, 1e-4, 1e-2, 0.3]))
def test_a_fit_is_exact_at_its_ends_and_within_tolerance_between(
    curve: tuple[np.ndarray, np.ndarray], tolerance: float
) -> None:
    times, values = curve
    knots = fit_knots(times, values, tolerance * values)
    fitted = knots.at(times)
    assert fitted[0] == values[0]
    assert fitted[-1] == pytest.approx(values[-1], rel=1e-12)
    assert np.all(np.abs(fitted - values) <= tolerance * values + 1e-9 * values.max())


@given(curve=samples(), tolerance=st.sampled_from([0.0, 1e-2]))
def test_a_fit_never_overshoots_its_knots(curve: tuple[np.ndarray, np.ndarray], tolerance: float) -> None:
    times, values = curve
    knots = fit_knots(times, values, tolerance * values)
    for left in range(len(knots.times) - 1):
        between = knots.at(np.linspace(knots.times[left], knots.times[left + 1], 33))
        ends = knots.values[left : left + 2]
        slack = 1e-9 * ends.max()
        assert ends.min() - slack <= between.min()
        assert between.max() <= ends.max() + slack


@given(curve=samples())
def test_usd_evaluates_the_spline_as_the_fit_does(curve: tuple[np.ndarray, np.ndarray]) -> None:
    """A Bezier segment whose handles reach a third of the way is the Hermite cubic."""
    times, values = curve
    knots = fit_knots(times, values)
    spline = spline_from_knots(knots, "double")
    where = np.linspace(times[0], times[-1], 200)
    np.testing.assert_allclose([spline.Eval(float(time)) for time in where], knots.at(where), rtol=1e-7)


def test_a_smooth_rack_takes_as_few_knots_as_an_artist_would(stage: Usd.Stage) -> None:
    spline = author_focus(stage, rack(), 1e-3)
    assert list(spline.GetKnots().keys()) == [1, 30, 54, 96]


def test_an_authored_spline_meets_its_promise(stage: Usd.Stage) -> None:
    wobbling = rack() + 0.3 * np.sin(FRAMES / 7)
    spline = author_focus(stage, wobbling, 1e-3)
    assert len(spline.GetKnots().keys()) < len(FRAMES) / 3
    np.testing.assert_allclose(focus(stage), wobbling, rtol=1e-3 + SINGLE)
    np.testing.assert_allclose(focus(stage, FRAMES[[0, -1]]), wobbling[[0, -1]], rtol=SINGLE)


def test_at_no_tolerance_every_sample_is_met_in_single_precision(stage: Usd.Stage) -> None:
    noisy = rack() + np.random.default_rng(3).uniform(-0.5, 0.5, len(FRAMES))
    author_focus(stage, noisy, 0)
    np.testing.assert_allclose(focus(stage), noisy, rtol=SINGLE)


def test_spline_and_samples_take_each_others_place(stage: Usd.Stage) -> None:
    layer = stage.GetRootLayer()
    for _ in range(2):
        author_samples(stage, "/shot/cam", FRAMES, {"focusDistance": rack()})
        assert layer.GetNumTimeSamplesForPath(spec_of(layer).path) == 96
        assert not spec_of(layer).HasInfo("spline")
        author_focus(stage, rack(), 1e-3)
        assert spec_of(layer).HasInfo("spline")
        assert not spec_of(layer).HasInfo("timeSamples")


def test_new_samples_leave_none_of_the_old(stage: Usd.Stage) -> None:
    author_samples(stage, "/shot/cam", FRAMES, {"focusDistance": rack()})
    author_samples(stage, "/shot/cam", FRAMES[:10] + 0.5, {"focusDistance": rack()[:10]})
    assert stage.GetAttributeAtPath("/shot/cam.focusDistance").GetTimeSamples() == list(FRAMES[:10] + 0.5)


@pytest.mark.parametrize("form", ["spline", "samples"])
def test_a_focus_layer_over_the_shot_gives_the_curve(stage: Usd.Stage, form: str) -> None:
    """Also at another time-code rate than USD's default 24, at which a layer that is silent would be retimed."""
    layer = camera_layer(stage, "/shot/cam", FRAMES, {"focusDistance": rack()}, form)  # type: ignore[arg-type]
    stage.GetRootLayer().subLayerPaths.append(layer.identifier)
    np.testing.assert_allclose(focus(stage), rack(), rtol=1e-6 + SINGLE)
    assert spec_of(layer).HasInfo("spline") is (form == "spline")
    assert spec_of(layer).HasInfo("timeSamples") is (form == "samples")
    assert layer.GetPrimAtPath("/shot/cam").specifier == Sdf.SpecifierOver


def test_both_layers_agree_at_every_frame(stage: Usd.Stage) -> None:
    both = []
    for form in ("spline", "samples"):
        off = {"focusDistance": 1e-5 * rack()}
        over = Usd.Stage.Open(camera_layer(stage, "/shot/cam", FRAMES, {"focusDistance": rack()}, form, off))  # type: ignore[arg-type]
        both.append(focus(over))
    np.testing.assert_allclose(both[0], both[1], rtol=1e-5 + SINGLE)


def test_one_sample_is_a_constant(stage: Usd.Stage) -> None:
    author_splines(stage, "/shot/cam", [7], {"focusDistance": [3.0]})
    assert focus(stage, np.array([-5.0, 7, 99])).tolist() == [3, 3, 3]


@pytest.mark.parametrize(
    ("times", "values", "message"),
    [
        ([], {"focusDistance": []}, "at least one"),
        ([1, 2], {"focusDistance": [3.0]}, "as many values as times"),
        ([1, 2, 2], {"focusDistance": [3.0, 3.0, 3.0]}, "got 2 after 2"),
        ([1, 2], {"focusDistance": [3.0, float("nan")]}, "got nan at time 2"),
        ([1, 2], {"focusDistance": [float("inf"), 3.0]}, "got inf at time 1"),
        ([1, 2], {"focusDistance": [3.0, 0.0]}, "focusDistance must be positive, got 0 at time 2"),
        ([1, 2], {"fStop": [2.0, 2.0], "focalLength": [-3.0, 1.0]}, "focalLength must be positive, got -3 at time 1"),
        ([1, 2], {"fStop": [2.0, -1.0]}, "fStop must be at least 0, got -1 at time 2"),
        ([1], {"tiltShift:tilt": [95.0]}, "tiltShift:tilt must be at least -89 and at most 89, got 95 at time 1"),
        ([1], {"focus:smoothing": [-1.0]}, "focus:smoothing must be at least 0, got -1"),
        ([1], {"focusDistance": [1.0], "clippingRange": [1.0]}, "no attribute 'clippingRange' that takes a spline"),
        ([1], {"focusDistance": [1.0], "nonsense": [1.0]}, "no attribute 'nonsense' that takes a spline"),
        ([1], {}, "at least one attribute"),
    ],
)
def test_what_makes_no_curve_is_refused(
    stage: Usd.Stage, times: list[float], values: dict[str, list[float]], message: str
) -> None:
    before = stage.GetRootLayer().ExportToString()
    for author in (author_splines, author_samples):
        with pytest.raises(SchemaError, match=message):
            author(stage, "/shot/cam", times, values)
    assert stage.GetRootLayer().ExportToString() == before


@pytest.mark.parametrize("path", ["/shot", "/nowhere", "not a path", "/shot/cam.focusDistance"])
def test_a_path_that_is_no_camera_is_refused(stage: Usd.Stage, path: str) -> None:
    with pytest.raises(SchemaError, match="need a camera"):
        camera_layer(stage, path, [1], {"focusDistance": [1.0]})


@pytest.mark.parametrize("path", ["/", "cam", "no path"])
def test_a_layer_needs_an_absolute_path(path: str) -> None:
    with pytest.raises(SchemaError, match="absolute path"):
        author_splines(Sdf.Layer.CreateAnonymous(), path, [1], {"focusDistance": [1.0]})


@pytest.mark.parametrize("tolerance", [-1.0, float("nan"), [1.0, 1.0]])
def test_a_tolerance_must_be_one(stage: Usd.Stage, tolerance: object) -> None:
    with pytest.raises(SchemaError, match="tolerance of a curve of fStop"):
        author_splines(stage, "/shot/cam", [1], {"fStop": [1.0]}, {"fStop": tolerance})  # type: ignore[dict-item]


def test_an_hour_of_frames_is_fitted_in_seconds() -> None:
    times = np.arange(20_000.0)
    steps = np.random.default_rng(1).normal(0, 0.01, len(times))
    values = np.maximum(5 + np.cumsum(steps), 0.5)
    knots = fit_knots(times, values, 1e-2 * values)
    assert len(knots.times) < len(times) / 5
    assert isinstance(spline_from_knots(knots, "float"), Ts.Spline)
