"""Racks as keys: the weights of two points cross by the ease, keys that contradict are refused, and rules find them."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from usd_schemas import FocusPoint, LensCamera, SchemaError
from usd_schemas.racks import EASES, WeightRack, author_rack
from usd_schemas.validation import validate

TIMES = np.linspace(-5, 70, 301)


@pytest.fixture
def stage() -> Usd.Stage:
    return Usd.Stage.CreateInMemory()


@pytest.fixture
def camera(stage: Usd.Stage) -> LensCamera:
    for name in "abc":
        UsdGeom.Xform.Define(stage, f"/{name}")
    camera = LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())
    for name in "abc":
        camera.add_focus_point(name, FocusPoint(name, (f"/{name}",)))
    return camera


def weight(camera: LensCamera, name: str, times: np.ndarray = TIMES) -> np.ndarray:
    return np.array([camera.focus_point(name).read(float(time)).weight for time in times])


def saved(camera: LensCamera) -> str:
    return str(camera.prim.GetStage().GetRootLayer().ExportToString())


CURVES = {
    "linear": lambda u: u,
    "smooth": lambda u: u * u * (3 - 2 * u),
    "in": lambda u: u * u,
    "out": lambda u: 1 - (1 - u) ** 2,
}


@pytest.mark.parametrize("ease", EASES)
def test_the_weights_cross_by_the_ease_and_are_level_before_and_after(camera: LensCamera, ease: str) -> None:
    author_rack(camera, WeightRack("a", "b", 10, 34, ease))  # type: ignore[arg-type]
    share = CURVES[ease](np.clip((TIMES - 10) / 24, 0, 1))
    np.testing.assert_allclose(weight(camera, "b"), share, atol=1e-6)
    np.testing.assert_allclose(weight(camera, "a"), 1 - share, atol=1e-6)


def test_a_rack_keeps_the_weight_that_the_first_point_has(camera: LensCamera) -> None:
    camera.focus_point("a").set_key("weight", 1, 0.3)
    author_rack(camera, WeightRack("a", "b", 10, 34))
    np.testing.assert_allclose(weight(camera, "a") + weight(camera, "b"), 0.3, atol=1e-6)


def test_a_rack_makes_the_points_decide(camera: LensCamera) -> None:
    author_rack(camera, WeightRack("a", "b", 10, 34))
    assert camera.focus.read().mode == "points"


def test_a_rack_can_start_where_another_ends_and_keeps_its_ease(camera: LensCamera) -> None:
    author_rack(camera, WeightRack("a", "b", 1, 25, "in"))
    first = weight(camera, "b", TIMES[TIMES <= 25])
    author_rack(camera, WeightRack("b", "c", 25, 49, "out"))
    np.testing.assert_array_equal(weight(camera, "b", TIMES[TIMES <= 25]), first)
    total = sum(weight(camera, name) for name in "abc")
    np.testing.assert_allclose(total, 1, atol=1e-6)
    assert weight(camera, "c", np.array([0.0, 25, 49, 60])).tolist() == [0, 0, 1, 1]


def test_there_and_back_again(camera: LensCamera) -> None:
    author_rack(camera, WeightRack("a", "b", 1, 13))
    author_rack(camera, WeightRack("b", "a", 37, 49))
    assert weight(camera, "a", np.array([0.0, 1, 13, 25, 37, 49, 60])).tolist() == [1, 1, 0, 0, 0, 1, 1]


def test_the_same_rack_once_more_changes_nothing(camera: LensCamera) -> None:
    author_rack(camera, WeightRack("a", "b", 1, 13, "out"))
    before = saved(camera)
    author_rack(camera, WeightRack("a", "b", 1, 13, "out"))
    assert saved(camera) == before


@pytest.mark.parametrize(
    ("rack", "message"),
    [
        (WeightRack("a", "nobody", 1, 2), "has no focus point named 'nobody'"),
        (WeightRack("a", "a", 1, 2), "got a twice"),
        (WeightRack("a", "b", 2, 2), "must end after its start, got 2 to 2"),
        (WeightRack("a", "b", 1, float("nan")), "must end after its start"),
        (WeightRack("a", "b", 1, 2, "hop"), "must be one of linear, smooth, in, out, got 'hop'"),  # type: ignore[arg-type]
        (WeightRack("a", "b", 20, 40), "contradicts the keys of a's weight at 34"),
        (WeightRack("a", "c", 40, 50), "starts at 40, where a is not in focus"),
        (WeightRack("c", "b", 40, 50), "b is in focus by then: its weight has the key 1 at 34"),
    ],
)
def test_what_contradicts_the_keys_is_refused_and_nothing_is_authored(
    camera: LensCamera, rack: WeightRack, message: str
) -> None:
    author_rack(camera, WeightRack("a", "b", 10, 34))
    before = saved(camera)
    with pytest.raises(SchemaError, match=message):
        author_rack(camera, rack)
    assert saved(camera) == before


def test_a_rack_to_what_is_switched_off_is_refused(camera: LensCamera) -> None:
    camera.focus_point("b").set_key("enabled", 1, True)
    camera.focus_point("b").set_key("enabled", 20, False)
    with pytest.raises(SchemaError, match="b is switched off at 34"):
        author_rack(camera, WeightRack("a", "b", 10, 34))


def rules(camera: LensCamera) -> dict[str, str]:
    return {problem.rule: problem.message for problem in validate(camera.prim.GetStage())}


def test_racks_are_no_contradiction(camera: LensCamera) -> None:
    author_rack(camera, WeightRack("a", "b", 1, 13))
    author_rack(camera, WeightRack("b", "c", 20, 30))
    assert not {"FocusPointKeys", "FocusDrivers"} & set(rules(camera))


def test_keys_of_what_is_switched_off_are_found(camera: LensCamera) -> None:
    camera.focus_point("b").set_key("weight", 5, 1.0)
    camera.focus_point("b").set_key("weight", 30, 1.0)
    camera.focus_point("b").set_key("enabled", 20, False)
    camera.focus_point("b").set_key("enabled", 1, True)
    assert "focus point b has keys of its weight where it is switched off: at 30" in rules(camera)["FocusPointKeys"]


def test_times_at_which_nothing_counts_are_found(camera: LensCamera) -> None:
    for name in "abc":
        camera.focus_point(name).set_key("weight", 5, 1.0)
        camera.focus_point(name).set_key("weight", 9, 0.0)
    assert "no focus point counts at 9" in rules(camera)["FocusPointKeys"]


def test_a_focus_that_is_keyed_and_solved_is_found(camera: LensCamera) -> None:
    camera.set_key("focusDistance", 1, 3.0)
    assert "FocusDrivers" not in rules(camera)
    author_rack(camera, WeightRack("a", "b", 1, 13))
    assert "focus:mode is points: they are used only where no focus point is" in rules(camera)["FocusDrivers"]
